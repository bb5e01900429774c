//! Sketches of cells, bodies and points, and curves beside them.

use std::io;
use std::path::Path;

use crate::axes::{Axes, Look};
use crate::canvas::{Canvas, Rect};
use crate::colour::{self, Colour, INK, Map, WHITE, mix};
use crate::text::Type;

/// What something in a sketch is painted with.
#[derive(Clone, Copy, Debug)]
pub enum Paint {
    /// Between white (0) and slate (1).
    Share(f64),
    /// One of a few colours that differ well, lightened by a part.
    Kind(usize, f64),
    /// As lines and letters are.
    Ink,
}

impl Paint {
    fn colour(self, map: &Map) -> Colour {
        match self {
            Self::Share(share) => map.at(share),
            Self::Kind(kind, light) => mix(colour::line(kind), WHITE, light),
            Self::Ink => INK,
        }
    }
}

/// One drawing in a sketch. Everything is in the units of its axes.
#[derive(Clone, Debug, Default)]
pub struct Drawing {
    /// Stands above it.
    pub title: String,
    /// Range along x and y.
    pub range: [(f64, f64); 2],
    /// Labels of the axes; without them none are drawn.
    pub labels: Option<[String; 2]>,
    /// Rectangles: lower and upper corner.
    pub cells: Vec<([f64; 2], [f64; 2], Paint)>,
    /// Lines through points, with their width in pixels.
    pub lines: Vec<(Vec<[f64; 2]>, f64, Paint)>,
    /// Points with their names.
    pub points: Vec<([f64; 2], Paint, String)>,
    /// Colours and what they stand for.
    pub legend: Vec<(Paint, String)>,
}

const LOOK: Look = Look { font: 17.0, line: 1.5 };
/// Widest and highest drawing \[pixels\].
const SIZE: (f64, f64) = (560.0, 420.0);
const MARGIN: f64 = 36.0;
const LEFT: f64 = 76.0;
const FOOT: f64 = 64.0;
const TITLE: f64 = 52.0;
const ROW: f64 = 26.0;

/// Least and largest finite value, apart from one another; (0, 1) if there is none.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let ends = values.filter(|v| v.is_finite()).fold(None, |ends: Option<(f64, f64)>, v| {
        Some(ends.map_or((v, v), |(low, high)| (low.min(v), high.max(v))))
    });
    let (low, high) = ends.unwrap_or((0.0, 1.0));
    if high > low { (low, high) } else { (low - 0.5, high + 0.5) }
}

/// Writes the drawings side by side, so many in a row.
pub fn draw(path: &Path, columns: usize, drawings: &[Drawing]) -> io::Result<()> {
    let rows: Vec<&[Drawing]> = drawings.chunks(columns.max(1)).collect();
    let foot = |row: &[Drawing]| {
        let axes = if row.iter().any(|d| d.labels.is_some()) { FOOT } else { 0.0 };
        axes + ROW * row.iter().map(|d| d.legend.len()).max().unwrap_or(0) as f64 + 12.0
    };
    let height: f64 = rows.iter().map(|row| TITLE + SIZE.1 + foot(row)).sum();
    let width = columns as f64 * (LEFT + SIZE.0) + MARGIN;
    let mut canvas = Canvas::new(width as usize, height as usize);
    let mut top = TITLE;
    for row in rows {
        for (column, drawing) in row.iter().enumerate() {
            let left = LEFT + column as f64 * (LEFT + SIZE.0);
            drawing.draw(&mut canvas, Rect::new(left, top, SIZE.0, SIZE.1));
        }
        top += TITLE + SIZE.1 + foot(row);
    }
    canvas.save(path)
}

impl Drawing {
    /// Rectangular cells between the faces of both axes, x fastest, with lines between them.
    pub fn lattice(title: &str, faces: [&[f64]; 2], paint: impl Fn(usize) -> Paint) -> Self {
        let [across, up] = faces;
        let n = across.len().saturating_sub(1);
        let mut drawing = Self { title: title.into(), ..Self::default() };
        drawing.range = [across, up].map(|axis| range(axis.iter().copied()));
        for (j, y) in up.windows(2).enumerate() {
            let cells = across.windows(2).enumerate();
            drawing.cells.extend(cells.map(|(i, x)| ([x[0], y[0]], [x[1], y[1]], paint(i + n * j))));
        }
        let [(x0, x1), (y0, y1)] = drawing.range;
        let columns = across.iter().map(|&x| vec![[x, y0], [x, y1]]);
        let rows = up.iter().map(|&y| vec![[x0, y], [x1, y]]);
        drawing.lines = columns.chain(rows).map(|line| (line, 1.0, Paint::Share(0.45))).collect();
        drawing
    }

    /// Curves over linear axes that hold all their points, each with a colour and a legend entry.
    pub fn curves(title: &str, labels: [&str; 2], curves: &[(&str, Vec<[f64; 2]>)]) -> Self {
        let points = || curves.iter().flat_map(|(_, points)| points);
        let ends = [0, 1].map(|a| range(points().map(|p| p[a])));
        let margin = 0.05 * (ends[1].1 - ends[1].0);
        let colour = |i: usize| Paint::Kind(i, 0.0);
        Self {
            title: title.into(),
            range: [ends[0], (ends[1].0 - margin, ends[1].1 + margin)],
            labels: Some(labels.map(String::from)),
            lines: curves.iter().enumerate().map(|(i, c)| (c.1.clone(), 2.5, colour(i))).collect(),
            legend: curves.iter().enumerate().map(|(i, c)| (colour(i), c.0.into())).collect(),
            ..Self::default()
        }
    }

    /// Adds the zero level of `f` within the range: linear interpolation on `n` × `n` squares, each
    /// of two triangles.
    pub fn add_zero_level(&mut self, f: impl Fn([f64; 2]) -> f64, n: usize, width: f64, paint: Paint) {
        let node = |k: usize, (from, to): (f64, f64)| from + (to - from) * k as f64 / n as f64;
        let at = |i: usize, j: usize| [node(i, self.range[0]), node(j, self.range[1])];
        let values: Vec<f64> =
            (0..=n).flat_map(|j| (0..=n).map(move |i| (i, j))).map(|(i, j)| f(at(i, j))).collect();
        let vertex = |i: usize, j: usize| (at(i, j), values[i + (n + 1) * j]);
        let mut segments = Vec::new();
        for (i, j) in (0..n).flat_map(|j| (0..n).map(move |i| (i, j))) {
            for middle in [vertex(i + 1, j), vertex(i, j + 1)] {
                let corners = [vertex(i, j), middle, vertex(i + 1, j + 1)];
                let edges = (0..3).map(|k| (corners[k], corners[(k + 1) % 3]));
                let cut = edges.filter(|(a, b)| (a.1 < 0.0) != (b.1 < 0.0)).map(|((p, a), (q, b))| {
                    let share = a / (a - b);
                    [p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1])]
                });
                segments.push(cut.collect::<Vec<_>>());
            }
        }
        self.lines.extend(segments.into_iter().filter(|s| s.len() == 2).map(|s| (s, width, paint)));
    }

    fn draw(&self, canvas: &mut Canvas, room: Rect) {
        let [x, y] = self.range;
        let map = Map::slate();
        // Cells keep their shape; curves fill the room.
        let rect = if self.labels.is_some() {
            room
        } else {
            let scale = (room.width / (x.1 - x.0)).min(room.height / (y.1 - y.0));
            Rect::new(room.left, room.top, scale * (x.1 - x.0), scale * (y.1 - y.0))
        };
        let axes = Axes { rect, x, y };
        canvas.text((room.left, room.top - 18.0), Type::new(1.1 * LOOK.font, (0.0, 0.0)), &self.title);
        if let Some([along, up]) = &self.labels {
            axes.grid(canvas, LOOK);
            axes.bottom(canvas, LOOK, along);
            axes.left(canvas, LOOK, up);
            axes.frame(canvas, LOOK);
        }
        canvas.clip(Some(rect));
        for (low, high, paint) in &self.cells {
            let (a, b) = (axes.at(low[0], low[1]), axes.at(high[0], high[1]));
            canvas.fill(Rect::new(a.0, b.1, b.0 - a.0, a.1 - b.1), paint.colour(&map), 1.0);
        }
        for (points, width, paint) in &self.lines {
            let pixels: Vec<_> = points.iter().map(|p| axes.at(p[0], p[1])).collect();
            canvas.line(&pixels, *width, paint.colour(&map));
        }
        for (point, paint, name) in &self.points {
            let at = axes.at(point[0], point[1]);
            canvas.disc(at, 7.5, WHITE, 1.0);
            canvas.disc(at, 6.0, paint.colour(&map), 1.0);
            let style = Type::new(1.15 * LOOK.font, (0.0, 0.5));
            canvas.text((at.0 + 12.0, at.1 + 16.0), style, name);
        }
        canvas.clip(None);
        for (row, (paint, text)) in self.legend.iter().enumerate() {
            let below = if self.labels.is_some() { FOOT } else { 4.0 };
            let y = rect.bottom() + below + ROW * (row as f64 + 0.5);
            let key = Rect::new(rect.left, y - 8.0, 26.0, 16.0);
            canvas.fill(Rect::new(key.left - 1.0, key.top - 1.0, 28.0, 18.0), INK, 1.0);
            canvas.fill(key, paint.colour(&map), 1.0);
            canvas.text((rect.left + 38.0, y), Type::new(LOOK.font, (0.0, 0.5)), text);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lattice_cells_are_numbered_x_fastest() {
        let faces: [&[f64]; 2] = [&[0.0, 1.0, 3.0, 4.0], &[-1.0, 0.0, 2.0]];
        let drawing = Drawing::lattice("", faces, |at| Paint::Kind(at, 0.0));
        assert_eq!(drawing.range, [(0.0, 4.0), (-1.0, 2.0)]);
        assert_eq!((drawing.cells.len(), drawing.lines.len()), (6, 7));
        let (low, high, paint) = drawing.cells[4];
        assert!(low == [1.0, 0.0] && high == [3.0, 2.0] && matches!(paint, Paint::Kind(4, _)));
    }

    #[test]
    fn curves_hold_all_finite_points() {
        let curves = [("a", vec![[0.0, 1.0], [2.0, f64::NAN]]), ("b", vec![[4.0, 3.0]])];
        let drawing = Drawing::curves("", ["x", "y"], &curves);
        assert_eq!(drawing.range, [(0.0, 4.0), (0.9, 3.1)]);
        assert_eq!((drawing.lines.len(), drawing.legend.len()), (2, 2));
        assert_eq!(range([5.0].into_iter()), (4.5, 5.5));
    }

    #[test]
    fn the_zero_level_of_a_circle_has_its_length() {
        let mut drawing = Drawing { range: [(-2.0, 2.0), (-1.5, 1.5)], ..Drawing::default() };
        drawing.add_zero_level(|[x, y]| x.hypot(y) - 1.0, 100, 1.0, Paint::Ink);
        let length = |p: &[[f64; 2]]| (p[1][0] - p[0][0]).hypot(p[1][1] - p[0][1]);
        let circumference: f64 = drawing.lines.iter().map(|(points, ..)| length(points)).sum();
        assert!((circumference / std::f64::consts::TAU - 1.0).abs() < 1e-3, "{circumference}");
    }
}
