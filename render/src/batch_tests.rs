use glam::{DAffine3, DMat3, Vec3};
use proptest::prelude::*;

use super::*;
use crate::geometry::Geometry;
use crate::layout::Capacity;
use crate::{AlphaMode, Material, Mesh, Object, Primitive, SceneData};

/// Opaque, masked, blended, double-sided.
fn materials() -> Vec<Material> {
    let with = |alpha, double_sided| Material { alpha, double_sided, ..Material::default() };
    vec![
        with(AlphaMode::Opaque, false),
        with(AlphaMode::Mask(0.5), false),
        with(AlphaMode::Blend, false),
        with(AlphaMode::Opaque, true),
    ]
}

prop_compose! {
    fn primitive()(
        positions in prop::collection::vec([-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0], 3..30),
        picks in prop::collection::vec([any::<prop::sample::Index>(), any::<prop::sample::Index>(), any::<prop::sample::Index>()], 0..25),
        normals in any::<bool>(),
        material in 0u32..4,
    ) -> Primitive {
        let indices = picks.iter().flatten().map(|pick| pick.index(positions.len()) as u32).collect();
        let normals = if normals { vec![[0.0, 1.0, 0.0]; positions.len()] } else { Vec::new() };
        Primitive { positions, normals, indices, material, ..Primitive::default() }
    }
}

prop_compose! {
    fn scene()(
        meshes in prop::collection::vec(prop::collection::vec(primitive(), 0..3), 1..6),
    )(
        objects in prop::collection::vec((0..meshes.len() as u32, [-50.0f64..50.0, -50.0f64..50.0, -50.0f64..50.0], any::<bool>(), 0.0f64..6.0), 0..40),
        meshes in Just(meshes),
    ) -> SceneData {
        let object = |&(mesh, place, mirrored, angle): &(u32, [f64; 3], bool, f64)| {
            let size = DMat3::from_diagonal(DVec3::new(if mirrored { -1.0 } else { 1.0 }, 1.5, 0.5));
            Object { mesh, to_world: DAffine3 { matrix3: DMat3::from_rotation_y(angle) * size, translation: place.into() } }
        };
        SceneData {
            meshes: meshes.into_iter().map(|primitives| Mesh { primitives }).collect(),
            materials: materials(),
            objects: objects.iter().map(object).collect(),
            images: Vec::new(),
        }
    }
}

/// Of one object: triangles, sum of their corners, sum of their area vectors towards the front.
type Sums = (u64, DVec3, DVec3);

fn add(sums: &mut Sums, [a, b, c]: [DVec3; 3], front: f64) {
    sums.0 += 1;
    sums.1 += a + b + c;
    sums.2 += (b - a).cross(c - a) * front;
}

/// What should be drawn, straight from the scene.
fn expected(data: &SceneData, objects: &[u32]) -> Vec<Sums> {
    let mut sums = vec![Sums::default(); data.objects.len()];
    let mut distinct: Vec<u32> =
        objects.iter().copied().filter(|&o| (o as usize) < data.objects.len()).collect();
    distinct.sort_unstable();
    distinct.dedup();
    for object in distinct {
        let Object { mesh, to_world } = &data.objects[object as usize];
        let front = to_world.matrix3.determinant().signum();
        for primitive in &data.meshes[*mesh as usize].primitives {
            let point =
                |i: u32| to_world.transform_point3(Vec3::from(primitive.positions[i as usize]).as_dvec3());
            for triangle in primitive.indices.chunks_exact(3) {
                add(
                    &mut sums[object as usize],
                    [point(triangle[0]), point(triangle[1]), point(triangle[2])],
                    front,
                );
            }
        }
    }
    sums
}

/// What the GPU would draw, from buffers, rows and draw calls.
fn drawn(data: &SceneData, layout: &Layout, batcher: &Batcher, eye: DVec3) -> Vec<Sums> {
    let chunks: Vec<Geometry> = layout
        .sources
        .chunk_by(|a, b| a.chunk == b.chunk)
        .map(|sources| {
            let mut geometry = Geometry::default();
            sources.iter().for_each(|source| geometry.append(data, layout, source, false));
            geometry
        })
        .collect();
    let mut sums = vec![Sums::default(); data.objects.len()];
    for draw in &batcher.draws {
        let chunk = &chunks[draw.chunk as usize];
        for row in &batcher.rows[draw.row as usize..(draw.row + draw.instances) as usize] {
            let [x, y, z, place] = row.columns.map(|c| Vec3::from(c).as_dvec3());
            let indices =
                &chunk.indices[draw.first_index as usize..(draw.first_index + draw.index_count) as usize];
            for triangle in indices.chunks_exact(3) {
                let corner = |i: usize| {
                    let p = Vec3::from(chunk.vertices[triangle[i] as usize].position).as_dvec3();
                    x * p.x + y * p.y + z * p.z + place + eye
                };
                let object = chunk.vertices[triangle[0] as usize].object + row.object;
                let front = if draw.mirrored { -1.0 } else { 1.0 };
                add(&mut sums[object as usize], [corner(0), corner(1), corner(2)], front);
            }
        }
    }
    sums
}

proptest! {
    #[test]
    fn every_requested_object_is_drawn_exactly_once(
        data in scene(),
        picks in prop::collection::vec(0u32..45, 0..80),
        order in prop::collection::vec(any::<prop::sample::Index>(), 0..30),
        vertices in 30u32..200,
        indices in 1u32..60,
        merged_vertices in 0u64..200,
    ) {
        let eye = DVec3::new(3.0, -7.0, 20.0);
        let order: Vec<u32> = order.iter().filter(|_| !data.objects.is_empty()).map(|i| i.index(data.objects.len()) as u32).collect();
        let capacity = Capacity { vertices, indices: indices * 3, merged_vertices };
        let layout = Layout::new(&data, &order, capacity);
        let mut batcher = Batcher::default();
        // Nothing of the frame before may stay.
        batcher.plan(&layout, &(0..45).collect::<Vec<_>>(), DVec3::ZERO);
        batcher.plan(&layout, &picks, eye);

        let (expected, drawn) = (expected(&data, &picks), drawn(&data, &layout, &batcher, eye));
        for (object, (e, d)) in expected.iter().zip(&drawn).enumerate() {
            prop_assert_eq!(e.0, d.0, "object {}", object);
            prop_assert!(e.1.distance(d.1) < 0.01 && e.2.distance(d.2) < 0.01, "object {object}: {e:?} {d:?}");
        }
        let distinct: std::collections::HashSet<u32> =
            picks.iter().copied().filter(|&o| (o as usize) < data.objects.len()).collect();
        let statistics = DrawStatistics {
            objects: distinct.len(),
            triangles: expected.iter().map(|e| e.0).sum(),
            draw_calls: batcher.draws.len(),
        };
        prop_assert_eq!(batcher.statistics, statistics);
        for (i, draw) in batcher.draws.iter().enumerate() {
            prop_assert_eq!(layout.is_blended(draw.class), i >= batcher.blended);
        }
        prop_assert!(batcher.sorted.is_sorted_by(|a, b| a.distance >= b.distance));
        // Buffers keep to their capacity.
        for sources in layout.sources.chunk_by(|a, b| a.chunk == b.chunk) {
            let mut geometry = Geometry::default();
            sources.iter().for_each(|source| geometry.append(&data, &layout, source, false));
            prop_assert!(geometry.vertices.len() <= vertices as usize && geometry.indices.len() <= indices as usize * 3);
        }
    }
}

#[test]
fn runs_of_bits() {
    let bits = [0b1110_0110u64, u64::MAX, 1];
    let mut runs = Vec::new();
    let mut from = 0;
    while let Some((first, end)) = next_run(&bits, from, 129) {
        runs.push((first, end));
        from = end;
    }
    assert_eq!(runs, [(1, 3), (5, 8), (64, 129)]);
    assert_eq!(next_run(&bits, 8, 64), None);
    assert_eq!(next_run(&bits, 6, 7), Some((6, 7)));
    assert_eq!(next_run(&[], 0, 0), None);
}
