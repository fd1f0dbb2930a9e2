//! The stages of one tree: rays, hierarchy, sampling, pruning, importance.

use super::borrow::borrow_rows;
use super::choose;
use super::encode::encode_tree;
use super::hierarchy::{self, HierarchyKind};
use super::options::{BakeOptions, DEFAULT_PRUNE, HierarchyChoice};
use super::progress::Progress;
use super::prune;
use super::rays::RayScene;
use super::sample::{Ancestry, Areas, Levels, MAX_DEPTH, Met, Target, sample_batch};
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
    let kinds: &[HierarchyKind] = match &options.hierarchy {
        HierarchyChoice::Kind(kind) => std::slice::from_ref(kind),
        HierarchyChoice::Auto => &[HierarchyKind::Scene, HierarchyKind::Octree, HierarchyKind::Bvh],
    };
    let mut candidates: Vec<Candidate> =
        kinds.iter().map(|&kind| candidate(kind, subject, meshes, options)).collect();
    let mut targets: Vec<Target> =
        candidates.iter().map(|c| Target::new(Ancestry::new(&c.hierarchy), directions.len())).collect();

    let met = Met::new(subject.members.len());
    let limit = options.ray_limit();
    let crossing_limit = options.crossing_limit();
    let pilot = PILOT_RAYS.min(limit / 2).max(1);
    progress.stage("sample", Some(limit));
    let advance = |rays| progress.advance(rays);
    let found = sample_batch(&scene, directions, &mut targets, None, &met, pilot, 0, &advance);

    // Choose and prune by what the pilot saw.
    let share = options.prune.unwrap_or(DEFAULT_PRUNE).clamp(0.0, 1.0);
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
    let chosen = candidates.swap_remove(best);
    let target = targets.swap_remove(best);
    drop(targets);
    let mut rays = found[best].rays;
    let mut crossings = found[best].crossings;
    let mut missing_ppm = found[best].missing_ppm() * 0.5;
    let mut tree = State { spheres: chosen.spheres, hierarchy: chosen.hierarchy, target };
    let nodes_before = tree.hierarchy.nodes.len();
    tree.drop_nodes(&keep);

    // Batches double the number of rays, and what is missing falls as one over it.
    let mut areas = Areas::new(&tree.target.ancestry, directions.len());
    let mut index = 1;
    loop {
        // What is left of the limits, going by the crossings per ray so far.
        let left = limit.saturating_sub(rays);
        let affordable =
            (crossing_limit.saturating_sub(crossings) as f64 * rays as f64 / crossings.max(1) as f64) as u64;
        let batch = rays.min(left).min(affordable).max(pilot);
        let found = sample_batch(
            &scene,
            directions,
            std::slice::from_mut(&mut tree.target),
            Some(&mut areas),
            &met,
            batch,
            index,
            &advance,
        )[0];
        let before = rays;
        rays += found.rays;
        crossings += found.crossings;
        index += 1;
        missing_ppm =
            if found.seen == 0 { missing_ppm } else { found.missing_ppm() * before as f64 / rays as f64 };
        let enough = missing_ppm * ESTIMATE_MARGIN <= options.target_ppm();
        let spent = rays >= limit || crossings >= crossing_limit || batch == affordable;
        if enough || spent || found.seen == 0 {
            break;
        }
    }

    progress.stage("prune", None);
    for member in (0..subject.members.len() as u32).filter(|&m| !met.get(m)) {
        tree.target.levels.set_row(member, &vec![tree.target.ancestry.depth(member); directions.len()]);
    }
    let unit = scene.radius() * scene.radius();
    let mut areas: Vec<Vec<f64>> = (0..subject.members.len() as u32)
        .map(|member| areas.largest(member).into_iter().map(|area| area * unit).collect())
        .collect();
    // Three levels take two bits each, fifteen take four.
    let steps = match options.prune {
        Some(share) => vec![(share.clamp(0.0, 1.0), MOST_LEVELS)],
        None => vec![
            (DEFAULT_PRUNE, MOST_LEVELS),
            (DEFAULT_PRUNE, 3),
            (0.1, 3),
            (0.2, 3),
            (0.3, 3),
            (0.5, 3),
            (0.5, 1),
            (1.0, 1),
        ],
    };
    let mut baked = None;
    for (share, limit) in steps {
        let visible = tree.visible_triangles(subject);
        let keep = prune::nodes_worth_keeping(&tree.hierarchy, &subject.members, &visible, share, limit);
        tree.drop_areas(&keep, &mut areas);
        tree.drop_nodes(&keep);
        let mut result = BakedTree {
            hierarchy: tree.hierarchy.clone(),
            spheres: tree.spheres.clone(),
            levels: tree.target.levels.clone(),
            areas: areas.clone(),
            made: Made { kind: chosen.kind, nodes_before, prune: share, rays, missing_ppm },
        };
        let bytes = |tree: &BakedTree| encode_tree(tree, subject, directions).bytes() as u64;
        let mut enough = options.prune.is_some() || bytes(&result) <= bytes_allowed;
        if !enough {
            result.save_rows(subject, directions, bytes_allowed);
            enough = bytes(&result) <= bytes_allowed;
        }
        baked = Some(result);
        if enough {
            break;
        }
    }
    // The list of shares is never empty.
    baked.unwrap_or_else(|| unreachable!("at least one share was tried"))
}

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
