//! One field on a plane grid, equal cells or not, as a picture: colour bar, axes, solids lightened.

use std::io;
use std::path::Path;

use super::axes::{Axes, Look, colour_bar};
use super::canvas::{Canvas, Rect};
use super::colour::{BLACK, Colour, Map, WHITE, mix};
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

/// What stays from one picture to the next: axes, colour bar and the labels of both.
#[derive(Clone, Debug, PartialEq)]
struct Ground {
    plot: Rect,
    ends: [(f64, f64); 2],
    names: [String; 2],
    limits: [f64; 2],
    label: String,
    signed: bool,
}

impl Ground {
    fn new(section: &Section<'_>, layer: &Layer<'_>) -> Self {
        let ends = [section.across, section.up].map(|faces| match faces {
            [first, .., last] => (*first, *last),
            _ => (0.0, 1.0),
        });
        let [width, height] = ends.map(|(from, to)| to - from);
        let scale = (MOST[0] / width).min(MOST[1] / height);
        // Even numbers, as video encoders ask for.
        let even = |pixels: f64| 2.0 * (0.5 * pixels.max(LEAST)).round();
        Self {
            plot: Rect::new(96.0, 56.0, even(scale * width), even(scale * height)),
            ends,
            names: section.names.map(String::from),
            limits: layer.limits,
            label: layer.label.into(),
            signed: layer.signed,
        }
    }

    fn map(&self) -> Map {
        if self.signed { Map::signed() } else { Map::viridis() }
    }

    fn canvas(&self) -> Canvas {
        let Self { plot, ends, names, limits, label, .. } = self;
        let mut canvas = Canvas::new(plot.right() as usize + 140, plot.bottom() as usize + 66);
        // Millimetres or metres.
        let longest = ends.iter().map(|(from, to)| to - from).fold(0.0, f64::max);
        let (name, per_metre) = if longest < 0.5 { ("mm", 1e3) } else { ("m", 1.0) };
        let [x, y] = ends.map(|(from, to)| (per_metre * from, per_metre * to));
        let axes = Axes { rect: *plot, x, y };
        axes.bottom(&mut canvas, LOOK, &format!("{} in {name}", names[0]));
        axes.left(&mut canvas, LOOK, &format!("{} in {name}", names[1]));
        axes.frame(&mut canvas, LOOK);
        let bar = Rect::new(plot.right() + 22.0, plot.top, 18.0, plot.height);
        colour_bar(&mut canvas, bar, &self.map(), (limits[0], limits[1]), label, LOOK);
        canvas
    }
}

/// What sections are drawn on, one after the other: axes and colour bar are drawn anew only where they change.
#[derive(Default)]
pub struct Sheet(Option<Kept>);

struct Kept {
    ground: Ground,
    canvas: Canvas,
    /// The pixels above the plot, where the title comes.
    head: Vec<u8>,
}

impl Section<'_> {
    /// Writes the picture.
    ///
    /// # Errors
    /// What writing the file answers.
    pub fn draw(&self, sheet: &mut Sheet, path: &Path, layer: &Layer<'_>, title: &str) -> io::Result<()> {
        let ground = Ground::new(self, layer);
        let (plot, map) = (ground.plot, ground.map());
        let top = plot.top as usize;
        let kept = sheet.0.take().filter(|kept| kept.ground == ground);
        let Kept { canvas, head, .. } = sheet.0.insert(kept.unwrap_or_else(|| {
            let mut canvas = ground.canvas();
            Kept { head: canvas.upper(top).to_vec(), ground, canvas }
        }));
        canvas.upper(top).copy_from_slice(head);
        self.paint(canvas, plot, layer, &map);
        canvas.text((plot.left, plot.top - 20.0), Type::new(1.2 * LOOK.font, (0.0, 0.0)), title);
        canvas.save(path)
    }

    fn paint(&self, canvas: &mut Canvas, plot: Rect, layer: &Layer<'_>, map: &Map) {
        let columns = places(self.across, plot.width as usize, false);
        let rows = places(self.up, plot.height as usize, true);
        let n = self.across.len() - 1;
        let [low, high] = layer.limits;
        let per_value = 1.0 / (high - low);
        let solid_rows: Vec<bool> = layer.solid.map_or(vec![false; self.up.len()], |all| {
            all.chunks_exact(n).map(|row| row.iter().any(|share| *share > 0.0)).collect()
        });
        let mut values = Stretched::new(layer.values, n, &columns);
        let mut solid = layer.solid.map(|all| Stretched::new(all, n, &columns));
        let left = plot.left as usize;
        for (y, row) in rows.iter().enumerate() {
            let values = values.at(row, |value| (value - low) * per_value);
            let pixels = canvas.row(plot.top as usize + y, left, left + columns.len()).as_chunks_mut().0;
            match &mut solid {
                Some(solid) if solid_rows[row.0] || solid_rows[row.1] => {
                    let shares = solid.at(row, |share| share.clamp(0.0, 1.0));
                    for (pixel, (value, share)) in pixels.iter_mut().zip(values.iter().zip(shares)) {
                        *pixel = lightened(map.at((*value).into()), (*share).into(), layer.solids_alone);
                    }
                }
                _ if layer.solids_alone => pixels.fill(WHITE),
                _ => map.row(values, pixels),
            }
        }
    }
}

/// A colour in a solid, which a line surrounds where half of a cell is solid; of nothing but solids all else is white.
fn lightened(colour: Colour, share: f64, alone: bool) -> Colour {
    if share <= 0.0 {
        return if alone { WHITE } else { colour };
    }
    let colour = if alone { mix(WHITE, colour, share) } else { mix(colour, WHITE, 0.55 * share) };
    let away = (share - 0.5).abs();
    if away < 0.25 { mix(colour, BLACK, 0.9 - 3.6 * away) } else { colour }
}

/// Lower cell, upper cell, share of the upper.
type Place = (usize, usize, f64);

/// A field as rows of pixels: of its rows of cells two are kept as wide as the picture, which many rows of pixels share.
struct Stretched<'a> {
    field: &'a [f64],
    cells: usize,
    columns: &'a [Place],
    kept: [(Option<usize>, Vec<f32>); 2],
    row: Vec<f32>,
}

impl<'a> Stretched<'a> {
    fn new(field: &'a [f64], cells: usize, columns: &'a [Place]) -> Self {
        let row = || vec![0.0; columns.len()];
        Self { field, cells, columns, kept: [(None, row()), (None, row())], row: row() }
    }

    /// The row at this place between two rows of cells, of what `of` makes of the values.
    fn at(&mut self, &(low, high, t): &Place, of: impl Fn(f64) -> f64) -> &[f32] {
        // The next row upwards was the lower one of two, or is one of two others.
        if self.kept[0].0 == Some(high) {
            self.kept.swap(0, 1);
        }
        for (row, (number, kept)) in [low, high].into_iter().zip(&mut self.kept) {
            if *number != Some(row) {
                let line = &self.field[row * self.cells..][..self.cells];
                for (kept, &(left, right, t)) in kept.iter_mut().zip(self.columns) {
                    *kept = of(line[left] + t * (line[right] - line[left])) as f32;
                }
                *number = Some(row);
            }
        }
        let [(_, lower), (_, upper)] = &self.kept;
        let t = t as f32;
        for (out, (a, b)) in self.row.iter_mut().zip(lower.iter().zip(upper)) {
            *out = a + t * (b - a);
        }
        &self.row
    }
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

    /// A picture is the same whatever was drawn on its sheet before.
    #[test]
    fn pictures_do_not_depend_on_those_before() {
        let faces: Vec<f64> = (0..=8).map(|i| 0.125 * f64::from(i)).collect();
        let section = Section { across: &faces, up: &faces, names: ["x", "y"] };
        let values: Vec<f64> = (0..64).map(|i| f64::from(i) / 63.0).collect();
        let solid: Vec<f64> = (0..64).map(|i| if (24..40).contains(&i) { 1.0 } else { 0.0 }).collect();
        let layer = |high, solid, alone| Layer {
            values: &values,
            solid,
            solids_alone: alone,
            limits: [0.0, high],
            label: "speed",
            signed: false,
        };
        let layers = [
            (layer(1.0, None, false), "t = 1"),
            (layer(1.0, Some(&solid[..]), false), "t = 22222"),
            (layer(2.0, Some(&solid[..]), true), ""),
            (layer(1.0, None, false), "t = 1"),
        ];
        let path = std::env::temp_dir().join(format!("siltflow-sheet-{}.png", std::process::id()));
        let mut sheet = Sheet::default();
        let draw = |sheet: Option<&mut Sheet>, (layer, title): &(Layer<'_>, &str)| {
            section.draw(sheet.unwrap_or(&mut Sheet::default()), &path, layer, title).unwrap();
            std::fs::read(&path).unwrap()
        };
        let pictures: Vec<Vec<u8>> = layers
            .iter()
            .map(|layer| {
                let kept = draw(Some(&mut sheet), layer);
                assert_eq!(kept, draw(None, layer));
                kept
            })
            .collect();
        std::fs::remove_file(&path).unwrap();
        assert!(pictures[0] == pictures[3] && pictures[0] != pictures[1] && pictures[1] != pictures[2]);
    }
}
