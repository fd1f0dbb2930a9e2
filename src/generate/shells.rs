//! Closed shell in closed shell: exactly known visible sets.
//!
//! Every shell has a group of its own that holds the shell, a small box, and the next smaller shell's group. From
//! outside a group only its shell is visible, so the level of shell and box k is exactly 1 and 0: the shell is
//! seen from outside its own group, and the box from outside none.

use super::Sample;
use super::builder::{Builder, Transform};
use super::paint::Paint;
use super::shape::Shape;

/// What [`shells`] makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShellOptions {
    /// Number of shells, one inside the other; clamped to 1..=[`ShellOptions::MAX_DEPTH`].
    pub depth: usize,
    /// Leave one hole in the middle of the outermost shell's +x face: a square with 1/9 of the face's side.
    pub hole: bool,
}

impl ShellOptions {
    /// The deepest nesting; the outermost shell is then 354,294 m wide.
    pub const MAX_DEPTH: usize = 12;
}

/// Boxes about the origin, each 3 times as wide as the next one inside it; the innermost is 2 m wide. Shell 0 is
/// the outermost. The box in a group has a side of 1/3 of the space between its shell and the next and stands
/// in the middle of that space on the +y side (the innermost: at the origin).
///
/// With the hole, a sight line enters the outermost shell only through it: it reaches the next shell only within
/// 44 degrees of the +x axis.
pub fn shells(options: &ShellOptions) -> Sample {
    const PAINTS: [Paint; 4] = [Paint::Sage, Paint::SlateBlue, Paint::Sand, Paint::Graphite];
    let depth = options.depth.clamp(1, ShellOptions::MAX_DEPTH);
    let mut builder = Builder::default();
    let content = builder.shape(Shape::unit_box("content"));
    let content = builder.mesh(content, Paint::SignalRed);
    let mut parent = None;
    for k in 0..depth {
        let inner = (k + 1..depth).fold(1.0, |half, _| half * 3.0);
        let (half, last) = (inner, k + 1 == depth);
        let group = builder.group(parent, format!("group {k}"), Transform::IDENTITY);
        let shape = builder.shape(Shape::box_shell("shell", half, 9, (k == 0 && options.hole).then_some(1)));
        let mesh = builder.mesh(shape, PAINTS[k % PAINTS.len()]);
        builder.object(group, format!("shell {k}"), mesh, Transform::IDENTITY);
        // Half widths 1, 3, 9, …: the space between two shells is 2/3 of the outer one's half width.
        let y = if last { 0.0 } else { half * 2.0 / 3.0 };
        let side = if last { 0.5 } else { half * 2.0 / 9.0 };
        builder.object(
            group,
            format!("content {k}"),
            content,
            Transform::at(0.0, y, 0.0).scaled(side, side, side),
        );
        parent = Some(group);
    }
    builder.finish()
}
