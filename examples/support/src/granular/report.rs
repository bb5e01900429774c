//! Curves and numbers that every such run has.
use super::record::History;
use crate::table::{Table, number};
use render::sketch::{Drawing, Paint};

/// A column over time, `by` times as large, from zero on.
pub fn over_time(history: &History, column: &str, by: f64, title: &str, label: &str) -> Drawing {
    let line: Vec<[f64; 2]> = history.over_time(column).iter().map(|(t, v)| [*t, by * v]).collect();
    let end = line.last().map_or(1.0, |p| p[0]);
    let (low, high) = line.iter().fold((0.0_f64, 0.0_f64), |(l, h), p| (l.min(p[1]), h.max(p[1])));
    let air = if high > low { 0.08 * (high - low) } else { 1.0 };
    Drawing {
        title: title.into(),
        range: [
            (0.0, if end > 0.0 { end } else { 1.0 }),
            (if low < 0.0 { low - air } else { 0.0 }, high + air),
        ],
        labels: Some(["time, s".into(), label.into()]),
        lines: vec![(line, 3.0, Paint::Kind(0, 0.0))],
        ..Drawing::default()
    }
}

/// A level line across a drawing, with what it stands for.
#[must_use]
pub fn with_level(mut drawing: Drawing, value: f64, measured: &str, text: &str) -> Drawing {
    let (begin, end) = drawing.range[0];
    drawing.lines.push((vec![[begin, value], [end, value]], 2.0, Paint::Kind(1, 0.0)));
    drawing.legend = vec![(Paint::Kind(0, 0.0), measured.into()), (Paint::Kind(1, 0.0), text.into())];
    drawing.range[1].1 = drawing.range[1].1.max(1.1 * value);
    drawing
}

/// The last value of a column, and the largest; zero of an empty one.
pub fn last(history: &History, column: &str) -> f64 {
    history.column(column).last().copied().unwrap_or(0.0)
}

/// The largest value of a column.
pub fn most(history: &History, column: &str) -> f64 {
    history.column(column).into_iter().fold(0.0, f64::max)
}

/// Mean and standard deviation of the last half of a column.
pub fn late(history: &History, column: &str) -> (f64, f64) {
    let values = history.column(column);
    let half = &values[values.len() / 2..];
    let n = half.len().max(1) as f64;
    let mean = half.iter().sum::<f64>() / n;
    (mean, (half.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / n).sqrt())
}

/// What every run tells.
pub fn common(table: &mut Table, history: &History) {
    table.row("grains", number(last(history, "grains")), "");
    table.row("kinetic energy, last and largest", number(last(history, "kinetic_energy")), "J");
    table.row("", number(most(history, "kinetic_energy")), "J");
    table.row("fastest grain of all", number(most(history, "fastest")), "m/s");
    table.row("contacts per grain at the end", number(last(history, "coordination")), "");
    table.row("overlap by radius at the end, mean", number(100.0 * last(history, "overlap")), "%");
    table.row("largest of all", number(100.0 * most(history, "largest_overlap")), "%");
    table.row("grains beyond the walls, most", most(history, "outside"), "");
}
