//! Many fields on one grid, in rows and columns: what several models make of the same snapshots, or modes.

use std::io;
use std::path::Path;

use crate::axes::{Look, colour_bar};
use crate::canvas::{Canvas, Rect};
use crate::colour::{INK, Map, WHITE};
use crate::scalar::{Scalar, paint};
use crate::text::Type;

/// One field.
#[derive(Clone, Debug)]
pub struct Tile<'a> {
    /// Stands above it.
    pub title: String,
    /// What is painted.
    pub field: Scalar<'a>,
}

/// Fields that share a range of colours.
#[derive(Clone, Debug)]
pub struct Row<'a> {
    /// Stands at the colour bar.
    pub label: String,
    /// Lowest and highest value; one on either side of zero takes a map with white at zero, and is made even. `None`: each tile its own range, without a bar.
    pub range: Option<(f64, f64)>,
    /// From left to right.
    pub tiles: Vec<Tile<'a>>,
}

/// Rows of fields.
#[derive(Clone, Debug)]
pub struct Gallery<'a> {
    /// Which directions wrap around.
    pub periodic: [bool; 2],
    /// Height over width of a field.
    pub aspect: f64,
    /// From above.
    pub rows: Vec<Row<'a>>,
}

const LOOK: Look = Look { font: 19.0, line: 1.0 };
const MARGIN: f64 = 24.0;
const TITLE: f64 = 34.0;
const GAP: f64 = 18.0;
const BAR: f64 = 22.0;
const BAR_ROOM: f64 = 150.0;
/// Pixels of a tile.
const AREA: f64 = 90_000.0;

impl Gallery<'_> {
    /// Writes the figure.
    ///
    /// # Errors
    /// Of the file system.
    pub fn draw(&self, path: &Path) -> io::Result<()> {
        let width = (AREA / self.aspect).sqrt().round();
        let height = (width * self.aspect).round();
        let columns = self.rows.iter().map(|row| row.tiles.len()).max().unwrap_or(0) as f64;
        let bar = if self.rows.iter().any(|row| row.range.is_some()) { BAR_ROOM } else { -GAP };
        let wide = 2.0 * MARGIN + columns * (width + GAP) + bar;
        let high = 2.0 * MARGIN + self.rows.len() as f64 * (height + TITLE + GAP);
        let mut canvas = Canvas::new(wide as usize, high as usize);
        for (r, row) in self.rows.iter().enumerate() {
            let top = (MARGIN + TITLE + r as f64 * (height + TITLE + GAP)).round();
            for (c, tile) in row.tiles.iter().enumerate() {
                let rect = Rect::new((MARGIN + c as f64 * (width + GAP)).round(), top, width, height);
                let (low, high, map) = colours(row.range.unwrap_or_else(|| extent(tile.field.values)));
                let frame = Rect::new(rect.left - 1.0, rect.top - 1.0, width + 2.0, height + 2.0);
                canvas.fill(frame, INK, 1.0);
                canvas.fill(rect, WHITE, 1.0);
                paint(&mut canvas, rect, self.periodic, &tile.field, |v| map.at((v - low) / (high - low)));
                let above = (rect.left + 0.5 * width, top - 0.5 * LOOK.font);
                canvas.text(above, Type::new(LOOK.font, (0.5, 0.0)), &tile.title);
            }
            if let Some(range) = row.range {
                let (low, high, map) = colours(range);
                let left = (MARGIN + columns * (width + GAP)).round();
                let bar = Rect::new(left, top, BAR, height);
                colour_bar(&mut canvas, bar, &map, (low, high), &row.label, LOOK);
            }
        }
        canvas.save(path)
    }
}

fn extent(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)))
}

/// The range as it is used, and its colours.
fn colours((low, high): (f64, f64)) -> (f64, f64, Map) {
    if low < 0.0 && high > 0.0 {
        let most = high.max(-low);
        return (-most, most, Map::signed());
    }
    (low, if high > low { high } else { low + 1.0 }, Map::viridis())
}
