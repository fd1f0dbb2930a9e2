//! The frame in which a method's picture differs most: reference, picture, and the picture with what is missing marked.

use super::picture;
use super::svg::escape;
use crate::evaluate::result::{MissingObject, WorstFrame};
use std::fmt::Write as _;

pub(super) fn section(worst: &WorstFrame) -> String {
    let quality = &worst.quality;
    let mut html = format!(
        "<div class=\"worst\"><h3>Worst frame of {}: frame {}, SSIM {:.6}, {:.1} missing ppm</h3>\n\
         <div class=\"three\">\n",
        escape(worst.method.name()),
        worst.frame,
        quality.ssim,
        quality.missing_ppm,
    );
    let pictures = [
        (picture::data_uri(&worst.reference), "reference: frustum culling"),
        (picture::data_uri(&worst.picture), worst.method.name()),
        (picture::marked_uri(&worst.picture, &worst.missing), "missing pixels in magenta, boxed"),
    ];
    for (uri, caption) in pictures {
        let Some(uri) = uri else { continue };
        let caption = escape(caption);
        let _ = writeln!(
            html,
            "<figure><img alt=\"{caption}\" src=\"{uri}\"><figcaption>{caption}</figcaption></figure>"
        );
    }
    let _ = writeln!(html, "</div><p class=\"quiet\">{}</p></div>", missing(worst));
    html
}

/// What is missing, in words.
fn missing(worst: &WorstFrame) -> String {
    let quality = &worst.quality;
    if quality.missing_objects == 0 {
        return "No object is missing: the pictures differ in the order in which equally near or transparent surfaces \
                are drawn, or in transparent surfaces behind others."
            .to_owned();
    }
    let names: Vec<String> = worst.largest.iter().map(name).collect();
    let rest = quality.missing_objects.saturating_sub(names.len());
    let rest = if rest > 0 { format!(" and {rest} more") } else { String::new() };
    format!(
        "{} of {} visible objects missing; the largest: {}{rest}.",
        quality.missing_objects,
        quality.visible_objects,
        names.join(", "),
    )
}

/// Longest name shown, characters.
const LONGEST: usize = 60;

fn name(missing: &MissingObject) -> String {
    let name = match missing.name.as_deref() {
        Some(name) if !name.is_empty() => {
            let mut short: String = name.chars().take(LONGEST).collect();
            if short.len() < name.len() {
                short.push('…');
            }
            format!("“{}”", escape(&short))
        }
        _ => format!("object {}", missing.object),
    };
    format!("{name} ({} px)", missing.pixels)
}
