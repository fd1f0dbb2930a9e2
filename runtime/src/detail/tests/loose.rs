//! Levels of objects in no tree.

use crate::bounds::{Bounds, BoundsError};
use crate::budget::Budget;
use crate::camera::Camera;
use crate::decode::Visibility;
use crate::detail::{Detail, Level, Metric, SelectedKind};
use crate::query::Settings;
use crate::scene::SceneCuller;
use crate::tables::TreeTables;
use crate::tree::{Placement, Tree};
use glam::Vec3;

/// An object in no tree is drawn as the one of a tree that is on no proxy and was never baked: at the same levels.
#[test]
fn loose_objects_are_simplified_as_those_of_trees() {
    let bounds: Vec<Bounds> = [2.0_f32, 9.0, 40.0, 200.0]
        .map(|z| Bounds { min: Vec3::new(-1.0, -1.0, -z - 2.0), max: Vec3::new(1.0, 1.0, -z) })
        .to_vec();
    let (triangles, starts) = ([1000, 900, 800, 700], [0, 3, 5, 5, 6]);
    let levels = [
        Level::new(500, 0.002),
        Level::new(100, 0.05),
        Level::new(20, 0.4),
        Level::new(300, 0.01),
        Level::new(30, 0.3),
        Level::new(50, 0.2),
    ];
    let tables = TreeTables {
        placement: Placement::Scene(0),
        directions: "octahedron".to_owned(),
        object_count: 4,
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
        proxies: None,
        nested: Vec::new(),
        recommended_quality: None,
        fingerprint: None,
    };
    let visibility = Visibility::new(vec![Tree::new(tables).unwrap()]).unwrap();
    let mut tree = SceneCuller::new(&visibility, &[&bounds]).unwrap();
    tree.set_triangles(0, &triangles).unwrap();
    tree.set_levels(0, &starts, &levels).unwrap();
    let mut loose = SceneCuller::empty();
    loose.set_loose(&bounds, &triangles).unwrap();
    loose.set_loose_levels(&starts, &levels).unwrap();

    let camera = Camera::perspective(glam::DMat4::IDENTITY, 1.0, 1000.0, 800.0, 0.1);
    let mut simplified = 0;
    for tau in [0.0, 0.5, 2.0, 30.0] {
        for budget in
            [Budget::Unlimited, Budget::Triangles(1500), Budget::Triangles(200), Budget::Triangles(60)]
        {
            let detail = Detail { tau, metric: Metric::Sse };
            let mut drawn = [&mut tree, &mut loose].map(|culler| {
                culler.cull(&camera, &Settings::FRUSTUM);
                let selected = culler.select(&camera, &Settings::FRUSTUM, &detail, &budget);
                let mut drawn: Vec<_> = selected.iter().map(|s| (s.draw.object, s.kind)).collect();
                drawn.sort_unstable();
                drawn
            });
            simplified += drawn[0].iter().filter(|(_, kind)| *kind != SelectedKind::Object).count();
            let of_loose = std::mem::take(&mut drawn[1]);
            assert_eq!(drawn[0], of_loose, "tau {tau}, {budget:?}");
        }
    }
    assert!(simplified > 10, "{simplified}");

    // By hand: a radian is 732 pixels, so 0.4 m at 2 m are 146 pixels, 0.05 m 18; 0.3 m at 9 m are 24.
    let detail = Detail { tau: 20.0, metric: Metric::Sse };
    let selected = loose.select(&camera, &Settings::FRUSTUM, &detail, &Budget::Unlimited);
    let mut kinds: Vec<_> = selected.iter().map(|s| (s.draw.object, s.kind)).collect();
    kinds.sort_unstable();
    let level = SelectedKind::Level;
    assert_eq!(kinds, [(0, level(2)), (1, level(1)), (2, SelectedKind::Object), (3, level(1))]);

    // Others take their place, without levels until they are given.
    assert!(matches!(loose.set_loose_levels(&starts[1..], &levels), Err(BoundsError::LooseLevelStarts)));
    let falling = [Level::new(5, 0.2), Level::new(6, 0.3)];
    let wrong = loose.set_loose_levels(&[0, 0, 2, 2, 2], &falling);
    assert!(matches!(wrong, Err(BoundsError::LooseLevels { object: 1 })));
    loose.set_loose(&bounds[..2], &triangles[..2]).unwrap();
    let selected = loose.select(&camera, &Settings::FRUSTUM, &detail, &Budget::Unlimited);
    assert!(selected.len() == 2 && selected.iter().all(|s| s.kind == SelectedKind::Object));
}
