//! A bitmap to draw on: anti-aliased lines and circles, written as PNG.

use crate::files::write_over;
use std::io;
use std::path::Path;

use png::{BitDepth, ColorType, Compression, Encoder, Filter};

use crate::colour::{Colour, mix};

/// A point on the canvas in pixels: x to the right, y downwards.
pub(crate) type Pixel = (f64, f64);

/// A rectangle on the canvas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rect {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) width: f64,
    pub(crate) height: f64,
}

impl Rect {
    pub(crate) fn new(left: f64, top: f64, width: f64, height: f64) -> Self {
        Self { left, top, width, height }
    }

    pub(crate) fn right(&self) -> f64 {
        self.left + self.width
    }

    pub(crate) fn bottom(&self) -> f64 {
        self.top + self.height
    }
}

/// The bitmap.
#[derive(Clone)]
pub(crate) struct Canvas {
    width: usize,
    height: usize,
    rgb: Vec<u8>,
    /// Coverage of the line at work; zero between lines, empty before the first.
    mask: Vec<f32>,
    clip: [i32; 4],
}

impl Canvas {
    /// A white canvas.
    pub(crate) fn new(width: usize, height: usize) -> Self {
        let clip = [0, 0, width as i32, height as i32];
        Self { width, height, rgb: vec![u8::MAX; 3 * width * height], mask: Vec::new(), clip }
    }

    /// Keeps what follows inside `rect`, or lifts that with `None`.
    pub(crate) fn clip(&mut self, rect: Option<Rect>) {
        let (w, h) = (self.width as i32, self.height as i32);
        self.clip = rect.map_or([0, 0, w, h], |r| {
            let edge = |x: f64, limit: i32| (x.round() as i32).clamp(0, limit);
            [edge(r.left, w), edge(r.top, h), edge(r.right(), w), edge(r.bottom(), h)]
        });
    }

    /// Lays `colour` over one pixel.
    #[inline]
    pub(crate) fn blend(&mut self, x: i32, y: i32, colour: Colour, share: f64) {
        let [left, top, right, bottom] = self.clip;
        if (left..right).contains(&x) && (top..bottom).contains(&y) {
            let at = 3 * (y as usize * self.width + x as usize);
            let old = [self.rgb[at], self.rgb[at + 1], self.rgb[at + 2]];
            self.rgb[at..at + 3].copy_from_slice(&mix(old, colour, share.clamp(0.0, 1.0)));
        }
    }

    /// The pixels `[left, right)` of row `y`, three bytes each.
    pub(crate) fn row(&mut self, y: usize, left: usize, right: usize) -> &mut [u8] {
        let start = y * self.width;
        &mut self.rgb[3 * (start + left)..3 * (start + right)]
    }

    /// The uppermost rows.
    pub(crate) fn upper(&mut self, rows: usize) -> &mut [u8] {
        &mut self.rgb[..3 * rows * self.width]
    }

    /// A filled rectangle with edges on whole pixels.
    pub(crate) fn fill(&mut self, rect: Rect, colour: Colour, share: f64) {
        let [left, top, right, bottom] = self.clip;
        let within = |from: f64, to: f64, [low, high]: [i32; 2]| {
            let end = |x: f64| (x.round() as i32).clamp(low, high) as usize;
            end(from)..end(to)
        };
        let across = within(rect.left, rect.right(), [left, right]);
        for y in within(rect.top, rect.bottom(), [top, bottom]) {
            for pixel in self.row(y, across.start, across.end.max(across.start)).as_chunks_mut().0 {
                *pixel = if share < 1.0 { mix(*pixel, colour, share) } else { colour };
            }
        }
    }

    /// Pixels of the clip that a box reaches.
    fn reach(&self, x0: f64, y0: f64, x1: f64, y1: f64) -> (std::ops::Range<i32>, std::ops::Range<i32>) {
        let [left, top, right, bottom] = self.clip;
        let low = |x: f64, limit: i32| (x.floor() as i32 - 1).max(limit);
        let high = |x: f64, limit: i32| (x.ceil() as i32 + 1).min(limit);
        (low(x0, left)..high(x1, right), low(y0, top)..high(y1, bottom))
    }

    /// A line through `points`, of one piece: where it meets itself nothing is laid twice.
    pub(crate) fn line(&mut self, points: &[Pixel], width: f64, colour: Colour) {
        let half = 0.5 * width;
        self.mask.resize(self.width * self.height, 0.0);
        let mut hull = [f64::MAX, f64::MAX, f64::MIN, f64::MIN];
        for pair in points.windows(2) {
            let [a, b] = [pair[0], pair[1]];
            let bounds = [a.0.min(b.0), a.1.min(b.1), a.0.max(b.0), a.1.max(b.1)];
            let [x0, y0, x1, y1] = [bounds[0] - half, bounds[1] - half, bounds[2] + half, bounds[3] + half];
            hull = [hull[0].min(x0), hull[1].min(y0), hull[2].max(x1), hull[3].max(y1)];
            let (columns, rows) = self.reach(x0, y0, x1, y1);
            let (dx, dy) = (b.0 - a.0, b.1 - a.1);
            let length = (dx * dx + dy * dy).max(1e-12);
            for y in rows {
                for x in columns.clone() {
                    let (px, py) = (f64::from(x) + 0.5 - a.0, f64::from(y) + 0.5 - a.1);
                    let along = ((px * dx + py * dy) / length).clamp(0.0, 1.0);
                    let away = (px - along * dx).hypot(py - along * dy);
                    let cover = (half + 0.5 - away).clamp(0.0, width.min(1.0)) as f32;
                    let cell = &mut self.mask[y as usize * self.width + x as usize];
                    *cell = cell.max(cover);
                }
            }
        }
        if hull[0] > hull[2] {
            return;
        }
        let (columns, rows) = self.reach(hull[0], hull[1], hull[2], hull[3]);
        for y in rows {
            for x in columns.clone() {
                let cover = std::mem::take(&mut self.mask[y as usize * self.width + x as usize]);
                if cover > 0.0 {
                    self.blend(x, y, colour, f64::from(cover));
                }
            }
        }
    }

    /// A disc of the given colour and opacity.
    pub(crate) fn disc(&mut self, centre: Pixel, radius: f64, colour: Colour, opacity: f64) {
        self.round(centre, radius, |away| opacity * (radius + 0.5 - away).clamp(0.0, 1.0), colour);
    }

    /// A circle drawn with a line of the given width.
    pub(crate) fn circle(&mut self, centre: Pixel, radius: f64, width: f64, colour: Colour) {
        let half = 0.5 * width;
        let cover = |away: f64| (half + 0.5 - (away - radius).abs()).clamp(0.0, width.min(1.0));
        self.round(centre, radius + half, cover, colour);
    }

    fn round(&mut self, centre: Pixel, reach: f64, cover: impl Fn(f64) -> f64, colour: Colour) {
        let (x, y) = centre;
        let (columns, rows) = self.reach(x - reach, y - reach, x + reach, y + reach);
        for j in rows {
            for i in columns.clone() {
                let share = cover((f64::from(i) + 0.5 - x).hypot(f64::from(j) + 0.5 - y));
                if share > 0.0 {
                    self.blend(i, j, colour, share);
                }
            }
        }
    }

    /// Writes the canvas as an RGB picture.
    pub(crate) fn save(&self, path: &Path) -> io::Result<()> {
        write_over(path, |out| {
            let mut encoder = Encoder::new(out, self.width as u32, self.height as u32);
            encoder.set_color(ColorType::Rgb);
            encoder.set_depth(BitDepth::Eight);
            encoder.set_compression(Compression::Fast);
            encoder.set_filter(Filter::Up);
            let mut writer = encoder.write_header().map_err(io::Error::other)?;
            writer.write_image_data(&self.rgb).map_err(io::Error::other)?;
            writer.finish().map_err(io::Error::other)
        })
    }
}
