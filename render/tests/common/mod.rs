//! Small scenes and pictures for the tests.
#![allow(dead_code, reason = "every test program uses a part of it")]

use glam::{DAffine3, DMat3, DVec3};
use svs_render::{
    Frame, Gpu, GpuScene, Image, ItemBuffer, Line, Material, Mesh, Object, Offscreen, Primitive, SceneData,
    View,
};

/// The GPU, once per test program: drivers do not like being opened by many threads at once.
pub(crate) fn gpu() -> &'static Gpu {
    static GPU: std::sync::OnceLock<Gpu> = std::sync::OnceLock::new();
    GPU.get_or_init(|| Gpu::headless().expect("these tests need a Vulkan driver, e.g. mesa-vulkan-drivers"))
}

pub(crate) fn material(base_color: [f32; 4]) -> Material {
    Material { base_color, metallic: 0.0, roughness: 0.6, ..Material::default() }
}

/// A grid of quads over u, v in 0 to 1.
pub(crate) fn surface(
    columns: u32,
    rows: u32,
    point: impl Fn(f32, f32) -> ([f32; 3], [f32; 3]),
) -> Primitive {
    let mut primitive = Primitive::default();
    for row in 0..=rows {
        for column in 0..=columns {
            let (u, v) = (column as f32 / columns as f32, row as f32 / rows as f32);
            let (position, normal) = point(u, v);
            primitive.positions.push(position);
            primitive.normals.push(normal);
            primitive.uvs.push([u, v]);
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let a = row * (columns + 1) + column;
            let (b, c, d) = (a + 1, a + columns + 1, a + columns + 2);
            primitive.indices.extend([a, c, b, b, c, d]);
        }
    }
    primitive
}

/// Radius 1.
pub(crate) fn sphere(columns: u32, rows: u32) -> Primitive {
    surface(columns, rows, |u, v| {
        let (longitude, latitude) = (u * std::f32::consts::TAU, v * std::f32::consts::PI);
        let p = [latitude.sin() * longitude.sin(), latitude.cos(), latitude.sin() * longitude.cos()];
        (p, p)
    })
}

/// From -1 to 1 in x and y, seen from +z.
pub(crate) fn quad() -> Primitive {
    surface(1, 1, |u, v| ([u * 2.0 - 1.0, 1.0 - v * 2.0, 0.0], [0.0, 0.0, 1.0]))
}

/// A box from -1 to 1, 24 vertices.
pub(crate) fn cube() -> Primitive {
    let mut all = Primitive::default();
    for axis in 0..3 {
        for sign in [1.0f32, -1.0] {
            let base = all.positions.len() as u32;
            let turn = |p: [f32; 3]| {
                let p = [p[0] * sign, p[1], p[2] * sign];
                [p[(3 - axis) % 3], p[(4 - axis) % 3], p[(5 - axis) % 3]]
            };
            let face = quad();
            all.positions.extend(face.positions.iter().map(|p| turn([p[0], p[1], 1.0])));
            all.normals.extend(face.normals.iter().map(|&n| turn(n)));
            all.uvs.extend(&face.uvs);
            all.indices.extend(face.indices.iter().map(|i| base + i));
        }
    }
    all
}

pub(crate) fn mesh(primitive: Primitive, material: u32) -> Mesh {
    Mesh { primitives: vec![Primitive { material, ..primitive }] }
}

pub(crate) fn object(mesh: u32, to_world: DAffine3) -> Object {
    Object { mesh, to_world }
}

pub(crate) fn at(x: f64, y: f64, z: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::new(x, y, z))
}

pub(crate) fn scaled(x: f64, y: f64, z: f64, place: DVec3) -> DAffine3 {
    DAffine3 { matrix3: DMat3::from_diagonal(DVec3::new(x, y, z)), translation: place }
}

/// From `eye` to `to`, 50 degrees.
pub(crate) fn view(eye: [f64; 3], to: [f64; 3]) -> View {
    let (eye, to) = (DVec3::from(eye), DVec3::from(to));
    View::looking_along(eye, to - eye, 50f64.to_radians(), 0.05)
}

/// A scene and what it takes to draw it.
pub(crate) struct Studio {
    pub(crate) scene: GpuScene,
    pub(crate) offscreen: Offscreen,
    pub(crate) objects: Vec<u32>,
}

impl Studio {
    pub(crate) fn new(data: &SceneData, width: u32, height: u32) -> Self {
        let gpu = gpu();
        let scene = GpuScene::upload(gpu, data, &[]).expect("a good scene");
        let offscreen = Offscreen::new(gpu, width, height).expect("a small picture");
        Self { scene, offscreen, objects: (0..data.objects.len() as u32).collect() }
    }

    pub(crate) fn image(&mut self, view: View, lines: &[Line]) -> Image {
        let mut renderer = Offscreen::renderer(gpu());
        let frame = Frame { view, objects: &self.objects, lines };
        self.offscreen.image(gpu(), &mut renderer, &self.scene, &frame).expect("a picture")
    }

    pub(crate) fn items(&mut self, view: View) -> ItemBuffer {
        let mut renderer = Offscreen::renderer(gpu());
        let frame = Frame { view, objects: &self.objects, lines: &[] };
        self.offscreen.items(gpu(), &mut renderer, &self.scene, &frame).expect("items")
    }
}
