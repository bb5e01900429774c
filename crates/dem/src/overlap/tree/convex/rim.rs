//! The rim of a convex region: where both surfaces meet.
use super::polytope::{Corner, Polytope};
use super::view::View;
use interfaces::Vector;

/// Gauss points on [0, 1] and their weights.
const GAUSS: [[f64; 2]; 3] =
    [[0.112_701_665_379_258, 5.0 / 18.0], [0.5, 4.0 / 9.0], [0.887_298_334_620_742, 5.0 / 18.0]];

/// As a share of the area that the edges enclose, the rim encloses as much more or less at most.
const FAR: f64 = 0.3;

/// Sums along rims and the memory of it.
#[derive(Clone, Debug, Default)]
pub(super) struct Rims {
    /// Of every corner, the sums of the slopes of each body's distance over the sides there, and along the edge between two of them.
    slopes: Vec<[Slope; 2]>,
    /// Where the rim is nearby.
    places: Vec<Option<Vector>>,
}

impl Rims {
    /// ½∮x × dx and −½∮|x|² dx along the edges between sides of the two bodies, each an arc of second order through three points
    /// of the rim; around the first body's sides.
    pub(super) fn around(&mut self, view: &View<'_>, polytope: &Polytope) -> Option<(Vector, Vector)> {
        let corners = &polytope.corners;
        self.slopes.clear();
        self.slopes.resize(corners.len(), [Slope::default(); 2]);
        self.places.clear();
        self.places.resize(corners.len(), None);
        for side in polytope.alive() {
            let Some(body) = side.body else { continue };
            for [corner, ..] in side.edges() {
                self.slopes[corner][body].add(side.normal);
            }
        }
        let (mut area, mut moment) = (Vector::zeros(), Vector::zeros());
        let mut edges = Vector::zeros();
        for side in polytope.alive().filter(|s| s.body == Some(0)) {
            for [from, to, across] in side.edges() {
                let other = &polytope.sides[across];
                if other.body != Some(1) {
                    continue;
                }
                edges += 0.5 * corners[from].x.cross(&corners[to].x);
                let mut ends = [Vector::zeros(); 2];
                for (end, c) in ends.iter_mut().zip([from, to]) {
                    if self.places[c].is_none() {
                        let slopes = [side.slope, other.slope];
                        self.places[c] = Some(corner(view, &corners[c], self.slopes[c], slopes));
                    }
                    *end = self.places[c]?;
                }
                let [x, y] = ends;
                let middle = 0.5 * (x + y);
                let slopes = [side.slope * side.normal, other.slope * other.normal];
                let m = meet(view, middle, view.distances(middle), slopes).unwrap_or(middle);
                area += 0.5 * (4.0 * x.cross(&m) - x.cross(&y) + 4.0 * m.cross(&y)) / 3.0;
                for [s, weight] in GAUSS {
                    let at =
                        (1.0 - s) * (1.0 - 2.0 * s) * x + 4.0 * s * (1.0 - s) * m + s * (2.0 * s - 1.0) * y;
                    let rate = (4.0 * s - 3.0) * x + (4.0 - 8.0 * s) * m + (4.0 * s - 1.0) * y;
                    moment -= 0.5 * weight * at.norm_squared() * rate;
                }
            }
        }
        // The rim is not far from the edges.
        ((area - edges).norm() <= FAR * edges.norm()).then_some((area, moment))
    }
}

/// What the sides of one body at a corner are like.
#[derive(Clone, Copy, Debug, Default)]
struct Slope {
    sum: Vector,
    first: Vector,
    /// Along the edge between two sides, if there are two.
    edge: Vector,
}

impl Slope {
    fn add(&mut self, normal: Vector) {
        if self.first == Vector::zeros() {
            self.first = normal;
        }
        let edge = self.first.cross(&normal);
        if edge.norm_squared() > self.edge.norm_squared() {
            self.edge = edge;
        }
        self.sum += normal;
    }
}

/// The place of the rim near a corner: where an edge of the one body meets the surface of the other one, or both surfaces meet.
fn corner(view: &View<'_>, at: &Corner, own: [Slope; 2], slopes: [f64; 2]) -> Vector {
    let d = at.distances;
    let normals = [0, 1].map(|i| own[i].sum.try_normalize(0.0).unwrap_or_default());
    for i in 0..2 {
        // On an edge, and the other body's surface elsewhere.
        if d[i].abs() <= view.slack && own[i].edge.norm() > 0.1 && d[1 - i] > view.slack {
            let along = own[i].edge.normalize();
            if let Some(x) =
                view.along(1 - i, at.x, along, d[1 - i], slopes[1 - i] * normals[1 - i].dot(&along))
            {
                return x;
            }
        }
    }
    meet(view, at.x, d, [slopes[0] * normals[0], slopes[1] * normals[1]]).unwrap_or(at.x)
}

/// The place near `x` where both distances vanish, by steps along their slopes, which what they do not foresee is put down to
/// (Broyden 1965).
fn meet(view: &View<'_>, mut x: Vector, mut d: [f64; 2], mut slopes: [Vector; 2]) -> Option<Vector> {
    for _ in 0..14 {
        if view.is_small(d) {
            return Some(x);
        }
        let [a, b] = slopes;
        let [aa, ab, bb] = [a.norm_squared(), a.dot(&b), b.norm_squared()];
        let det = aa * bb - ab * ab;
        if det <= 1e-12 * aa * bb {
            return None;
        }
        let step = ((ab * d[1] - bb * d[0]) / det) * a + ((ab * d[0] - aa * d[1]) / det) * b;
        x += step;
        d = view.distances(x);
        for i in 0..2 {
            slopes[i] += (d[i] / step.norm_squared()) * step;
        }
    }
    None
}
