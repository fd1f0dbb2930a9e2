//! The stages of one tree: rays, hierarchy, sampling, pruning, importance.

use super::borrow::borrow_rows;
use super::choose;
use super::encode::encode_tree;
use super::hierarchy::{self, HierarchyKind};
use super::options::{BakeOptions, DEFAULT_PRUNE, HierarchyChoice};
use super::progress::Progress;
use super::prune;
use super::rays::RayScene;
use super::sample::{Ancestry, Areas, Found, Levels, MAX_DEPTH, Met, Observer, Target, sample_batch};
use super::spheres;
use super::subject::Subject;
use super::tree::{Hierarchy, Sphere};
use crate::scene::Mesh;
use svs_runtime::directions::DirectionSet;
use svs_runtime::encode::{importance_code, index_bytes, row_stride};

/// Rays of the first batch: it chooses the hierarchy and prunes it.
const PILOT_RAYS: u64 = 1 << 22;

/// The estimate of missing pixels has to be this many times below the target: measured missing pixels of
/// perspective views were 1 to 3.6 times the estimate, which is made of parallel rays.
const ESTIMATE_MARGIN: f64 = 3.0;

/// Triangles that sharing rows of levels may add to what is visible before spheres are given up instead.
const BORROWING_SHARE: f64 = 0.02;

/// Most nodes kept above any object: what four bits can count.
const MOST_LEVELS: u32 = 15;

/// A baked tree, ready to be encoded.
#[derive(Clone, Debug)]
pub struct BakedTree {
    /// Inner nodes and the order of the members.
    pub hierarchy: Hierarchy,
    /// Sphere of each node, tree space.
    pub spheres: Vec<Sphere>,
    /// Visible levels by member (document order).
    pub levels: Levels,
    /// For each member (document order) the largest visible area in m², for heights 1 to its depth.
    pub areas: Vec<Vec<f64>>,
    /// How it came about.
    pub made: Made,
}

/// Figures about the making of a tree.
#[derive(Clone, Debug, PartialEq)]
pub struct Made {
    /// Hierarchy that was used.
    pub kind: HierarchyKind,
    /// Nodes before pruning.
    pub nodes_before: usize,
    /// Share that pruning asked for.
    pub prune: f64,
    /// Rays traced.
    pub rays: u64,
    /// Estimated missing pixels per million covered ones, parallel views from outside.
    pub missing_ppm: f64,
}

struct Candidate {
    kind: HierarchyKind,
    hierarchy: Hierarchy,
    spheres: Vec<Sphere>,
}

/// Bakes one tree. If its tables take more than `bytes_allowed`, and the share of pruning was not named, objects
/// share rows of levels, then spheres are given up, until they do not.
pub fn bake_tree(
    subject: &Subject,
    meshes: &[Mesh],
    directions: &DirectionSet,
    options: &BakeOptions,
    progress: &dyn Progress,
    bytes_allowed: u64,
) -> BakedTree {
    progress.stage("rays", None);
    let scene = RayScene::new(meshes, &subject.parts);
    progress.stage("hierarchy", None);
    let candidates = candidates(subject, meshes, options);
    progress.stage("sample", Some(options.ray_limit()));
    let mut sampling = Sampling {
        scene,
        directions,
        met: Met::new(subject.members.len()),
        objects: subject.members.len() as u64,
        triangles: subject.members.iter().map(|m| u64::from(m.triangles)).sum(),
        rays: 0,
        crossings: 0,
        missing_ppm: 0.0,
        batches: 0,
        progress,
    };
    let share = options.prune.unwrap_or(DEFAULT_PRUNE).clamp(0.0, 1.0);
    let (mut tree, mut made) = choose_by_pilot(candidates, &mut sampling, subject, options, share);
    let areas = sampling.sample_until_enough(&mut tree.target, options);

    progress.stage("prune", None);
    for member in (0..subject.members.len() as u32).filter(|&m| !sampling.met.get(m)) {
        let seen_by_all = vec![tree.target.ancestry.depth(member); directions.len()];
        tree.target.levels.set_row(member, &seen_by_all);
    }
    let unit = sampling.scene.radius() * sampling.scene.radius();
    let areas = (0..subject.members.len() as u32)
        .map(|member| areas.largest(member).into_iter().map(|area| area * unit).collect())
        .collect();
    made.rays = sampling.rays;
    made.missing_ppm = sampling.missing_ppm;
    prune_to_size(tree, areas, made, subject, directions, options, bytes_allowed)
}

/// The hierarchies to choose from.
fn candidates(subject: &Subject, meshes: &[Mesh], options: &BakeOptions) -> Vec<Candidate> {
    let kinds: &[HierarchyKind] = match &options.hierarchy {
        HierarchyChoice::Kind(kind) => std::slice::from_ref(kind),
        HierarchyChoice::Auto => &[HierarchyKind::Scene, HierarchyKind::Octree, HierarchyKind::Bvh],
    };
    kinds.iter().map(|&kind| candidate(kind, subject, meshes, options)).collect()
}

/// Samples all candidates with the same few rays and takes the one that is cheapest after pruning, pruned.
fn choose_by_pilot(
    mut candidates: Vec<Candidate>,
    sampling: &mut Sampling<'_>,
    subject: &Subject,
    options: &BakeOptions,
    share: f64,
) -> (State, Made) {
    let mut targets: Vec<Target> = candidates
        .iter()
        .map(|c| Target::new(Ancestry::new(&c.hierarchy), sampling.directions.len()))
        .collect();
    let found = sampling.batch(&mut targets, None, pilot_rays(options));
    let (best, keep) = candidates
        .iter()
        .zip(&targets)
        .enumerate()
        .map(|(index, (candidate, target))| {
            let (cost, keep) = pruned_cost(candidate, target, subject, share);
            (index, cost, keep)
        })
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(index, _, keep)| (index, keep))
        .unwrap_or_default();
    sampling.missing_ppm = found[best].missing_ppm() * 0.5;
    let chosen = candidates.swap_remove(best);
    let made = Made {
        kind: chosen.kind,
        nodes_before: chosen.hierarchy.nodes.len(),
        prune: share,
        rays: 0,
        missing_ppm: 0.0,
    };
    let mut tree =
        State { spheres: chosen.spheres, hierarchy: chosen.hierarchy, target: targets.swap_remove(best) };
    tree.drop_nodes(&keep);
    (tree, made)
}

fn pilot_rays(options: &BakeOptions) -> u64 {
    PILOT_RAYS.min(options.ray_limit() / 2).max(1)
}

/// The rays of one tree, batch by batch.
struct Sampling<'a> {
    scene: RayScene<'a>,
    directions: &'a DirectionSet,
    met: Met,
    /// In the tree.
    objects: u64,
    /// Drawn by them.
    triangles: u64,
    rays: u64,
    crossings: u64,
    /// Estimate for the table as it is now.
    missing_ppm: f64,
    batches: u64,
    progress: &'a dyn Progress,
}

impl Sampling<'_> {
    fn batch(&mut self, targets: &mut [Target], areas: Option<&mut Areas>, rays: u64) -> Vec<Found> {
        let advance = |rays| self.progress.advance(rays);
        let observer = Observer { areas, met: &self.met, advance: &advance };
        let found = sample_batch(&self.scene, self.directions, targets, observer, rays, self.batches);
        self.batches += 1;
        self.rays += found.first().map_or(0, |f| f.rays);
        self.crossings += found.first().map_or(0, |f| f.crossings);
        found
    }

    /// Doubles the number of rays until the estimate is below the target or a limit is reached; what is missing
    /// falls as one over the number of rays. Returns the visible areas.
    fn sample_until_enough(&mut self, target: &mut Target, options: &BakeOptions) -> Areas {
        let ray_limit = options.ray_limit();
        let crossing_limit = options.crossing_limit(self.triangles);
        let least_rays = options.least_rays(self.objects);
        let mut areas = Areas::new(&target.ancestry, self.directions.len());
        loop {
            // What is left of the limits, going by the crossings per ray so far.
            let left = ray_limit.saturating_sub(self.rays);
            let crossings_left = crossing_limit.saturating_sub(self.crossings) as f64;
            let affordable = (crossings_left * self.rays as f64 / self.crossings.max(1) as f64) as u64;
            let affordable = affordable.max(least_rays.saturating_sub(self.rays));
            let rays = self.rays.min(left).min(affordable).max(pilot_rays(options));
            let before = self.rays;
            let found = self.batch(std::slice::from_mut(target), Some(&mut areas), rays)[0];
            if found.seen > 0 {
                self.missing_ppm = found.missing_ppm() * before as f64 / self.rays as f64;
            }
            let enough = self.missing_ppm * ESTIMATE_MARGIN <= options.target_ppm();
            let crossed = self.crossings >= crossing_limit && self.rays >= least_rays;
            let spent = self.rays >= ray_limit || crossed || rays == affordable;
            if enough || spent || found.seen == 0 {
                return areas;
            }
        }
    }
}

/// Gives up spheres, and distinct rows of levels, until the tables fit.
fn prune_to_size(
    mut tree: State,
    mut areas: Vec<Vec<f64>>,
    made: Made,
    subject: &Subject,
    directions: &DirectionSet,
    options: &BakeOptions,
    bytes_allowed: u64,
) -> BakedTree {
    // Three levels take two bits each, fifteen take four.
    let named = options.prune.map(|share| [(share.clamp(0.0, 1.0), MOST_LEVELS)]);
    let steps = named.as_ref().map_or(PRUNE_STEPS, |named| named.as_slice());
    let mut last = 0;
    loop {
        let (share, limit) = steps[last];
        let visible = tree.visible_triangles(subject);
        let keep = prune::nodes_worth_keeping(&tree.hierarchy, &subject.members, &visible, share, limit);
        tree.drop_areas(&keep, &mut areas);
        tree.drop_nodes(&keep);
        if options.prune.is_none() && !tree.pays(subject) {
            let none = vec![false; tree.hierarchy.nodes.len()];
            tree.drop_areas(&none, &mut areas);
            tree.drop_nodes(&none);
        }
        let mut baked = BakedTree {
            hierarchy: tree.hierarchy.clone(),
            spheres: tree.spheres.clone(),
            levels: tree.target.levels.clone(),
            areas: areas.clone(),
            made: Made { prune: share, ..made.clone() },
        };
        if baked.hierarchy.nodes.is_empty() {
            // Nothing is hidden, so nothing can be missed.
            baked.made.missing_ppm = 0.0;
        }
        let fits = |tree: &BakedTree| encode_tree(tree, subject, directions).bytes() as u64 <= bytes_allowed;
        last += 1;
        if options.prune.is_some() || fits(&baked) {
            return baked;
        }
        baked.save_rows(subject, directions, bytes_allowed);
        if last == steps.len() || fits(&baked) {
            return baked;
        }
    }
}

/// With spheres, at most this share of the triangles may be expected to be drawn: else the tree has none, and costs nothing at
/// run time. In linz-city 95 % of the triangles were left; their spheres took 1.3 ms a frame to ask, broke 49 draw calls
/// into 1,060, and made frames 6 % slower than frustum culling alone.
const LEAST_SAVING: f64 = 0.9;

/// Share of pruning and most nodes kept above any object, from what is best to what fits everywhere.
const PRUNE_STEPS: &[(f64, u32)] = &[
    (DEFAULT_PRUNE, MOST_LEVELS),
    (DEFAULT_PRUNE, 3),
    (0.1, 3),
    (0.2, 3),
    (0.3, 3),
    (0.5, 3),
    (0.5, 1),
    (1.0, 1),
];

/// A hierarchy with what has been seen of it.
struct State {
    hierarchy: Hierarchy,
    spheres: Vec<Sphere>,
    target: Target,
}

impl State {
    fn visible_triangles(&self, subject: &Subject) -> Vec<f64> {
        prune::visible_triangles(
            &self.hierarchy,
            &self.target.ancestry,
            &self.target.levels,
            &subject.members,
        )
    }

    /// The spheres save enough triangles to make up for asking them, and for what they miss.
    fn pays(&self, subject: &Subject) -> bool {
        let visible = self.visible_triangles(subject);
        let all: f64 = subject.members.iter().map(|member| f64::from(member.triangles)).sum();
        choose::cost(&self.hierarchy, &self.spheres, &subject.members, &visible) <= all * LEAST_SAVING
    }

    fn drop_nodes(&mut self, keep: &[bool]) {
        if keep.iter().all(|&k| k) {
            return;
        }
        prune::levels_of_kept(&self.target.ancestry, keep, &mut self.target.levels);
        // Kept nodes stay in depth-first order, so spheres stay in step.
        let mut kept = keep.iter();
        self.spheres.retain(|_| *kept.next().unwrap_or(&false));
        self.hierarchy = prune::without_dropped(&self.hierarchy, keep);
        self.target.ancestry = Ancestry::new(&self.hierarchy);
    }

    /// To be called before `drop_nodes`: keeps the areas of the heights that stay.
    fn drop_areas(&self, keep: &[bool], areas: &mut [Vec<f64>]) {
        for (member, areas) in areas.iter_mut().enumerate() {
            let mut ancestors = self.target.ancestry.ancestors(member as u32);
            areas.retain(|_| ancestors.next().is_some_and(|node| keep[node as usize]));
        }
    }
}

fn candidate(kind: HierarchyKind, subject: &Subject, meshes: &[Mesh], options: &BakeOptions) -> Candidate {
    let mut hierarchy = hierarchy::build(kind, &subject.members, &subject.groups);
    let shallow = prune::nodes_within_depth(&hierarchy, MAX_DEPTH);
    if !shallow.iter().all(|&k| k) {
        hierarchy = prune::without_dropped(&hierarchy, &shallow);
    }
    let spheres = spheres::spheres(options.spheres, &hierarchy, &subject.members, &subject.parts, meshes);
    Candidate { kind, hierarchy, spheres }
}

fn pruned_cost(candidate: &Candidate, target: &Target, subject: &Subject, share: f64) -> (f64, Vec<bool>) {
    let mut state = State {
        hierarchy: candidate.hierarchy.clone(),
        spheres: candidate.spheres.clone(),
        target: target.clone(),
    };
    let visible = state.visible_triangles(subject);
    let keep = prune::nodes_worth_keeping(&state.hierarchy, &subject.members, &visible, share, MOST_LEVELS);
    state.drop_nodes(&keep);
    let visible = state.visible_triangles(subject);
    (choose::cost(&state.hierarchy, &state.spheres, &subject.members, &visible), keep)
}

impl BakedTree {
    /// Lets objects share rows of levels, as far as that helps to fit into `bytes_allowed`.
    fn save_rows(&mut self, subject: &Subject, directions: &DirectionSet, bytes_allowed: u64) {
        let encoded = encode_tree(self, subject, directions);
        let size = |semantic: &str| {
            encoded.tables.iter().filter(|t| t.semantic == semantic).map(|t| t.bytes.len()).sum::<usize>()
        };
        let rows = size("LEVEL_ROW");
        let others = encoded.bytes() - rows - size("LEVEL_ROW_INDEX");
        let objects = subject.members.len();
        let index = objects * index_bytes(objects.saturating_sub(1) as u32);
        let room = (bytes_allowed as usize).saturating_sub(others + index);
        let stride = row_stride(directions.len(), encoded.level_bits);
        borrow_rows(&mut self.levels, &subject.members, room / stride, BORROWING_SHARE);
    }

    /// Area that importance code 0 stands for: the largest there is, m².
    pub fn importance_area(&self) -> f64 {
        self.areas.iter().flatten().copied().fold(0.0, f64::max)
    }

    /// Importance codes of a member for heights 1 to its highest level.
    pub fn importance(&self, member: u32, importance_area: f64) -> impl Iterator<Item = u8> + '_ {
        let highest = self.levels.row(member).iter().copied().max().unwrap_or(0);
        self.areas[member as usize][..usize::from(highest)]
            .iter()
            .map(move |&area| importance_code(area, importance_area))
    }
}
