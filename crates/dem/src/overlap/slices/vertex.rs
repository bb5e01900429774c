//! Corners of the outline of what slices of two tubes share.
use super::lanes::{Lanes, Places};
use super::slice::{Place, cross};
use super::tube::{Ends, SlicedTube};
use pulp::Simd;

/// One curve of a tube's outline, the same at all heights but for the width.
#[derive(Clone, Copy, Debug)]
pub(super) enum Curve {
    /// A straight line: normal·x = offset, and the width more of a side.
    Line { normal: Place, offset: f64, moves: f64 },
    /// A circle, as large as the width.
    Circle { centre: Place },
}

/// Where two curves cross, or where one of a tube's ends and its next begins.
#[derive(Clone, Copy, Debug)]
pub(super) enum Vertex {
    /// A place, and what it moves by with both widths.
    Moving { from: Place, by: [Place; 2] },
    /// A line of one body and a circle of the `round` one's: the circle's centre, the line's distance from it and whether it moves with the
    /// width, and the way along the line.
    OnCircle { round: usize, centre: Place, normal: Place, above: f64, moves: f64, along: Place },
    /// Circles of both: the first one's centre, and ways to the second one's and to the left or right of that.
    Circles { centre: Place, apart: f64, towards: Place, aside: Place },
}

impl Curve {
    /// The right and left side of a tube, then its ends along the axis and against it.
    pub(super) fn all(tube: &SlicedTube) -> [Self; 4] {
        let right = Place::new(tube.axis.y, -tube.axis.x);
        let side = |normal: Place| Self::Line { normal, offset: normal.dot(&tube.centre), moves: 1.0 };
        let end = |out: Place| {
            let centre = tube.centre + out * tube.half;
            match tube.ends {
                Ends::Flat => Self::Line { normal: out, offset: out.dot(&centre), moves: 0.0 },
                Ends::Round => Self::Circle { centre },
            }
        };
        [side(right), side(-right), end(tube.axis), end(-tube.axis)]
    }
}

impl Vertex {
    pub(super) const NONE: Self =
        Self::Moving { from: Place::new(0.0, 0.0), by: [Place::new(0.0, 0.0), Place::new(0.0, 0.0)] };
    /// Where a curve of the first body crosses one of the second, next to a place; which of two crossings that is.
    pub(super) fn crossing(first: &Curve, second: &Curve, near: Place) -> (Self, bool) {
        match (*first, *second) {
            (
                Curve::Line { normal: n, offset, moves },
                Curve::Line { normal: m, offset: other, moves: moves_too },
            ) => {
                // n·x = p and m·x = q.
                let (per, left) = (1.0 / cross(n, m), |v: Place| Place::new(-v.y, v.x));
                let (per_p, per_q) = (left(m) * -per, left(n) * per);
                let (from, by) = (per_p * offset + per_q * other, [per_p * moves, per_q * moves_too]);
                (Self::Moving { from, by }, true)
            }
            (Curve::Line { normal, offset, moves }, Curve::Circle { centre }) => {
                Self::on_circle(1, centre, normal, offset, moves, near)
            }
            (Curve::Circle { centre }, Curve::Line { normal, offset, moves }) => {
                Self::on_circle(0, centre, normal, offset, moves, near)
            }
            (Curve::Circle { centre }, Curve::Circle { centre: other }) => {
                let apart = (other - centre).norm();
                let towards = (other - centre) / apart;
                let left = Place::new(-towards.y, towards.x);
                let sign = 1f64.copysign(left.dot(&(near - centre)));
                (Self::Circles { centre, apart, towards, aside: left * sign }, sign > 0.0)
            }
        }
    }
    fn on_circle(
        round: usize,
        centre: Place,
        normal: Place,
        offset: f64,
        moves: f64,
        near: Place,
    ) -> (Self, bool) {
        let along = Place::new(-normal.y, normal.x);
        let sign = 1f64.copysign(along.dot(&(near - centre)));
        let above = offset - normal.dot(&centre);
        (Self::OnCircle { round, centre, normal, above, moves, along: along * sign }, sign > 0.0)
    }
    /// Its places in slices of these widths.
    #[inline(always)]
    pub(super) fn places<S: Simd>(&self, simd: S, widths: [Lanes<S>; 2]) -> Places<S> {
        let zero = Lanes::splat(simd, 0.0);
        match self {
            Self::Moving { from, by } => {
                Places::splat(simd, *from)
                    + Places::splat(simd, by[0]) * widths[0]
                    + Places::splat(simd, by[1]) * widths[1]
            }
            Self::OnCircle { round, centre, normal, above, moves, along } => {
                let (r, width) = (widths[*round], widths[1 - round]);
                let above = width * *moves + *above;
                let half = ((r - above) * (r + above)).max(zero).sqrt();
                Places::splat(simd, *centre)
                    + Places::splat(simd, *normal) * above
                    + Places::splat(simd, *along) * half
            }
            Self::Circles { centre, apart, towards, aside } => {
                let (r, w) = (widths[0], widths[1]);
                let (sum, less) = (r + w, r - w);
                let far = Lanes::splat(simd, *apart);
                // Heron's product.
                let product = (sum - far) * (sum + far) * (far - less) * (far + less);
                let per = 0.5 / apart;
                let half = product.max(zero).sqrt() * per;
                let along = less * sum * per + 0.5 * apart;
                Places::splat(simd, *centre)
                    + Places::splat(simd, *towards) * along
                    + Places::splat(simd, *aside) * half
            }
        }
    }
}
