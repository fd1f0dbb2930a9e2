//! From poses to a smooth path (Catmull and Rom, *A class of local interpolating splines*, 1974).

use super::Pose;
use glam::DVec3;

/// The pose at `at`, counted in poses from the first; ends are kept to. `None` without poses.
pub(super) fn pose(poses: &[Pose], at: f64) -> Option<Pose> {
    let (first, last) = (poses.first()?, poses.last()?);
    let segments = poses.len() - 1;
    if segments == 0 {
        return Some(*first);
    }
    let at = if at.is_finite() { at.clamp(0.0, segments as f64) } else { 0.0 };
    let segment = (at as usize).min(segments - 1);
    let closed = segments > 2 && first == last;
    let (from, to) = (poses[segment], poses[segment + 1]);
    // Beyond the ends a path goes on as it ended, and a loop as it began.
    let before = match segment.checked_sub(1) {
        Some(before) => poses[before],
        None if closed => poses[segments - 1],
        None => from,
    };
    let after = match poses.get(segment + 2) {
        Some(after) => *after,
        None if closed => poses[1],
        None => to,
    };
    let share = at - segment as f64;
    let mix = |of: fn(&Pose) -> DVec3| catmull_rom([of(&before), of(&from), of(&to), of(&after)], share);
    let forward = mix(|pose| pose.forward);
    Some(Pose {
        eye: mix(|pose| pose.eye),
        forward: direction(forward).unwrap_or_else(|| turn(from.forward, to.forward, share)),
    })
}

/// Through `b` at 0 and `c` at 1, there parallel to `c - a` and `d - b`.
fn catmull_rom([a, b, c, d]: [DVec3; 4], t: f64) -> DVec3 {
    let velocity = (c - a) * 0.5;
    let bend = a - b * 2.5 + c * 2.0 - d * 0.5;
    let twist = (b - c) * 1.5 + (d - a) * 0.5;
    b + (velocity + (bend + twist * t) * t) * t
}

/// Half a turn has no shortest way, and the spline of its ends goes through zero: turns by way of the side instead.
fn turn(from: DVec3, to: DVec3, t: f64) -> DVec3 {
    let side = direction(from.cross(DVec3::Y)).unwrap_or(DVec3::X);
    let (a, b) = if t < 0.5 { (from, side) } else { (side, to) };
    direction(a.lerp(b, 2.0 * t - (2.0 * t).floor())).unwrap_or(side)
}

/// Unit vector; `None` for one that has no direction to speak of.
pub(super) fn direction(vector: DVec3) -> Option<DVec3> {
    let length = vector.length();
    (length.is_finite() && length > 1e-6).then(|| vector / length)
}
