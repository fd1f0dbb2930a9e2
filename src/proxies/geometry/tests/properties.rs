//! What holds for any input.

use super::*;
use glam::DVec3;
use proptest::prelude::*;
use proptest::strategy::Strategy;

/// Triangles of any shape: coarse coordinates make repeated, flat and touching ones likely.
fn any_primitive() -> impl Strategy<Value = Primitive> {
    let position = prop_oneof![
        8 => prop::array::uniform3((-4i8..4).prop_map(f32::from)),
        1 => prop::array::uniform3(-1e3f32..1e3),
        1 => prop::array::uniform3(prop_oneof![Just(f32::NAN), Just(f32::INFINITY), Just(1e30), Just(1e-30)]),
    ];
    (
        prop::collection::vec(position, 1..60),
        prop::collection::vec(any::<prop::sample::Index>(), 0..400),
        0u8..8,
    )
        .prop_map(|(positions, indices, has)| {
            let count = positions.len();
            let indices = indices.iter().map(|i| i.index(count) as u32).collect();
            let some = |bit: u8| if has & bit != 0 { count } else { 0 };
            Primitive {
                normals: vec![[0.0, 1.0, 0.0]; some(1)],
                colors: vec![[200, 100, 50, 255]; some(2)],
                uvs: vec![[0.5, f32::NAN]; some(4)],
                positions,
                indices,
                material: u32::from(has) % 3,
            }
        })
}

fn check(made: &ProxyGeometry, given: usize) {
    assert!(made.triangles <= made.visible && made.visible <= made.gathered && made.gathered <= given);
    assert!(made.error.is_finite() && made.error >= 0.0 && made.fidelity.rms <= made.error * 1.001 + 1e-12);
    assert_eq!(made.triangles, made.classes.iter().map(ClassMesh::triangles).sum::<usize>());
    for class in &made.classes {
        let count = class.positions.len();
        assert!(class.positions.iter().chain(&class.normals).flatten().all(|c| c.is_finite()));
        assert!(class.uvs.iter().flatten().all(|c| c.is_finite()));
        assert!([0, count].contains(&class.colors.len()) && [0, count].contains(&class.uvs.len()));
        assert_eq!(class.normals.len(), if class.class.is_flat() { 0 } else { count });
        assert!(class.indices.len() % 3 == 0 && class.indices.iter().all(|&i| (i as usize) < count));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn any_triangles_give_a_usable_proxy(
        primitives in prop::collection::vec(any_primitive(), 0..4),
        target in 0usize..60,
        scale in prop_oneof![Just(1.0f64), Just(-1.0), Just(1e-6), Just(1e6), Just(0.0)],
        tolerance in prop_oneof![Just(0.0f64), Just(0.1), Just(1e9)],
    ) {
        let mesh = mesh(primitives);
        let given = mesh.primitives.iter().map(|p| p.indices.len() / 3).sum();
        let to_node = DAffine3::from_scale(DVec3::new(scale, scale.abs(), 1.0));
        let options = NodeOptions { target_triangles: target, tolerance, samples: 200, ..NodeOptions::default() };
        let palette = Palette::new(&[Material::default(), Material { double_sided: true, ..Material::default() }], &[]);
        let made = simplify_node(&[placed(&mesh, to_node)], &palette, &options);
        check(&made, given);
        let parent = simplify_node(&[Part::Proxy { geometry: &made, origin: DVec3::ONE }], &palette, &options);
        check(&parent, made.triangles);
        prop_assert!(parent.error >= made.error);
    }

    #[test]
    fn any_mesh_gives_usable_levels(primitives in prop::collection::vec(any_primitive(), 0..4)) {
        let mesh = mesh(primitives);
        let options = LevelOptions { least_triangles: 1, samples: 200, largest_error: 10.0, ..LevelOptions::default() };
        let mut before = mesh.primitives.iter().map(|p| p.indices.len() / 3).sum::<usize>();
        let mut error = 0.0;
        for level in simplify_mesh_levels(&mesh, &options) {
            prop_assert!(level.triangles < before && level.error >= error && level.error.is_finite());
            for primitive in &level.mesh.primitives {
                let count = primitive.positions.len();
                prop_assert!(primitive.positions.iter().flatten().all(|c| c.is_finite()));
                prop_assert!(primitive.indices.iter().all(|&i| (i as usize) < count));
            }
            (before, error) = (level.triangles, level.error);
        }
    }
}

#[test]
fn threads_make_no_difference() {
    let meshes: Vec<Mesh> =
        (0..6).map(|i| mesh(vec![sphere(12 + i), cuboid([i as f32, 0.5, 0.0], 0.8)])).collect();
    let options = NodeOptions { target_triangles: 400, ..NodeOptions::default() };
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| node(&meshes, &options))
    };
    let one = with(1);
    assert!(one.triangles > 0 && one.triangles <= 440);
    assert_eq!(one, with(2));
    assert_eq!(one, with(5));
}

#[test]
fn nothing_gives_nothing() {
    let made = node(&[], &NodeOptions::default());
    assert_eq!((made.triangles, made.error), (0, 0.0));
    assert!(simplify_mesh_levels(&Mesh::default(), &LevelOptions::default()).is_empty());
    let cube = mesh(vec![cuboid([0.0; 3], 1.0)]);
    let far = placed(&cube, DAffine3::from_translation(DVec3::NAN));
    assert_eq!(simplify_node(&[far], &palette(), &NodeOptions::default()).triangles, 0);
}
