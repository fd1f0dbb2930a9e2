use super::exact_ball::exact_ball;
use super::*;
use crate::bake::hierarchy::{self, HierarchyKind};
use crate::bake::tree::Aabb;
use glam::{DAffine3, DQuat, DVec3};
use proptest::prelude::*;

const KINDS: [SphereKind; 2] = [SphereKind::Simple, SphereKind::Tight];

/// Numbers in [-1, 1), the same every time (splitmix64).
fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (state ^ state >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// `count` points: 0 in a cube, 1 on a sphere, 2 in an ellipsoid, 3 on few grid points, 4 on a line, 5 in a plane.
fn cloud(shape: u32, count: usize, seed: u64) -> Vec<DVec3> {
    let mut random = random(seed);
    (0..count)
        .map(|_| {
            let point = DVec3::new(random(), random(), random());
            match shape {
                0 => point,
                1 => point.normalize_or(DVec3::X),
                2 => point.normalize_or(DVec3::X) * point.length() * DVec3::new(5.0, 2.0, 1.0),
                3 => (point * 1.5).round(),
                4 => DVec3::new(1.0, 2.0, 3.0) * point.x,
                _ => point.x * DVec3::new(1.0, 2.0, 3.0) + point.y * DVec3::new(-2.0, 1.0, 0.5),
            }
        })
        .collect()
}

fn mesh(points: &[DVec3], origin: DVec3) -> Mesh {
    let count = points.len() as u32;
    Mesh {
        positions: points.iter().map(|point| point.as_vec3()).collect(),
        origin,
        triangles: (0..count).map(|i| [i, (i + 1) % count, (i + 2) % count]).collect(),
        ..Mesh::default()
    }
}

struct Model {
    members: Vec<Member>,
    parts: Vec<Part>,
    meshes: Vec<Mesh>,
}

impl Model {
    /// Members of one or two parts, stretched, rotated, mirrored, and placed about `offset`; sizes in `unit`s.
    fn random(count: u32, seed: u64, unit: f64, offset: DVec3) -> Self {
        let mut random = random(seed);
        let meshes = (0..6u32)
            .map(|shape| {
                let origin = DVec3::new(random(), random(), random()) * 10.0;
                mesh(&cloud(shape, 40 + 60 * shape as usize, seed + u64::from(shape)), origin)
            })
            .collect();
        let mut model = Self { members: Vec::new(), parts: Vec::new(), meshes };
        for member in 0..count {
            let start = model.parts.len() as u32;
            let place = DVec3::new(random(), random(), random()) * 50.0;
            for _ in 0..1 + member % 2 {
                let scale = DVec3::new(random(), 1.2 + random(), 1.2 + random()) * unit;
                let rotation =
                    DQuat::from_euler(glam::EulerRot::XYZ, random() * 3.0, random() * 3.0, random() * 3.0);
                let to_tree = DAffine3::from_scale_rotation_translation(
                    scale,
                    rotation,
                    (place + DVec3::splat(random())) * unit + offset,
                );
                let mesh = ((random() + 1.0) * 3.0) as u32;
                model.parts.push(Part { mesh, member, to_tree });
            }
            let parts = start..model.parts.len() as u32;
            model.members.push(Member { bounds: Aabb::EMPTY, triangles: 1, parts });
            let vertices = model.vertices(member);
            model.members[member as usize].bounds = Aabb {
                min: vertices.iter().copied().fold(DVec3::INFINITY, DVec3::min),
                max: vertices.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max),
            };
        }
        model
    }

    fn vertices(&self, member: u32) -> Vec<DVec3> {
        let parts = self.members[member as usize].parts.clone();
        parts
            .flat_map(|part| {
                let part = &self.parts[part as usize];
                let mesh = &self.meshes[part.mesh as usize];
                let place = |p: &glam::Vec3| part.to_tree.transform_point3(mesh.origin + p.as_dvec3());
                mesh.positions.iter().map(place).collect::<Vec<_>>()
            })
            .collect()
    }

    fn spheres(&self, kind: SphereKind, hierarchy: &Hierarchy) -> Vec<Sphere> {
        spheres(kind, hierarchy, &self.members, &self.parts, &self.meshes)
    }

    /// Vertices below a node.
    fn below(&self, hierarchy: &Hierarchy, node: usize) -> Vec<DVec3> {
        let places = hierarchy.nodes[node].members.clone();
        places.flat_map(|place| self.vertices(hierarchy.order[place as usize])).collect()
    }
}

/// The smallest ball by trying all pairs, triples and quadruples, with formulas other than the ones under test.
fn brute_force_radius(points: &[DVec3]) -> f64 {
    let mut best = f64::INFINITY;
    let mut attempt = |center: DVec3| {
        if center.is_finite() {
            let radius = points.iter().map(|point| point.distance(center)).fold(0.0, f64::max);
            best = best.min(radius);
        }
    };
    // Any centre gives an upper bound, so wrong candidates do no harm, and the right one is among them.
    for (i, &a) in points.iter().enumerate() {
        attempt(a);
        for (j, &b) in points.iter().enumerate().skip(i + 1) {
            attempt((a + b) * 0.5);
            for (k, &c) in points.iter().enumerate().skip(j + 1) {
                let (u, v) = (b - a, c - a);
                let w = u.cross(v);
                let flat = v.length_squared() * w.cross(u) - u.length_squared() * w.cross(v);
                attempt(a + flat / (2.0 * w.length_squared()));
                for &d in &points[k + 1..] {
                    let t = d - a;
                    let numerator = t.length_squared() * w
                        + v.length_squared() * t.cross(u)
                        + u.length_squared() * v.cross(t);
                    attempt(a + numerator / (2.0 * t.dot(w)));
                }
            }
        }
    }
    best
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn the_exact_ball_is_the_smallest(shape in 0u32..6, count in 1usize..12, seed: u64) {
        let points = cloud(shape, count, seed);
        let ball = exact_ball(&points).unwrap();
        let expected = brute_force_radius(&points);
        prop_assert!((ball.radius - expected).abs() <= 1e-9 * expected.max(1e-3), "{} {expected}", ball.radius);
        for point in points {
            prop_assert!(point.distance(ball.center) <= ball.radius);
        }
    }

    #[test]
    fn the_exact_ball_has_no_favourite_unit_or_place(shape in 0u32..6, count in 1usize..90, seed: u64) {
        let points = cloud(shape, count, seed);
        let ball = exact_ball(&points).unwrap();
        for (scale, offset) in [(1e-6, 0.0), (1e6, 0.0), (1e-30, 0.0), (1e30, 0.0), (1.0, 1e7)] {
            let moved: Vec<DVec3> = points.iter().map(|&point| point * scale + DVec3::splat(offset)).collect();
            let moved = exact_ball(&moved).unwrap();
            let rounding = if offset > 0.0 { 1e-8 } else { 0.0 };
            let error = 1e-9 * ball.radius * scale + rounding;
            prop_assert!((moved.radius - ball.radius * scale).abs() <= error);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn spheres_hold_all_vertices(count in 1u32..60, seed: u64, exponent in -8i32..8, far: bool) {
        let offset = if far { DVec3::new(1e7, -3e6, 17.0) } else { DVec3::ZERO };
        let model = Model::random(count, seed, 10f64.powi(exponent), offset);
        for hierarchy_kind in [HierarchyKind::Octree, HierarchyKind::Bvh] {
            let hierarchy = hierarchy::build(hierarchy_kind, &model.members, &[]);
            for kind in KINDS {
                let spheres = model.spheres(kind, &hierarchy);
                prop_assert_eq!(spheres.len(), hierarchy.nodes.len());
                for (node, sphere) in spheres.iter().enumerate() {
                    prop_assert_eq!(sphere.center, sphere.center.as_vec3().as_dvec3());
                    prop_assert_eq!(sphere.radius, f64::from(sphere.radius as f32));
                    for vertex in model.below(&hierarchy, node) {
                        prop_assert!(vertex.distance(sphere.center) <= sphere.radius);
                    }
                }
            }
        }
    }
}

#[test]
fn unions_of_two() {
    let ball = |x: f64, radius| Sphere { center: DVec3::new(x, 2.0, 3.0), radius };
    let union = |a, b| simple::union_of_two(&a, &b);
    assert_eq!(union(ball(0.0, 1.0), ball(4.0, 1.0)), ball(2.0, 3.0));
    assert_eq!(union(ball(0.0, 1.0), ball(6.0, 3.0)), ball(4.0, 5.0));
    assert_eq!(union(ball(0.0, 9.0), ball(6.0, 3.0)), ball(0.0, 9.0));
    assert_eq!(union(ball(0.0, 1.0), ball(1.0, 3.0)), ball(1.0, 3.0));
    assert_eq!(union(ball(1.0, 2.0), ball(1.0, 2.0)), ball(1.0, 2.0));
}

#[test]
fn the_directions_are_distinct_axes() {
    for (i, a) in epos98::NORMALS.iter().enumerate() {
        for b in &epos98::NORMALS[..i] {
            let cross = DVec3::from(a.map(f64::from)).cross(DVec3::from(b.map(f64::from)));
            assert!(cross.length() > 0.0, "{a:?} {b:?}");
        }
    }
}

#[test]
fn extreme_points_give_nearly_the_smallest_ball() {
    let mut worst: f64 = 0.0;
    let mut worst_final: f64 = 0.0;
    for seed in 0..60 {
        let points = cloud(seed as u32 % 3, 300 + 40 * seed as usize, seed);
        // What the mesh holds: positions rounded to f32.
        let points: Vec<DVec3> = points.iter().map(|point| point.as_vec3().as_dvec3()).collect();
        let mesh = MeshPoints::new(&mesh(&points, DVec3::ZERO));
        let part = || PlacedPart::new(&mesh, DAffine3::IDENTITY);
        let mut extremes = epos98::Extremes::EMPTY;
        extremes.add_part(&part().unwrap());
        let exact = exact_ball(&points).unwrap().radius;
        let first = exact_ball(&extremes.points()).unwrap();
        let enlarged = points.iter().map(|point| point.distance(first.center)).fold(0.0, f64::max);
        worst = worst.max(enlarged / exact - 1.0);
        let refined = tight::ball(extremes.points(), || part().into_iter()).unwrap().radius;
        worst_final = worst_final.max(refined / exact - 1.0);
    }
    // Measured: 6.9e-3 (points on and in spheres are the worst case for few directions) and 1.8e-8.
    assert!(worst < 1e-2, "{worst}");
    assert!(worst_final < 2e-6, "{worst_final}");
}

#[test]
fn the_farthest_and_the_most_extreme_vertex_are_found() {
    let model = Model::random(12, 9, 1.0, DVec3::new(5.0, 6.0, 7.0));
    let mut random = random(4);
    for part in &model.parts {
        let mesh = &model.meshes[part.mesh as usize];
        let points = MeshPoints::new(mesh);
        let placed = PlacedPart::new(&points, part.to_tree).unwrap();
        let vertices: Vec<DVec3> = mesh
            .positions
            .iter()
            .map(|p| part.to_tree.transform_point3(mesh.origin + p.as_dvec3()))
            .collect();
        for _ in 0..20 {
            let direction = DVec3::new(random(), random(), random());
            let expected = vertices.iter().map(|v| v.dot(direction)).fold(f64::MIN, f64::max);
            let found = placed.extreme(direction).unwrap().dot(direction);
            assert!((found - expected).abs() < 1e-9);
            let center = direction * 80.0;
            let expected = vertices.iter().map(|v| v.distance_squared(center)).fold(0.0, f64::max);
            assert_eq!(placed.farthest(center, 0.0).unwrap().1, expected);
            assert!(placed.farthest(center, expected).is_none());
        }
    }
}

#[test]
fn tight_spheres_are_the_smallest_and_simple_ones_not_much_larger() {
    let model = Model::random(300, 3, 1.0, DVec3::ZERO);
    let hierarchy = hierarchy::build(HierarchyKind::Octree, &model.members, &[]);
    let simple = model.spheres(SphereKind::Simple, &hierarchy);
    let tight = model.spheres(SphereKind::Tight, &hierarchy);
    for (node, (simple, tight)) in simple.iter().zip(&tight).enumerate() {
        let smallest = exact_ball(&model.below(&hierarchy, node)).unwrap().radius;
        assert!(tight.radius >= smallest && tight.radius <= smallest * (1.0 + 3e-6));
        assert!(simple.radius >= smallest);
    }
    let sum = |spheres: &[Sphere]| spheres.iter().map(|sphere| sphere.radius).sum::<f64>();
    let ratio = sum(&simple) / sum(&tight);
    // Measured: 1.198; the dissertation has 1.068 to 1.181 for its scenes.
    assert!((1.0..1.3).contains(&ratio), "{ratio}");
}

#[test]
fn a_box_is_held_by_the_sphere_about_it() {
    let corners: Vec<DVec3> =
        (0..8).map(|i| DVec3::from([0, 1, 2].map(|bit| f64::from(i >> bit & 1)))).collect();
    let meshes = vec![mesh(&corners, DVec3::ZERO)];
    let place = |x: u32| DAffine3::from_translation(DVec3::X * f64::from(x));
    let parts: Vec<Part> = (0..4).map(|i| Part { mesh: 0, member: i, to_tree: place(i) }).collect();
    let member = |i: u32| Member {
        bounds: Aabb { min: DVec3::X * f64::from(i), max: DVec3::X * f64::from(i) + 1.0 },
        triangles: 8,
        parts: i..i + 1,
    };
    let members: Vec<Member> = (0..4).map(member).collect();
    let hierarchy = hierarchy::build(HierarchyKind::Octree, &members, &[]);
    for kind in KINDS {
        let sphere = spheres(kind, &hierarchy, &members, &parts, &meshes)[0];
        assert!(sphere.center.distance(DVec3::new(2.0, 0.5, 0.5)) < 1e-6);
        assert!((sphere.radius - 4.5f64.sqrt()).abs() < 1e-6, "{kind:?} {}", sphere.radius);
    }
}

#[test]
fn the_unit_and_the_place_do_not_matter() {
    let model = Model::random(50, 8, 1.0, DVec3::ZERO);
    let hierarchy = hierarchy::build(HierarchyKind::Octree, &model.members, &[]);
    for kind in KINDS {
        let expected = model.spheres(kind, &hierarchy);
        for (unit, offset, tolerance) in
            [(1e-6, DVec3::ZERO, 1e-5), (1e6, DVec3::ZERO, 1e-5), (1.0, DVec3::splat(1e7), 0.9)]
        {
            // An f32 at 1e7 is at most half a metre off, along each axis.
            let moved = Model::random(50, 8, unit, offset);
            for (sphere, expected) in moved.spheres(kind, &hierarchy).iter().zip(&expected) {
                let error = (sphere.radius / unit - expected.radius).abs();
                assert!(error <= tolerance * expected.radius.max(1.0), "{kind:?} {unit} {error}");
            }
        }
    }
}

#[test]
fn threads_do_not_matter() {
    let model = Model::random(700, 21, 1.0, DVec3::ZERO);
    let hierarchy = hierarchy::build(HierarchyKind::Bvh, &model.members, &[]);
    for kind in KINDS {
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| model.spheres(kind, &hierarchy))
        };
        assert_eq!(with(1), with(5));
    }
}

#[test]
fn what_has_no_vertices_has_no_influence() {
    let mut model = Model::random(20, 2, 1.0, DVec3::ZERO);
    let before = hierarchy::build(HierarchyKind::Octree, &model.members, &[]);
    let expected: Vec<Vec<Sphere>> = KINDS.map(|kind| model.spheres(kind, &before)).to_vec();
    // No box; no mesh; a transform without numbers; a vertex that no triangle uses; an empty mesh.
    model.meshes[0].positions.push(glam::Vec3::splat(1e6));
    model.meshes.push(Mesh::default());
    let far = DAffine3::from_translation(DVec3::splat(1e300));
    let bounds = Aabb { min: DVec3::ZERO, max: DVec3::ONE };
    for (mesh, to_tree, bounds) in [
        (0, DAffine3::from_translation(DVec3::splat(1e5)), Aabb::EMPTY),
        (99, DAffine3::IDENTITY, bounds),
        (0, DAffine3::NAN, bounds),
        (0, far, bounds),
        (6, DAffine3::IDENTITY, bounds),
    ] {
        let part = model.parts.len() as u32;
        model.parts.push(Part { mesh, member: model.members.len() as u32, to_tree });
        model.members.push(Member { bounds, triangles: 0, parts: part..part + 1 });
    }
    model.members.push(Member { bounds: Aabb::EMPTY, triangles: 0, parts: 5_000..6_000 });
    model.members.push(Member { bounds, triangles: 0, parts: u32::MAX - 1..u32::MAX });
    let root = |spheres: Vec<Sphere>| spheres[0];
    let after = hierarchy::build(HierarchyKind::Octree, &model.members, &[]);
    for (kind, expected) in KINDS.into_iter().zip(expected) {
        let spheres = model.spheres(kind, &after);
        assert!(spheres.iter().all(|sphere| sphere.center.is_finite() && sphere.radius.is_finite()));
        let (found, expected) = (root(spheres), root(expected));
        assert!((found.radius - expected.radius).abs() < 0.1 * expected.radius);
    }
    // Nothing at all, and nothing with vertices.
    for kind in KINDS {
        assert!(spheres(kind, &Hierarchy::default(), &[], &[], &[]).is_empty());
        let members = vec![Member { bounds, triangles: 0, parts: 0..0 }; 3];
        let hierarchy = hierarchy::build(HierarchyKind::Octree, &members, &[]);
        let point = Sphere { center: DVec3::splat(0.5), radius: 0.0 };
        assert_eq!(spheres(kind, &hierarchy, &members, &[], &[]), [point]);
    }
}
