use super::*;

const SMALL: f64 = 1e-9;

fn rig() -> Rig {
    Rig::new(DVec3::new(-10.0, 0.0, -20.0), DVec3::new(30.0, 12.0, 20.0))
}

fn level(view: &View) -> bool {
    view.right().y.abs() < SMALL && view.up.y > 0.0 && (view.up.length() - 1.0).abs() < SMALL
}

#[test]
fn the_whole_scene_is_in_sight_at_first() {
    let view = rig().view();
    let center = DVec3::new(10.0, 6.0, 0.0);
    let offset = center - view.eye;
    assert!(offset.normalize().dot(view.forward) > 1.0 - SMALL);
    assert!(offset.length() * (view.vertical_fov * 0.5).sin() >= 28.9);
    assert!(level(&view));
}

#[test]
fn turning_keeps_the_distance_and_never_rolls() {
    let mut rig = rig();
    let before = rig.orbit;
    for step in 0..500 {
        rig.drag(37.0, if step < 250 { 23.0 } else { -31.0 }, 700.0);
        let view = rig.view();
        assert!((view.eye.distance(before.target) / before.distance - 1.0).abs() < SMALL);
        assert!(level(&view) && view.eye.is_finite());
    }
    assert_eq!((rig.orbit.target, rig.orbit.distance), (before.target, before.distance));
}

#[test]
fn pitch_stops_before_the_poles() {
    for down in [1e6, -1e6] {
        let mut rig = rig();
        rig.drag(0.0, down, 1.0);
        let steep = rig.view().forward.y.abs();
        assert!(steep > 0.99 && steep < 1.0 && level(&rig.view()));
    }
}

#[test]
fn dragging_there_and_back_changes_nothing() {
    let before = rig().view();
    let mut again = rig();
    again.drag(120.0, 40.0, 700.0);
    again.pan(40.0, 120.0, 700.0);
    again.wheel(3.0);
    assert!(again.view().eye.distance(before.eye) > 1.0);
    again.wheel(-3.0);
    again.pan(-40.0, -120.0, 700.0);
    again.drag(-120.0, -40.0, 700.0);
    assert!(again.view().eye.distance(before.eye) < 1e-6);
    assert!(again.view().forward.distance(before.forward) < SMALL);
}

#[test]
fn panning_moves_the_target_with_the_hand() {
    let mut rig = rig();
    let (view, target) = (rig.view(), rig.orbit.target);
    rig.pan(100.0, 0.0, 700.0);
    let moved = rig.orbit.target - target;
    assert!(moved.dot(view.right()) < 0.0 && moved.dot(view.forward).abs() < SMALL);
    // 100 of 700 pixels are a seventh of what the image shows at the target.
    let shown = 2.0 * (view.vertical_fov * 0.5).tan() * rig.orbit.distance;
    assert!((moved.length() - shown / 7.0).abs() < 1e-9);
    assert_eq!(rig.view().forward, view.forward);
}

#[test]
fn the_wheel_zooms_within_limits() {
    let mut rig = rig();
    let before = rig.orbit.distance;
    rig.wheel(1.0);
    assert!(rig.orbit.distance < before);
    for notches in [1e9, -1e9, f64::NAN, f64::INFINITY] {
        (0..10).for_each(|_| rig.wheel(notches));
        assert!(rig.orbit.distance > 0.0 && rig.view().eye.is_finite());
    }
}

#[test]
fn switching_cameras_does_not_move_the_eye() {
    let mut rig = rig();
    rig.drag(200.0, -80.0, 700.0);
    let before = rig.view();
    for mode in [CameraMode::Walk, CameraMode::Orbit, CameraMode::Walk] {
        rig.switch(mode);
        assert_eq!(rig.mode(), mode);
        assert!(rig.view().eye.distance(before.eye) < 1e-6);
        assert!(rig.view().forward.distance(before.forward) < SMALL);
    }
}

#[test]
fn walking_goes_where_it_looks_at_a_speed_of_the_scene() {
    let mut rig = rig();
    rig.switch(CameraMode::Walk);
    let before = rig.view();
    let ahead = Motion { ahead: 1.0, ..Motion::default() };
    rig.advance(&ahead, 0.1, false);
    let slow = rig.view().eye - before.eye;
    assert!((slow.length() - rig.metres_per_second() * 0.1).abs() < 1e-6);
    assert!(slow.normalize().dot(before.forward) > 1.0 - 1e-6);
    let at = rig.view().eye;
    rig.advance(&Motion { faster: true, ..ahead }, 0.1, false);
    assert!((rig.view().eye - at).length() > 4.0 * slow.length());
    let at = rig.view().eye;
    rig.advance(&ahead, 0.1, true);
    assert!(((rig.view().eye - at).length() / slow.length() - 0.25).abs() < 1e-6);
    // A stall of an hour is no leap.
    let at = rig.view().eye;
    rig.advance(&ahead, 3600.0, false);
    assert!((rig.view().eye - at).length() < 3.0 * slow.length());
}

#[test]
fn a_thousand_times_larger_scene_is_walked_a_thousand_times_faster() {
    let small = Rig::new(DVec3::ZERO, DVec3::ONE);
    let large = Rig::new(DVec3::ZERO, DVec3::splat(1000.0));
    assert!((large.metres_per_second() / small.metres_per_second() - 1000.0).abs() < 1e-6);
}

#[test]
fn framing_keeps_the_direction() {
    let mut rig = rig();
    rig.drag(300.0, 50.0, 700.0);
    rig.switch(CameraMode::Walk);
    let forward = rig.view().forward;
    rig.frame(Some((DVec3::ZERO, DVec3::ONE)), 1.5);
    let view = rig.view();
    assert!(view.forward.distance(forward) < SMALL);
    let offset = DVec3::splat(0.5) - view.eye;
    assert!(offset.normalize().dot(view.forward) > 1.0 - SMALL && offset.length() < 5.0);
    // A narrow image needs more distance.
    let near = offset.length();
    rig.frame(Some((DVec3::ZERO, DVec3::ONE)), 0.5);
    assert!((DVec3::splat(0.5) - rig.view().eye).length() > near);
}

#[test]
fn a_view_can_be_taken_and_set() {
    let mut rig = rig();
    let view = View::looking_along(DVec3::new(1.0, 2.0, 3.0), DVec3::new(1.0, -0.3, 0.4), 0.8, 0.05);
    for mode in [CameraMode::Orbit, CameraMode::Walk] {
        rig.switch(mode);
        rig.set_view(&view);
        let got = rig.view();
        assert!(got.eye.distance(view.eye) < 1e-6 && got.forward.distance(view.forward) < SMALL);
        assert!(got.up.distance(view.up) < SMALL);
        assert_eq!((got.vertical_fov, got.near), (0.8, 0.05));
    }
}

#[test]
fn nothing_makes_a_camera_that_is_not_finite() {
    let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300];
    for mode in [CameraMode::Orbit, CameraMode::Walk] {
        let mut rig = rig();
        rig.switch(mode);
        for a in bad {
            for height in [0.0, 700.0, f64::NAN] {
                rig.drag(a, a, height);
                rig.pan(a, a, height);
                rig.wheel(a);
                rig.advance(&Motion { right: a, up: a, ahead: a, faster: true }, 0.1, false);
                rig.frame(Some((DVec3::splat(a), DVec3::splat(a))), a);
                rig.set_view(&View { eye: DVec3::splat(a), ..rig.view() });
                let view = rig.view();
                assert!(
                    view.eye.is_finite() && view.forward.is_finite() && view.up.is_finite(),
                    "{a} {mode:?}"
                );
            }
        }
    }
    for bounds in [(DVec3::NAN, DVec3::NAN), (DVec3::ZERO, DVec3::ZERO), (DVec3::MAX, DVec3::MIN)] {
        let view = Rig::new(bounds.0, bounds.1).view();
        assert!(view.eye.is_finite() && view.forward.is_finite(), "{bounds:?}");
    }
}

#[test]
fn an_aim_comes_back_from_its_vector() {
    for (yaw, pitch) in [(0.0, 0.0), (1.0, 0.5), (-2.5, -1.2), (3.1, 1.5)] {
        let aim = Aim::new(yaw, pitch);
        let again = Aim::along(aim.forward());
        assert!(again.forward().distance(aim.forward()) < SMALL);
        assert!((again.pitch() - pitch).abs() < SMALL);
    }
    assert!(Aim::along(DVec3::ZERO).forward().is_normalized());
}
