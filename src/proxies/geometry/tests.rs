//! Exact answers.

use super::*;
use glam::{DAffine3, DVec3};
use svs_render::{Material, Mesh, Primitive};

/// A closed box of flat faces, outward.
fn cuboid(center: [f32; 3], half: f32) -> Primitive {
    let mut primitive = Primitive::default();
    for axis in 0..3 {
        for side in [-1.0f32, 1.0] {
            let first = primitive.positions.len() as u32;
            for (u, v) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                let mut p = center;
                p[axis] += side * half;
                p[(axis + 1) % 3] += u * half;
                p[(axis + 2) % 3] += v * half;
                primitive.positions.push(p);
            }
            let quad = if side > 0.0 { [0, 1, 2, 0, 2, 3] } else { [0, 2, 1, 0, 3, 2] };
            primitive.indices.extend(quad.map(|i| first + i));
        }
    }
    primitive
}

fn mesh(primitives: Vec<Primitive>) -> Mesh {
    Mesh { primitives }
}

fn palette() -> Palette {
    Palette::new(&[Material::default()], &[])
}

fn node(meshes: &[Mesh], options: &NodeOptions) -> ProxyGeometry {
    let parts: Vec<Part<'_>> =
        meshes.iter().map(|mesh| Part::Mesh { mesh, to_node: DAffine3::IDENTITY }).collect();
    simplify_node(&parts, &palette(), options)
}

#[test]
fn box_in_a_box_is_dropped() {
    let made = node(
        &[mesh(vec![cuboid([0.0; 3], 1.0)]), mesh(vec![cuboid([0.1, 0.0, 0.0], 0.5)])],
        &NodeOptions::default(),
    );
    assert_eq!((made.gathered, made.visible, made.triangles), (24, 12, 12));
    assert_eq!(made.error, 0.0);
}

#[test]
fn box_in_an_open_box_is_kept() {
    let mut outer = cuboid([0.0; 3], 1.0);
    // Without the side at +z.
    outer.indices.truncate(30);
    let made = node(&[mesh(vec![outer, cuboid([0.0; 3], 0.5)])], &NodeOptions::default());
    // Its face at -z shows in no line through the opening.
    assert_eq!(made.gathered, 22);
    assert!(made.visible >= 20, "{}", made.visible);
}

#[test]
fn offset_plane_has_its_distance() {
    let square = |z: f32| vec![[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]];
    let indices = [0, 1, 2, 0, 2, 3];
    let (a, b) = (square(0.0), square(0.25));
    let found = measure(
        Surface { positions: &a, indices: &indices },
        Surface { positions: &b, indices: &indices },
        100,
    );
    assert_eq!(found, Deviation { max: 0.25, mean: 0.25 });
}

#[test]
fn nothing_gives_nothing() {
    let made = node(&[], &NodeOptions::default());
    assert_eq!((made.triangles, made.error), (0, 0.0));
    assert!(simplify_mesh_levels(&Mesh::default(), &LevelOptions::default()).is_empty());
    let far = Part::Mesh {
        mesh: &mesh(vec![cuboid([0.0; 3], 1.0)]),
        to_node: DAffine3::from_translation(DVec3::NAN),
    };
    assert_eq!(simplify_node(&[far], &palette(), &NodeOptions::default()).triangles, 0);
}
