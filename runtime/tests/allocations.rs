//! Culling allocates nothing once warm: counted by an allocator of this program's own.
#![allow(
    unsafe_code,
    reason = "an allocator cannot be written without; the runtime itself forbids unsafe code"
)]

mod common;

use common::{camera, camera_at, sample, some_proxies};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::Arc;
use svs_runtime::{
    Bounds, Budget, CostModel, Culler, Detail, Draw, Level, Placement, Query, SceneCuller, Settings, Tree,
    Visibility,
};

thread_local! {
    /// Allocations of this thread: the test runner has threads of its own.
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

struct Counting;

// SAFETY: every call goes to the system's allocator with unchanged arguments, so its guarantees are this one's. Counting
// does not allocate: the counter is initialised at compile time and needs no destructor.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: the caller keeps the contract of `alloc_zeroed`.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        // SAFETY: the caller keeps the contract of `realloc`, and `block` came from the system's allocator.
        unsafe { System.realloc(block, layout, size) }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps the contract of `dealloc`, and `block` came from the system's allocator.
        unsafe { System.dealloc(block, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn count() {
    // A thread that is about to end has no counter any more.
    let _ = ALLOCATIONS.try_with(|allocations| allocations.set(allocations.get() + 1));
}

/// Allocations of this thread while `work` runs.
fn allocations<T>(work: impl FnOnce() -> T) -> usize {
    let before = ALLOCATIONS.get();
    std::hint::black_box(work());
    ALLOCATIONS.get() - before
}

fn settings() -> Vec<Settings> {
    let queries =
        [Query::SphereNearest, Query::SphereMax3, Query::SphereWeighted3, Query::SphereMaxAll, Query::Object];
    let qualities = [0.1, 0.6, 0.8, 1.0];
    queries
        .into_iter()
        .flat_map(|query| qualities.map(|quality| Settings { query, ..Settings::from_quality(quality) }))
        .collect()
}

#[test]
fn the_counter_counts() {
    assert_eq!(allocations(|| Box::new(1)), 1);
    assert_eq!(allocations(|| vec![0_u8; 100]), 1);
    assert_eq!(allocations(|| 1), 0);
}

#[test]
fn a_culler_never_allocates() {
    for seed in 0..10 {
        let sample = sample(seed, seed % 2 == 0);
        let tree = Arc::new(Tree::new(sample.tables).unwrap());
        let mut culler = Culler::new(&tree, &sample.bounds).unwrap();
        let settings = settings();
        let mut drawn = 0;
        for hidden in [false, true] {
            culler.set_hidden(0, hidden);
            let count = allocations(|| {
                for frame in 0..20 {
                    let camera =
                        if frame % 2 == 0 { camera(frame) } else { camera_at(&sample.bounds[0], frame) };
                    drawn +=
                        settings.iter().map(|settings| culler.cull(&camera, settings).len()).sum::<usize>();
                }
            });
            assert_eq!(count, 0, "seed {seed}, hidden {hidden}");
        }
        assert!(drawn > 0);
    }
}

#[test]
fn a_scene_culler_never_allocates_once_warm() {
    let (mut outer, mut inner) = (sample(1, false), sample(2, true));
    outer.tables.nested = vec![svs_runtime::Nested { object: 0, tree: 1, anchor: 0 }];
    inner.tables.placement = Placement::Anchors(vec![3, 4]);
    for sample in [&mut outer, &mut inner] {
        sample.tables.proxies = Some(some_proxies(sample.tables.object_count));
    }
    let bounds: Vec<Vec<Bounds>> = vec![outer.bounds, inner.bounds];
    let trees = [outer.tables, inner.tables].map(|tables| Tree::new(tables).unwrap());
    let visibility = Visibility::new(trees.into()).unwrap();
    let mut culler = SceneCuller::new(&visibility, &bounds).unwrap();
    culler.set_hidden(Draw { tree: 1, anchor: 1, object: 0 }, true);
    for (tree, bounds) in bounds.iter().enumerate() {
        culler.set_triangles(tree as u32, &vec![7; bounds.len()]).unwrap();
        culler.set_proxy_triangles(tree as u32, &[30, 20, 20]).unwrap();
        let starts: Vec<u32> = (0..=bounds.len() as u32).collect();
        culler.set_levels(tree as u32, &starts, &vec![Level::new(3, 0.05); bounds.len()]).unwrap();
    }
    let others = sample(3, true).bounds;
    culler.set_loose(&others, &vec![9; others.len()]).unwrap();
    let settings = settings();
    let mut model = CostModel::new();
    let mut round = |culler: &mut SceneCuller| {
        let mut drawn = 0;
        for frame in 0..20 {
            let camera = camera(frame);
            for settings in &settings {
                drawn += culler.cull(&camera, settings).len();
                for budget in [
                    Budget::Unlimited,
                    Budget::Triangles(100),
                    Budget::Triangles(300),
                    Budget::StopAtFirstMisfit(300),
                    Budget::Milliseconds(0.6, &model),
                ] {
                    drawn += culler.cull_within(&camera, settings, &budget).len();
                    for tau in [0.0, 1.0, 30.0] {
                        let detail = Detail { tau, ..Detail::default() };
                        drawn += culler.select(&camera, settings, &detail, &budget).len();
                    }
                }
                let chosen = culler.selection();
                model.record(chosen.chosen_triangles, chosen.chosen as u64, 1.0);
            }
        }
        drawn
    };
    assert!(round(&mut culler) > 0);
    assert_eq!(allocations(|| round(&mut culler)), 0);
}
