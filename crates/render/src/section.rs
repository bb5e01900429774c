//! One field on a plane grid, equal cells or not, as a picture: colour bar, axes, solids lightened.

use std::io;
use std::path::Path;

use crate::axes::{Axes, Look, colour_bar};
use crate::canvas::{Canvas, Rect};
use crate::colour::{BLACK, Colour, Map, WHITE, mix};
use crate::outlines::Mask;
use crate::text::{Type, width, wrapped};

pub use crate::outlines::BodySection;

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
#[derive(Clone)]
pub struct Layer<'a> {
    /// The field.
    pub values: &'a [f64],
    /// Solid fraction of cells, for solids without a shape.
    pub solid: Option<&'a [f64]>,
    /// Bodies, outlined at the resolution of the picture.
    pub bodies: &'a [BodySection<'a>],
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
/// Least width of a picture \[pixels\]: titles of narrow boxes wrap there.
const LEAST_WIDTH: f64 = 480.0;
/// Font size of the title, and pixels from one of its lines to the next.
const TITLE: [f64; 2] = [1.2 * LOOK.font, 26.0];
/// Digits for which the line of the title has room: pictures of a run keep their size.
const RESERVED: &str = "000000000000000000000000";
/// Margins around the plot \[pixels\]: left, above, right, below.
const MARGINS: [f64; 4] = [96.0, 56.0, 140.0, 66.0];

/// Pixels of the plot of a section of this width and height \[m\]: even numbers, as video encoders
/// need.
fn plot_of(width: f64, height: f64) -> [f64; 2] {
    let scale = (MOST[0] / width).min(MOST[1] / height);
    [width, height].map(|length| 2.0 * (0.5 * (scale * length).max(LEAST)).round())
}

/// Pixels of the picture of a section of this width and height \[m\] with a title of one line.
pub fn pixels(width: f64, height: f64) -> [usize; 2] {
    let [across, up] = plot_of(width, height);
    let [left, above, right, below] = MARGINS;
    [(left + across + right).max(LEAST_WIDTH) as usize, (above + up + below) as usize]
}

/// What stays from one picture to the next: axes, colour bar and the labels of both.
#[derive(Clone, Debug, PartialEq)]
struct Ground {
    plot: Rect,
    width: f64,
    ends: [(f64, f64); 2],
    names: [String; 2],
    limits: [f64; 2],
    label: String,
    signed: bool,
}

impl Ground {
    /// The ground, and the lines of the title.
    fn new(section: &Section<'_>, layer: &Layer<'_>, title: [&str; 2]) -> (Self, Vec<String>) {
        let ends = [section.across, section.up].map(|faces| match faces {
            [first, .., last] => (*first, *last),
            _ => (0.0, 1.0),
        });
        let [width, height] = ends.map(|(from, to)| to - from);
        let [across, up] = plot_of(width, height);
        let [left, above, right, _] = MARGINS;
        let width = (left + across + right).max(LEAST_WIDTH);
        let lines = heading(title, width - left - 20.0);
        let top = above + TITLE[1] * (lines.len().max(1) - 1) as f64;
        let ground = Self {
            plot: Rect::new(left, top, across, up),
            width,
            ends,
            names: section.names.map(String::from),
            limits: layer.limits,
            label: layer.label.into(),
            signed: layer.signed,
        };
        (ground, lines)
    }

    fn map(&self) -> Map {
        if self.signed { Map::signed() } else { Map::viridis() }
    }

    fn canvas(&self) -> Canvas {
        let Self { plot, width, ends, names, limits, label, .. } = self;
        let mut canvas = Canvas::new(*width as usize, (plot.bottom() + MARGINS[3]) as usize);
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
    /// Writes the picture with a title and a state (time, iteration) above it, on one line if there
    /// is room, otherwise wrapped.
    ///
    /// # Errors
    /// Errors of writing the file.
    pub fn draw(
        &self,
        sheet: &mut Sheet,
        path: &Path,
        layer: &Layer<'_>,
        title: [&str; 2],
    ) -> io::Result<()> {
        let (ground, lines) = Ground::new(self, layer, title);
        let (plot, map, ends) = (ground.plot, ground.map(), ground.ends);
        let top = plot.top as usize;
        let kept = sheet.0.take().filter(|kept| kept.ground == ground);
        let Kept { canvas, head, .. } = sheet.0.insert(kept.unwrap_or_else(|| {
            let mut canvas = ground.canvas();
            Kept { head: canvas.upper(top).to_vec(), ground, canvas }
        }));
        canvas.upper(top).copy_from_slice(head);
        let bodies = (!layer.bodies.is_empty()).then(|| Mask::new(plot, ends, layer.bodies));
        self.paint(canvas, plot, layer, &map, bodies.as_ref());
        for (row, line) in lines.iter().rev().enumerate() {
            let base = plot.top - 20.0 - TITLE[1] * row as f64;
            canvas.text((plot.left, base), Type::new(TITLE[0], (0.0, 0.0)), line);
        }
        canvas.save(path)
    }

    fn paint(&self, canvas: &mut Canvas, plot: Rect, layer: &Layer<'_>, map: &Map, bodies: Option<&Mask>) {
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
            if let Some(shares) = bodies.and_then(|bodies| bodies.row(y)) {
                for (pixel, (value, share)) in pixels.iter_mut().zip(values.iter().zip(shares)) {
                    *pixel = outlined(map.at((*value).into()), share, layer.solids_alone);
                }
                continue;
            }
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

/// Title and state on lines of so many pixels.
fn heading([title, state]: [&str; 2], room: f64) -> Vec<String> {
    let mut lines = wrapped(TITLE[0], title, room);
    let reserved = width(TITLE[0], RESERVED).max(width(TITLE[0], state));
    match lines.last_mut() {
        _ if state.is_empty() => {}
        Some(last) if width(TITLE[0], last) + reserved <= room => *last += &format!("   {state}"),
        _ => lines.extend(wrapped(TITLE[0], state, room)),
    }
    lines
}

/// A colour under shares of a body's inside and of its outline; of nothing but solids all else is
/// white.
fn outlined(colour: Colour, [inside, line]: [f64; 2], alone: bool) -> Colour {
    let colour = if alone { mix(WHITE, colour, inside) } else { mix(colour, WHITE, 0.55 * inside) };
    if line > 0.0 { mix(colour, BLACK, 0.9 * line) } else { colour }
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
            bodies: &[],
            solids_alone: alone,
            limits: [0.0, high],
            label: "speed",
            signed: false,
        };
        let layers = [
            (layer(1.0, None, false), ["cells", "t = 1"]),
            (layer(1.0, Some(&solid[..]), false), ["cells", "t = 22222"]),
            (layer(2.0, Some(&solid[..]), true), ["", ""]),
            (layer(1.0, None, false), ["cells", "t = 1"]),
        ];
        let path = std::env::temp_dir().join(format!("siltflow-sheet-{}.png", std::process::id()));
        let mut sheet = Sheet::default();
        let draw = |sheet: Option<&mut Sheet>, (layer, title): &(Layer<'_>, [&str; 2])| {
            section.draw(sheet.unwrap_or(&mut Sheet::default()), &path, layer, *title).unwrap();
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

    const LONG: [&str; 2] = ["A heavy ellipse that settles in a tall channel of water", "t = 12.3456 s"];

    /// Title and time of a narrow, tall box fit its picture, and do so at any time.
    #[test]
    fn headings_of_tall_boxes_fit() {
        let (across, up) = ([0.0, 0.5, 1.0], [0.0, 4.0, 8.0]);
        let section = Section { across: &across, up: &up, names: ["x", "y"] };
        let values = [0.0; 4];
        let layer = Layer {
            values: &values,
            solid: None,
            bodies: &[],
            solids_alone: false,
            limits: [0.0, 1.0],
            label: "speed",
            signed: false,
        };
        let (ground, lines) = Ground::new(&section, &layer, LONG);
        assert!(lines.len() > 1, "{lines:?}");
        assert_eq!(lines.join(" ").split_whitespace().collect::<Vec<_>>().join(" "), LONG.join(" "));
        for line in &lines {
            assert!(ground.plot.left + width(TITLE[0], line) < ground.width, "{line}");
        }
        let later = Ground::new(&section, &layer, [LONG[0], "t = 123456.7890 s"]).0;
        assert!(later == ground && ground.plot.top > MARGINS[1]);
    }

    /// The outline of an ellipse on cells of an eighth of its length is the ellipse to a pixel.
    #[test]
    fn outlines_are_those_of_the_shape() {
        let semi_axes = [0.4, 0.15];
        let solid = dem::Ellipsoid::new([semi_axes[0], semi_axes[1], 0.3]).unwrap();
        let pose = interfaces::Pose::at([0.5, 0.5, 0.25]);
        let body = BodySection { solid: &solid, pose, axes: [0, 1], plane: [0.0, 0.0, 0.25] };
        let plot = Rect::new(0.0, 0.0, 400.0, 400.0);
        let mask = Mask::new(plot, [(0.0, 1.0); 2], &[body]);
        let mut area = 0.0;
        for y in 0..400 {
            for (x, [inside, line]) in mask.row(y).into_iter().flatten().enumerate() {
                area += inside;
                let at = [x as f64 + 0.5 - 200.0, y as f64 + 0.5 - 200.0];
                let level = (at[0] / (400.0 * semi_axes[0])).hypot(at[1] / (400.0 * semi_axes[1]));
                // A pixel is at most 1/60 of the level; lines are two wide.
                if line > 0.0 {
                    assert!((level - 1.0).abs() < 2.5 / 60.0, "line at {at:?}, level {level}");
                }
                if (level - 1.0).abs() < 0.3 / 160.0 {
                    assert!(line > 0.6, "gap at {at:?}: {line}");
                }
            }
        }
        let exact = std::f64::consts::PI * semi_axes[0] * semi_axes[1] * 160_000.0;
        assert!((area / exact - 1.0).abs() < 1e-3, "{area} of {exact}");
    }
}
