use super::*;
use crate::bake::tree::{Aabb, Sphere};
use crate::verify::Surroundings;
use serde_json::{Value, json};

fn pose(x: f64, y: f64, z: f64, forward: DVec3) -> Pose {
    Pose { eye: DVec3::new(x, y, z), forward: forward.normalize() }
}

fn path(poses: Vec<Pose>) -> CameraPath {
    CameraPath { name: "test".to_owned(), vertical_fov: 1.0, near: Some(0.25), poses }
}

fn bent() -> Vec<Pose> {
    vec![
        pose(0.0, 0.0, 0.0, DVec3::X),
        pose(5.0, 1.0, 0.0, DVec3::new(1.0, 0.0, 1.0)),
        pose(6.0, 1.0, 9.0, DVec3::Z),
        pose(6.5, 8.0, 9.0, DVec3::new(-1.0, 0.2, 0.5)),
    ]
}

#[test]
fn the_spline_passes_through_every_pose_without_a_jump() {
    let poses = bent();
    let steps = path(poses.clone()).steps(3 * 10 + 1);
    assert_eq!(steps.len(), 31);
    for (index, pose) in poses.iter().enumerate() {
        let at = steps[index * 10];
        assert!(at.eye.distance(pose.eye) < 1e-12 && at.forward.distance(pose.forward) < 1e-12, "{index}");
    }
    let fine = path(poses).steps(3_001);
    for pair in fine.windows(3) {
        assert!(pair[0].eye.distance(pair[1].eye) < 0.03);
        assert!((pair[1].forward.length() - 1.0).abs() < 1e-12);
        // No corner: velocity changes little from step to step.
        let bend = (pair[2].eye - pair[1].eye) - (pair[1].eye - pair[0].eye);
        assert!(bend.length() < 2e-4, "{}", bend.length());
    }
}

#[test]
fn half_a_turn_has_a_direction_everywhere() {
    for poses in [
        vec![pose(0.0, 0.0, 0.0, DVec3::X), pose(1.0, 0.0, 0.0, DVec3::NEG_X)],
        vec![pose(0.0, 0.0, 0.0, DVec3::Y), pose(1.0, 0.0, 0.0, DVec3::NEG_Y)],
    ] {
        for step in path(poses).steps(101) {
            assert!((step.forward.length() - 1.0).abs() < 1e-9);
        }
    }
}

#[test]
fn one_pose_stands_still_and_a_loop_has_no_corner() {
    assert_eq!(path(bent()[..1].to_vec()).steps(3), [bent()[0]; 3]);
    assert!(path(bent()).steps(0).is_empty());
    let mut round = bent();
    round.push(bent()[0]);
    let path = path(round);
    let fine = path.steps(4_001);
    let (leave, arrive) = (fine[1].eye - fine[0].eye, fine[4_000].eye - fine[3_999].eye);
    assert!(leave.distance(arrive) < 1e-4, "{leave} {arrive}");
}

#[test]
fn a_file_comes_back_as_it_was_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("path.json");
    let written = path(bent());
    written.write(&file).expect("written");
    let read = CameraPath::read(&file).expect("read");
    assert_eq!((read.poses.len(), read.near, read.name.as_str()), (4, Some(0.25), "test"));
    assert!((read.vertical_fov - 1.0).abs() < 1e-12);
    for (a, b) in read.poses.iter().zip(&written.poses) {
        assert!(a.eye == b.eye && a.forward.distance(b.forward) < 1e-15);
    }
    assert!(CameraPath::read(&folder.path().join("none.json")).is_err());
    assert!(written.write(&folder.path().join("none/path.json")).is_err());
}

#[test]
fn errors_name_the_place() {
    let good = json!({"version": 1, "poses": [{"eye": [1, 2, 3], "forward": [0, 0, -9]}]});
    let read = CameraPath::from_json(&good).expect("a camera");
    assert_eq!(read.poses, [pose(1.0, 2.0, 3.0, DVec3::NEG_Z)]);
    assert_eq!((read.vertical_fov, read.near), (DEFAULT_FOV, None));
    let cases: [(&str, Value, &str); 10] = [
        ("/version", json!(2), "/version"),
        ("/name", json!(3), "/name"),
        ("/vertical_fov", json!(180), "/vertical_fov"),
        ("/near", json!(0), "/near"),
        ("/poses", json!([]), "/poses"),
        ("/poses/0", json!(1), "/poses/0"),
        ("/poses/0/eye", json!([1, 2]), "/poses/0/eye"),
        ("/poses/0/eye", json!([1, 2, 1e300]), "/poses/0/eye"),
        ("/poses/0/forward", json!([0, 0, 0]), "/poses/0/forward"),
        ("/poses/0/up", json!([0, 1, 0]), "/poses/0/up"),
    ];
    for (at, value, pointer) in cases {
        let mut json = good.clone();
        let (parent, key) = at.rsplit_once('/').expect("a pointer");
        let parent = json.pointer_mut(parent).expect("a parent");
        match parent {
            Value::Array(items) => items[0] = value,
            _ => parent[key] = value,
        }
        let error = CameraPath::from_json(&json).expect_err(at).to_string();
        assert!(error.starts_with(&format!("{pointer}: ")), "{error}");
    }
    assert!(CameraPath::from_json(&json!([])).is_err());
}

#[test]
fn the_recorder_leaves_out_pauses() {
    let mut recorder = Recorder::new(100.0);
    assert!(recorder.observe(pose(0.0, 0.0, 0.0, DVec3::X)));
    assert!((0..50).all(|_| !recorder.observe(pose(0.1, 0.0, 0.0, DVec3::X))));
    assert!(recorder.observe(pose(0.3, 0.0, 0.0, DVec3::X)));
    assert!(recorder.observe(pose(0.3, 0.0, 0.0, DVec3::new(1.0, 0.1, 0.0))));
    assert!(!recorder.observe(pose(f64::NAN, 0.0, 0.0, DVec3::X)));
    assert!(!recorder.observe(pose(0.4, 0.0, 0.0, DVec3::new(1.0, 0.1, 0.0))));
    assert_eq!(recorder.len(), 3);
    let path = recorder.finish("flight", 1.0, 0.1).expect("a path");
    assert_eq!((path.poses.len(), path.poses[3].eye.x), (4, 0.4));
    assert!(Recorder::new(1.0).finish("", 1.0, 0.1).is_none());
}

fn scene(objects: &[Aabb]) -> Surroundings<'_> {
    Surroundings {
        sphere: Sphere { center: DVec3::new(5.0, 6.0, 7.0), radius: 20.0 },
        bounds: Aabb { min: DVec3::new(-5.0, 0.0, -1.0), max: DVec3::new(15.0, 12.0, 15.0) },
        objects,
    }
}

#[test]
fn the_round_trip_nears_and_leaves() {
    let path = CameraPath::outside(&scene(&[]));
    assert_eq!(path.poses.first(), path.poses.last());
    let radii: Vec<f64> =
        path.steps(500).iter().map(|p| p.eye.distance(DVec3::new(5.0, 6.0, 7.0)) / 20.0).collect();
    let (least, most) = radii.iter().fold((f64::MAX, 0_f64), |(a, b), &r| (a.min(r), b.max(r)));
    assert!((1.049..1.06).contains(&least) && (2.99..3.01).contains(&most), "{least} {most}");
    assert!(path.near.is_some_and(|near| near < 0.04 * 20.0));
    assert_eq!(path, CameraPath::outside(&scene(&[])));
}

#[test]
fn the_walk_stays_inside_and_out_of_small_objects() {
    // Furniture on a grid with room between.
    let objects: Vec<Aabb> = (0..100)
        .map(|i| {
            let min = DVec3::new(-5.0 + f64::from(i % 10) * 2.0, 0.0, -1.0 + f64::from(i / 10) * 1.6);
            Aabb { min, max: min + DVec3::new(1.0, 1.0, 1.0) }
        })
        .collect();
    let around = scene(&objects);
    let path = CameraPath::inside(&around);
    assert_eq!(path, CameraPath::inside(&around));
    assert!(path.poses.len() > 100);
    for stop in path.poses.iter().step_by(8) {
        assert!(around.is_free(stop.eye), "{}", stop.eye);
    }
    for pose in &path.poses {
        let share = pose.eye.y / 12.0;
        assert!((0.05..=0.6).contains(&share), "{share}");
        assert!((pose.forward.length() - 1.0).abs() < 1e-12);
    }
    let blocked = path.poses.iter().filter(|pose| !around.is_free(pose.eye)).count();
    assert!(blocked * 10 < path.poses.len(), "{blocked} of {}", path.poses.len());
}

#[test]
fn an_empty_scene_has_paths_too() {
    let around = Surroundings {
        sphere: Sphere { center: DVec3::ZERO, radius: 0.0 },
        bounds: Aabb { min: DVec3::ZERO, max: DVec3::ZERO },
        objects: &[],
    };
    for path in [CameraPath::outside(&around), CameraPath::inside(&around), CameraPath::inspection(&around)] {
        assert!(path.steps(50).iter().all(|p| p.eye.is_finite() && p.forward.is_finite()));
    }
}

#[test]
fn the_inspection_nears_the_scene_three_times_and_stays_outside_of_its_box() {
    let around = scene(&[]);
    let path = CameraPath::inspection(&around);
    assert_eq!((path.poses.len(), path.poses[0]), (121, path.poses[120]));
    let distance = |pose: &Pose| (pose.eye - around.sphere.center).length() / around.sphere.radius;
    let overview = path.poses.iter().map(distance).fold(0.0, f64::max);
    assert!((overview - 3.0).abs() < 1e-9, "{overview}");
    let near: Vec<bool> = path.poses.iter().map(|pose| distance(pose) < 1.0).collect();
    assert_eq!(near.windows(2).filter(|pair| !pair[0] && pair[1]).count(), 3);
    for pose in &path.poses {
        let inside = pose.eye.cmpgt(around.bounds.min).all() && pose.eye.cmplt(around.bounds.max).all();
        assert!(!inside && pose.eye.is_finite(), "{pose:?}");
        assert!((pose.forward.length() - 1.0).abs() < 1e-9);
    }
}
