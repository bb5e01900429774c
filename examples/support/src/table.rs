//! The closing table of a run, and its twin for machines.

use std::fmt::{self, Display};
use std::fs;
use std::io;
use std::path::Path;

use serde_json::Value;

enum Part {
    Section(String),
    Row { key: String, value: String, unit: String },
    Matrix { header: Vec<String>, rows: Vec<Vec<String>> },
    Note(String),
}

/// Sections of `key  value unit` rows and small matrices, aligned over the whole table when it is shown.
#[derive(Default)]
pub struct Table {
    parts: Vec<Part>,
}

impl Table {
    /// An empty table.
    pub fn new() -> Self {
        Self::default()
    }

    /// Starts a section under a ruled title.
    pub fn section(&mut self, title: &str) -> &mut Self {
        self.parts.push(Part::Section(title.into()));
        self
    }

    /// One quantity. Numbers may be handed over as they are, or written by [`number`] and [`grouped`].
    pub fn row(&mut self, key: &str, value: impl Display, unit: &str) -> &mut Self {
        self.parts.push(Part::Row { key: key.into(), value: value.to_string(), unit: unit.into() });
        self
    }

    /// A small matrix: the first column is text and reads from the left, the others are numbers.
    pub fn matrix(&mut self, header: &[&str], rows: Vec<Vec<String>>) -> &mut Self {
        self.parts.push(Part::Matrix { header: header.iter().map(|&h| h.into()).collect(), rows });
        self
    }

    /// A line of prose.
    pub fn note(&mut self, text: &str) -> &mut Self {
        self.parts.push(Part::Note(text.into()));
        self
    }
}

fn width(text: &str) -> usize {
    text.chars().count()
}

impl Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (mut keys, mut values, mut units) = (0, 0, 0);
        for part in &self.parts {
            if let Part::Row { key, value, unit } = part {
                (keys, values, units) =
                    (keys.max(width(key)), values.max(width(value)), units.max(width(unit)));
            }
        }
        let rule = (2 + keys + 2 + values + 1 + units).clamp(64, 100);
        for part in &self.parts {
            match part {
                Part::Section(title) => {
                    let rest = rule.saturating_sub(width(title) + 4);
                    writeln!(f, "\n── {title} {}", "─".repeat(rest))?;
                }
                Part::Row { key, value, unit } => {
                    let line = format!("  {key:<keys$}  {value:>values$} {unit}");
                    writeln!(f, "{}", line.trim_end())?;
                }
                Part::Matrix { header, rows } => write_matrix(f, header, rows)?,
                Part::Note(text) => writeln!(f, "  {text}")?,
            }
        }
        Ok(())
    }
}

fn write_matrix(f: &mut fmt::Formatter<'_>, header: &[String], rows: &[Vec<String>]) -> fmt::Result {
    let mut widths: Vec<usize> = header.iter().map(|cell| width(cell)).collect();
    for row in rows {
        for (w, cell) in widths.iter_mut().zip(row) {
            *w = (*w).max(width(cell));
        }
    }
    for row in std::iter::once(header).chain(rows.iter().map(Vec::as_slice)) {
        let mut line = String::from("  ");
        for (column, (cell, &w)) in row.iter().zip(&widths).enumerate() {
            line += &if column == 0 { format!("{cell:<w$}") } else { format!("   {cell:>w$}") };
        }
        writeln!(f, "{}", line.trim_end())?;
    }
    Ok(())
}

/// A number to four significant digits: plain between 10⁻³ and 10⁶, otherwise with a power of ten.
pub fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        "0".into()
    } else if !value.is_finite() {
        value.to_string()
    } else if (1e-3..1e6).contains(&size) {
        let decimals = (3 - size.log10().floor() as i32).max(0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.3e}")
    }
}

/// A count with its thousands set apart: `45 000`.
pub fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

/// Writes a JSON value indented, with a closing newline. A number that is not finite becomes `null`.
pub fn write_json(path: &Path, value: &Value) -> io::Result<()> {
    let mut text = serde_json::to_string_pretty(value).map_err(io::Error::other)?;
    text.push('\n');
    fs::write(path, text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_line_up() {
        let mut table = Table::new();
        table.section("Run").row("cells", grouped(45_000), "").row("step Δt", number(2e-4), "s");
        table.matrix(&["body", "x"], vec![vec!["heavy".into(), "1".into()]]);
        let text = table.to_string();
        let ends: Vec<_> = text.lines().skip(2).take(2).map(width).collect();
        assert_eq!(ends[0] + 2, ends[1], "{text}");
        assert!(text.contains("  body    x\n  heavy   1\n"), "{text}");
    }

    #[test]
    fn numbers_keep_four_digits() {
        let expected =
            [(0.0, "0"), (1.0, "1.000"), (-12.3456, "-12.35"), (99_999.0, "99999"), (2.5e-7, "2.500e-7")];
        for (value, text) in expected {
            assert_eq!(number(value), text);
        }
        assert_eq!((grouped(7), grouped(1_234_567)), ("7".into(), "1 234 567".into()));
    }
}
