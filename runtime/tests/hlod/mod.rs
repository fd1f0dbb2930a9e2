//! Random scenes with proxies, levels, and trees in trees.

use crate::common::{Random, sample};
use glam::{DAffine3, DQuat, DVec3, Vec3};
use std::collections::HashSet;
use svs_runtime::{
    Bounds, Camera, Draw, Level, Nested, Placement, Proxies, ProxyTables, SceneCuller, Selected,
    SelectedKind, Tree, TreeTables, Visibility,
};

/// A scene, and all that a test needs to know of it.
pub(crate) struct Hlod {
    pub(crate) culler: SceneCuller,
    pub(crate) bounds: Vec<Vec<Bounds>>,
    pub(crate) has_guests: bool,
    trees: Vec<Known>,
    /// Per tree, per anchor.
    to_world: Vec<Vec<DAffine3>>,
}

struct Known {
    proxies: Option<Proxies>,
    nested: Vec<Nested>,
    triangles: Vec<u32>,
    proxy_triangles: Vec<u32>,
    starts: Vec<u32>,
    levels: Vec<Level>,
}

/// Most triangles of a proxy are fewer than those of its parts in their coarsest forms.
struct Builder<'a> {
    random: Random,
    bounds: &'a [Bounds],
    /// Triangles of each object in its coarsest form, by place.
    least: &'a [u32],
    order: Vec<u32>,
    tables: ProxyTables,
    triangles: Vec<u32>,
}

impl Builder<'_> {
    /// A proxy over a range of positions; returns the triangles of its coarsest form.
    fn node(&mut self, first: u32, count: u32, depth: u32) -> u64 {
        let index = self.triangles.len();
        self.triangles.push(0);
        self.tables.subtree.push(0);
        self.tables.first_object.push(first);
        self.tables.object_count.push(count);
        self.tables.sphere.push([0.0; 4]);
        self.tables.error.push(0.0);
        self.tables.mesh.push(index as u32);
        self.tables.origin.push([0.0; 3]);
        let direct = if depth == 3 || count < 3 { count } else { self.random.below(2) as u32 };
        let places = &self.order[first as usize..(first + direct) as usize];
        let mut parts: u64 = places.iter().map(|&place| u64::from(self.least[place as usize])).sum();
        let mut children = Vec::new();
        let mut rest = first + direct..first + count;
        while !rest.is_empty() {
            let most = rest.len();
            // Sometimes one child of all objects: a level within the node.
            let take = if self.random.below(4) == 0 { most } else { 1 + self.random.below(most) } as u32;
            children.push(self.triangles.len());
            parts += self.node(rest.start, take, depth + 1);
            rest.start += take;
        }
        let mut center = DVec3::ZERO;
        let places = &self.order[first as usize..(first + count) as usize];
        for &place in places {
            let b = &self.bounds[place as usize];
            center += (b.min + b.max).as_dvec3() * 0.5 / f64::from(count.max(1));
        }
        let far = |b: &Bounds| {
            let (min, max) = (b.min.as_dvec3(), b.max.as_dvec3());
            (max - center).abs().max((min - center).abs()).length()
        };
        let mut radius = places.iter().map(|&place| far(&self.bounds[place as usize])).fold(0.0, f64::max);
        let mut error = 0.002 + 0.05 * self.random.unit() as f32;
        for child in children {
            let [x, y, z, r] = self.tables.sphere[child].map(f64::from);
            radius = radius.max((DVec3::new(x, y, z) - center).length() + r);
            error = error.max(self.tables.error[child] * (1.0 + self.random.unit() as f32));
        }
        self.tables.sphere[index] = [center.x, center.y, center.z, radius * 1.0001].map(|v| v as f32);
        self.tables.error[index] = if self.random.below(8) == 0 && depth == 3 { 0.0 } else { error };
        self.tables.subtree[index] = (self.triangles.len() - index) as u32;
        let triangles = ((parts as f64 * (0.2 + 0.8 * self.random.unit())) as u64).max(1);
        self.triangles[index] = triangles as u32;
        parts.min(triangles)
    }
}

impl Hlod {
    pub(crate) fn new(seed: u64) -> Self {
        let mut random = Random(seed ^ 0x5EED);
        let (mut outer, mut inner) =
            (sample(seed, seed.is_multiple_of(3)), sample(seed.wrapping_add(1000), seed % 3 == 1));
        let has_guests = seed.is_multiple_of(2);
        inner.tables.placement = Placement::Anchors(vec![3, 4, 5]);
        if has_guests {
            // Two of three anchors hang on objects of the outer tree.
            let (a, b) = (0, outer.tables.object_count - 1);
            let nested = if a == b { vec![a] } else { vec![a, b] }.into_iter().enumerate();
            outer.tables.nested =
                nested.map(|(k, object)| Nested { object, tree: 1, anchor: k as u32 }).collect();
        }
        let mut to_world = vec![vec![DAffine3::IDENTITY], Vec::new()];
        for _ in 0..3 {
            let rotation = DQuat::from_axis_angle(DVec3::Y, random.unit() * 6.0);
            let scale = DVec3::splat(0.2 + 0.3 * random.unit());
            let place = random.point(8.0);
            to_world[1].push(DAffine3::from_scale_rotation_translation(scale, rotation, place));
        }
        for nested in &outer.tables.nested {
            // The box of a host holds its guest.
            let to_outer = to_world[1][nested.anchor as usize];
            let mut host = Bounds { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };
            for b in &inner.bounds {
                for corner in 0..8 {
                    let pick = |k: usize| if corner >> k & 1 == 0 { b.min[k] } else { b.max[k] };
                    let p =
                        to_outer.transform_point3(DVec3::new(pick(0).into(), pick(1).into(), pick(2).into()));
                    host.min = host.min.min(p.as_vec3() - 1e-4);
                    host.max = host.max.max(p.as_vec3() + 1e-4);
                }
            }
            outer.bounds[nested.object as usize] = host;
        }
        let inner_known = known(&mut inner.tables, &inner.bounds, &mut random, 0);
        let guest: u32 = inner_known.triangles.iter().sum::<u32>() / 10;
        let outer_known = known(&mut outer.tables, &outer.bounds, &mut random, guest);
        let bounds = vec![outer.bounds, inner.bounds];
        let trees = [outer.tables, inner.tables].map(|tables| Tree::new(tables).unwrap());
        let visibility = Visibility::new(trees.into()).unwrap();
        let mut culler = SceneCuller::new(&visibility, &bounds).unwrap();
        let trees = vec![outer_known, inner_known];
        for (tree, known) in trees.iter().enumerate() {
            culler.set_triangles(tree as u32, &known.triangles).unwrap();
            culler.set_proxy_triangles(tree as u32, &known.proxy_triangles).unwrap();
            culler.set_levels(tree as u32, &known.starts, &known.levels).unwrap();
            for (anchor, to_world) in to_world[tree].iter().enumerate() {
                culler.set_anchor(tree as u32, anchor as u32, *to_world);
            }
        }
        let loose = sample(seed.wrapping_add(2000), true).bounds;
        culler.set_loose(&loose, &vec![9; loose.len()]).unwrap();
        Self { culler, bounds, has_guests, trees, to_world }
    }

    /// Objects that a proxy stands for, those of trees in it included.
    pub(crate) fn below(&self, proxy: Draw) -> Vec<Draw> {
        let known = &self.trees[proxy.tree as usize];
        let proxies = known.proxies.as_ref().unwrap();
        let mut below = Vec::new();
        for position in proxies.nodes()[proxy.object as usize].objects() {
            let object = proxies.object(position);
            match known.nested.iter().find(|nested| nested.object == object) {
                Some(nested) => {
                    let objects = 0..self.trees[nested.tree as usize].triangles.len() as u32;
                    let (tree, anchor) = (nested.tree, nested.anchor);
                    below.extend(objects.map(|object| Draw { tree, anchor, object }));
                }
                None => below.push(Draw { object, ..proxy }),
            }
        }
        below
    }

    /// Distance of the eye from a proxy's sphere, in the space of its tree.
    pub(crate) fn distance(&self, proxy: Draw, camera: &Camera) -> f64 {
        let node = self.trees[proxy.tree as usize].proxies.as_ref().unwrap().nodes()[proxy.object as usize];
        let to_world = &self.to_world[proxy.tree as usize][proxy.anchor as usize];
        let eye = to_world.inverse().transform_point3(camera.eye());
        (eye - node.center.as_dvec3()).length() - f64::from(node.radius)
    }

    pub(crate) fn triangles(&self, selected: &[Selected]) -> u64 {
        let of = |s: &Selected| {
            let Some(known) = self.trees.get(s.draw.tree as usize) else { return 9 };
            let object = s.draw.object as usize;
            match s.kind {
                SelectedKind::Object => known.triangles[object],
                SelectedKind::Level(level) => {
                    known.levels[known.starts[object] as usize + usize::from(level) - 1].triangles
                }
                SelectedKind::Proxy => known.proxy_triangles[object],
            }
        };
        selected.iter().map(|s| u64::from(of(s))).sum()
    }

    /// Of the coarsest form in which an object may be drawn by itself.
    pub(crate) fn least_triangles(&self, draw: Draw, camera: &Camera) -> u32 {
        let Some(known) = self.trees.get(draw.tree as usize) else { return 9 };
        let object = draw.object as usize;
        let to_world = &self.to_world[draw.tree as usize][draw.anchor as usize];
        let eye = to_world.inverse().transform_point3(camera.eye());
        let b = &self.bounds[draw.tree as usize][object];
        let inside = (b.min.as_dvec3().cmple(eye) & eye.cmple(b.max.as_dvec3())).all();
        let levels = &known.levels[known.starts[object] as usize..known.starts[object + 1] as usize];
        match levels.last() {
            Some(level) if !inside => level.triangles.min(known.triangles[object]),
            _ => known.triangles[object],
        }
    }
}

fn known(tables: &mut TreeTables, bounds: &[Bounds], random: &mut Random, guest: u32) -> Known {
    let count = bounds.len() as u32;
    let triangles: Vec<u32> = (0..count).map(|_| 12 + random.below(3000) as u32).collect();
    let (mut starts, mut levels, mut least) = (vec![0], Vec::new(), Vec::new());
    for &original in &triangles {
        let (mut triangles, mut error) = (original, 0.0);
        for _ in 0..random.below(4) {
            triangles = (triangles as f64 * (0.2 + 0.8 * random.unit())) as u32;
            error += 0.04 * random.unit() as f32;
            levels.push(Level::new(triangles, error));
        }
        starts.push(levels.len() as u32);
        least.push(triangles);
    }
    // A host is at least as large as the guest in its coarsest form.
    for nested in &tables.nested {
        least[nested.object as usize] = guest.min(1);
    }
    let mut order: Vec<u32> = (0..count).collect();
    let permuted = random.below(2) == 0;
    if permuted {
        for k in (1..order.len()).rev() {
            order.swap(k, random.below(k + 1));
        }
    }
    let mut builder = Builder {
        random: random.clone(),
        bounds,
        least: &least,
        order: order.clone(),
        tables: ProxyTables { visible: true, ..ProxyTables::default() },
        triangles: Vec::new(),
    };
    // Some objects lie before, between and behind the roots.
    let mut next = random.below(3) as u32;
    while next < count {
        let take = 1 + random.below((count - next) as usize) as u32;
        builder.node(next, take, 0);
        next += take + random.below(2) as u32;
    }
    let Builder { tables: mut proxies, triangles: proxy_triangles, .. } = builder;
    proxies.object = permuted.then_some(order);
    tables.proxies = Some(proxies.clone());
    let proxies = Some(Proxies::new(proxies, count).unwrap());
    Known { proxies, nested: tables.nested.clone(), triangles, proxy_triangles, starts, levels }
}

/// All objects that are drawn as something, each once.
pub(crate) fn covered(hlod: &Hlod, selected: &[Selected]) -> Result<HashSet<Draw>, String> {
    let mut covered = HashSet::new();
    for s in selected {
        let objects = if s.kind == SelectedKind::Proxy { hlod.below(s.draw) } else { vec![s.draw] };
        for draw in objects {
            if !covered.insert(draw) {
                return Err(format!("{draw:?} is drawn twice"));
            }
        }
    }
    Ok(covered)
}
