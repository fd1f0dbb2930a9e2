//! Measured errors with known answers.

use super::*;

fn square(z: f32) -> Vec<[f32; 3]> {
    vec![[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]]
}

const SQUARE: [u32; 6] = [0, 1, 2, 0, 2, 3];

#[test]
fn offset_plane_has_its_distance() {
    let (a, b) = (square(0.0), square(0.25));
    let [a, b] = [&a, &b].map(|positions| Surface { positions, indices: &SQUARE });
    assert_eq!(measure(a, b, 100), Deviation { max: 0.25, mean: 0.25 });
    assert!(measure(a, a, 100).max < 1e-6);
}

#[test]
fn missing_and_added_parts_count_alike() {
    let mut both = square(0.0);
    both.extend(square(3.0));
    let indices: Vec<u32> = SQUARE.iter().copied().chain(SQUARE.map(|i| i + 4)).collect();
    let one = square(0.0);
    let one = Surface { positions: &one, indices: &SQUARE };
    let both = Surface { positions: &both, indices: &indices };
    assert_eq!(measure(one, both, 100).max, 3.0);
    assert_eq!(measure(both, one, 100), measure(one, both, 100));
}

#[test]
fn all_missing_is_the_diagonal() {
    let positions = square(0.0);
    let there = Surface { positions: &positions, indices: &SQUARE };
    let nothing = Surface { positions: &[], indices: &[] };
    assert_eq!(measure(there, nothing, 10).max, 2f64.sqrt());
    assert_eq!(measure(nothing, there, 10).max, 2f64.sqrt());
    assert_eq!(measure(nothing, nothing, 10).max, 0.0);
}

/// An inscribed octahedron and the unit sphere: sqrt(1/3) of the radius at the faces' middles.
#[test]
fn octahedron_in_a_sphere() {
    let (round, edged) = (sphere(96), sphere(2));
    let [a, b] = [&round, &edged].map(|p| Surface { positions: &p.positions, indices: &p.indices });
    let found = measure(a, b, 20_000).max;
    let exact = 1.0 - (1.0f64 / 3.0).sqrt();
    assert!((found - exact).abs() < 2e-3, "{found} is not {exact}");
}

#[test]
fn sphere_is_reduced_with_a_small_error() {
    let made =
        node(&[mesh(vec![sphere(64)])], &NodeOptions { target_triangles: 1000, ..NodeOptions::default() });
    assert!(made.triangles <= 1000, "{}", made.triangles);
    // The best 1,000 triangles of a sphere are 0.006 off.
    assert!(made.error > 0.001 && made.error < 0.02, "{}", made.error);
    assert!(made.fidelity.mean <= made.fidelity.rms && made.fidelity.rms <= made.error);
    let six_volumes: f32 = made.classes.iter().map(volume).sum();
    assert!((six_volumes / 6.0 - 4.1888).abs() < 0.1, "{six_volumes}");
}

#[test]
fn error_of_children_adds_up() {
    let options = NodeOptions { target_triangles: 1000, ..NodeOptions::default() };
    let child = node(&[mesh(vec![sphere(64)])], &options);
    let parts = [Part::Proxy { geometry: &child, origin: glam::DVec3::X }];
    let parent = simplify_node(&parts, &palette(), &NodeOptions { target_triangles: 250, ..options });
    assert!(parent.error > child.error && parent.triangles <= 250);
    // It really is there.
    let x = parent.classes[0].positions.iter().map(|p| p[0]);
    assert!(x.fold(f32::INFINITY, f32::min) > -0.2);
}

#[test]
fn a_flat_grid_costs_nothing() {
    let side = 33u32;
    let mut grid = Primitive::default();
    for y in 0..side {
        for x in 0..side {
            grid.positions.push([x as f32, y as f32, 0.0]);
        }
    }
    for y in 0..side - 1 {
        for x in 0..side - 1 {
            let a = y * side + x;
            grid.indices.extend([a, a + 1, a + side, a + 1, a + side + 1, a + side]);
        }
    }
    let options = NodeOptions { target_triangles: 64, ..NodeOptions::default() };
    let made = node(&[mesh(vec![grid.clone()])], &options);
    assert!(made.triangles <= 64 && made.error < 1e-4, "{} {}", made.triangles, made.error);
    let options = NodeOptions { tolerance: 0.01, ..NodeOptions::default() };
    let made = node(&[mesh(vec![grid])], &options);
    assert!(made.triangles <= 16 && made.error <= 0.01, "{} {}", made.triangles, made.error);
}

#[test]
fn levels_of_a_sphere_fall_by_four_and_err_more_and_more() {
    let original = mesh(vec![Primitive { material: 7, ..sphere(64) }]);
    let levels = simplify_mesh_levels(&original, &LevelOptions::default());
    assert!(levels.len() >= 3, "{}", levels.len());
    let mut before = (16_128, 0.0);
    for level in &levels {
        let primitive = &level.mesh.primitives[0];
        assert!(level.triangles * 10 <= before.0 * 3 && level.error >= before.1);
        assert_eq!((primitive.material, primitive.indices.len()), (7, level.triangles * 3));
        assert_eq!(primitive.normals.len(), primitive.positions.len());
        assert!(primitive.uvs.is_empty() && primitive.colors.is_empty());
        before = (level.triangles, level.error);
    }
}
