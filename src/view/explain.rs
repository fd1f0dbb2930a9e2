//! Why an object is drawn or not, in words.

use super::figures::grouped;
use svs_runtime::Reason;

/// A sentence for people. `drawn` is what happened in the end: only the budget can make it differ from the reason.
pub(crate) fn sentence(reason: &Reason, drawn: bool, budget: bool) -> String {
    let why = match *reason {
        Reason::Unknown => "nothing is known about it: it is always drawn".to_owned(),
        Reason::NotShown => "its tree is left out".to_owned(),
        Reason::HostNotDrawn { host } => {
            format!("not drawn: the group it belongs to (tree {}, object {}) is not drawn", host.tree, host.object)
        }
        Reason::UserHidden => "not drawn: you have hidden it".to_owned(),
        Reason::OutsideFrustum => "not drawn: it is outside the frustum".to_owned(),
        Reason::NotVisible { node, height, level } => format!(
            "not drawn: from this direction it is hidden outside its {} group (sphere {node}); it is seen as far as \
             level {level} only",
            ordinal(height)
        ),
        Reason::TooSmall { pixels, .. } => {
            format!("not drawn: it would show an estimated {} only", counted(pixels))
        }
        Reason::Sphere { node, height, level, pixels } => {
            // What has no estimated size is drawn whatever its size.
            let size = if pixels.is_finite() { format!(", estimated {}", counted(pixels)) } else { String::new() };
            format!(
                "drawn: seen from outside its {} group (sphere {node}), visible level {level}{size}",
                ordinal(height)
            )
        }
        Reason::Frustum { spheres: 0, .. } => "drawn: it is in the frustum; no baked sphere is around it".to_owned(),
        Reason::Frustum { disturbed: true, .. } => {
            "drawn: it is in the frustum; something was hidden in the spheres around it, so that they are not trusted"
                .to_owned()
        }
        Reason::Frustum { spheres, .. } => {
            format!("drawn: it is in the frustum; the camera is inside or too near to all {spheres} spheres around it")
        }
        _ => "the runtime gives a reason this viewer does not know".to_owned(),
    };
    if reason.is_drawn() && !drawn {
        let left_out = if budget { "left out by the budget" } else { "not drawn by this method" };
        return format!("{left_out} (else {why})");
    }
    why
}

/// What is said of an object that a proxy stands for; `error` in pixels, if it is known.
pub(crate) fn proxy(objects: u64, error: Option<f64>, triangles: u64) -> String {
    format!(
        "drawn as a proxy of {} objects ({}{} triangles)",
        grouped(objects),
        off_by(error),
        grouped(triangles)
    )
}

/// The same of an object that is drawn simplified.
pub(crate) fn level(level: u8, error: Option<f64>, triangles: u64) -> String {
    format!("drawn as simplified level {level} ({}{} triangles)", off_by(error), grouped(triangles))
}

fn off_by(error: Option<f64>) -> String {
    error.map_or_else(String::new, |error| format!("error {error:.2} px, "))
}

fn counted(pixels: f64) -> String {
    if pixels < 10.0 { format!("{pixels:.1} pixels") } else { format!("{pixels:.0} pixels") }
}

fn ordinal(height: u32) -> String {
    let end = match (height % 100, height % 10) {
        (11..=13, _) => "th",
        (_, 1) => "st",
        (_, 2) => "nd",
        (_, 3) => "rd",
        _ => "th",
    };
    format!("{height}{end}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reasons_are_sentences() {
        let sphere = Reason::Sphere { node: 4, height: 2, level: 3, pixels: 120.4 };
        assert_eq!(
            sentence(&sphere, true, false),
            "drawn: seen from outside its 2nd group (sphere 4), visible level 3, estimated 120 pixels"
        );
        assert!(sentence(&sphere, false, true).starts_with("left out by the budget (else drawn"));
        assert!(sentence(&Reason::TooSmall { pixels: 0.42, node: 1 }, false, false).contains("0.4 pixels"));
        assert!(
            sentence(&Reason::Frustum { spheres: 0, disturbed: false }, true, false)
                .contains("no baked sphere")
        );
        assert!(sentence(&Reason::UserHidden, false, false).contains("hidden"));
    }

    #[test]
    fn what_stands_for_an_object_is_told_with_its_error() {
        assert_eq!(
            proxy(1200, Some(0.834), 240),
            "drawn as a proxy of 1\u{2009}200 objects (error 0.83 px, 240 triangles)"
        );
        assert_eq!(level(2, None, 96), "drawn as simplified level 2 (96 triangles)");
    }

    #[test]
    fn heights_are_ordinals() {
        let words: Vec<String> = [1, 2, 3, 4, 11, 12, 13, 21, 112].map(ordinal).into();
        assert_eq!(words, ["1st", "2nd", "3rd", "4th", "11th", "12th", "13th", "21st", "112th"]);
    }
}
