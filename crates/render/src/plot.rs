//! Plots of one quantity over another, both on logarithmic axes.

use std::io;
use std::path::Path;

use crate::axes::{Axes, Look, Ticks};
use crate::canvas::{Canvas, Pixel, Rect};
use crate::colour::{self, WHITE};
use crate::text::Type;

/// Points of one kind.
#[derive(Clone, Debug)]
pub struct Series {
    /// What the legend calls it.
    pub label: String,
    /// x, y, and what is written beside the point.
    pub points: Vec<(f64, f64, String)>,
    /// Filled points joined by a line, else rings.
    pub ours: bool,
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
    /// Kinds of points, in the order of their colours.
    pub series: Vec<Series>,
}

const LOOK: Look = Look { font: 17.0, line: 2.0 };
const PLOT: (f64, f64) = (560.0, 380.0);
const LEFT: f64 = 108.0;
const RIGHT: f64 = 40.0;
const FOOT: f64 = 84.0;
/// Height of a line of the legend, which stands between title and plot.
const ROW: f64 = 24.0;
const TITLE: f64 = 52.0;
const COLUMNS: usize = 2;

/// Writes the panels side by side, two in a row.
pub fn draw(path: &Path, panels: &[Panel]) -> io::Result<()> {
    let rows: Vec<&[Panel]> = panels.chunks(COLUMNS).collect();
    let head = |row: &[Panel]| TITLE + ROW * row.iter().map(|p| p.series.len()).max().unwrap_or(0) as f64;
    let width = COLUMNS as f64 * (LEFT + PLOT.0 + RIGHT);
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
    /// Title and legend from `top` on, the plot in `rect`.
    fn draw(&self, canvas: &mut Canvas, top: f64, rect: Rect) {
        let points = || self.series.iter().flat_map(|s| &s.points);
        let axes = Axes { rect, x: range(points().map(|p| p.0)), y: range(points().map(|p| p.1)) };
        let ticks = [Ticks::decades(axes.x), Ticks::decades(axes.y)];
        axes.grid_at(canvas, LOOK, &ticks);
        let title = (rect.left, top + TITLE - 18.0);
        canvas.text(title, Type::new(1.15 * LOOK.font, (0.0, 0.0)), &self.title);
        for (row, series) in self.series.iter().enumerate() {
            let ink = colour::line(row);
            let y = top + TITLE + ROW * (row as f64 + 0.5) - 6.0;
            if series.ours {
                canvas.line(&[(rect.left, y), (rect.left + 40.0, y)], 3.0, ink);
            }
            series.mark(canvas, (rect.left + 20.0, y), ink);
            canvas.text((rect.left + 54.0, y), Type::new(LOOK.font, (0.0, 0.5)), &series.label);

            let place = |p: &(f64, f64, String)| axes.at(p.0.log10(), p.1.log10());
            if series.ours {
                canvas.line(&series.points.iter().map(place).collect::<Vec<Pixel>>(), 3.0, ink);
            }
            // Text of the upper one of two curves stands above it, of the lower one below.
            let upper = self.series.get(row + 1).is_some_and(|next| next.ours);
            let (shift, align) = match (series.ours, upper) {
                (true, true) => ((7.0, -7.0), (0.0, 0.0)),
                (true, false) => ((-9.0, 6.0), (1.0, 1.0)),
                _ => ((12.0, 0.0), (0.0, 0.5)),
            };
            for point in &series.points {
                let (x, y) = place(point);
                series.mark(canvas, (x, y), ink);
                let style = Type::new(0.8 * LOOK.font, align).coloured(ink);
                canvas.text((x + shift.0, y + shift.1), style, &point.2);
            }
        }
        axes.frame(canvas, LOOK);
        axes.bottom_at(canvas, LOOK, &ticks[0], &self.x);
        axes.left_at(canvas, LOOK, &ticks[1], &self.y);
    }
}

impl Series {
    fn mark(&self, canvas: &mut Canvas, at: Pixel, ink: colour::Colour) {
        let radius = 6.0;
        if self.ours {
            canvas.disc(at, radius, ink, 1.0);
        } else {
            canvas.disc(at, radius, WHITE, 1.0);
            canvas.circle(at, radius, 3.0, ink);
        }
    }
}

/// Exponents of the range of what is positive, with air around; at least one power of ten lies inside.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let exponents = values.filter(|v| *v > 0.0 && v.is_finite()).map(f64::log10);
    let (low, high) =
        exponents.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), e| (low.min(e), high.max(e)));
    if low > high {
        return (0.0, 1.0);
    }
    let air = 0.08 * (high - low) + 0.15;
    let (low, high) = (low - 1.6 * air, high + air);
    if low.ceil() > high.floor() { (low.floor(), high.ceil()) } else { (low, high) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_hold_all_points_and_a_power_of_ten() {
        let (low, high) = range([1e-3, 0.0, 2e-6, f64::NAN].into_iter());
        assert!(low < 2e-6_f64.log10() && high > -3.0 && low > -7.0 && high < -2.0);
        let (low, high) = range([3.0, 3.0].into_iter());
        assert!(low.ceil() <= high.floor() && low < 0.5 && high > 0.48);
        assert_eq!(range(std::iter::empty()), (0.0, 1.0));
    }

    #[test]
    fn a_figure_is_a_picture() {
        let series = Series {
            label: "a".into(),
            points: vec![(1e-3, 1e-2, "8²".into()), (1.0, 1e-4, "16²".into())],
            ours: true,
        };
        let panel = Panel { title: "t".into(), x: "x".into(), y: "y".into(), series: vec![series] };
        let path = std::env::temp_dir().join(format!("siltflow-plot-{}.png", std::process::id()));
        draw(&path, &[panel.clone(), panel.clone(), panel]).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        std::fs::remove_file(&path).unwrap();
        // The width in the header.
        assert_eq!(u32::from_be_bytes(bytes[16..20].try_into().unwrap()), 1416);
    }
}
