//! The cut within a budget against the best one, found by keeping every cut that no other beats in both triangles and loss.

use super::frame::{COVERED, Content, DROPPED, Layout, NodeState};
use super::view::{Part, Scene, nodes, parts};
use super::{Detail, Level, Metric};
use crate::bounds::Bounds;
use crate::budget::Budget;
use crate::camera::Camera;
use crate::decode::Visibility;
use crate::proxies::ProxyTables;
use crate::query::Settings;
use crate::scene::SceneCuller;
use crate::tables::TreeTables;
use crate::tree::{Placement, Tree};
use glam::{DVec3, Vec3};

mod loose;
mod outcomes;

/// splitmix64.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Even in the logarithm.
    fn octaves(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.unit())
    }
}

/// A tree of proxies with two to four children each over boxes on a line, the leaves of two or three boxes.
struct Builder {
    random: Random,
    proxies: ProxyTables,
    proxy_triangles: Vec<u32>,
    bounds: Vec<Bounds>,
    triangles: Vec<u32>,
    starts: Vec<u32>,
    levels: Vec<Level>,
}

impl Builder {
    fn node(&mut self, center: DVec3, reach: f64, depth: u32) -> u32 {
        let index = self.proxy_triangles.len();
        let first = self.bounds.len() as u32;
        self.proxy_triangles.push(0);
        let p = &mut self.proxies;
        p.subtree.push(0);
        p.first_object.push(first);
        p.object_count.push(0);
        p.sphere.push([center.x as f32, center.y as f32, center.z as f32, (reach * 2.0) as f32]);
        p.error.push((reach * 0.05 * (0.5 + 0.5 * self.random.unit())) as f32);
        p.mesh.push(0);
        p.origin.push([0.0; 3]);
        let mut parts = 0;
        for k in 0..2 + self.random.next() % 2 {
            let offset = DVec3::new(k as f64 - 1.0, self.random.unit() - 0.5, self.random.unit() - 0.5);
            let center = center + offset * reach * 0.6;
            if depth > 0 {
                parts += self.node(center, reach * 0.4, depth - 1);
                continue;
            }
            let half = Vec3::splat(self.random.octaves(0.02, 0.5) as f32 * reach as f32);
            self.bounds.push(Bounds { min: center.as_vec3() - half, max: center.as_vec3() + half });
            let original = self.random.octaves(12.0, 20_000.0) as u32;
            self.triangles.push(original);
            let (mut triangles, mut error) = (original, 0.0);
            for _ in 0..self.random.next() % 3 {
                triangles = (f64::from(triangles) * (0.1 + 0.5 * self.random.unit())) as u32 + 1;
                error += half.x * 0.1 * self.random.unit() as f32;
                self.levels.push(Level::new(triangles, error));
            }
            self.starts.push(self.levels.len() as u32);
            parts += triangles;
        }
        let triangles = (f64::from(parts) * self.random.octaves(0.1, 0.8)) as u32 + 1;
        self.proxy_triangles[index] = triangles;
        self.proxies.subtree[index] = (self.proxy_triangles.len() - index) as u32;
        self.proxies.object_count[index] = self.bounds.len() as u32 - first;
        triangles
    }
}

fn scene(seed: u64, depth: u32) -> SceneCuller {
    let mut builder = Builder {
        random: Random(seed),
        proxies: ProxyTables { visible: true, ..ProxyTables::default() },
        proxy_triangles: Vec::new(),
        bounds: Vec::new(),
        triangles: Vec::new(),
        starts: vec![0],
        levels: Vec::new(),
    };
    for k in 0..2 {
        builder.node(DVec3::new(f64::from(k) * 6.0 - 3.0, 0.0, 0.0), 2.0, depth);
    }
    // Errors do not rise downwards.
    let parents: Vec<Option<u32>> = {
        let p = &builder.proxies;
        (0..p.subtree.len())
            .map(|n| (0..n).rev().find(|&a| a + p.subtree[a] as usize > n).map(|a| a as u32))
            .collect()
    };
    for (node, parent) in parents.into_iter().enumerate() {
        if let Some(parent) = parent {
            builder.proxies.error[node] =
                builder.proxies.error[node].min(builder.proxies.error[parent as usize]);
        }
    }
    let tables = TreeTables {
        placement: Placement::Scene(0),
        directions: "octahedron".to_owned(),
        object_count: builder.bounds.len() as u32,
        node_sphere: Vec::new(),
        node_subtree: Vec::new(),
        node_first_object: Vec::new(),
        node_object_count: Vec::new(),
        object_order: None,
        level_bits: 1,
        level_row: Vec::new(),
        level_row_index: None,
        importance_area: 0.0,
        importance: Vec::new(),
        proxies: Some(builder.proxies),
        nested: Vec::new(),
        recommended_quality: None,
        fingerprint: None,
    };
    let visibility = Visibility::new(vec![Tree::new(tables).unwrap()]).unwrap();
    let mut culler = SceneCuller::new(&visibility, &[builder.bounds]).unwrap();
    culler.set_triangles(0, &builder.triangles).unwrap();
    culler.set_proxy_triangles(0, &builder.proxy_triangles).unwrap();
    culler.set_levels(0, &builder.starts, &builder.levels).unwrap();
    culler
}

/// Cuts of something: triangles and value, each better than the others in one of them, triangles ascending.
type Front = Vec<(u64, f64)>;

fn best_of(mut front: Front) -> Front {
    front.sort_by(|a, b| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)));
    let mut best = f64::NEG_INFINITY;
    front.retain(|&(_, value)| {
        let better = value > best;
        best = best.max(value);
        better
    });
    front
}

fn both(a: &Front, b: &Front) -> Front {
    best_of(a.iter().flat_map(|x| b.iter().map(move |y| (x.0 + y.0, x.1 + y.1))).collect())
}

/// All cuts worth having of a part of entry 0.
fn cuts(scene: &Scene<'_>, layout: &Layout, below: Option<u32>) -> Front {
    let entry = &layout.entries[0];
    let mut front = vec![(0, 0.0)];
    parts(layout, entry, nodes(scene.placed, entry), below, |part| {
        match part {
            Part::Proxy(node, slots) => {
                let mut of_node = cuts(scene, layout, Some(node));
                if let Some(view) = scene.view(layout, entry, node, slots) {
                    assert!(view.shown <= view.pixels);
                    of_node.push((u64::from(view.triangles), view.shown * (1.0 - view.loss)));
                }
                front = both(&front, &best_of(of_node));
            }
            Part::Slots(slots) => {
                for slot in slots {
                    let Content::Object(candidate) = layout.slots[slot].content() else { continue };
                    let object = scene.object(entry, candidate);
                    let mut of_object = vec![(0, 0.0)];
                    let mut level = scene.coarsest(&object);
                    loop {
                        let value = object.pixels * (1.0 - scene.level_loss(&object, level));
                        of_object.push((scene.level_triangles(&object, level).into(), value));
                        if level == 0 {
                            break;
                        }
                        level = scene.finer(&object, level);
                    }
                    front = both(&front, &best_of(of_object));
                }
            }
        }
        true
    });
    front
}

/// Value of what was selected, and the cuts there are.
fn measure(culler: &SceneCuller, detail: Detail) -> (f64, Front) {
    let state = &culler.detail;
    let scene = Scene {
        placed: &culler.placed,
        loose: &culler.loose,
        tables: &state.tables,
        candidates: &culler.within.candidates,
        detail,
        clip: true,
    };
    let (layout, states) = (&state.frame.layout, &state.frame.states);
    let entry = &layout.entries[0];
    let mut value = 0.0;
    parts(layout, entry, nodes(scene.placed, entry), None, |part| match part {
        Part::Proxy(node, slots) => {
            let drawn = states.nodes[node as usize] == NodeState::Drawn;
            if drawn {
                let view = scene.view(layout, entry, node, slots).unwrap();
                value += view.shown * (1.0 - view.loss);
            }
            drawn
        }
        Part::Slots(slots) => {
            for slot in slots {
                let Content::Object(candidate) = layout.slots[slot].content() else { continue };
                let object = scene.object(entry, candidate);
                value += match states.slots[slot] {
                    DROPPED => 0.0,
                    COVERED => unreachable!("no proxy stands for it"),
                    level => object.pixels * (1.0 - scene.level_loss(&object, level)),
                };
            }
            true
        }
    });
    (value, cuts(&scene, layout, None))
}

fn camera() -> Camera {
    let eye = DVec3::new(1.0, 4.0, 14.0);
    let view = glam::dcamera::rh::view::look_at_mat4(eye, DVec3::ZERO, DVec3::Y);
    Camera::perspective(view, 1.2, 1280.0, 720.0, 0.05)
}

/// The figures of the documentation: print them with
/// `cargo test --release -p svs-runtime near_the_best_cut -- --nocapture`.
#[test]
fn near_the_best_cut() {
    let detail = Detail { tau: 0.0, metric: Metric::Sse };
    for (depth, scenes) in [(1, 300), (2, 20)] {
        let (mut shares, mut plain) = (Vec::new(), Vec::new());
        for seed in 0..scenes {
            let mut culler = scene(seed, depth);
            let camera = camera();
            culler.set_hysteresis(1.0);
            culler.cull(&camera, &Settings::FRUSTUM);
            let all = culler.selection().chosen_triangles;
            for share in [0.02, 0.05, 0.1, 0.2, 0.4] {
                let most = (all as f64 * share) as u64;
                culler.select(&camera, &Settings::FRUSTUM, &detail, &Budget::Triangles(most));
                let (value, front) = measure(&culler, detail);
                let best = front.iter().rev().find(|cut| cut.0 <= most).unwrap().1;
                assert!(culler.detail_statistics().triangles <= most);
                assert!(value <= best * (1.0 + 1e-9), "{value} is better than the best, {best}");
                // Originals alone are never worth more.
                let chosen =
                    culler.cull_within(&camera, &Settings::FRUSTUM, &Budget::Triangles(most)).to_vec();
                let originals: f64 = chosen
                    .iter()
                    .map(|draw| culler.within.candidates.iter().find(|c| c.draw == *draw).unwrap())
                    .map(|candidate| f64::from(candidate.estimate.expected))
                    .sum();
                assert!(value >= originals * (1.0 - 1e-6), "{value} is less than {originals}");
                if best > 0.0 {
                    shares.push(value / best);
                    plain.push(originals / best);
                }
            }
        }
        let mean = |shares: &[f64]| shares.iter().sum::<f64>() / shares.len() as f64;
        shares.sort_by(f64::total_cmp);
        let at = |share: f64| shares[((shares.len() - 1) as f64 * share) as usize];
        println!(
            "depth {depth}, {} cuts: mean {:.4}, median {:.4}, worst tenth {:.4}, worst hundredth {:.4}, worst {:.4}; originals \
             alone: mean {:.4}",
            shares.len(),
            mean(&shares),
            at(0.5),
            at(0.1),
            at(0.01),
            at(0.0),
            mean(&plain),
        );
        assert!(mean(&shares) > 0.97 && at(0.01) > 0.8 && mean(&shares) > mean(&plain) + 0.05);
    }
}
