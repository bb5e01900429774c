//! Sections of bodies through the plane of a picture: the share of each pixel inside, and outlines.

use interfaces::{Point, Pose, Solid};

use crate::canvas::Rect;

/// A body where it is, and the plane of the picture: both axes, and a point of the plane \[m\].
#[derive(Clone, Copy)]
pub struct BodySection<'a> {
    /// The shape.
    pub solid: &'a dyn Solid,
    /// Centre of mass and orientation, of the periodic image that is drawn.
    pub pose: Pose,
    /// Axes across and up.
    pub axes: [usize; 2],
    /// Coordinates of the plane; those along its axes are not used.
    pub plane: [f64; 3],
}

/// Width of an outline \[pixels\].
const LINE: f64 = 2.0;
/// Edge of a block of pixels that is divided only if a surface crosses it, coarse and fine.
const BLOCKS: [usize; 2] = [48, 8];

/// Coverage of the pixels of a plot, by rows from the top.
pub(crate) struct Mask {
    width: usize,
    height: usize,
    /// Share of the pixel inside a body, and share under an outline, in 255ths.
    shares: Vec<[u8; 2]>,
    rows: Vec<bool>,
}

impl Mask {
    /// Bodies on a plot of the plane between `ends` of both axes \[m\].
    pub(crate) fn new(plot: Rect, ends: [(f64, f64); 2], bodies: &[BodySection<'_>]) -> Self {
        let (width, height) = (plot.width as usize, plot.height as usize);
        let mut mask =
            Self { width, height, shares: vec![[0; 2]; width * height], rows: vec![false; height] };
        let pixel = [(ends[0].1 - ends[0].0) / plot.width, (ends[1].1 - ends[1].0) / plot.height];
        let stamp = Stamp { corner: [ends[0].0, ends[1].1], pixel };
        bodies.iter().for_each(|body| stamp.lay(&mut mask, body));
        mask
    }

    /// The shares of a row of pixels; `None` if no body is in it.
    pub(crate) fn row(&self, y: usize) -> Option<impl Iterator<Item = [f64; 2]> + '_> {
        let row = self.rows[y].then(|| &self.shares[y * self.width..][..self.width]);
        row.map(|row| row.iter().map(|shares| shares.map(|share| f64::from(share) / 255.0)))
    }

    fn add(&mut self, x: usize, y: usize, shares: [f64; 2]) {
        let [inside, line] = shares.map(|share| (255.0 * share).round() as u8);
        let share = &mut self.shares[y * self.width + x];
        *share = [share[0].max(inside), share[1].max(line)];
        self.rows[y] = true;
    }
}

/// Pixels in the plane: the upper left corner and the edges of a pixel \[m\].
struct Stamp {
    corner: [f64; 2],
    pixel: [f64; 2],
}

/// A block of pixels: columns and rows from, to.
type Block = [[usize; 2]; 2];

impl Stamp {
    /// A point of the plane from pixels, in the body's frame.
    fn point(&self, body: &BodySection<'_>, x: f64, y: f64) -> Point {
        let mut at = Point::from(body.plane);
        at[body.axes[0]] = self.corner[0] + x * self.pixel[0];
        at[body.axes[1]] = self.corner[1] - y * self.pixel[1];
        body.pose.to_body(at)
    }

    fn lay(&self, mask: &mut Mask, body: &BodySection<'_>) {
        let bounds = body.solid.aabb().posed(&body.pose);
        let [a, b] = body.axes;
        let reach = |from: f64, to: f64, pixels: usize| {
            let end = |x: f64| x.clamp(0.0, pixels as f64) as usize;
            [end(from.floor() - LINE), end(to.ceil() + LINE)]
        };
        let across = [bounds.min[a], bounds.max[a]].map(|x| (x - self.corner[0]) / self.pixel[0]);
        let down = [bounds.max[b], bounds.min[b]].map(|y| (self.corner[1] - y) / self.pixel[1]);
        let block = [reach(across[0], across[1], mask.width), reach(down[0], down[1], mask.height)];
        self.divide(mask, body, block, &BLOCKS);
    }

    /// Fills blocks inside, leaves out those outside, and divides the others down to pixels.
    fn divide(&self, mask: &mut Mask, body: &BodySection<'_>, [columns, rows]: Block, edges: &[usize]) {
        let Some((&edge, finer)) = edges.split_first() else {
            return self.pixels(mask, body, [columns, rows]);
        };
        for y in (rows[0]..rows[1]).step_by(edge) {
            for x in (columns[0]..columns[1]).step_by(edge) {
                let block = [[x, (x + edge).min(columns[1])], [y, (y + edge).min(rows[1])]];
                let [middle, half] =
                    [0.5, -0.5].map(|sign| block.map(|[from, to]| 0.5 * to as f64 + sign * from as f64));
                let margin = LINE * self.pixel[0].max(self.pixel[1]);
                let radius = (half[0] * self.pixel[0]).hypot(half[1] * self.pixel[1]) + margin;
                let point = self.point(body, middle[0], middle[1]);
                let distance = body.solid.signed_distance(point, radius);
                if distance.abs() < radius {
                    self.divide(mask, body, block, finer);
                } else if distance < 0.0 {
                    for y in block[1][0]..block[1][1] {
                        (block[0][0]..block[0][1]).for_each(|x| mask.add(x, y, [1.0, 0.0]));
                    }
                }
            }
        }
    }

    /// Distances in pixels are those to the surface over their slope in the plane.
    fn pixels(&self, mask: &mut Mask, body: &BodySection<'_>, [columns, rows]: Block) {
        let n = columns[1] - columns[0] + 2;
        let band = 4.0 * LINE * self.pixel[0].max(self.pixel[1]);
        let points: Vec<Point> = (rows[0]..rows[1] + 2)
            .flat_map(|y| (columns[0]..columns[1] + 2).map(move |x| (x, y)))
            .map(|(x, y)| self.point(body, x as f64 - 0.5, y as f64 - 0.5))
            .collect();
        let mut distances = vec![0.0; points.len()];
        body.solid.signed_distances(&points, band, &mut distances);
        for y in rows[0]..rows[1] {
            for x in columns[0]..columns[1] {
                let at = (y - rows[0] + 1) * n + x - columns[0] + 1;
                let d = distances[at];
                // The larger of both sides: a thin body's middle has no slope.
                let slope = |k: usize| (distances[at + k] - d).abs().max((d - distances[at - k]).abs());
                let steepest = slope(1).hypot(slope(n));
                let away = if steepest > 0.0 { d / steepest } else { d.signum() * f64::INFINITY };
                let inside = (0.5 - away).clamp(0.0, 1.0);
                let line = (0.5 * LINE + 0.5 - away.abs()).clamp(0.0, 1.0);
                if inside > 0.0 || line > 0.0 {
                    mask.add(x, y, [inside, line]);
                }
            }
        }
    }
}
