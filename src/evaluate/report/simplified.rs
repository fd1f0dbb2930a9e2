//! The table of what is simplified.

use super::html::{decibels, grouped};
use super::svg::escape;
use crate::evaluate::method::EvaluationMethod;
use crate::evaluate::result::MethodSummary;
use std::fmt::Write as _;

/// What is simplified, for the methods that simplify; nothing without them.
pub(super) fn table(methods: &[MethodSummary]) -> String {
    let draws_proxies = |method: &&MethodSummary| {
        method.method.parse().is_ok_and(|method: EvaluationMethod| method.draws_proxies().is_some())
    };
    if !methods.iter().any(|method| draws_proxies(&method)) {
        return String::new();
    }
    let mut html = String::from(
        "<div class=\"wide\"><table><thead><tr><th rowspan=\"2\">method</th><th rowspan=\"2\">proxies</th>\
         <th rowspan=\"2\">simplified<br>objects</th><th rowspan=\"2\">HLOD<br>nodes</th>\
         <th colspan=\"2\">largest hole, px</th><th colspan=\"2\">largest missing, px</th>\
         <th colspan=\"2\">PSNR Cb, dB</th><th colspan=\"2\">PSNR Cr, dB</th></tr>\n<tr>",
    );
    html += &"<th>median</th><th>worst</th>".repeat(4);
    html += "</tr></thead><tbody>\n";
    for method in methods {
        let mut cells = vec![escape(&method.method)];
        cells.extend([method.proxies, method.levels, method.nodes].map(|f| grouped(f.median)));
        for figures in [method.largest_hole, method.largest_missing] {
            cells.extend([figures.median, figures.worst].map(grouped));
        }
        for ratio in [method.psnr_cb, method.psnr_cr] {
            cells.extend([ratio.median, ratio.worst].map(decibels));
        }
        let cells: Vec<String> = cells.into_iter().map(|cell| format!("<td>{cell}</td>")).collect();
        let _ = writeln!(html, "<tr>{}</tr>", cells.concat());
    }
    html + "</tbody></table></div>\n"
}
