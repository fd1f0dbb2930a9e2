//! Markdown tables and the numbers in them.

/// A markdown table: the first column to the left, the others to the right.
pub(crate) fn markdown(head: &[&str], rows: &[Vec<String>]) -> String {
    let mut text = format!("| {} |\n", head.join(" | "));
    let rule: Vec<&str> = (0..head.len()).map(|column| if column == 0 { "---" } else { "--:" }).collect();
    text += &format!("| {} |\n", rule.join(" | "));
    for row in rows {
        text += &format!("| {} |\n", row.join(" | "));
    }
    text
}

/// A whole number with thousands separators.
pub(crate) fn count(number: f64) -> String {
    if !number.is_finite() {
        return "-".to_owned();
    }
    let digits = format!("{:.0}", number.abs());
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    if number <= -0.5 { format!("-{text}") } else { text }
}

/// A measured value with about two digits that count; `-` where nothing was measured.
pub(crate) fn short(number: f64) -> String {
    match number.abs() {
        size if !size.is_finite() => "-".to_owned(),
        0.0 => "0".to_owned(),
        size if size < 0.095 => format!("{number:.3}"),
        size if size < 0.95 => format!("{number:.2}"),
        size if size < 9.5 => format!("{number:.1}"),
        _ => count(number),
    }
}

/// Middle value, ignoring what is not finite; NaN of nothing.
pub(crate) fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.filter(|value| !value.is_nan()).collect();
    values.sort_by(f64::total_cmp);
    match values.len() {
        0 => f64::NAN,
        length if length % 2 == 1 => values[length / 2],
        length => (values[length / 2 - 1] + values[length / 2]) / 2.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers() {
        assert_eq!([count(1_234_567.4), count(999.0), count(f64::NAN)], ["1,234,567", "999", "-"]);
        assert_eq!([short(0.0), short(0.0123), short(0.123), short(1.23)], ["0", "0.012", "0.12", "1.2"]);
        assert_eq!([short(12.3), short(12_345.0), short(f64::NAN)], ["12", "12,345", "-"]);
    }

    #[test]
    fn medians() {
        assert_eq!(median([3.0, 1.0, f64::NAN, 2.0].into_iter()), 2.0);
        assert_eq!(median([1.0, 2.0].into_iter()), 1.5);
        // An infinite ratio (nothing missing) is larger than all others, and counts.
        assert_eq!(median([1.0, f64::INFINITY, f64::INFINITY].into_iter()), f64::INFINITY);
        assert!(median(std::iter::empty()).is_nan());
    }
}
