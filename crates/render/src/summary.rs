//! The summary figure of a run: fields at a few times, paths, speeds.

use std::io;
use std::path::Path;

use crate::axes::{Axes, Look, colour_bar};
use crate::canvas::{Canvas, Pixel, Rect};
use crate::colour::{self, INK, Map, WHITE};
use crate::frames::{Disc, Domain, Scalar, paint};
use crate::text::{self, Type};

/// The fields at one time.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a> {
    /// Time in seconds.
    pub time: f64,
    /// Solid fraction.
    pub lambda: Scalar<'a>,
    /// Speed of fluid and solid in m/s.
    pub speed: Scalar<'a>,
    /// The bodies.
    pub discs: &'a [Disc],
}

/// The history of one body.
#[derive(Clone, Copy, Debug)]
pub struct Track<'a> {
    /// What the legend calls it.
    pub label: &'a str,
    /// Radius in metres.
    pub radius: f64,
    /// Times in seconds; as long as the three that follow.
    pub times: &'a [f64],
    /// Centre in metres, running on across periodic borders.
    pub x: &'a [f64],
    /// Centre in metres, running on across periodic borders.
    pub y: &'a [f64],
    /// Speed in m/s.
    pub speed: &'a [f64],
    /// Theory to compare with, as (time, speed); may be empty.
    pub theory: &'a [(f64, f64)],
}

/// What the figure shows.
#[derive(Clone, Copy, Debug)]
pub struct Summary<'a> {
    /// The rectangle.
    pub domain: Domain,
    /// Columns of fields from left to right; three make a balanced figure.
    pub moments: &'a [Moment<'a>],
    /// The bodies.
    pub tracks: &'a [Track<'a>],
    /// What the legend calls the theory.
    pub theory: &'a str,
}

const LOOK: Look = Look { font: 21.0, line: 2.0 };
const LEFT: f64 = 88.0;
const TOP: f64 = 62.0;
/// Height of both rows of fields and the gap between them.
const HEIGHT: f64 = 954.0;
const ROW_GAP: f64 = 34.0;
const COLUMN_GAP: f64 = 38.0;
/// Room for a colour bar with its numbers, and for what stands left of a plot.
const BAR_ROOM: f64 = 128.0;
const LABEL_ROOM: f64 = 104.0;
const FOOT: f64 = 82.0;
/// Size of the plots of speed over time.
const PLOT_WIDTH: f64 = 560.0;
const PLOT_GAP: f64 = 132.0;
const STROKE: f64 = 3.0;

impl Summary<'_> {
    /// Writes the figure.
    pub fn draw(&self, path: &Path) -> io::Result<()> {
        let fit = |width: f64, height: f64| {
            let scale = (width / self.domain.width).min(height / self.domain.height);
            ((scale * self.domain.width).round(), (scale * self.domain.height).round())
        };
        let field = fit(420.0, 0.5 * (HEIGHT - ROW_GAP));
        let fields = self.moments.len() as f64 * (field.0 + COLUMN_GAP) - COLUMN_GAP;
        let paths = fit(640.0, HEIGHT);
        let paths_left = LEFT + fields + BAR_ROOM + LABEL_ROOM;
        let plots_left = paths_left + paths.0 + LABEL_ROOM + 24.0;
        let latest = self.tracks.iter().flat_map(|t| t.times.last()).fold(0.0f64, |a, &b| a.max(b));
        let theory = self.tracks.iter().flat_map(|t| t.theory).fold(0.0f64, |a, &(time, _)| a.max(time));
        let plot = Rect::new(plots_left, TOP, PLOT_WIDTH, 0.5 * (HEIGHT - PLOT_GAP));
        let below = Rect { top: plot.bottom() + PLOT_GAP, ..plot };
        let ends = [if theory > 0.0 { below } else { plot }.bottom(), TOP + paths.1];
        let foot = ends.into_iter().fold(TOP + 2.0 * field.1 + ROW_GAP, f64::max);

        let mut canvas = Canvas::new((plot.right() + 30.0) as usize, (foot + FOOT) as usize);
        self.fields(&mut canvas, field);
        self.paths(&mut canvas, Rect::new(paths_left, TOP, paths.0, paths.1));
        self.speeds(&mut canvas, plot, latest, "speed of the bodies", false);
        if theory > 0.0 {
            self.speeds(&mut canvas, below, latest.min(1.1 * theory), "start-up", true);
        }
        canvas.save(path)
    }

    /// λ above, |u| below, one column per moment.
    fn fields(&self, canvas: &mut Canvas, (width, height): (f64, f64)) {
        let peak = self.moments.iter().flat_map(|m| m.speed.values).fold(0.0f64, |a, &b| a.max(b));
        let peak = if peak > 0.0 { peak } else { 1.0 };
        let maps = [Map::slate(), Map::viridis()];
        let mut rect = Rect::new(LEFT, TOP, width, height);
        for (column, moment) in self.moments.iter().enumerate() {
            let above = (rect.left + 0.5 * width, TOP - 18.0);
            canvas.text(above, Type::new(LOOK.font, (0.5, 0.0)), &format!("t = {:.3} s", moment.time));
            for row in 0..2 {
                let field = [&moment.lambda, &moment.speed][row];
                rect.top = TOP + row as f64 * (height + ROW_GAP);
                let range = [1.0, peak][row];
                let map = &maps[row];
                paint(canvas, rect, self.domain.periodic, [field], |[value]| map.at(value / range));
                if row == 1 {
                    self.domain.discs(canvas, rect, moment.discs, 1.5);
                }
                let axes = self.domain.axes(rect);
                axes.frame(canvas, LOOK);
                if row == 1 {
                    axes.bottom(canvas, LOOK, "x in mm");
                }
                if column == 0 {
                    axes.left(canvas, LOOK, "y in mm");
                }
            }
            rect.left += width + COLUMN_GAP;
        }
        let bar = |row: usize| {
            let top = TOP + row as f64 * (height + ROW_GAP);
            Rect::new(rect.left - COLUMN_GAP + 22.0, top, 20.0, height)
        };
        colour_bar(canvas, bar(0), &maps[0], (0.0, 1.0), "solid fraction λ", LOOK);
        colour_bar(canvas, bar(1), &maps[1], (0.0, 1e3 * peak), "speed |u| in mm/s", LOOK);
    }

    /// The paths of the centres, wrapped into the domain, with the bodies at the start and at the end.
    fn paths(&self, canvas: &mut Canvas, rect: Rect) {
        let axes = self.domain.axes(rect);
        axes.grid(canvas, LOOK);
        let style = Type::new(LOOK.font, (0.5, 0.0));
        canvas.text((rect.left + 0.5 * rect.width, rect.top - 18.0), style, "paths");
        canvas.clip(Some(rect));
        let scale = rect.width / self.domain.width;
        let Domain { width, height, periodic } = self.domain;
        for track in self.tracks {
            let ink = self.ink(track);
            // The whole path once for every period it passes through: the clip cuts out the piece inside.
            for dx in periods(track.x, width, periodic[0]) {
                for dy in periods(track.y, height, periodic[1]) {
                    let points = track.x.iter().zip(track.y);
                    let points = points.map(|(x, y)| axes.at(1e3 * (x - dx), 1e3 * (y - dy)));
                    canvas.line(&points.collect::<Vec<Pixel>>(), STROKE, ink);
                }
            }
        }
        for track in self.tracks {
            let ink = self.ink(track);
            let ends = [track.x.first().zip(track.y.first()), track.x.last().zip(track.y.last())];
            for (end, place) in ends.into_iter().enumerate() {
                let Some((&x, &y)) = place else { continue };
                for (x, y) in self.domain.images(&Disc { x, y, radius: track.radius, angle: 0.0 }) {
                    let centre = axes.at(1e3 * x, 1e3 * y);
                    canvas.disc(centre, track.radius * scale, [WHITE, ink][end], [0.6, 0.35][end]);
                    canvas.circle(centre, track.radius * scale, STROKE, ink);
                }
            }
        }
        canvas.clip(None);
        axes.frame(canvas, LOOK);
        axes.bottom(canvas, LOOK, "x in mm");
        axes.left(canvas, LOOK, "y in mm");
    }

    /// Speeds over time up to `end`, with the theory's points if `theory`.
    fn speeds(&self, canvas: &mut Canvas, rect: Rect, end: f64, title: &str, theory: bool) {
        let shown = |track: &Track<'_>| track.times.partition_point(|&t| t <= end * (1.0 + 1e-9));
        let curves = self.tracks.iter().flat_map(|t| t.speed[..shown(t)].iter().copied());
        let marks = self.tracks.iter().flat_map(|t| t.theory).filter(|_| theory).map(|&(_, speed)| speed);
        let top = curves.chain(marks).fold(0.0f64, f64::max);
        let (end, top) = (if end > 0.0 { end } else { 1.0 }, if top > 0.0 { 1.08e3 * top } else { 1.0 });
        // Milliseconds where seconds would be all zeros.
        let (unit, factor) = if end < 0.1 { ("t in ms", 1e3) } else { ("t in s", 1.0) };
        let axes = Axes { rect, x: (0.0, factor * end), y: (0.0, top) };
        axes.grid(canvas, LOOK);
        let middle = (rect.left + 0.5 * rect.width, rect.top - 18.0);
        canvas.text(middle, Type::new(LOOK.font, (0.5, 0.0)), title);
        canvas.clip(Some(rect));
        for track in self.tracks {
            let points = track.times.iter().zip(track.speed).take(shown(track) + 1);
            let points: Vec<Pixel> = points.map(|(t, v)| axes.at(factor * t, 1e3 * v)).collect();
            canvas.line(&points, STROKE, self.ink(track));
            for &(time, speed) in track.theory.iter().filter(|_| theory) {
                mark(canvas, axes.at(factor * time, 1e3 * speed), self.ink(track));
            }
        }
        canvas.clip(None);
        axes.frame(canvas, LOOK);
        axes.bottom(canvas, LOOK, unit);
        axes.left(canvas, LOOK, "speed in mm/s");
        self.legend(canvas, rect, theory);
    }

    /// The labels, each once: bodies of one label share a colour.
    fn kinds(&self) -> Vec<&str> {
        let mut kinds: Vec<&str> = Vec::new();
        for track in self.tracks {
            if !kinds.contains(&track.label) {
                kinds.push(track.label);
            }
        }
        kinds
    }

    /// The colour of a body.
    fn ink(&self, track: &Track<'_>) -> colour::Colour {
        colour::line(self.kinds().iter().position(|k| *k == track.label).unwrap_or(0))
    }

    /// Names of the lines: at the lower right, or with the theory at the upper left, where start-up leaves room.
    fn legend(&self, canvas: &mut Canvas, rect: Rect, theory: bool) {
        let (pad, key, line) = (14.0, 46.0, 1.5 * LOOK.font);
        let kinds = self.kinds();
        let names: Vec<&str> = kinds.iter().copied().chain(theory.then_some(self.theory)).collect();
        let widest = names.iter().map(|name| text::width(LOOK.font, name)).fold(0.0, f64::max);
        let (width, height) = (widest + key + 2.0 * pad, names.len() as f64 * line + pad);
        let corner = if theory {
            (rect.left + pad, rect.top + pad)
        } else {
            (rect.right() - width - pad, rect.bottom() - height - pad)
        };
        canvas.fill(Rect::new(corner.0, corner.1, width, height), WHITE, 0.85);
        for (row, name) in names.iter().enumerate() {
            let y = (corner.1 + 0.5 * pad + (row as f64 + 0.5) * line).round();
            let (from, to) = ((corner.0 + pad, y), (corner.0 + pad + key - 12.0, y));
            if row < kinds.len() {
                canvas.line(&[from, to], STROKE, colour::line(row));
            } else {
                mark(canvas, (0.5 * (from.0 + to.0), y), INK);
            }
            canvas.text((corner.0 + pad + key, y), Type::new(LOOK.font, (0.0, 0.5)), name);
        }
    }
}

/// A ring for a point of the theory.
fn mark(canvas: &mut Canvas, at: Pixel, ink: colour::Colour) {
    canvas.disc(at, 6.5, WHITE, 1.0);
    canvas.circle(at, 6.5, 2.5, ink);
}

/// The displacements by which a path must be taken back to pass through `[0, length]`.
fn periods(path: &[f64], length: f64, periodic: bool) -> Vec<f64> {
    if !periodic {
        return vec![0.0];
    }
    let low = path.iter().copied().fold(f64::INFINITY, f64::min);
    let high = path.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if low > high {
        return Vec::new();
    }
    ((low / length).floor() as i64..=(high / length).floor() as i64).map(|k| k as f64 * length).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_shows_in_every_period_it_visits() {
        assert_eq!(periods(&[0.5, -0.2, -1.4], 1.0, true), [-2.0, -1.0, 0.0]);
        assert_eq!(periods(&[0.5, -0.2], 1.0, false), [0.0]);
        assert!(periods(&[], 1.0, true).is_empty());
    }
}
