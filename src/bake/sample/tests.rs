//! The sampler against the brute-force oracle.

use super::lines::Batch;
use super::random::Random;
use super::{Ancestry, Met, Observer, Target, oracle, sample_batch};
use crate::bake::hierarchy::{self, HierarchyKind};
use crate::bake::rays::RayScene;
use crate::bake::subject::box_in_tree;
use crate::bake::tree::{Member, Part};
use crate::scene::{Mesh, Opacity, Surface};
use glam::{DAffine3, DMat3, DVec3, Vec3};
use svs_runtime::directions::DirectionSet;

/// A few triangles each: opaque or transparent, one-sided or two-sided.
fn random_mesh(random: &mut Random) -> Mesh {
    let triangles = 1 + (random.next() % 6) as u32;
    let positions: Vec<Vec3> = (0..triangles * 3)
        .map(|_| DVec3::new(random.unit(), random.unit(), random.unit()).as_vec3() - Vec3::splat(0.5))
        .collect();
    let split = random.next() as u32 % (triangles + 1);
    let mut surface = |range: std::ops::Range<u32>| Surface {
        triangles: range,
        double_sided: random.next().is_multiple_of(2),
        opacity: if random.next().is_multiple_of(3) { Opacity::Transparent } else { Opacity::Opaque },
    };
    Mesh {
        min: positions.iter().fold(DVec3::INFINITY, |m, p| m.min(p.as_dvec3())),
        max: positions.iter().fold(DVec3::NEG_INFINITY, |m, p| m.max(p.as_dvec3())),
        triangles: (0..triangles).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
        surfaces: vec![surface(0..split), surface(split..triangles)],
        drawn_triangles: triangles,
        positions,
        ..Mesh::default()
    }
}

/// Forty placements of six meshes, so that some are drawn once and some often; turned, stretched and mirrored.
fn random_scene(seed: u64) -> (Vec<Mesh>, Vec<Member>, Vec<Part>) {
    let mut random = Random::new(seed, 77);
    let meshes: Vec<Mesh> = (0..6).map(|_| random_mesh(&mut random)).collect();
    let (mut members, mut parts) = (Vec::new(), Vec::new());
    for member in 0..40 {
        let mesh = if member < 4 { member } else { 4 + (random.next() % 2) as u32 };
        let scale = DVec3::new(random.unit() + 0.3, random.unit() + 0.3, random.unit() + 0.3)
            * if random.next().is_multiple_of(2) { -1.0 } else { 1.0 };
        let to_tree = DAffine3 {
            matrix3: random.rotation() * DMat3::from_diagonal(scale),
            translation: DVec3::new(random.unit(), random.unit(), random.unit()) * 4.0,
        };
        members.push(Member {
            bounds: box_in_tree(&meshes[mesh as usize], &to_tree),
            triangles: meshes[mesh as usize].drawn_triangles,
            parts: member..member + 1,
        });
        parts.push(Part { mesh, member, to_tree });
    }
    (meshes, members, parts)
}

fn quiet(met: &Met) -> Observer<'_> {
    Observer { areas: None, met, advance: &|_| () }
}

#[test]
fn levels_equal_the_oracle() {
    let directions = DirectionSet::by_name("dodecahedron").unwrap();
    for (seed, kind) in [
        (1, HierarchyKind::Octree),
        (2, HierarchyKind::Bvh),
        (3, HierarchyKind::Octree),
        (4, HierarchyKind::Bvh),
    ] {
        let (meshes, members, parts) = random_scene(seed);
        let scene = RayScene::new(&meshes, &parts);
        let hierarchy = hierarchy::build(kind, &members, &[]);
        let mut target = Target::new(Ancestry::new(&hierarchy), directions.len());
        let (rays, index) = (40_000, seed);
        let found = sample_batch(
            &scene,
            directions,
            std::slice::from_mut(&mut target),
            quiet(&Met::new(members.len())),
            rays,
            index,
        )[0];
        assert!(found.seen > 1_000);
        assert_eq!(found.seen, found.missed, "nothing was known before the first batch");

        let batch: Batch = super::batch(&scene, directions, rays, index);
        assert_eq!(batch.rays, found.rays);
        let expected = oracle::levels(&meshes, &parts, &hierarchy, directions, &batch, |point| {
            scene.center() + point * scene.radius()
        });
        for member in 0..members.len() as u32 {
            assert_eq!(target.levels.row(member), expected[member as usize], "seed {seed}, member {member}");
        }
    }
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let directions = DirectionSet::by_name("icosahedron-1").unwrap();
    let (meshes, members, parts) = random_scene(9);
    let hierarchy = hierarchy::build(HierarchyKind::Octree, &members, &[]);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let scene = RayScene::new(&meshes, &parts);
            let ancestry = Ancestry::new(&hierarchy);
            let mut areas = super::Areas::new(&ancestry, directions.len());
            let mut target = Target::new(ancestry, directions.len());
            let mut found = Vec::new();
            for index in 0..2 {
                found.extend(sample_batch(
                    &scene,
                    directions,
                    std::slice::from_mut(&mut target),
                    Observer { areas: Some(&mut areas), ..quiet(&Met::new(members.len())) },
                    100_000,
                    index,
                ));
            }
            let areas: Vec<Vec<f64>> = (0..members.len() as u32).map(|m| areas.largest(m)).collect();
            (target.levels, areas, found)
        })
    };
    let one = run(1);
    assert_eq!(one, run(2));
    assert!(one.2[1].missed < one.2[1].seen / 20, "the second batch finds little that is new");
}

#[test]
fn areas_are_those_of_a_known_shape() {
    // A square of side 1 seen from all sides next to a far speck: its largest visible area is 1, seen head-on.
    let square = Mesh {
        positions: vec![
            Vec3::new(-0.5, -0.5, 0.0),
            Vec3::new(0.5, -0.5, 0.0),
            Vec3::new(0.5, 0.5, 0.0),
            Vec3::new(-0.5, 0.5, 0.0),
        ],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        surfaces: vec![Surface { triangles: 0..2, double_sided: true, opacity: Opacity::Opaque }],
        drawn_triangles: 2,
        min: DVec3::new(-0.5, -0.5, 0.0),
        max: DVec3::new(0.5, 0.5, 0.0),
        ..Mesh::default()
    };
    let meshes = [square];
    let place = |x: f64| DAffine3::from_translation(DVec3::new(x, 0.0, 0.0));
    let parts: Vec<Part> = [0.0, 3.0]
        .iter()
        .enumerate()
        .map(|(m, &x)| Part { mesh: 0, member: m as u32, to_tree: place(x) })
        .collect();
    let members: Vec<Member> = parts
        .iter()
        .map(|p| Member {
            bounds: box_in_tree(&meshes[0], &p.to_tree),
            triangles: 2,
            parts: p.member..p.member + 1,
        })
        .collect();
    let hierarchy = hierarchy::build(HierarchyKind::Octree, &members, &[]);
    let scene = RayScene::new(&meshes, &parts);
    let ancestry = Ancestry::new(&hierarchy);
    let directions = DirectionSet::by_name("octahedron-2").unwrap();
    let mut areas = super::Areas::new(&ancestry, directions.len());
    let mut target = Target::new(ancestry, directions.len());
    sample_batch(
        &scene,
        directions,
        std::slice::from_mut(&mut target),
        Observer { areas: Some(&mut areas), ..quiet(&Met::new(2)) },
        2_000_000,
        1,
    );
    for member in 0..2 {
        let area = areas.largest(member)[0] * scene.radius() * scene.radius();
        // The mean over the bin around the normal: the cell reaches about 12 degrees from it.
        assert!((0.96..1.01).contains(&area), "{area}");
    }
}
