//! A run beside what others measured: the flow at a few times, and curves through points.

use std::io;
use std::path::Path;

use crate::axes::{Axes, Look, colour_bar};
use crate::canvas::{Canvas, Pixel, Rect};
use crate::colour::{self, INK, Map, WHITE};
use crate::frames::{Disc, Domain, Scalar, paint};
use crate::text::{self, Type};

/// The flow at one time.
#[derive(Clone, Copy, Debug)]
pub struct Field<'a> {
    /// Time in seconds.
    pub time: f64,
    /// Speed in m/s.
    pub speed: Scalar<'a>,
    /// The bodies.
    pub discs: &'a [Disc],
}

/// A computed curve and the points it is held against, either of which may be empty.
#[derive(Clone, Debug, Default)]
pub struct Curve {
    /// What the legend calls it.
    pub label: String,
    /// Computed: drawn as a line.
    pub line: Vec<(f64, f64)>,
    /// Published: drawn as rings.
    pub points: Vec<(f64, f64)>,
}

/// One plot.
#[derive(Clone, Debug, Default)]
pub struct Panel {
    /// Label of the lower axis.
    pub x: String,
    /// Label of the left axis.
    pub y: String,
    /// In the order of their colours, the same labels in every panel.
    pub curves: Vec<Curve>,
}

/// The whole figure.
#[derive(Clone, Copy, Debug)]
pub struct Comparison<'a> {
    /// The rectangle of the fields.
    pub domain: Domain,
    /// From left to right.
    pub fields: &'a [Field<'a>],
    /// Row after row.
    pub panels: &'a [Panel],
    /// So many panels in a row.
    pub columns: usize,
    /// What the legend calls lines and rings; empty if there are none.
    pub names: [&'a str; 2],
}

const LOOK: Look = Look { font: 21.0, line: 2.0 };
const LEFT: f64 = 92.0;
const TOP: f64 = 62.0;
const HEIGHT: f64 = 940.0;
/// With fields that are less high than this, panels are no higher either, but at least so high.
const LEAST_HEIGHT: f64 = 720.0;
const WIDEST_FIELDS: f64 = 1500.0;
const GAP: f64 = 34.0;
const BAR_ROOM: f64 = 132.0;
const PANEL_WIDTH: f64 = 560.0;
/// Room left of and below a panel.
const PANEL_LEFT: f64 = 112.0;
const PANEL_FOOT: f64 = 96.0;
const FOOT: f64 = 130.0;
const STROKE: f64 = 3.0;

impl Comparison<'_> {
    /// Writes the figure.
    pub fn draw(&self, path: &Path) -> io::Result<()> {
        let n = self.fields.len() as f64;
        let room = (WIDEST_FIELDS - GAP * (n - 1.0).max(0.0)) / n.max(1.0);
        let scale = (HEIGHT / self.domain.height).min(room / self.domain.width);
        let size = ((scale * self.domain.width).round(), (scale * self.domain.height).round());
        let fields = if self.fields.is_empty() { 0.0 } else { n * (size.0 + GAP) - GAP + BAR_ROOM };
        let rows = self.panels.len().div_ceil(self.columns.max(1)).max(1) as f64;
        let whole = if self.fields.is_empty() { HEIGHT } else { size.1.max(LEAST_HEIGHT) };
        let height = ((whole - PANEL_FOOT * (rows - 1.0)) / rows).round();
        let start = if fields > 0.0 { LEFT + fields } else { 0.0 };
        let width = start + self.columns as f64 * (PANEL_LEFT + PANEL_WIDTH) + 40.0;
        let mut canvas = Canvas::new(width as usize, (TOP + whole + FOOT) as usize);
        self.flows(&mut canvas, size);
        for (i, panel) in self.panels.iter().enumerate() {
            let (row, column) = ((i / self.columns.max(1)) as f64, (i % self.columns.max(1)) as f64);
            let left = start + PANEL_LEFT + column * (PANEL_LEFT + PANEL_WIDTH);
            let top = TOP + row * (height + PANEL_FOOT);
            panel.draw(&mut canvas, Rect::new(left, top, PANEL_WIDTH, height));
        }
        self.legend(&mut canvas, (start + PANEL_LEFT, TOP + whole + FOOT - 26.0));
        canvas.save(path)
    }

    fn flows(&self, canvas: &mut Canvas, (width, height): (f64, f64)) {
        let peak = self.fields.iter().flat_map(|f| f.speed.values).fold(0.0f64, |a, &b| a.max(b));
        let peak = if peak > 0.0 { peak } else { 1.0 };
        let map = Map::viridis();
        let mut rect = Rect::new(LEFT, TOP, width, height);
        for (column, field) in self.fields.iter().enumerate() {
            let above = (rect.left + 0.5 * width, TOP - 18.0);
            canvas.text(above, Type::new(LOOK.font, (0.5, 0.0)), &format!("t = {:.3} s", field.time));
            paint(canvas, rect, self.domain.periodic, [&field.speed], |[v]| map.at(v / peak));
            self.domain.discs(canvas, rect, field.discs, 1.8);
            let axes = self.domain.axes(rect);
            axes.frame(canvas, LOOK);
            axes.bottom(canvas, LOOK, "mm");
            if column == 0 {
                axes.left(canvas, LOOK, "height in mm");
            }
            rect.left += width + GAP;
        }
        if !self.fields.is_empty() {
            let bar = Rect::new(rect.left - GAP + 22.0, TOP, 20.0, height);
            colour_bar(canvas, bar, &map, (0.0, 1e3 * peak), "speed |u| in mm/s", LOOK);
        }
    }

    /// One line below the panels: the curves' colours, then what lines and rings are.
    fn legend(&self, canvas: &mut Canvas, (mut x, y): Pixel) {
        let style = Type::new(LOOK.font, (0.0, 0.5));
        let Some(panel) = self.panels.first() else { return };
        let kinds = if panel.curves.len() > 1 { &panel.curves[..] } else { &[] };
        for (row, curve) in kinds.iter().enumerate() {
            canvas.fill(Rect::new(x, y - 8.0, 26.0, 16.0), colour::line(row), 1.0);
            canvas.text((x + 38.0, y), style, &curve.label);
            x += 38.0 + text::width(LOOK.font, &curve.label) + 44.0;
        }
        for (kind, name) in self.names.iter().enumerate().filter(|(_, name)| !name.is_empty()) {
            if kind == 0 {
                canvas.line(&[(x, y), (x + 34.0, y)], STROKE, INK);
            } else {
                ring(canvas, (x + 17.0, y), INK);
            }
            canvas.text((x + 46.0, y), style, name);
            x += 46.0 + text::width(LOOK.font, name) + 44.0;
        }
    }
}

impl Panel {
    fn draw(&self, canvas: &mut Canvas, rect: Rect) {
        let all = || self.curves.iter().flat_map(|c| c.line.iter().chain(&c.points));
        let y = range(all().map(|p| p.1));
        let air = 0.06 * (y.1 - y.0);
        let axes = Axes { rect, x: range(all().map(|p| p.0)), y: (y.0 - air, y.1 + air) };
        axes.grid(canvas, LOOK);
        canvas.clip(Some(rect));
        for (row, curve) in self.curves.iter().enumerate() {
            for &(x, y) in &curve.points {
                ring(canvas, axes.at(x, y), colour::line(row));
            }
        }
        for (row, curve) in self.curves.iter().enumerate() {
            let pixels: Vec<Pixel> = curve.line.iter().map(|&(x, y)| axes.at(x, y)).collect();
            canvas.line(&pixels, STROKE, colour::line(row));
        }
        canvas.clip(None);
        axes.frame(canvas, LOOK);
        axes.bottom(canvas, LOOK, &self.x);
        axes.left(canvas, LOOK, &self.y);
    }
}

/// A published point.
fn ring(canvas: &mut Canvas, at: Pixel, ink: colour::Colour) {
    canvas.disc(at, 5.5, WHITE, 1.0);
    canvas.circle(at, 5.5, 2.0, ink);
}

/// From the least to the largest of what is finite.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values
        .filter(|v| v.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    if low < high {
        (low, high)
    } else if low == high {
        (low - 0.5, low + 0.5)
    } else {
        (0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_with_and_without_fields() {
        let path = std::env::temp_dir().join(format!("siltflow-comparison-{}.png", std::process::id()));
        let domain = Domain { width: 0.1, height: 0.16, periodic: [false; 2] };
        let speed = [0.0, 1.0, 2.0, f64::NAN];
        let field = Field { time: 0.5, speed: Scalar { nx: 2, ny: 2, values: &speed }, discs: &[] };
        let curve = Curve { label: "a".into(), line: vec![(0.0, 1.0), (1.0, 2.0)], points: vec![(0.5, 1.4)] };
        let panels = [
            Panel { x: "x".into(), y: "y".into(), curves: vec![curve.clone(), curve] },
            Panel { x: "x".into(), y: "y".into(), curves: Vec::new() },
        ];
        for fields in [&[][..], &[field]] {
            let names = ["here", "there"];
            Comparison { domain, fields, panels: &panels, columns: 1, names }.draw(&path).unwrap();
            assert!(std::fs::metadata(&path).unwrap().len() > 1000);
        }
        std::fs::remove_file(&path).unwrap();
    }
}
