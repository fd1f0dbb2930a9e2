//! Random scenes, and random cameras that use no code of the library to look at them before and after.

use crate::builder::{Builder, shell};
use crate::options;
use glam::{DVec3, dvec3};
use serde_json::json;
use svs::bake::Silent;
use svs::gltf::Document;
use svs::hidden::{RemoveMode, remove};
use svs::scene::{MaskMode, Opacity, ReadOptions, read_scene};

/// SplitMix64.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    fn direction(&mut self) -> DVec3 {
        loop {
            let v = DVec3::from([0; 3].map(|_| self.between(-1.0, 1.0)));
            if (0.01..=1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }
}

struct Triangle {
    corners: [DVec3; 3],
    double_sided: bool,
    transparent: bool,
}

fn triangles(document: &Document) -> Vec<Triangle> {
    let options = ReadOptions { mask: MaskMode::Transparent, ..ReadOptions::default() };
    let scene = read_scene(document, &options).expect("a scene");
    let mut all = Vec::new();
    for object in &scene.objects {
        let mesh = &scene.meshes[object.mesh as usize];
        let mirrored = object.to_world.matrix3.determinant() < 0.0;
        for surface in &mesh.surfaces {
            for t in surface.triangles.clone() {
                let place = |v: u32| {
                    object.to_world.transform_point3(mesh.positions[v as usize].as_dvec3() + mesh.origin)
                };
                let [a, b, c] = mesh.triangles[t as usize].map(place);
                let corners = if mirrored { [a, c, b] } else { [a, b, c] };
                let transparent = matches!(surface.opacity, Opacity::Transparent);
                all.push(Triangle { corners, double_sided: surface.double_sided, transparent });
            }
        }
    }
    all
}

/// Distance along the ray (Möller and Trumbore 1997), and whether it meets the front.
fn meet(triangle: &Triangle, origin: DVec3, direction: DVec3) -> Option<(f64, bool)> {
    let [a, b, c] = triangle.corners;
    let (e1, e2) = (b - a, c - a);
    let p = direction.cross(e2);
    let determinant = e1.dot(p);
    if determinant.abs() < 1e-12 {
        return None;
    }
    let s = origin - a;
    let (u, q) = (s.dot(p) / determinant, s.cross(e1));
    let (v, t) = (direction.dot(q) / determinant, e2.dot(q) / determinant);
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some((t, determinant > 0.0))
}

/// Nearest opaque surface, and how many transparent ones are before it.
fn picture(all: &[Triangle], origin: DVec3, direction: DVec3) -> (f64, usize) {
    let hits: Vec<(f64, bool)> = all
        .iter()
        .filter_map(|triangle| {
            let (t, front) = meet(triangle, origin, direction)?;
            (front || triangle.double_sided).then_some((t, triangle.transparent))
        })
        .collect();
    let opaque = hits.iter().filter(|hit| !hit.1).map(|hit| hit.0).fold(f64::INFINITY, f64::min);
    (opaque, hits.iter().filter(|hit| hit.1 && hit.0 < opaque).count())
}

/// Whether no opaque surface is nearer than `radius`.
fn is_clear(all: &[Triangle], point: DVec3, radius: f64) -> bool {
    all.iter().filter(|triangle| !triangle.transparent).all(|triangle| {
        let [a, b, c] = triangle.corners;
        // A fine grid of points instead of the exact distance: triangles here are at most a few metres wide.
        let steps = 24;
        (0..=steps).all(|i| {
            (0..=steps - i).all(|j| {
                let (u, v) = (f64::from(i) / f64::from(steps), f64::from(j) / f64::from(steps));
                (a + (b - a) * u + (c - a) * v).distance(point) >= radius
            })
        })
    })
}

/// Boxes of all sorts in, on and beside each other.
fn random_scene(random: &mut Random) -> Builder {
    let mut builder = Builder::new();
    let room = builder.mesh(&shell([4.0, 2.0, 3.0], 3, if random.unit() < 0.5 { &[] } else { &[2] }), 1);
    builder.node("room", room, json!({}));
    for number in 0..14 {
        let half = [0; 3].map(|_| random.between(0.1, 0.9) as f32);
        let cells = 1 + (random.unit() * 4.0) as u32;
        let open: &[usize] = if random.unit() < 0.3 { &[3] } else { &[] };
        let material = [0, 0, 1, 1, 1, 2][(random.unit() * 6.0) as usize];
        let mesh = builder.mesh(&shell(half, cells, open), material);
        let at = [random.between(-4.0, 4.0), random.between(-2.0, 2.0), random.between(-3.0, 3.0)];
        let scale = [if random.unit() < 0.2 { -1.0 } else { 1.0 }, 1.0, 1.0];
        builder.node(&format!("box {number}"), mesh, json!({"translation": at, "scale": scale}));
        // Half of them again, smaller and mostly in the first: an instance.
        if random.unit() < 0.5 {
            let at = at.map(|x| x + random.between(-0.2, 0.2));
            builder.node(
                &format!("small {number}"),
                mesh,
                json!({"translation": at, "scale": [0.4, 0.4, 0.4]}),
            );
        }
    }
    builder
}

/// Pixels per million that may differ.
const MOST_PPM: f64 = 300.0;

#[test]
fn random_cameras_see_the_same_before_and_after() {
    let mut random = Random(11);
    let clearance = 0.25;
    let (mut removed, mut rays, mut different) = (0, 0u32, 0u32);
    for _ in 0..8 {
        let builder = random_scene(&mut random);
        let (before, mut document) = (builder.document(), builder.document());
        let report = remove(&mut document, &options(RemoveMode::Triangles, Some(clearance)), &Silent)
            .expect("a readable scene");
        assert!(report.estimated_missing_ppm < MOST_PPM, "{report:?}");
        removed += report.triangles_removed;
        let (before, after) = (triangles(&before), triangles(&document));
        let mut cameras = 0;
        while cameras < 40 {
            let outside = cameras % 4 == 0;
            let origin = if outside {
                random.direction() * random.between(8.0, 30.0)
            } else {
                dvec3(random.between(-4.5, 4.5), random.between(-2.5, 2.5), random.between(-3.5, 3.5))
            };
            if !outside && !is_clear(&before, origin, clearance) {
                continue;
            }
            cameras += 1;
            for _ in 0..250 {
                let aim =
                    dvec3(random.between(-4.0, 4.0), random.between(-2.0, 2.0), random.between(-3.0, 3.0));
                let direction = if outside { (aim - origin).normalize() } else { random.direction() };
                let (a, b) = (picture(&before, origin, direction), picture(&after, origin, direction));
                rays += 1;
                // Surfaces closer than rays can tell apart may take each other's place.
                let same = a.0 == b.0 || (a.0 - b.0).abs() < 1e-3;
                different += u32::from(!(same && a.1 == b.1));
            }
        }
    }
    let ppm = f64::from(different) / f64::from(rays) * 1e6;
    assert!(removed > 500, "only {removed} triangles were removed");
    assert!(ppm <= MOST_PPM, "{different} of {rays} rays differ: {ppm} ppm");
}
