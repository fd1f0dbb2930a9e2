//! What is visible from outside.

use super::*;
use svs_render::AlphaMode;

#[test]
fn box_in_a_box_is_dropped() {
    let made = node(
        &[mesh(vec![cuboid([0.0; 3], 1.0)]), mesh(vec![cuboid([0.1, 0.0, 0.0], 0.5)])],
        &NodeOptions::default(),
    );
    assert_eq!((made.gathered, made.visible, made.triangles), (24, 12, 12));
    assert_eq!((made.error, made.strategy), (0.0, Strategy::Unchanged));
}

#[test]
fn box_in_an_open_box_is_kept() {
    let mut outer = cuboid([0.0; 3], 1.0);
    // Without the side at +z.
    outer.indices.truncate(30);
    let made = node(&[mesh(vec![outer, cuboid([0.0; 3], 0.5)])], &NodeOptions::default());
    assert_eq!(made.gathered, 22);
    // The inner box's face at -z looks at the bottom.
    assert!(made.visible >= 20, "{}", made.visible);
}

#[test]
fn everything_is_kept_on_request() {
    let meshes = [mesh(vec![cuboid([0.0; 3], 1.0)]), mesh(vec![cuboid([0.0; 3], 0.5)])];
    let made = node(&meshes, &NodeOptions { visible_only: false, ..NodeOptions::default() });
    assert_eq!((made.gathered, made.visible), (24, 24));
}

#[test]
fn glass_hides_nothing() {
    let glass = Material { alpha: AlphaMode::Blend, base_color: [1.0, 1.0, 1.0, 0.2], ..Material::default() };
    let palette = Palette::new(&[glass, Material::default()], &[]);
    let mut inner = cuboid([0.0; 3], 0.5);
    inner.material = 1;
    let mesh = mesh(vec![cuboid([0.0; 3], 1.0), inner]);
    let made = simplify_node(&[placed(&mesh, DAffine3::IDENTITY)], &palette, &NodeOptions::default());
    assert_eq!((made.visible, made.classes.len()), (24, 2));
}

#[test]
fn backs_of_single_sided_faces_hide_nothing() {
    let mut inside_out = cuboid([0.0; 3], 1.0);
    for corners in inside_out.indices.chunks_exact_mut(3) {
        corners.swap(1, 2);
    }
    let meshes = [mesh(vec![inside_out, cuboid([0.0; 3], 0.5)])];
    assert_eq!(node(&meshes, &NodeOptions::default()).visible, 24);
}

#[test]
fn of_repeated_triangles_one_is_kept() {
    let made = node(&[mesh(vec![cuboid([0.0; 3], 1.0), cuboid([0.0; 3], 1.0)])], &NodeOptions::default());
    assert_eq!((made.gathered, made.visible), (12, 12));
}

#[test]
fn coplanar_faces_of_two_classes_are_both_kept() {
    let red = Material { metallic: 0.0, ..Material::default() };
    let palette = Palette::new(&[Material::default(), red], &[]);
    let mut second = cuboid([0.0; 3], 1.0);
    second.material = 1;
    let mesh = mesh(vec![cuboid([0.0; 3], 1.0), second]);
    let made = simplify_node(&[placed(&mesh, DAffine3::IDENTITY)], &palette, &NodeOptions::default());
    assert_eq!(made.visible, 24);
}
