//! Curves over a logarithmic axis: velocity profiles beside walls, friction along them.

use std::io;
use std::path::Path;

use crate::axes::{Axes, Look, Ticks};
use crate::canvas::{Canvas, Pixel, Rect};
use crate::colour::{self, WHITE};
use crate::text::Type;

/// One curve.
#[derive(Clone, Debug)]
pub struct Curve {
    /// What the legend calls it.
    pub label: String,
    /// x (positive) and y.
    pub points: Vec<(f64, f64)>,
    /// A line, else rings.
    pub line: bool,
}

/// One plot.
#[derive(Clone, Debug)]
pub struct Panel {
    /// Stands above the plot.
    pub title: String,
    /// Label of the lower axis.
    pub x: String,
    /// Label of the left axis.
    pub y: String,
    /// In the order of their colours, rings above lines.
    pub curves: Vec<Curve>,
}

const LOOK: Look = Look { font: 17.0, line: 2.0 };
const PLOT: (f64, f64) = (520.0, 340.0);
const LEFT: f64 = 100.0;
const RIGHT: f64 = 36.0;
const FOOT: f64 = 78.0;
const TITLE: f64 = 46.0;
/// Height of a line of the legend, which stands between title and plot.
const ROW: f64 = 24.0;
const COLUMNS: usize = 2;

/// Writes the panels side by side, two in a row.
///
/// # Errors
/// If the file cannot be written.
pub fn draw(path: &Path, panels: &[Panel]) -> io::Result<()> {
    let rows: Vec<&[Panel]> = panels.chunks(COLUMNS).collect();
    let head = |row: &[Panel]| TITLE + ROW * row.iter().map(|p| p.curves.len()).max().unwrap_or(0) as f64;
    let columns = panels.len().clamp(1, COLUMNS);
    let width = columns as f64 * (LEFT + PLOT.0 + RIGHT);
    let height: f64 = rows.iter().map(|row| head(row) + PLOT.1 + FOOT).sum();
    let mut canvas = Canvas::new(width as usize, height as usize);
    let mut top = 0.0;
    for row in rows {
        for (column, panel) in row.iter().enumerate() {
            let left = LEFT + column as f64 * (LEFT + PLOT.0 + RIGHT);
            panel.draw(&mut canvas, top, Rect::new(left, top + head(row), PLOT.0, PLOT.1));
        }
        top += head(row) + PLOT.1 + FOOT;
    }
    canvas.save(path)
}

impl Panel {
    fn draw(&self, canvas: &mut Canvas, top: f64, rect: Rect) {
        let points = || self.curves.iter().flat_map(|c| &c.points);
        let (low, high) = range(points().map(|p| p.0.log10()), 0.02);
        let axes = Axes { rect, x: (low, high), y: range(points().map(|p| p.1), 0.06) };
        let ticks = [Ticks::decades(axes.x), Ticks::new(axes.y, 6)];
        axes.grid_at(canvas, LOOK, &ticks);
        canvas.text((rect.left, top + TITLE - 16.0), Type::new(1.15 * LOOK.font, (0.0, 0.0)), &self.title);
        for (row, curve) in self.curves.iter().enumerate() {
            let (ink, y) = (colour::line(row), top + TITLE + ROW * (row as f64 + 0.5) - 6.0);
            let places: Vec<Pixel> = curve.points.iter().map(|p| axes.at(p.0.log10(), p.1)).collect();
            if curve.line {
                canvas.line(&[(rect.left, y), (rect.left + 40.0, y)], 3.0, ink);
                canvas.line(&places, 3.0, ink);
            } else {
                for at in places.into_iter().chain([(rect.left + 20.0, y)]) {
                    canvas.disc(at, 5.0, WHITE, 1.0);
                    canvas.circle(at, 5.0, 2.5, ink);
                }
            }
            canvas.text((rect.left + 54.0, y), Type::new(LOOK.font, (0.0, 0.5)), &curve.label);
        }
        axes.frame(canvas, LOOK);
        axes.bottom_at(canvas, LOOK, &ticks[0], &self.x);
        axes.left_at(canvas, LOOK, &ticks[1], &self.y);
    }
}

/// The range of what is finite, with air around.
fn range(values: impl Iterator<Item = f64>, air: f64) -> (f64, f64) {
    let (low, high) = values
        .filter(|v| v.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    if low > high {
        return (0.0, 1.0);
    }
    let air = air * (high - low) + 1e-12 * high.abs().max(1e-300);
    (low - air, high + air)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_is_a_picture() {
        let curve = |line| Curve { label: "a".into(), points: vec![(1.0, 2.0), (300.0, 17.0)], line };
        let (x, y) = ("y+".into(), "u+".into());
        let panel = Panel { title: "t".into(), x, y, curves: vec![curve(true), curve(false)] };
        let path = std::env::temp_dir().join(format!("siltflow-profiles-{}.png", std::process::id()));
        draw(&path, &[panel.clone(), panel.clone(), panel]).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        std::fs::remove_file(&path).unwrap();
        // The width in the header.
        assert_eq!(u32::from_be_bytes(bytes[16..20].try_into().unwrap()), 1312);
        assert_eq!(range(std::iter::empty(), 0.1), (0.0, 1.0));
    }
}
