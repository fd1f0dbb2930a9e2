//! Cameras in the hand of a user. They know nothing of windows: mouse and keys arrive as pixels, notches and seconds.

mod aim;
mod orbit;
#[cfg(test)]
mod tests;
mod walk;

pub use aim::Aim;
pub use orbit::Orbit;
pub use walk::Walk;

use glam::DVec3;
use serde::{Deserialize, Serialize};
use svs_render::View;

/// Radians a drag over the whole height of the image turns the camera.
const TURN_PER_HEIGHT: f64 = 3.0;
/// Factor of the distance per notch of the wheel towards the viewer.
const ZOOM_PER_NOTCH: f64 = 1.15;
/// Walking speed in radii of the scene per second.
const SPEED: f64 = 0.12;
/// How much faster with Shift.
const FASTER: f64 = 5.0;
/// How much slower while a path is recorded: a hand is not steady (as in the flythroughs of the dissertation's method).
const WHILE_RECORDING: f64 = 0.25;
/// Near plane in radii of the scene.
const NEAR: f64 = 1e-4;
/// Full vertical opening angle until a camera file says otherwise, radians.
const VERTICAL_FOV: f64 = std::f64::consts::FRAC_PI_3;

/// `value`, or `otherwise` if it is not finite.
fn finite(value: f64, otherwise: f64) -> f64 {
    if value.is_finite() { value } else { otherwise }
}

/// Which camera has the mouse and the keys.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CameraMode {
    /// Turns around a point.
    #[default]
    Orbit,
    /// Goes through the scene.
    Walk,
}

/// Keys that are held down, from -1 to 1 along each axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// To the right.
    pub right: f64,
    /// Up.
    pub up: f64,
    /// Into the image.
    pub ahead: f64,
    /// Shift is held.
    pub faster: bool,
}

impl Motion {
    /// Some key is held that moves the camera.
    pub fn moves(&self) -> bool {
        self.right != 0.0 || self.up != 0.0 || self.ahead != 0.0
    }
}

/// Both cameras and what they share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rig {
    mode: CameraMode,
    orbit: Orbit,
    walk: Walk,
    /// Radius of the scene's bounding sphere, metres, above 0: the measure of all speeds.
    radius: f64,
    center: DVec3,
    vertical_fov: f64,
    near: f64,
    /// Multiplies the walking speed.
    pub speed: f64,
}

impl Rig {
    /// Looks at a scene (its box in world space, metres) from above at a slant.
    pub fn new(min: DVec3, max: DVec3) -> Self {
        let (center, radius) = sphere(min, max);
        let aim = Aim::new(0.6, -0.45);
        let mut rig = Self {
            mode: CameraMode::Orbit,
            orbit: Orbit { target: center, distance: radius, aim },
            walk: Walk { eye: center, aim },
            radius,
            center,
            vertical_fov: VERTICAL_FOV,
            near: radius * NEAR,
            speed: 1.0,
        };
        rig.frame(None, 1.0);
        rig
    }

    /// The camera in use.
    pub fn view(&self) -> View {
        let (eye, aim) = match self.mode {
            CameraMode::Orbit => (self.orbit.eye(), self.orbit.aim),
            CameraMode::Walk => (self.walk.eye, self.walk.aim),
        };
        View { eye, forward: aim.forward(), up: aim.up(), vertical_fov: self.vertical_fov, near: self.near }
    }

    /// Puts the camera where a view is; roll is lost. A view that is not finite changes nothing.
    pub fn set_view(&mut self, view: &View) {
        if !view.eye.is_finite() || !view.forward.is_finite() {
            return;
        }
        let aim = Aim::along(view.forward);
        self.walk = Walk { eye: view.eye, aim };
        // Keeps the distance, so that turning afterwards feels as before.
        self.orbit.aim = aim;
        self.orbit.target = view.eye + aim.forward() * self.orbit.distance;
        if view.vertical_fov > 0.0 && view.vertical_fov < 3.1 {
            self.vertical_fov = view.vertical_fov;
        }
        if view.near > 0.0 && view.near.is_finite() {
            self.near = view.near;
        }
    }

    /// Which camera is in use.
    pub fn mode(&self) -> CameraMode {
        self.mode
    }

    /// Changes to the other camera without moving the eye.
    pub fn switch(&mut self, mode: CameraMode) {
        if mode == self.mode {
            return;
        }
        let view = self.view();
        if mode == CameraMode::Orbit {
            // What was walked up to is what to turn around: the scene's centre as far as it lies ahead.
            let ahead = (self.center - view.eye).dot(view.forward);
            self.orbit.distance = ahead.max(self.radius * 0.1);
        }
        self.set_view(&view);
        self.mode = mode;
    }

    /// A drag that turns, in pixels (right and down are positive) of an image `height` pixels high.
    pub fn drag(&mut self, right: f64, down: f64, height: f64) {
        let angle = TURN_PER_HEIGHT / height.max(1.0);
        match self.mode {
            // The scene follows the hand ...
            CameraMode::Orbit => self.orbit.turn(-right * angle, -down * angle),
            // ... and so does what a walker sees.
            CameraMode::Walk => self.walk.turn(right * angle * 0.6, down * angle * 0.6),
        }
    }

    /// A drag that shifts the image, in pixels; what is at the target's distance follows the hand exactly.
    pub fn pan(&mut self, right: f64, down: f64, height: f64) {
        let depth = match self.mode {
            CameraMode::Orbit => self.orbit.distance,
            CameraMode::Walk => self.radius * 0.2,
        };
        let metres = 2.0 * (self.vertical_fov * 0.5).tan() * depth / height.max(1.0);
        match self.mode {
            CameraMode::Orbit => self.orbit.pan(-right * metres, down * metres),
            CameraMode::Walk => self.walk.go(-right * metres, down * metres, 0.0),
        }
    }

    /// Turns of the wheel, positive away from the hand: nearer when orbiting, faster when walking.
    pub fn wheel(&mut self, notches: f64) {
        let factor = ZOOM_PER_NOTCH.powf(finite(notches, 0.0).clamp(-50.0, 50.0));
        match self.mode {
            CameraMode::Orbit => {
                self.orbit.zoom(1.0 / factor, (self.radius * 1e-3, self.radius * 100.0));
            }
            CameraMode::Walk => self.speed = (self.speed * factor).clamp(0.01, 100.0),
        }
    }

    /// Moves as the keys say for some seconds.
    pub fn advance(&mut self, motion: &Motion, seconds: f64, recording: bool) {
        if !motion.moves() || seconds.is_nan() || seconds <= 0.0 {
            return;
        }
        // After a stall (a file was loaded) the camera shall not leap.
        let mut metres = SPEED * self.radius * self.speed * seconds.min(0.25);
        if motion.faster {
            metres *= FASTER;
        }
        if recording {
            metres *= WHILE_RECORDING;
        }
        let (right, up, ahead) = (motion.right * metres, motion.up * metres, motion.ahead * metres);
        match self.mode {
            CameraMode::Orbit => {
                self.orbit.pan(right, up);
                self.orbit.zoom(1.0 - ahead / self.radius, (self.radius * 1e-3, self.radius * 100.0));
            }
            CameraMode::Walk => self.walk.go(right, up, ahead),
        }
    }

    /// Shows the whole scene, or a box in it (world space, metres), from the present side. `aspect`: width by height.
    pub fn frame(&mut self, bounds: Option<(DVec3, DVec3)>, aspect: f64) {
        let (center, radius) = match bounds {
            Some((min, max)) => sphere(min, max),
            None => (self.center, self.radius),
        };
        let view = self.view();
        let half = (self.vertical_fov * 0.5).tan();
        let smaller = 2.0 * (half * finite(aspect, 1.0).clamp(0.1, 1.0)).atan();
        self.orbit.aim = Aim::along(view.forward);
        self.orbit.frame(center, radius, smaller);
        self.walk = Walk { eye: self.orbit.eye(), aim: self.orbit.aim };
    }

    /// Metres a second at the present walking speed, without Shift.
    pub fn metres_per_second(&self) -> f64 {
        SPEED * self.radius * self.speed
    }
}

/// Bounding sphere of a box; one metre for what has no size.
fn sphere(min: DVec3, max: DVec3) -> (DVec3, f64) {
    let (center, radius) = ((min + max) * 0.5, (max - min).length() * 0.5);
    let usable = center.is_finite() && radius.is_finite() && radius > 0.0;
    if usable { (center, radius) } else { (if center.is_finite() { center } else { DVec3::ZERO }, 1.0) }
}
