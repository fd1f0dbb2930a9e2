//! A chain of unit boxes along x in binary nested groups: exactly known visible sets.
//!
//! Seen from -x each group shows its first box only, from +x its last, from the sides all of its boxes. Boxes are
//! 1 m apart, so a group's bounding sphere touches no box of another group.

use super::Sample;
use super::builder::{Builder, NodeId, Transform};
use super::paint::Paint;
use super::shape::Shape;

/// Distance between the centres of neighbouring boxes, metres.
const PITCH: f64 = 2.0;

/// `count` (at least 2) boxes; box k has its centre at (2 k, 0, 0). A group of n > 2 boxes consists of the group or
/// box of its first ceil(n / 2) boxes and that of the rest.
pub(super) fn boxes(count: usize) -> Sample {
    let mut builder = Builder::default();
    let shape = builder.shape(Shape::unit_box("unit box"));
    let mesh = builder.mesh(shape, Paint::SafetyYellow);
    // Explicit stack: first box, number of boxes, parent. Pushed in reverse, so nodes come in depth-first order.
    let mut pending: Vec<(usize, usize, Option<NodeId>)> = vec![(0, count.max(2), None)];
    while let Some((first, count, parent)) = pending.pop() {
        match parent {
            Some(parent) if count == 1 => {
                builder.object(
                    parent,
                    format!("box {first}"),
                    mesh,
                    Transform::at(PITCH * first as f64, 0.0, 0.0),
                );
            }
            _ => {
                let name = format!("boxes {first}-{}", first + count - 1);
                let group = builder.group(parent, name, Transform::IDENTITY);
                let left = count.div_ceil(2);
                pending.push((first + left, count - left, Some(group)));
                pending.push((first, left, Some(group)));
            }
        }
    }
    builder.finish()
}
