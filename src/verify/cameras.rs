//! Held-out cameras: perspective views that no bake has sampled.

use super::random::Random;
use super::view::View;
use crate::bake::tree::{Aabb, Sphere};
use glam::DVec3;

/// tan(60° / 2): the vertical field of view is 60 degrees.
const HALF_HEIGHT: f64 = 0.577_350_269_189_625_7;

/// Boxes with a diagonal below this share of the scene's are of small objects: nobody stands in them.
const SMALL_OBJECT: f64 = 0.1;

/// Places tried before a camera inside takes one in a small object's box.
const TRIES: u32 = 1_000;

/// Where the cameras of a group are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CameraGroup {
    /// This many radii of the scene's bounding sphere from its centre, in uniformly random directions, looking at
    /// a random point within half a radius of the centre.
    Outside(f64),
    /// Standing in the scene: uniform in its box at 5-60 % of its height (+y is up), not in the box of a small
    /// object, looking in any horizontal direction with a slope within ±0.3.
    Inside,
}

/// The groups every verification has.
pub const CAMERA_GROUPS: [CameraGroup; 5] = [
    CameraGroup::Outside(1.05),
    CameraGroup::Outside(1.5),
    CameraGroup::Outside(3.0),
    CameraGroup::Outside(10.0),
    CameraGroup::Inside,
];

/// What cameras are placed around.
#[derive(Clone, Copy, Debug)]
pub struct Surroundings<'a> {
    /// Bounding sphere of the scene.
    pub sphere: Sphere,
    /// Box of the scene.
    pub bounds: Aabb,
    /// Boxes of its objects.
    pub objects: &'a [Aabb],
}

/// Size of the images and what else cameras share.
#[derive(Clone, Copy, Debug)]
pub struct CameraOptions {
    /// Cameras of the same seed are the same, and more cameras begin with the fewer.
    pub seed: u64,
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl CameraGroup {
    /// Name in reports: `inside`, `outside 1.05r`.
    pub fn name(&self) -> String {
        match self {
            Self::Outside(radii) => format!("outside {radii}r"),
            Self::Inside => "inside".to_owned(),
        }
    }

    /// Stands outside the scene's bounding sphere.
    pub fn is_outside(&self) -> bool {
        matches!(self, Self::Outside(_))
    }
}

/// Camera `index` of a group; `group` is the place in [`CAMERA_GROUPS`].
pub fn camera(group: usize, index: usize, around: &Surroundings<'_>, options: &CameraOptions) -> View {
    let mut random = Random::new(options.seed, group as u64, index as u64);
    let (eye, forward) = match CAMERA_GROUPS[group] {
        CameraGroup::Outside(radii) => outside(radii, &around.sphere, &mut random),
        CameraGroup::Inside => inside(around, &mut random),
    };
    View::new(eye, forward, HALF_HEIGHT, options.width, options.height)
}

fn outside(radii: f64, sphere: &Sphere, random: &mut Random) -> (DVec3, DVec3) {
    let offset = random.on_sphere() * radii;
    let target = random.in_ball() * 0.5;
    (sphere.center + offset * sphere.radius, target - offset)
}

fn inside(around: &Surroundings<'_>, random: &mut Random) -> (DVec3, DVec3) {
    let eye = around.standing_place(random);
    let mut forward = random.horizontal();
    forward.y = random.between(-0.3, 0.3);
    (eye, forward)
}

impl Surroundings<'_> {
    /// Uniform in the box at 5-60 % of its height, not in the box of a small object if there is room elsewhere.
    pub(crate) fn standing_place(&self, random: &mut Random) -> DVec3 {
        let size = self.bounds.max - self.bounds.min;
        let mut place = || {
            let share =
                DVec3::new(random.between(0.0, 1.0), random.between(0.05, 0.6), random.between(0.0, 1.0));
            self.bounds.min + size * share
        };
        let mut eye = place();
        for _ in 1..TRIES {
            if self.is_free(eye) {
                break;
            }
            eye = place();
        }
        eye
    }

    /// Not in the box of a small object.
    pub(crate) fn is_free(&self, p: DVec3) -> bool {
        !self.objects.iter().any(|b| b.min.cmple(p).all() && p.cmple(b.max).all() && self.is_small(b))
    }

    /// Nobody stands in an object of this size.
    pub(crate) fn is_small(&self, object: &Aabb) -> bool {
        let small = (self.bounds.max - self.bounds.min).length() * SMALL_OBJECT;
        (object.max - object.min).length_squared() < small * small
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OPTIONS: CameraOptions = CameraOptions { seed: 3, width: 1280, height: 720 };

    fn scene(objects: &[Aabb]) -> Surroundings<'_> {
        Surroundings {
            sphere: Sphere { center: DVec3::new(5.0, 6.0, 7.0), radius: 20.0 },
            bounds: Aabb { min: DVec3::new(-5.0, 0.0, -1.0), max: DVec3::new(15.0, 12.0, 15.0) },
            objects,
        }
    }

    #[test]
    fn outside_cameras_keep_their_distance_and_look_at_the_scene() {
        let around = scene(&[]);
        for (group, kind) in CAMERA_GROUPS.iter().enumerate().filter(|(_, g)| g.is_outside()) {
            let CameraGroup::Outside(radii) = *kind else { continue };
            for index in 0..200 {
                let view = camera(group, index, &around, &OPTIONS);
                let to_center = around.sphere.center - view.eye;
                assert!((to_center.length() / (radii * 20.0) - 1.0).abs() < 1e-12);
                let along = to_center.dot(view.forward);
                let beside = (to_center.length_squared() - along * along).max(0.0).sqrt();
                assert!(along > 0.0 && beside <= 0.5 * 20.0 + 1e-9);
            }
        }
    }

    #[test]
    fn inside_cameras_stand_in_the_box_but_not_in_small_objects() {
        // The small object fills a tenth of the length, the large one everything.
        let small = Aabb { min: DVec3::new(0.0, 0.0, 0.0), max: DVec3::new(1.5, 1.5, 1.5) };
        let large = Aabb { min: DVec3::splat(-100.0), max: DVec3::splat(100.0) };
        let objects = [small, large];
        let around = scene(&objects);
        for index in 0..2_000 {
            let view = camera(4, index, &around, &OPTIONS);
            assert!(view.eye.cmpge(around.bounds.min).all() && view.eye.cmple(around.bounds.max).all());
            assert!((0.6..=7.2).contains(&view.eye.y));
            assert!(!(view.eye.cmpge(small.min).all() && view.eye.cmple(small.max).all()));
            let slope = view.forward.y / view.forward.x.hypot(view.forward.z);
            assert!(slope.abs() <= 0.3 + 1e-12);
        }
    }

    #[test]
    fn cameras_depend_on_group_index_and_seed_alone() {
        let around = scene(&[]);
        assert_eq!(camera(1, 4, &around, &OPTIONS), camera(1, 4, &around, &OPTIONS));
        assert_ne!(camera(1, 4, &around, &OPTIONS).eye, camera(1, 5, &around, &OPTIONS).eye);
        let other = CameraOptions { seed: 4, ..OPTIONS };
        assert_ne!(camera(1, 4, &around, &OPTIONS).eye, camera(1, 4, &around, &other).eye);
    }

    #[test]
    fn a_scene_of_small_objects_only_still_gives_cameras() {
        let objects: Vec<Aabb> = (0..8_000)
            .map(|i| {
                let min =
                    DVec3::new(-5.0 + f64::from(i % 20), f64::from(i / 20 % 20), -1.0 + f64::from(i / 400));
                Aabb { min, max: min + 1.0 }
            })
            .collect();
        assert!(camera(4, 0, &scene(&objects), &OPTIONS).eye.is_finite());
    }

    #[test]
    fn groups_have_the_names_of_the_report() {
        let names: Vec<String> = CAMERA_GROUPS.iter().map(CameraGroup::name).collect();
        assert_eq!(names, ["outside 1.05r", "outside 1.5r", "outside 3r", "outside 10r", "inside"]);
    }
}
