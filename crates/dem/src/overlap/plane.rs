//! Polygons with one another, with discs and with walls, in the plane.
mod closest;
mod ring;
#[cfg(test)]
mod tests;

pub(crate) use closest::closest;

use super::Overlap;
use crate::shapes::Piece;
use crate::{HalfSpace, Polygon};
use interfaces::{Point, Pose, Vector};
use nalgebra::{Matrix3, Vector2};
use ring::{Ring, Side};

/// Overlaps convex pieces of both, and puts together what hangs together over the cuts between them; keeps the memory that this takes.
///
/// With n outward along the border of the first body within the second: S = ∫ n dl and ∫ (x − c) × n dl are sums over straight edges; of a disc, over the edges of the polygon within it, as
/// the whole border of a region has none of both. Sums are taken about the first body's place.
#[derive(Clone, Debug, Default)]
pub(super) struct PlaneOverlap {
    corners: [Corners; 2],
    ring: Ring,
    parts: Vec<Part>,
    /// Pairs of pieces that share a place on a cut.
    joints: Vec<[[u32; 2]; 2]>,
    /// Square of the radius of the smaller of two pieces that may meet, the largest of all.
    scale: f64,
}

/// The corners of all pieces of a polygon in the world, and where those of each begin.
#[derive(Clone, Debug, Default)]
struct Corners {
    points: Vec<Vector2<f64>>,
    starts: Vec<usize>,
    middles: Vec<Vector2<f64>>,
}

/// What two pieces share.
#[derive(Clone, Copy, Debug, Default)]
struct Part {
    pieces: [u32; 2],
    /// The patch that it belongs to, by the number of its first part.
    patch: usize,
    sums: Sums,
}

#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    area: f64,
    /// ∫ x dA.
    first: Vector2<f64>,
    /// ∫ n dl.
    gradient: Vector2<f64>,
    /// ∫ x × n dl.
    moment: f64,
}

impl Sums {
    fn add(&mut self, other: &Self) {
        self.area += other.area;
        self.first += other.first;
        self.gradient += other.gradient;
        self.moment += other.moment;
    }
    /// A straight piece of the border of the first body, counter-clockwise.
    fn add_border(&mut self, [p, q]: [Vector2<f64>; 2]) {
        let n = Vector2::new(q.y - p.y, p.x - q.x);
        self.gradient += n;
        self.moment += (0.5 * (p + q)).perp(&n);
    }
}

impl Corners {
    /// Those of `shape` at `pose`, from `about`.
    fn place(&mut self, shape: &Polygon, pose: &Pose, about: Point) {
        let [x, y] = [Vector::x(), Vector::y()].map(|e| (pose.orientation * e).xy());
        let shift = (pose.position - about).xy();
        let world = |c: &Vector2<f64>| shift + x * c.x + y * c.y;
        self.points.clear();
        self.starts.clear();
        self.middles.clear();
        self.starts.push(0);
        for piece in shape.pieces() {
            self.points.extend(piece.corners.iter().map(world));
            self.starts.push(self.points.len());
            self.middles.push(world(&piece.middle));
        }
    }
    fn of(&self, piece: usize) -> &[Vector2<f64>] {
        &self.points[self.starts[piece]..self.starts[piece + 1]]
    }
}

/// All pieces with their numbers.
fn numbered(shape: &Polygon) -> impl Iterator<Item = (usize, &Piece)> {
    shape.pieces().iter().enumerate()
}

impl PlaneOverlap {
    pub(super) fn polygons(
        &mut self,
        a: &Polygon,
        at_a: &Pose,
        b: &Polygon,
        at_b: &Pose,
        out: &mut Vec<Overlap>,
    ) {
        self.start();
        self.corners[0].place(a, at_a, at_a.position);
        self.corners[1].place(b, at_b, at_a.position);
        for (i, piece) in numbered(a) {
            for (j, other) in numbered(b) {
                let reach = piece.radius + other.radius;
                if (self.corners[0].middles[i] - self.corners[1].middles[j]).norm_squared() >= reach * reach {
                    continue;
                }
                self.look(piece.radius.min(other.radius));
                self.ring.start(self.corners[0].of(i), &piece.beyond);
                self.ring.clip(self.corners[1].of(j), &other.beyond);
                self.sum([i, j].map(|k| k as u32));
            }
        }
        self.finish(at_a.position, (at_a.position - at_b.position).xy(), out);
    }

    pub(super) fn at_wall(&mut self, a: &Polygon, at: &Pose, wall: &HalfSpace, out: &mut Vec<Overlap>) {
        self.start();
        self.corners[0].place(a, at, at.position);
        let (normal, height) = (wall.normal().xy(), wall.signed_distance(at.position));
        for (i, piece) in numbered(a) {
            if normal.dot(&self.corners[0].middles[i]) + height >= piece.radius {
                continue;
            }
            self.look(piece.radius);
            self.ring.start(self.corners[0].of(i), &piece.beyond);
            self.ring.cut(|x| -(normal.dot(&x) + height), Side::Second(None));
            self.sum([i as u32, 0]);
        }
        self.finish(at.position, normal, out);
    }

    /// A disc of radius `r` at `at`, and a polygon.
    pub(super) fn disc(&mut self, r: f64, at: Point, b: &Polygon, at_b: &Pose, out: &mut Vec<Overlap>) {
        self.start();
        self.corners[1].place(b, at_b, at);
        for (j, piece) in numbered(b) {
            let reach = r + piece.radius;
            if self.corners[1].middles[j].norm_squared() >= reach * reach {
                continue;
            }
            self.look(r.min(piece.radius));
            let (corners, mut part) =
                (self.corners[1].of(j), Part { pieces: [0, j as u32], ..Part::default() });
            let mut crosses = false;
            for (k, p) in corners.iter().enumerate() {
                let q = &corners[(k + 1) % corners.len()];
                let Some([s, e]) = ring::within(r, p, q) else {
                    ring::sector(r, p, q, &mut part.sums);
                    continue;
                };
                crosses = true;
                ring::sector(r, p, &s, &mut part.sums);
                ring::triangle(&s, &e, &mut part.sums);
                ring::sector(r, &e, q, &mut part.sums);
                match piece.beyond[k] {
                    // The polygon's border, the other way round the disc's.
                    None => part.sums.add_border([e, s]),
                    Some(next) => self.joints.push([part.pieces, [0, next]]),
                }
            }
            // Where no edge is within the disc, all of it is within the piece, or nothing.
            if crosses || part.sums.area > r * r {
                self.parts.push(part);
            }
        }
        let first = out.len();
        self.finish(at, (at - at_b.position).xy(), out);
        // Spin does not move a disc's border.
        out[first..].iter_mut().for_each(|o| o.pivot = Matrix3::zeros());
    }

    fn start(&mut self) {
        self.parts.clear();
        self.joints.clear();
        self.scale = 0.0;
    }

    /// Two pieces may meet, the smaller one of this radius.
    fn look(&mut self, radius: f64) {
        self.scale = self.scale.max(radius * radius);
    }

    /// Adds what the ring holds as the part of these pieces.
    fn sum(&mut self, pieces: [u32; 2]) {
        let mut part = Part { pieces, ..Part::default() };
        for (edge, side) in self.ring.edges() {
            ring::triangle(&edge[0], &edge[1], &mut part.sums);
            match side {
                Side::First(None) => part.sums.add_border(edge),
                Side::First(Some(next)) => self.joints.push([pieces, [next, pieces[1]]]),
                Side::Second(Some(next)) => self.joints.push([pieces, [pieces[0], next]]),
                Side::Second(None) => {}
            }
        }
        if !self.ring.is_empty() {
            self.parts.push(part);
        }
    }

    /// Adds a patch per group of parts that hang together.
    fn finish(&mut self, about: Point, apart: Vector2<f64>, out: &mut Vec<Overlap>) {
        for k in 0..self.parts.len() {
            self.parts[k].patch = k;
        }
        for [one, other] in &self.joints {
            let patch = |pieces: &[u32; 2]| Some(self.parts.iter().find(|p| p.pieces == *pieces)?.patch);
            if let (Some(one), Some(other)) = (patch(one), patch(other)) {
                let (low, high) = (one.min(other), one.max(other));
                self.parts.iter_mut().filter(|p| p.patch == high).for_each(|p| p.patch = low);
            }
        }
        for k in 0..self.parts.len() {
            if self.parts[k].patch != k {
                continue;
            }
            let mut sums = Sums::default();
            self.parts[k..].iter().filter(|p| p.patch == k).for_each(|p| sums.add(&p.sums));
            if sums.area > ROUND_OFF * self.scale {
                out.push(patch(&sums, about, apart));
            }
        }
    }
}

/// Patches whose area is a smaller share of the square of the pieces' size are round-off.
const ROUND_OFF: f64 = 1e-14;

fn patch(sums: &Sums, about: Point, apart: Vector2<f64>) -> Overlap {
    let Sums { area, first, gradient, moment } = *sums;
    let centre = first / area;
    let space = |v: Vector2<f64>| Vector::new(v.x, v.y, 0.0);
    let centroid = about + space(centre);
    let length = gradient.norm();
    // All of one is within the other.
    if length <= 1e-9 * area.sqrt() {
        let normal = space(apart).try_normalize(0.0).unwrap_or_else(Vector::x);
        return Overlap::whole(area, centroid, normal);
    }
    Overlap {
        volume: area,
        centroid,
        normal: -space(gradient) / length,
        gradient: space(gradient),
        moment: Vector::z() * (moment - centre.perp(&gradient)),
        pivot: Matrix3::from_diagonal(&(Vector::z() * (length.powi(3) / 12.0))),
    }
}
