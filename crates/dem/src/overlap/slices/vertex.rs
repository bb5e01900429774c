//! Corners of the outline of what slices of two tubes share.
use super::lanes::{Lanes, Places};
use super::slice::{Place, cross};
use super::sliced_tube::SlicedTube;
use crate::overlap::tube::Ends;
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
    /// Which of two crossings of a curve of the first body and one of the second is next to a place: the one to the left of the line's
    /// normal or of the way to the second centre.
    pub(super) fn is_left(first: &Curve, second: &Curve, near: Place) -> bool {
        match (first, second) {
            (Curve::Line { .. }, Curve::Line { .. }) => true,
            (Curve::Line { normal, .. }, Curve::Circle { centre })
            | (Curve::Circle { centre }, Curve::Line { normal, .. }) => cross(*normal, near - centre) > 0.0,
            (Curve::Circle { centre }, Curve::Circle { centre: other }) => {
                cross(other - centre, near - centre) > 0.0
            }
        }
    }
    /// Where a curve of the first body crosses one of the second.
    pub(super) fn crossing(first: &Curve, second: &Curve, left: bool) -> Self {
        let sign = if left { 1.0 } else { -1.0 };
        match (*first, *second) {
            (
                Curve::Line { normal: n, offset, moves },
                Curve::Line { normal: m, offset: other, moves: moves_too },
            ) => {
                // n·x = p and m·x = q.
                let per = 1.0 / cross(n, m);
                let (per_p, per_q) = (to_left(m) * -per, to_left(n) * per);
                let from = per_p * offset + per_q * other;
                Self::Moving { from, by: [per_p * moves, per_q * moves_too] }
            }
            (Curve::Line { normal, offset, moves }, Curve::Circle { centre }) => {
                let (above, along) = (offset - normal.dot(&centre), to_left(normal) * sign);
                Self::OnCircle { round: 1, centre, normal, above, moves, along }
            }
            (Curve::Circle { centre }, Curve::Line { normal, offset, moves }) => {
                let (above, along) = (offset - normal.dot(&centre), to_left(normal) * sign);
                Self::OnCircle { round: 0, centre, normal, above, moves, along }
            }
            (Curve::Circle { centre }, Curve::Circle { centre: other }) => {
                let apart = (other - centre).norm();
                let towards = (other - centre) / apart;
                Self::Circles { centre, apart, towards, aside: to_left(towards) * sign }
            }
        }
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

fn to_left(v: Place) -> Place {
    Place::new(-v.y, v.x)
}
