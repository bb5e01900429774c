//! A ball and a tube: slices across the tube's axis.
use super::adaptive;
use super::lanes::{Lanes, Places, WIDTH};
use super::piece::Piece;
use super::sums::{Sampled, Sums, Weighted};
use crate::Overlap;
use crate::overlap::integrals::Integrals;
use crate::overlap::tube::{Ends, Tube};
use interfaces::{Point, Vector};
use pulp::{Arch, Simd, WithSimd};
use std::f64::consts::{PI, TAU};

/// Distances of the ball's centre from the axis that are taken for zero, as a share of the size.
const COAXIAL: f64 = 1e-15;
/// Places at most where the outlines cross, seams and limits.
const BREAKS: usize = 14;

/// A ball beside the axis of a body of revolution; heights along the axis from the ball's centre.
///
/// Both are discs in slices across the axis, a distance apart that is the same in all, and what discs share has a formula. The discs
/// touch in the heights at which the outlines of both cross in their common plane of symmetry, straight lines and arcs:
/// between these heights one disc lies within the other and all is polynomial, or two arcs cross and all is smooth but for roots at the ends.
struct BallInTube {
    ball: f64,
    tube: f64,
    /// Heights of both ends of the tube's straight part.
    straight: [f64; 2],
    ends: Ends,
    /// Of the ball's centre from the axis.
    beside: f64,
}

/// What two discs do.
#[derive(PartialEq)]
enum Discs {
    Apart,
    BallWithin,
    TubeWithin,
    Cross,
}

/// What a ball and a tube share, the ball being the first; `normal` where the gradient gives none.
pub(super) fn overlap(
    centre: Point,
    radius: f64,
    tube: &Tube,
    normal: Vector,
    tolerance: f64,
) -> Option<Overlap> {
    let from = centre - tube.at.position;
    let up = tube.axis;
    let height = up.dot(&from);
    let across = from - up * height;
    let distance = across.norm();
    let size = radius + tube.bound();
    let out = if distance > COAXIAL * size { across / distance } else { Vector::zeros() };
    let pair = BallInTube {
        ball: radius,
        tube: tube.radius,
        straight: [-tube.half - height, tube.half - height],
        ends: tube.ends,
        beside: if distance > COAXIAL * size { distance } else { 0.0 },
    };
    let (sums, met) = pair.integrate(tolerance);
    match met {
        [true, false] => return Some(Overlap::whole(4.0 / 3.0 * PI * radius.powi(3), centre, normal)),
        [false, true] => return Some(Overlap::whole(tube.volume(), tube.at.position, normal)),
        _ => {}
    }
    if sums.volume.is_nan() || sums.volume <= 0.0 {
        return None;
    }
    let world = |v: Vector| out * v.x + up * v.z;
    let from_centre = world(sums.first) / sums.volume;
    let gradient = world(sums.area);
    Some(Overlap {
        volume: sums.volume,
        centroid: centre + from_centre,
        normal: (-gradient).try_normalize(0.0).unwrap_or(normal),
        gradient,
        // All normals of the ball lead through its centre.
        moment: -from_centre.cross(&gradient),
        pivot: nalgebra::Matrix3::zeros(),
    })
}

impl BallInTube {
    /// Integrals from the ball's centre, those of the surface over the ball's; whether parts of the ball's and the tube's surface
    /// are part of the common region's.
    fn integrate(&self, tolerance: f64) -> (Integrals, [bool; 2]) {
        let (mut sums, mut met) = (Integrals::default(), [false; 2]);
        let (breaks, n) = self.breaks();
        let breaks = &breaks[..n];
        let Some((&(low, _), &(high, _))) = breaks.first().zip(breaks.last()) else { return (sums, met) };
        let kind = |w: &[(f64, bool)]| self.discs(0.5 * (w[0].0 + w[1].0));
        for w in breaks.windows(2) {
            match kind(w) {
                Discs::Apart => {}
                Discs::BallWithin => {
                    met[0] = true;
                    sums = sums + self.within(true, w[0].0, w[1].0);
                }
                Discs::TubeWithin => {
                    met[1] = true;
                    sums = sums + self.within(false, w[0].0, w[1].0);
                }
                Discs::Cross => met = [true; 2],
            }
        }
        if met[0] {
            // Flat ends within the ball are the tube's.
            met[1] |= self.ends == Ends::Flat && (low == self.straight[0] || high == self.straight[1]);
            let (mut pieces, mut n) = ([Piece::default(); BREAKS], 0);
            for w in breaks.windows(2).filter(|w| kind(w) == Discs::Cross) {
                pieces[n] = Piece::between(w[0], w[1]);
                n += 1;
            }
            sums = adaptive::integrate::<BREAKS>(sums, &pieces[..n], tolerance, &mut &*self);
        }
        (sums, met)
    }

    /// The heights at which slices change, upwards; whether discs touch there.
    fn breaks(&self) -> ([(f64, bool); BREAKS], usize) {
        let (mut breaks, mut n) = ([(0.0, false); BREAKS], 0);
        let ([from, to], r, ball) = (self.straight, self.tube, self.ball);
        let round = self.ends == Ends::Round;
        let beyond = if round { r } else { 0.0 };
        let (low, high) = ((from - beyond).max(-ball), (to + beyond).min(ball));
        if low.is_nan() || high.is_nan() || low >= high {
            return (breaks, 0);
        }
        let mut push = |h: f64, touch: bool| {
            if h > low && h < high {
                breaks[n] = (h, touch);
                n += 1;
            }
        };
        for off in [(self.beside - r).abs(), self.beside + r] {
            if off < ball {
                let h = ((ball - off) * (ball + off)).sqrt();
                [-h, h].into_iter().filter(|h| (from..=to).contains(h)).for_each(|h| push(h, true));
            }
        }
        if round {
            for (end, sign) in [(from, -1.0), (to, 1.0)] {
                push(end, false);
                for h in self.crossings(end).into_iter().flatten() {
                    if (h - end) * sign > 0.0 {
                        push(h, true);
                    }
                }
            }
        }
        // Where a disc shrinks to a point on the other's rim.
        let tips = |h: f64| round || h.abs() == ball;
        (breaks[n], breaks[n + 1]) = ((low, tips(low)), (high, tips(high)));
        n += 2;
        breaks[..n].sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        (breaks, n)
    }
    /// Heights at which the outlines of both balls cross, that of the tube's end being at the height `end`.
    fn crossings(&self, end: f64) -> [Option<f64>; 2] {
        let (r, ball) = (self.tube, self.ball);
        let d = self.beside.hypot(end);
        let product = (ball + r - d) * (d - ball + r) * (d + ball - r) * (d + ball + r);
        if product <= 0.0 || d == 0.0 {
            return [None; 2];
        }
        let along = 0.5 * (d + (ball - r) * ((ball + r) / d)) * (end / d);
        let across = product.sqrt() / (2.0 * d) * (self.beside / d);
        [Some(along - across), Some(along + across)]
    }
    /// Squares of both radii.
    fn squares(&self, h: f64) -> [f64; 2] {
        let off = h - h.clamp(self.straight[0], self.straight[1]);
        [(self.ball - h) * (self.ball + h), (self.tube - off) * (self.tube + off)].map(|s| s.max(0.0))
    }
    fn discs(&self, h: f64) -> Discs {
        let [ball, tube] = self.squares(h).map(f64::sqrt);
        if ball + tube <= self.beside {
            Discs::Apart
        } else if ball + self.beside <= tube {
            Discs::BallWithin
        } else if tube + self.beside <= ball {
            Discs::TubeWithin
        } else {
            Discs::Cross
        }
    }
    /// Between two heights where one disc lies within the other: of third degree, which two points make exact.
    fn within(&self, ball: bool, low: f64, high: f64) -> Integrals {
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        let at = |share: f64| self.disc(ball, middle + half * share);
        let share = 1.0 / 3f64.sqrt();
        (at(-share) + at(share)) * half
    }
    /// All of the ball's disc or the tube's.
    fn disc(&self, ball: bool, h: f64) -> Integrals {
        let [of_ball, of_tube] = self.squares(h);
        if ball {
            let area = PI * of_ball;
            let (first, upward) = (Vector::new(0.0, 0.0, h * area), Vector::new(0.0, 0.0, TAU * h));
            Integrals { volume: area, first, area: upward, moment: Vector::zeros() }
        } else {
            let area = PI * of_tube;
            let first = Vector::new(-self.beside * area, 0.0, h * area);
            Integrals { volume: area, first, ..Integrals::default() }
        }
    }
}

impl adaptive::Slices for &BallInTube {
    fn sums<const N: usize>(
        &mut self,
        _: usize,
        heights: &[f64; WIDTH],
        weights: &[[f64; WIDTH]; N],
    ) -> Sampled<N> {
        Arch::new().dispatch(Crossing { pair: self, heights, weights })
    }
}

/// Slices in which the discs cross, in the widest vectors that the processor has.
struct Crossing<'a, const N: usize> {
    pair: &'a BallInTube,
    heights: &'a [f64; WIDTH],
    weights: &'a [[f64; WIDTH]; N],
}

impl<const N: usize> WithSimd for Crossing<'_, N> {
    type Output = Sampled<N>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Sampled<N> {
        let mut sums = Weighted::new(simd, self.weights);
        for (i, h) in S::as_simd_f64s(self.heights).0.iter().enumerate() {
            sums.add(i, self.pair.slice(simd, Lanes::new(simd, *h)));
        }
        sums.finish()
    }
}

impl BallInTube {
    /// Slices in which the discs cross.
    #[inline(always)]
    fn slice<S: Simd>(&self, simd: S, h: Lanes<S>) -> [S::f64s; 10] {
        let Self { ball, tube, straight, beside: d, .. } = self;
        let zero = h.all(0.0);
        let off = h - h.max(h.all(straight[0])).min(h.all(straight[1]));
        let ball2 = ((h.all(*ball) - h) * (h + *ball)).max(zero);
        let tube2 = ((h.all(*tube) - off) * (off + *tube)).max(zero);
        let (ball, tube) = (ball2.sqrt(), tube2.sqrt());
        let (sum, less, far) = (ball + tube, ball - tube, h.all(*d));
        // Heron's product.
        let product = (sum - far) * (far - less) * (far + less) * (sum + far);
        let half = product.max(zero).sqrt() * (0.5 / d);
        // The chord's distance from the ball's centre.
        let near = (far + less * sum * (1.0 / d)) * 0.5;
        let [of_ball, of_tube] = [half.angle(near), half.angle(far - near)];
        let ball_part = ball2 * of_ball.0.segment(of_ball.1);
        let tube_part = tube2 * of_tube.0.segment(of_tube.1);
        let area = ball_part + tube_part;
        Sums {
            area,
            // The segments' own moments balance.
            first: Places { x: tube_part * -d, y: zero },
            normal: Places { x: half * -2.0, y: zero },
            upward: of_ball.0 * h * 2.0,
            ..Sums::zero(simd)
        }
        .without_moment(h)
    }
}
