//! Exact answers, and properties that hold for any input.

mod classes;
mod error;
mod properties;
mod visibility;

use super::*;
use glam::{DAffine3, Vec3};
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

/// A unit sphere of `2 * rings * rings` quads or so, with smooth normals, outward.
fn sphere(rings: u32) -> Primitive {
    let mut primitive = Primitive::default();
    let around = rings * 2;
    for ring in 0..=rings {
        for step in 0..=around {
            let polar = std::f32::consts::PI * ring as f32 / rings as f32;
            let (sin, cos) = (std::f32::consts::TAU * (step % around) as f32 / around as f32).sin_cos();
            let radius = if ring == 0 || ring == rings { 0.0 } else { polar.sin() };
            let position = [radius * cos, polar.cos(), -radius * sin];
            primitive.positions.push(position);
            primitive.normals.push(position);
        }
    }
    let row = around + 1;
    for ring in 0..rings {
        for step in 0..around {
            let [a, b] = [ring * row + step, (ring + 1) * row + step];
            primitive.indices.extend([a, b, a + 1, a + 1, b, b + 1]);
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

fn placed(mesh: &Mesh, to_node: DAffine3) -> Part<'_> {
    Part::Mesh { mesh, to_node }
}

fn node(meshes: &[Mesh], options: &NodeOptions) -> ProxyGeometry {
    let parts: Vec<Part<'_>> = meshes.iter().map(|mesh| placed(mesh, DAffine3::IDENTITY)).collect();
    simplify_node(&parts, &palette(), options)
}

/// Six times the enclosed volume: positive if faces look outward.
fn volume(class: &ClassMesh) -> f32 {
    let corner = |i: u32| Vec3::from_array(class.positions[i as usize]);
    class.indices.chunks_exact(3).map(|t| corner(t[0]).dot(corner(t[1]).cross(corner(t[2])))).sum()
}
