//! Where a camera fits, and what that shows.

use crate::builder::{Builder, shell};
use crate::left;
use serde_json::json;

/// A closed box of half width 1 with one of half width 0.5 in it.
fn nested(material: usize, open: &[usize]) -> Builder {
    let mut builder = Builder::new();
    let outer = builder.mesh(&shell([1.0; 3], 4, open), material);
    builder.node("outer", outer, json!({}));
    builder.cube("inner", 0.5, [0.0; 3], material);
    builder
}

#[test]
fn a_closed_box_hides_what_is_in_it_unless_a_camera_fits_in() {
    let builder = nested(1, &[]);
    // Between the boxes are 0.5 m, and so are inside the inner one up to its middle.
    let (names, report, _) = left(&builder, Some(0.55));
    assert_eq!(names, ["outer"]);
    assert_eq!((report.objects, report.objects_removed, report.triangles_removed), (2, 1, 12));
    assert_eq!((report.largest.len(), report.largest[0].name.as_deref()), (1, Some("inner")));
    assert!(report.camera_points > 0, "there is room around the scene");
    let (names, report, _) = left(&builder, Some(0.2));
    assert_eq!((names.as_slice(), report.objects_removed), (&["outer".into(), "inner".into()][..], 0));
    // By default half a percent of the radius is enough for a camera.
    let (names, report, _) = left(&builder, None);
    assert_eq!(names, ["outer", "inner"]);
    assert!((report.clearance - 0.005 * 3f64.sqrt()).abs() < 1e-6, "{report:?}");
}

#[test]
fn an_open_box_hides_nothing() {
    for face in 0..6 {
        assert_eq!(left(&nested(1, &[face]), Some(0.55)).0, ["outer", "inner"], "face {face}");
    }
}

#[test]
fn a_camera_inside_needs_no_way_in() {
    let mut builder = Builder::new();
    let room = builder.mesh(&shell([5.0, 1.5, 4.0], 2, &[]), 1);
    builder.node("room", room, json!({}));
    builder.cube("table", 0.4, [2.0, -1.0, 1.0], 1);
    builder.cube("lamp", 0.02, [2.0, -0.55, 1.0], 1);
    let (names, report, _) = left(&builder, None);
    assert_eq!(names, ["room", "table", "lamp"]);
    assert!(report.camera_points > 100, "{report:?}");
}

#[test]
fn bolts_in_a_solid_go() {
    let mut builder = Builder::new();
    let plate = builder.mesh(&shell([1.0, 1.0, 0.1], 3, &[]), 0);
    builder.node("plate", plate, json!({}));
    for (number, x) in [-0.6f32, 0.0, 0.6].into_iter().enumerate() {
        builder.cube(&format!("bolt {number}"), 0.04, [x, 0.2, 0.0], 0);
    }
    // One looks out of the plate.
    builder.cube("head", 0.04, [0.3, 0.3, 0.08], 0);
    assert_eq!(left(&builder, Some(0.15)).0, ["plate", "head"]);
}

#[test]
fn mirrored_shells_hide_as_others_do() {
    for scale in [[-1.0, 1.0, 1.0], [1.0, -1.0, 1.0], [-1.0, -1.0, -1.0]] {
        let mut builder = Builder::new();
        let mesh = builder.mesh(&shell([1.0; 3], 1, &[]), 0);
        builder.node("outer", mesh, json!({"scale": scale}));
        builder.node("inner", mesh, json!({"scale": scale.map(|x| x * 0.5)}));
        assert_eq!(left(&builder, Some(0.55)).0, ["outer"], "{scale:?}");
    }
    // Inside out and one-sided: what faces inwards is culled, and the inner box shows through.
    let mut builder = Builder::new();
    let mut inverted = shell([1.0; 3], 1, &[]);
    inverted.indices.as_chunks_mut::<3>().0.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    let mesh = builder.mesh(&inverted, 0);
    builder.node("outer", mesh, json!({}));
    builder.cube("inner", 0.5, [0.0; 3], 0);
    assert_eq!(left(&builder, Some(0.55)).0, ["outer", "inner"]);
}
