//! Composes shaders from the files in `shaders/`.

pub(crate) const FRAME: &str = include_str!("../shaders/frame.wgsl");
pub(crate) const LIGHT: &str = include_str!("../shaders/light.wgsl");
pub(crate) const VERTEX: &str = include_str!("../shaders/vertex.wgsl");
pub(crate) const COLOR: &str = include_str!("../shaders/color.wgsl");
pub(crate) const ITEM: &str = include_str!("../shaders/item.wgsl");
pub(crate) const LINES: &str = include_str!("../shaders/lines.wgsl");
pub(crate) const SKY: &str = include_str!("../shaders/sky.wgsl");

/// Joins files and keeps of each `#if NAME` or `#if !NAME` … `#else` … `#endif` what `names` select. WGSL's own override
/// constants cannot leave out inputs and outputs, and those are what costs.
pub(crate) fn compose(files: &[&str], names: &[&str]) -> String {
    let mut kept = vec![true];
    let mut out = String::new();
    for line in files.iter().flat_map(|file| file.lines()) {
        let outer = kept.len().checked_sub(2).is_none_or(|i| kept[i]);
        match line.trim().strip_prefix('#').map(str::trim) {
            Some("else") => {
                if let Some(top) = kept.last_mut() {
                    *top = outer && !*top;
                }
            }
            Some("endif") => {
                kept.pop();
            }
            Some(condition) => {
                let name = condition.trim_start_matches("if ");
                let wanted = match name.strip_prefix('!') {
                    Some(name) => !names.contains(&name),
                    None => names.contains(&name),
                };
                kept.push(kept.last() == Some(&true) && wanted);
            }
            None if kept.last() == Some(&true) => {
                out.push_str(line);
                out.push('\n');
            }
            None => {}
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::compose;

    #[test]
    fn conditions_select_lines_and_nest() {
        let text = "a\n#if X\nb\n#if !Y\nc\n#else\nd\n#endif\n#else\ne\n#if Y\nf\n#endif\n#endif\ng";
        assert_eq!(compose(&[text], &[]), "a\ne\ng\n");
        assert_eq!(compose(&[text], &["X"]), "a\nb\nc\ng\n");
        assert_eq!(compose(&[text], &["X", "Y"]), "a\nb\nd\ng\n");
        assert_eq!(compose(&[text, "h"], &["Y"]), "a\ne\nf\ng\nh\n");
    }
}
