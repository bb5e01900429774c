//! One field on a plane grid, equal cells or not, as a picture: colour bar, axes, solids lightened.

use std::io;
use std::path::Path;

use super::axes::{Axes, Look, colour_bar};
use super::canvas::{Canvas, Rect};
use super::colour::{BLACK, Map, WHITE, mix};
use super::text::Type;

/// A plane through cells: faces of both axes in metres, and names of the axes.
#[derive(Clone, Debug)]
pub struct Section<'a> {
    /// Faces across, increasing.
    pub across: &'a [f64],
    /// Faces upwards, increasing.
    pub up: &'a [f64],
    /// Names of both axes.
    pub names: [&'a str; 2],
}

/// What is drawn on it; values are one per cell, across fastest.
#[derive(Clone, Debug)]
pub struct Layer<'a> {
    /// The field.
    pub values: &'a [f64],
    /// Solid fraction, if there are solids.
    pub solid: Option<&'a [f64]>,
    /// The values are those of the solids: there is nothing between them.
    pub solids_alone: bool,
    /// Ends of the colour bar.
    pub limits: [f64; 2],
    /// Label of the colour bar, with its unit.
    pub label: &'a str,
    /// Blue over white to red, for what has a sign.
    pub signed: bool,
}

const LOOK: Look = Look { font: 16.0, line: 1.0 };
/// Largest extents of the plot in pixels.
const MOST: [f64; 2] = [1100.0, 820.0];
/// Least extent: a thin channel is drawn higher than it is.
const LEAST: f64 = 150.0;

/// Millimetres or metres: name of the unit and units per metre.
fn unit(length: f64) -> (&'static str, f64) {
    if length < 0.5 { ("mm", 1e3) } else { ("m", 1.0) }
}

impl Section<'_> {
    /// Writes the picture.
    ///
    /// # Errors
    /// What writing the file answers.
    pub fn draw(&self, path: &Path, layer: &Layer<'_>, title: &str) -> io::Result<()> {
        let ends =
            |faces: &[f64]| (faces.first().copied().unwrap_or(0.0), faces.last().copied().unwrap_or(1.0));
        let (x, y) = (ends(self.across), ends(self.up));
        let (width, height) = (x.1 - x.0, y.1 - y.0);
        let scale = (MOST[0] / width).min(MOST[1] / height);
        // Even numbers, as video encoders ask for.
        let even = |pixels: f64| 2.0 * (0.5 * pixels.max(LEAST)).round();
        let plot = Rect::new(96.0, 56.0, even(scale * width), even(scale * height));
        let mut canvas = Canvas::new(plot.right() as usize + 140, plot.bottom() as usize + 66);
        let (name, per_metre) = unit(width.max(height));
        let axes =
            Axes { rect: plot, x: (per_metre * x.0, per_metre * x.1), y: (per_metre * y.0, per_metre * y.1) };
        let map = if layer.signed { Map::signed() } else { Map::viridis() };
        self.paint(&mut canvas, plot, layer, &map);
        axes.bottom(&mut canvas, LOOK, &format!("{} in {name}", self.names[0]));
        axes.left(&mut canvas, LOOK, &format!("{} in {name}", self.names[1]));
        axes.frame(&mut canvas, LOOK);
        let bar = Rect::new(plot.right() + 22.0, plot.top, 18.0, plot.height);
        colour_bar(&mut canvas, bar, &map, (layer.limits[0], layer.limits[1]), layer.label, LOOK);
        canvas.text((plot.left, plot.top - 20.0), Type::new(1.2 * LOOK.font, (0.0, 0.0)), title);
        canvas.save(path)
    }

    fn paint(&self, canvas: &mut Canvas, plot: Rect, layer: &Layer<'_>, map: &Map) {
        let columns = places(self.across, plot.width as usize, false);
        let rows = places(self.up, plot.height as usize, true);
        let n = self.across.len() - 1;
        let [low, high] = layer.limits;
        let per_value = 1.0 / (high - low);
        // Between rows of cells first, which whole rows of pixels share.
        let (mut values, mut solid) = (vec![0.0; n], vec![0.0; n]);
        let solid_rows: Vec<bool> = layer.solid.map_or(vec![false; self.up.len()], |all| {
            all.chunks_exact(n).map(|row| row.iter().any(|share| *share > 0.0)).collect()
        });
        let at = |line: &[f64], &(low, high, t): &Place| line[low] + t * (line[high] - line[low]);
        let left = plot.left as usize;
        for (y, row) in rows.iter().enumerate() {
            between(layer.values, row, &mut values);
            let solids = layer.solid.filter(|_| solid_rows[row.0] || solid_rows[row.1]);
            if let Some(all) = solids {
                between(all, row, &mut solid);
            }
            let pixels = canvas.row(plot.top as usize + y, left, left + columns.len());
            for (pixel, column) in pixels.as_chunks_mut().0.iter_mut().zip(&columns) {
                let mut colour = map.at((at(&values, column) - low) * per_value);
                let share = if solids.is_some() { at(&solid, column).clamp(0.0, 1.0) } else { 0.0 };
                if layer.solids_alone {
                    colour = mix(WHITE, colour, share);
                }
                if share > 0.0 {
                    if !layer.solids_alone {
                        colour = mix(colour, WHITE, 0.55 * share);
                    }
                    // A line where half of a cell is solid.
                    if (share - 0.5).abs() < 0.25 {
                        colour = mix(colour, BLACK, 0.9 - 3.6 * (share - 0.5).abs());
                    }
                }
                *pixel = colour;
            }
        }
    }
}

/// Lower cell, upper cell, share of the upper.
type Place = (usize, usize, f64);

/// The row of cells at this place between two.
fn between(field: &[f64], &(low, high, t): &Place, out: &mut [f64]) {
    let n = out.len();
    let rows = field[low * n..][..n].iter().zip(&field[high * n..][..n]);
    out.iter_mut().zip(rows).for_each(|(out, (a, b))| *out = a + t * (b - a));
}

/// Where pixels fall between the centres of cells.
fn places(faces: &[f64], pixels: usize, flip: bool) -> Vec<Place> {
    let n = faces.len() - 1;
    let centre = |i: usize| 0.5 * (faces[i] + faces[i + 1]);
    let (from, to) = (faces[0], faces[n]);
    let mut cell = 0;
    let mut out: Vec<_> = (0..pixels)
        .map(|p| {
            let x = from + (to - from) * (p as f64 + 0.5) / pixels as f64;
            while cell + 1 < n && centre(cell + 1) <= x {
                cell += 1;
            }
            let upper = (cell + 1).min(n - 1);
            let room = centre(upper) - centre(cell);
            let share = if room > 0.0 { ((x - centre(cell)) / room).clamp(0.0, 1.0) } else { 0.0 };
            (cell, upper, share)
        })
        .collect();
    if flip {
        out.reverse();
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_lie_between_centres_of_any_cells() {
        let found = places(&[0.0, 1.0, 4.0], 8, false);
        // Centres at 0.5 and 2.5; the first pixel is at 0.25, the fourth at 1.75.
        assert_eq!(found[0], (0, 1, 0.0));
        assert_eq!(found[3], (0, 1, 0.625));
        assert_eq!(found[7].0, 1);
        assert_eq!(places(&[0.0, 1.0, 4.0], 8, true)[7], found[0]);
    }
}
