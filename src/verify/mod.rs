//! Held-out cameras.

mod cameras;
mod item_buffer;
mod published;
mod published_bake;
mod random;
mod score;
mod statistics;
mod target;
mod view;

pub use cameras::{CAMERA_GROUPS, CameraGroup, CameraOptions, Surroundings, camera};
pub use item_buffer::{VisibleSet, visible_set};
pub use published_bake::{PIXEL_LIMIT, PublishedBake, RESOLUTION, Sampling};
pub use score::{Frame, Score};
pub use statistics::{Distribution, interpolate_log, ratio};
pub use target::Target;
pub use view::{Frustum, View};
