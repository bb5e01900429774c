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
