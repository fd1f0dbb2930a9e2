//! How results look: numbers, tables, JSON on standard output.

use super::args::Common;
use super::error::Failure;
use std::io::{self, Write};

/// Prints a result: as JSON if that was asked for, else for people unless they asked for quiet.
pub(crate) fn print(common: &Common, json: &serde_json::Value, text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    if common.json {
        writeln!(out, "{json:#}")?;
    } else if !common.quiet {
        out.write_all(text.as_bytes())?;
    }
    // Without it an error of a buffered last line would be lost.
    out.flush()?;
    Ok(())
}

/// A whole number with thousands separators: `12,916`.
pub(crate) fn count(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A count with its noun: `1 tree`, `2 trees`.
pub(crate) fn counted(number: u64, noun: &str) -> String {
    format!("{} {noun}{}", count(number), if number == 1 { "" } else { "s" })
}

/// A size: `812 bytes`, `4.1 kB`, `23.2 MB` (powers of 1000).
pub(crate) fn bytes(number: u64) -> String {
    match number {
        0..1_000 => counted(number, "byte"),
        1_000..999_950 => format!("{:.1} kB", number as f64 / 1e3),
        999_950..999_950_000 => format!("{:.1} MB", number as f64 / 1e6),
        _ => format!("{:.2} GB", number as f64 / 1e9),
    }
}

/// Three digits that count: `0.0213`, `2.13`, `213`, `21,300`. Nothing measured (not finite): `-`.
pub(crate) fn number(value: f64) -> String {
    if !value.is_finite() {
        return "-".to_owned();
    }
    let size = value.abs();
    if size == 0.0 {
        "0".to_owned()
    } else if size >= 99.95 {
        let whole = count(size.round() as u64);
        if value < 0.0 { format!("-{whole}") } else { whole }
    } else if size >= 9.995 {
        format!("{value:.1}")
    } else if size >= 0.9995 {
        format!("{value:.2}")
    } else if size >= 0.000_5 {
        format!("{value:.*}", 2 + (-size.log10()).ceil() as usize)
    } else {
        format!("{value:.1e}")
    }
}

/// A share as a percentage: `12.3 %`.
pub(crate) fn percent(share: f64) -> String {
    if share.is_finite() { format!("{} %", number(share * 100.0)) } else { "-".to_owned() }
}

/// `part / whole`, NaN if there is no whole.
pub(crate) fn ratio(part: u64, whole: u64) -> f64 {
    if whole == 0 { f64::NAN } else { part as f64 / whole as f64 }
}

/// Rows in aligned columns, indented by two spaces: the first column to the left, the others to the right.
pub(crate) fn table(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for row in rows {
        let mut line = String::new();
        for (column, cell) in row.iter().enumerate() {
            let gap = " ".repeat(widths[column] - cell.chars().count());
            line += "  ";
            if column == 0 {
                line += cell;
                line += &gap;
            } else {
                line += &gap;
                line += cell;
            }
        }
        text += line.trim_end();
        text.push('\n');
    }
    text
}

/// Names and values, one a line: the names aligned.
pub(crate) fn fields(rows: &[(&str, String)]) -> String {
    let width = rows.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    rows.iter().map(|(name, value)| format!("  {name:width$}   {value}\n")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_for_people() {
        assert_eq!([count(0), count(999), count(1000), count(1_234_567)], ["0", "999", "1,000", "1,234,567"]);
        assert_eq!([bytes(1), bytes(999), bytes(4_096)], ["1 byte", "999 bytes", "4.1 kB"]);
        assert_eq!([bytes(999_949), bytes(999_950), bytes(2_500_000_000)], ["999.9 kB", "1.0 MB", "2.50 GB"]);
        assert_eq!(
            [number(0.0), number(0.0213), number(0.213), number(2.13)],
            ["0", "0.0213", "0.213", "2.13"]
        );
        assert_eq!(
            [number(0.01), number(0.1), number(1.0), number(0.9999)],
            ["0.0100", "0.100", "1.00", "1.00"]
        );
        assert_eq!([number(21.3), number(213.4), number(21_300.0)], ["21.3", "213", "21,300"]);
        assert_eq!([number(-213.4), number(-2.0), number(1e-9)], ["-213", "-2.00", "1.0e-9"]);
        assert_eq!([number(f64::NAN), percent(f64::INFINITY), percent(0.123)], ["-", "-", "12.3 %"]);
        assert_eq!([counted(1, "tree"), counted(2, "tree")], ["1 tree", "2 trees"]);
        assert!(ratio(1, 0).is_nan());
    }

    #[test]
    fn columns_are_aligned() {
        let row = |cells: [&str; 2]| cells.map(str::to_owned).to_vec();
        assert_eq!(table(&[row(["name", "n"]), row(["x", "100"])]), "  name    n\n  x     100\n");
        assert_eq!(fields(&[("a", "1".to_owned()), ("long", "2".to_owned())]), "  a      1\n  long   2\n");
    }
}
