//! Frame times of generated scenes:
//! `cargo run --release -p svs-render --example frames [WIDTHxHEIGHT [PART OF A SCENE'S NAME [FRAMES]]]`.

use std::f64::consts::TAU;
use std::process::ExitCode;

use glam::{DAffine3, DMat3, DVec3};
use svs_render::{Frame, Gpu, GpuScene, Material, Mesh, Object, Offscreen, Primitive, SceneData, View};

/// A wavy sheet of `columns` by `rows` quads from -1 to 1.
fn sheet(columns: u32, rows: u32) -> Primitive {
    let mut primitive = Primitive::default();
    for row in 0..=rows {
        for column in 0..=columns {
            let (x, y) = (column as f32 / columns as f32 * 2.0 - 1.0, row as f32 / rows as f32 * 2.0 - 1.0);
            primitive.positions.push([x, y, (x * 20.0).sin() * (y * 17.0).cos() * 0.05]);
            primitive.normals.push([(x * 20.0).cos() * 0.3, (y * 17.0).sin() * 0.3, 0.9]);
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let a = row * (columns + 1) + column;
            let (b, c, d) = (a + 1, a + columns + 1, a + columns + 2);
            primitive.indices.extend([a, b, c, b, d, c]);
        }
    }
    primitive
}

/// `parts` tubes of 56 triangles in a cube of edge 2, each a mesh of its own.
fn tubes(parts: u32) -> SceneData {
    let side = f64::from(parts).cbrt().ceil() as u32;
    let mut tube = Primitive::default();
    for corner in 0..14u32 {
        let (sin, cos) = (f64::from(corner) / 14.0 * TAU).sin_cos();
        for ring in 0..3 {
            tube.positions.push([cos as f32, ring as f32 - 1.0, sin as f32]);
            tube.normals.push([cos as f32, 0.0, sin as f32]);
        }
        let (a, b) = (corner * 3, (corner + 1) % 14 * 3);
        for ring in 0..2 {
            tube.indices.extend([a + ring, a + ring + 1, b + ring, b + ring, a + ring + 1, b + ring + 1]);
        }
    }
    let object = |i: u32| {
        let place = [i % side, i / side % side, i / side / side]
            .map(|x| (f64::from(x) + 0.5) / f64::from(side) * 2.0 - 1.0);
        let size = DMat3::from_diagonal(DVec3::new(0.4, 1.0, 0.4) / f64::from(side));
        let turn = DMat3::from_rotation_z(f64::from(i));
        Object { mesh: i, to_world: DAffine3 { matrix3: turn * size, translation: DVec3::from(place) } }
    };
    SceneData {
        meshes: (0..parts).map(|_| Mesh { primitives: vec![tube.clone()] }).collect(),
        materials: vec![paint()],
        objects: (0..parts).map(object).collect(),
        images: Vec::new(),
    }
}

fn paint() -> Material {
    Material { base_color: [0.6, 0.5, 0.4, 1.0], metallic: 0.0, roughness: 0.5, ..Material::default() }
}

fn one(primitive: Primitive) -> SceneData {
    SceneData {
        meshes: vec![Mesh { primitives: vec![primitive] }],
        materials: vec![paint()],
        objects: vec![Object { mesh: 0, to_world: DAffine3::IDENTITY }],
        images: Vec::new(),
    }
}

/// The tubes as instances of one box.
fn boxes(count: u32) -> SceneData {
    let mut cube = Primitive::default();
    for axis in 0..3 {
        for sign in [-1.0f32, 1.0] {
            let base = cube.positions.len() as u32;
            for (u, v) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                let (mut p, mut n) = ([0.0; 3], [0.0; 3]);
                (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (sign, u * sign, v);
                n[axis] = sign;
                cube.positions.push(p);
                cube.normals.push(n);
            }
            cube.indices.extend([0, 1, 2, 0, 2, 3].map(|i| base + i));
        }
    }
    let mut data = tubes(count);
    data.meshes = vec![Mesh { primitives: vec![cube] }];
    data.objects.iter_mut().for_each(|object| object.mesh = 0);
    data
}

fn measure(
    gpu: &Gpu,
    offscreen: &mut Offscreen,
    name: &str,
    data: impl FnOnce() -> SceneData,
    objects: &[u32],
) -> Result<(), svs_render::RenderError> {
    let mut arguments = std::env::args().skip(2);
    if arguments.next().is_some_and(|part| !name.contains(&part)) {
        return Ok(());
    }
    let frames: usize = arguments.next().and_then(|count| count.parse().ok()).unwrap_or(12);
    let data = data();
    let begin = std::time::Instant::now();
    let scene = GpuScene::upload(gpu, &data, &[])?;
    let upload = begin.elapsed().as_secs_f64() * 1e3;
    let mut renderer = Offscreen::renderer(gpu);
    let view = View::looking_along(DVec3::new(1.2, 0.9, 2.6), DVec3::new(-1.2, -0.9, -2.6), 0.8, 0.05);
    let frame = Frame { view, objects, lines: &[] };
    let mut times = Vec::new();
    for _ in 0..frames.max(1) {
        times.push(offscreen.time(gpu, &mut renderer, &scene, &frame)?);
    }
    times.sort_by(|a, b| a.wall_ms.total_cmp(&b.wall_ms));
    let best = times[0];
    let cpu = times.iter().map(|time| time.cpu_ms).fold(f64::MAX, f64::min);
    println!(
        "{name:32} {:7.1} ms wall, {} on the GPU, {cpu:6.2} ms CPU; {} objects, {} triangles, {} calls; upload {upload:.0} ms, {:.1} MB",
        best.wall_ms,
        best.gpu_ms.map_or("unknown".to_owned(), |ms| format!("{ms:.1} ms")),
        best.statistics.objects,
        best.statistics.triangles,
        best.statistics.draw_calls,
        scene.bytes() as f64 * 1e-6,
    );
    Ok(())
}

fn run() -> Result<(), Box<dyn std::error::Error>> {
    let size = std::env::args().nth(1).unwrap_or_else(|| "1280x720".to_owned());
    let (width, height) = size.split_once('x').ok_or("the size is WIDTHxHEIGHT")?;
    let gpu = Gpu::headless()?;
    println!("{}", gpu.description());
    let mut offscreen = Offscreen::new(&gpu, width.parse()?, height.parse()?)?;
    let some = |count: u32, share: f64| -> Vec<u32> {
        // As culling answers: runs of neighbours.
        (0..count).filter(|i| (f64::from(i / 8) * 0.618_034).fract() < share).collect()
    };
    let flat = |mut primitive: Primitive| {
        primitive.normals.clear();
        primitive
    };
    measure(&gpu, &mut offscreen, "nothing", || one(sheet(1, 1)), &[])?;
    measure(&gpu, &mut offscreen, "one large quad", || one(sheet(1, 1)), &[0])?;
    measure(&gpu, &mut offscreen, "one large flat quad", || one(flat(sheet(1, 1))), &[0])?;
    measure(&gpu, &mut offscreen, "1 M triangles in one mesh", || one(sheet(1000, 500)), &[0])?;
    measure(&gpu, &mut offscreen, "1 M flat triangles in one mesh", || one(flat(sheet(1000, 500))), &[0])?;
    measure(&gpu, &mut offscreen, "15,000 tubes", || tubes(15_000), &some(15_000, 1.0))?;
    measure(&gpu, &mut offscreen, "15,000 tubes, 10 % visible", || tubes(15_000), &some(15_000, 0.1))?;
    measure(&gpu, &mut offscreen, "60,000 boxes", || boxes(60_000), &some(60_000, 1.0))?;
    measure(&gpu, &mut offscreen, "60,000 boxes, 10 % visible", || boxes(60_000), &some(60_000, 0.1))?;
    measure(&gpu, &mut offscreen, "400,000 tubes, 15 % visible", || tubes(400_000), &some(400_000, 0.15))?;
    measure(&gpu, &mut offscreen, "400,000 boxes, 15 % visible", || boxes(400_000), &some(400_000, 0.15))?;
    Ok(())
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
