//! Volumes and moments as sums over the edges of a solid.
use super::super::Overlap;
use super::super::outline::Outline;
use interfaces::{Point, Vector};
use nalgebra::Matrix3;

/// What a region bounded by flat faces sums to, about a reference point.
///
/// Every face is cut into triangles between its foot w (the point of its plane nearest to the reference point) and its
/// directed edges p → q, so with the tetrahedra over them
///
/// ```text
/// V = Σ (p × q)·w/6,   ∫x dV = Σ (p × q)·w (w + p + q)/24
/// ```
///
/// over the edges of all faces: nothing has to be known of how they hang together (after Franklin 1987, "Polygon properties
/// calculated from the vertex neighborhoods"). Along the curve in which two surfaces cross,
/// S = ½∮x × dx and the moment −½∮|x|²dx (Feng 2021).
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sums {
    pub(crate) volume: f64,
    /// ∫ x dV.
    pub(crate) first: Vector,
    /// S, of the first body.
    pub(crate) gradient: Vector,
    /// ∫ x × n dA over the same part of the first body's surface.
    pub(crate) turn: Vector,
}

impl Sums {
    /// An edge p → q of a face of both: on the `left` of it one face, on the right another, given by their feet.
    #[inline]
    pub(crate) fn add_edge(&mut self, p: Vector, q: Vector, left: Vector, right: Vector) {
        let area = p.cross(&q);
        let (l, r) = (area.dot(&left) / 6.0, area.dot(&right) / 6.0);
        self.volume += l - r;
        self.first += ((l - r) * (p + q) + l * left - r * right) * 0.25;
    }
    /// Parts of a line p + t u between faces with these feet, given by Σ ± t and Σ ± t² over their ends, those at the greater t
    /// positive.
    pub(crate) fn add_line(
        &mut self,
        p: Vector,
        u: Vector,
        [length, square]: [f64; 2],
        left: Vector,
        right: Vector,
    ) {
        let area = p.cross(&u);
        let (l, r) = (area.dot(&left) / 6.0, area.dot(&right) / 6.0);
        self.volume += (l - r) * length;
        self.first += ((l * left - r * right + 2.0 * (l - r) * p) * length + (l - r) * square * u) * 0.25;
    }
    /// A whole triangle.
    #[inline]
    pub(crate) fn add_face(&mut self, a: Vector, b: Vector, c: Vector) {
        let v = a.cross(&b).dot(&c) / 6.0;
        self.volume += v;
        self.first += v * (a + b + c) * 0.25;
    }
    /// A part p → q of the curve in which the surfaces cross, with the first body's part in the second on its left.
    #[inline]
    pub(crate) fn add_curve(&mut self, p: Vector, q: Vector) {
        self.gradient += 0.5 * p.cross(&q);
        self.turn -= (q - p) * ((p.norm_squared() + p.dot(&q) + q.norm_squared()) / 6.0);
    }
    /// Both together.
    pub(crate) fn add(&mut self, other: &Self) {
        self.volume += other.volume;
        self.first += other.first;
        self.gradient += other.gradient;
        self.turn += other.turn;
    }
    /// The overlap within an `outline` (empty: no [`Overlap::pivot`]), once moved by `to_world` from the reference point; `towards` is the way the first body is pushed where the gradient
    /// vanishes.
    pub(crate) fn overlap(
        &self,
        outline: &Outline,
        to_world: impl Fn(Vector) -> (Point, Vector),
        towards: Vector,
    ) -> Overlap {
        let arm = self.first / self.volume;
        let turn = self.turn - arm.cross(&self.gradient);
        let turn_to_world =
            Matrix3::from_columns(&[Vector::x(), Vector::y(), Vector::z()].map(|e| to_world(e).1));
        let (centroid, gradient) = (to_world(arm).0, to_world(self.gradient).1);
        Overlap {
            pivot: turn_to_world * outline.pivot() * turn_to_world.transpose(),
            volume: self.volume,
            centroid,
            normal: (-gradient).try_normalize(0.0).unwrap_or(towards),
            gradient,
            moment: to_world(turn).1,
        }
    }
}
