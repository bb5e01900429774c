//! Moments of a circular segment.
use crate::overlap::ball_faces::edge::EIGHT;

/// Moments of the segment that a chord cuts off the unit disc. Coordinates: u from the chord along
/// its outward normal, v along the chord from its middle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    /// ∫ dA.
    pub(super) area: f64,
    /// ∫ u dA.
    pub(super) u: f64,
    /// ∫ u² dA.
    pub(super) u2: f64,
    /// ∫ v² dA.
    pub(super) v2: f64,
}

/// Half angle up to which the rule is exact to rounding; from here on differences in the closed
/// forms cost no more than three digits.
const SHORT: f64 = 0.2;

impl Segment {
    /// The segment of half the angle `a` \[rad\], at most π/2. With s = sin a, c = cos a and
    /// A = a − s c: ∫u = ⅔s³ − cA, ∫u² = ¼A + ½s³c − ⁴⁄₃c s³ + c²A, ∫v² = ¼A − ⅙c s³.
    pub(super) fn new(a: f64) -> Self {
        if a <= SHORT {
            return Self::short(a);
        }
        let (s, c) = a.sin_cos();
        let (area, s3) = (a - s * c, s * s * s);
        Self {
            area,
            u: 2.0 / 3.0 * s3 - c * area,
            u2: 0.25 * area - 5.0 / 6.0 * s3 * c + c * c * area,
            v2: 0.25 * area - s3 * c / 6.0,
        }
    }
    /// Integrals over the angle t of the arc, where u runs to cos t − cos a.
    fn short(a: f64) -> Self {
        let mut sums = Self { area: 0.0, u: 0.0, u2: 0.0, v2: 0.0 };
        for (x, weight) in EIGHT {
            let (sin, cos) = (a * x).sin_cos();
            let height = 2.0 * (0.5 * a * (1.0 + x)).sin() * (0.5 * a * (1.0 - x)).sin();
            // Both halves are the same.
            let part = 2.0 * weight * a * height * cos;
            sums.area += part;
            sums.u += 0.5 * part * height;
            sums.u2 += part * height * height / 3.0;
            sums.v2 += part * sin * sin;
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use std::f64::consts::PI;

    #[test]
    fn half_a_disc() {
        let half = Segment::new(0.5 * PI);
        assert_relative_eq!(half.area, 0.5 * PI, max_relative = 1e-15);
        assert_relative_eq!(half.u, 2.0 / 3.0, max_relative = 1e-15);
        assert_relative_eq!(half.u2, PI / 8.0, max_relative = 1e-15);
        assert_relative_eq!(half.v2, PI / 8.0, max_relative = 1e-15);
    }

    #[test]
    fn both_ways_agree() {
        let (short, long) = (Segment::short(SHORT), Segment::new(SHORT * (1.0 + 1e-15)));
        assert_relative_eq!(short.area, long.area, max_relative = 1e-13);
        assert_relative_eq!(short.u, long.u, max_relative = 1e-11);
        assert_relative_eq!(short.u2, long.u2, max_relative = 1e-9);
        assert_relative_eq!(short.v2, long.v2, max_relative = 1e-11);
    }

    /// Leading terms ⅔a³, 2a⁵/15, 8·2a⁷/(3·105)… of narrow segments.
    #[test]
    fn narrow_segments_keep_their_digits() {
        for a in [1e-3, 1e-6, 1e-12] {
            let s = Segment::new(a);
            assert_relative_eq!(s.area, 2.0 / 3.0 * a * a * a, max_relative = a * a);
            assert_relative_eq!(s.u, 2.0 / 15.0 * a.powi(5), max_relative = a * a);
            assert_relative_eq!(s.v2, 2.0 / 15.0 * a.powi(5), max_relative = a * a);
        }
    }
}
