//! Pictures of a plane flow with round bodies, one PNG per snapshot.
use crate::axes::{Axes, Look, colour_bar};
use crate::canvas::{Canvas, Rect};
use crate::colour::{self, BLACK, Map, WHITE, mix};
use crate::text::Type;
use std::io;
use std::path::Path;

/// A field at the cell centres of a uniform grid over the [`Domain`]: x runs fastest, y upwards.
#[derive(Clone, Copy, Debug)]
pub struct Scalar<'a> {
    /// Cells along x.
    pub nx: usize,
    /// Cells along y.
    pub ny: usize,
    /// One value per cell.
    pub values: &'a [f64],
}

/// A round body as a picture shows it. In a periodic direction the centre may lie outside the domain.
#[derive(Clone, Copy, Debug)]
pub struct Disc {
    /// Centre in metres.
    pub x: f64,
    /// Centre in metres.
    pub y: f64,
    /// Radius in metres.
    pub radius: f64,
    /// Angle turned since the start, in radians: shown by a mark from the centre to the rim.
    pub angle: f64,
}

/// The rectangle all pictures of a run are taken of.
#[derive(Clone, Copy, Debug)]
pub struct Domain {
    /// Extent along x in metres.
    pub width: f64,
    /// Extent along y in metres.
    pub height: f64,
    /// Which directions wrap around.
    pub periodic: [bool; 2],
}

impl Domain {
    /// Where images of a disc reach into the domain.
    pub(crate) fn images(&self, disc: &Disc) -> Vec<(f64, f64)> {
        let along = |centre: f64, length: f64, periodic: bool| -> Vec<f64> {
            if !periodic {
                return vec![centre];
            }
            let inside = centre.rem_euclid(length);
            let images = [inside - length, inside, inside + length];
            images.into_iter().filter(|x| (-disc.radius..length + disc.radius).contains(x)).collect()
        };
        let rows = along(disc.y, self.height, self.periodic[1]);
        let columns = along(disc.x, self.width, self.periodic[0]);
        columns.iter().flat_map(|&x| rows.iter().map(move |&y| (x, y))).collect()
    }

    pub(crate) fn axes(&self, rect: Rect) -> Axes {
        Axes { rect, x: (0.0, 1e3 * self.width), y: (0.0, 1e3 * self.height) }
    }

    /// Draws the discs with outlines that show on dark and light ground alike.
    pub(crate) fn discs(&self, canvas: &mut Canvas, rect: Rect, discs: &[Disc], line: f64) {
        let scale = rect.width / self.width;
        canvas.clip(Some(rect));
        for disc in discs {
            let radius = disc.radius * scale;
            for (x, y) in self.images(disc) {
                let (x, y) = (rect.left + x * scale, rect.bottom() - y * scale);
                let rim = (x + radius * disc.angle.cos(), y - radius * disc.angle.sin());
                canvas.circle((x, y), radius + 0.5 * line, line, WHITE);
                canvas.circle((x, y), radius - 0.5 * line, line, BLACK);
                canvas.line(&[(x, y), rim], line, BLACK);
            }
        }
        canvas.clip(None);
    }
}

/// Where the pixels of one direction fall between cell centres: lower cell, upper cell, share of the upper.
fn lattice(pixels: usize, cells: usize, periodic: bool, flip: bool) -> Vec<(usize, usize, f64)> {
    let last = cells as isize - 1;
    let cell = |i: isize| (if periodic { i.rem_euclid(last + 1) } else { i.clamp(0, last) }) as usize;
    let place = |pixel: usize| {
        let pixel = if flip { pixels - 1 - pixel } else { pixel };
        let place = (pixel as f64 + 0.5) * cells as f64 / pixels as f64 - 0.5;
        (cell(place.floor() as isize), cell(place.floor() as isize + 1), place - place.floor())
    };
    (0..pixels).map(place).collect()
}

/// Paints `rect` pixel by pixel from fields on one grid, linearly between their cell centres.
pub(crate) fn paint<const N: usize>(
    canvas: &mut Canvas,
    rect: Rect,
    periodic: [bool; 2],
    fields: [&Scalar<'_>; N],
    colour: impl Fn([f64; N]) -> colour::Colour,
) {
    let Scalar { nx, ny, .. } = *fields[0];
    let columns = lattice(rect.width as usize, nx, periodic[0], false);
    let rows = lattice(rect.height as usize, ny, periodic[1], true);
    let (left, top) = (rect.left as usize, rect.top as usize);
    for (y, &(low, high, up)) in rows.iter().enumerate() {
        let row = canvas.row(top + y, left, left + columns.len());
        for (pixel, &(west, east, across)) in row.chunks_exact_mut(3).zip(&columns) {
            let sample = fields.map(|field| {
                let at = |row: usize| {
                    let line = &field.values[row * nx..(row + 1) * nx];
                    line[west] + across * (line[east] - line[west])
                };
                let below = at(low);
                below + up * (at(high) - below)
            });
            pixel.copy_from_slice(&colour(sample));
        }
    }
}

/// The frames of a run: everything that stays is drawn once, so a frame takes a few milliseconds.
/// Frames may be drawn from several threads at a time.
pub struct Frames {
    domain: Domain,
    ground: Canvas,
    plot: Rect,
    map: Map,
    max_speed: f64,
}

const FRAME: Look = Look { font: 15.0, line: 1.0 };

impl Frames {
    /// Colours run from rest to `max_speed` (m/s); what is faster takes the last colour.
    pub fn new(domain: Domain, max_speed: f64) -> Self {
        let scale = (880.0 / domain.height).min(1200.0 / domain.width);
        // Even numbers, as video encoders ask for.
        let (width, height) = ((scale * domain.width / 2.0).round() * 2.0, scale * domain.height);
        let plot = Rect::new(66.0, 52.0, width, (height / 2.0).round() * 2.0);
        let mut ground = Canvas::new(plot.right() as usize + 114, plot.bottom() as usize + 60);
        let axes = domain.axes(plot);
        axes.bottom(&mut ground, FRAME, "x in mm");
        axes.left(&mut ground, FRAME, "y in mm");
        axes.frame(&mut ground, FRAME);
        let map = Map::viridis();
        let bar = Rect::new(plot.right() + 22.0, plot.top, 18.0, plot.height);
        colour_bar(&mut ground, bar, &map, (0.0, 1e3 * max_speed), "speed |u| in mm/s", FRAME);
        Self { domain, ground, plot, map, max_speed }
    }

    /// Writes one frame: the speed of fluid and solid, the solid (λ) lightened, the bodies outlined.
    pub fn draw(
        &self,
        path: &Path,
        speed: &Scalar<'_>,
        lambda: &Scalar<'_>,
        discs: &[Disc],
        title: &str,
    ) -> io::Result<()> {
        let mut canvas = self.ground.clone();
        paint(&mut canvas, self.plot, self.domain.periodic, [speed, lambda], |[speed, lambda]| {
            mix(self.map.at(speed / self.max_speed), WHITE, 0.45 * lambda.clamp(0.0, 1.0))
        });
        self.domain.discs(&mut canvas, self.plot, discs, 1.6);
        let style = Type::new(1.2 * FRAME.font, (0.0, 0.0));
        canvas.text((self.plot.left, self.plot.top - 18.0), style, title);
        canvas.save(path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disc_on_a_corner_has_four_images() {
        let domain = Domain { width: 1.0, height: 2.0, periodic: [true, true] };
        let disc = |x, y| Disc { x, y, radius: 0.1, angle: 0.0 };
        assert_eq!(domain.images(&disc(0.95, 4.02)).len(), 4);
        assert_eq!(domain.images(&disc(-0.5, 1.0)), [(0.5, 1.0)]);
        let walled = Domain { periodic: [true, false], ..domain };
        assert_eq!(walled.images(&disc(0.95, 0.02)).len(), 2);
    }

    #[test]
    fn pixels_wrap_in_a_periodic_direction_only() {
        assert_eq!(lattice(4, 2, true, false)[0], (1, 0, 0.75));
        assert_eq!(lattice(4, 2, false, false)[0], (0, 0, 0.75));
        assert_eq!(lattice(4, 2, true, true)[0], lattice(4, 2, true, false)[3]);
    }
}
