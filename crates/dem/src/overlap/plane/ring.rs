//! What is left of a convex piece when another one cuts it, and what discs share with edges.
use super::Sums;
use nalgebra::Vector2;

/// Whose an edge is, and the piece beyond it if it is a cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Side {
    First(Option<u32>),
    Second(Option<u32>),
}

/// Corners of a convex region, counter-clockwise, each with the edge from there to the next.
#[derive(Clone, Debug, Default)]
pub(super) struct Ring {
    corners: Vec<(Vector2<f64>, Side)>,
    last: Vec<(Vector2<f64>, Side)>,
}

impl Ring {
    pub(super) fn is_empty(&self) -> bool {
        self.corners.len() < 3
    }

    /// All of a piece of the first body.
    pub(super) fn start(&mut self, corners: &[Vector2<f64>], beyond: &[Option<u32>]) {
        self.corners.clear();
        self.corners.extend(corners.iter().zip(beyond).map(|(c, next)| (*c, Side::First(*next))));
    }

    /// What is within a piece of the second, too.
    pub(super) fn clip(&mut self, corners: &[Vector2<f64>], beyond: &[Option<u32>]) {
        for (k, p) in corners.iter().enumerate() {
            let along = corners[(k + 1) % corners.len()] - p;
            self.cut(|x| along.perp(&(x - p)), Side::Second(beyond[k]));
            if self.is_empty() {
                return;
            }
        }
    }

    /// What is where `height` is not negative (Sutherland & Hodgman 1974, Commun. ACM 17, 32).
    pub(super) fn cut(&mut self, height: impl Fn(Vector2<f64>) -> f64, by: Side) {
        std::mem::swap(&mut self.corners, &mut self.last);
        self.corners.clear();
        let n = self.last.len();
        for k in 0..n {
            let ((p, side), (q, _)) = (self.last[k], self.last[(k + 1) % n]);
            let (hp, hq) = (height(p), height(q));
            let crossing = || p + (q - p) * (hp / (hp - hq));
            match (hp >= 0.0, hq >= 0.0) {
                (true, true) => self.corners.push((p, side)),
                (true, false) => self.corners.extend([(p, side), (crossing(), by)]),
                (false, true) => self.corners.push((crossing(), side)),
                (false, false) => {}
            }
        }
    }

    pub(super) fn edges(&self) -> impl Iterator<Item = ([Vector2<f64>; 2], Side)> {
        let n = self.corners.len();
        (0..n).map(move |k| ([self.corners[k].0, self.corners[(k + 1) % n].0], self.corners[k].1))
    }
}

/// The triangle between the origin and an edge.
pub(super) fn triangle(p: &Vector2<f64>, q: &Vector2<f64>, sums: &mut Sums) {
    let twice = p.perp(q);
    sums.area += 0.5 * twice;
    sums.first += (p + q) * (twice / 6.0);
}

/// The sector of a disc of radius `r` about the origin between the directions of `p` and `q`, less than half of it.
pub(super) fn sector(r: f64, p: &Vector2<f64>, q: &Vector2<f64>, sums: &mut Sums) {
    sums.area += 0.5 * r * r * p.perp(q).atan2(p.dot(q));
    let along = |v: &Vector2<f64>| v.try_normalize(0.0).unwrap_or_default();
    let change = along(q) - along(p);
    sums.first += Vector2::new(change.y, -change.x) * (r * r * r / 3.0);
}

/// The part of an edge within a disc of radius `r` about the origin.
pub(super) fn within(r: f64, p: &Vector2<f64>, q: &Vector2<f64>) -> Option<[Vector2<f64>; 2]> {
    let along = q - p;
    let square = along.norm_squared();
    // |p + t along|² = r², from the foot of the perpendicular.
    let foot = -p.dot(&along) / square;
    let apart = p.perp(&along) / square.sqrt();
    let half = (r * r - apart * apart) / square;
    if half <= 0.0 {
        return None;
    }
    let [from, to] = [(foot - half.sqrt()).max(0.0), (foot + half.sqrt()).min(1.0)];
    (from < to).then(|| [p + along * from, p + along * to])
}
