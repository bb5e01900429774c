//! What an edge of a face cuts off the disc in which the face's plane meets the unit ball.
/// A piece of an edge within the unit ball, seen from the foot w of the centre on the plane of a face.
#[derive(Clone, Copy, Debug)]
pub(in crate::overlap) struct Edge {
    /// Distance of the plane from the centre, from 0 to 1.
    pub(in crate::overlap) height: f64,
    /// Square of the disc's radius, 1 − height².
    pub(in crate::overlap) disc2: f64,
    /// Distance of the edge's line from w, positive where the face lies on the side of w.
    pub(in crate::overlap) distance: f64,
    /// Where the piece begins and ends, along the line from its point nearest to w.
    pub(in crate::overlap) from: f64,
    pub(in crate::overlap) to: f64,
    /// Its length.
    pub(in crate::overlap) length: f64,
    /// From where the line enters the ball to `from`, and from `to` to where it leaves the ball.
    pub(in crate::overlap) before: f64,
    pub(in crate::overlap) after: f64,
}

/// Integrals over the part of the disc beyond an edge, between the rays from w to its ends; also over a sector or a face. With
/// ρ the distance from the centre and dA the element of the plane:
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::overlap) struct Integrals {
    /// ∫ dA.
    pub(in crate::overlap) area: f64,
    /// ∫ (1 − ρ²)/2 dA.
    pub(in crate::overlap) second: f64,
    /// ∫ (1 − ρ³)/3 dΩ, dΩ = height dA/ρ³: the volume between the part and the sphere, along rays from the centre.
    pub(in crate::overlap) beyond: f64,
}

/// Points and weights of Gauss and Legendre, the positive half.
pub(in crate::overlap) const EIGHT: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_27),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];
const TWELVE: [(f64, f64); 6] = [
    (0.125_233_408_511_468_9, 0.249_147_045_813_402_77),
    (0.367_831_498_998_180_2, 0.233_492_536_538_354_8),
    (0.587_317_954_286_617_4, 0.203_167_426_723_065_92),
    (0.769_902_674_194_304_7, 0.160_078_328_543_346_22),
    (0.904_117_256_370_474_9, 0.106_939_325_995_318_43),
    (0.981_560_634_246_719_3, 0.047_175_336_386_511_83),
];
/// How long an interval may be for a rule to be exact to rounding errors, squared and as a share of the squared distance of the
/// integrand's poles. Measured: errors below 2e-15 of the integral.
const FOR_EIGHT: f64 = 0.25 * 0.25;
const FOR_TWELVE: f64 = 0.8 * 0.8;

impl Integrals {
    /// Over the sector that w sees under `angle`, of a disc of squared radius `radius2` = 1 − height².
    pub(in crate::overlap) fn sector(height: f64, radius2: f64, angle: f64) -> Self {
        let rest = radius2 / (1.0 + height);
        Self {
            area: 0.5 * angle * radius2,
            second: 0.125 * angle * radius2 * radius2,
            beyond: angle * rest * rest * (2.0 + height) / 6.0,
        }
    }
    pub(in crate::overlap) fn minus(self, other: Self) -> Self {
        Self {
            area: self.area - other.area,
            second: self.second - other.second,
            beyond: self.beyond - other.beyond,
        }
    }
}

impl Edge {
    /// Square of the distance from w to the nearest point of the piece.
    fn nearest2(&self) -> f64 {
        let t = 0.0f64.clamp(self.from, self.to);
        self.distance * self.distance + t * t
    }
    /// Square of the distance from the centre to the nearest point of the piece.
    pub(in crate::overlap) fn centre2(&self) -> f64 {
        self.height * self.height + self.nearest2()
    }

    /// The part of the disc beyond the piece. With t along the edge, u² = height² + distance² + t² and p = 1 − u² the integrals
    /// are, over distance dt/(distance² + t²): p/2, p²/8 and height (1 − u)²(2 + u)/(6u).
    ///
    /// All three are smooth and of one sign. Where the piece is short as seen from w they are summed at Gauss points, which
    /// keeps their digits however thin the part is; else in closed form.
    pub(in crate::overlap) fn beyond(&self) -> Integrals {
        let (square, nearest) = (self.length * self.length, self.nearest2());
        // The poles are at ± i distance and, farther off, ± i √(height² + distance²).
        if square <= FOR_EIGHT * nearest {
            self.points(&EIGHT)
        } else if square <= FOR_TWELVE * nearest {
            self.points(&TWELVE)
        } else {
            self.closed(square)
        }
    }

    fn points<const N: usize>(&self, rule: &[(f64, f64); N]) -> Integrals {
        let (h2, d2) = (self.height * self.height, self.distance * self.distance);
        let half = 0.5 * self.length;
        let (before, after) = (self.before, self.after);
        let mut sum = Integrals::default();
        for &(x, weight) in rule {
            for x in [x, -x] {
                let (left, right) = (half * (1.0 + x), half * (1.0 - x));
                let t = self.from + left;
                let p = (before + left) * (after + right);
                let r2 = d2 + t * t;
                let u = (h2 + r2).sqrt();
                let v = u * (1.0 + u) * (1.0 + u);
                let part = weight * p / (r2 * v);
                sum.area += part * v;
                sum.second += part * v * p;
                sum.beyond += part * p * (2.0 + u);
            }
        }
        let scale = self.distance * half;
        Integrals {
            area: 0.5 * scale * sum.area,
            second: 0.125 * scale * sum.second,
            beyond: self.height * scale / 6.0 * sum.beyond,
        }
    }

    fn closed(&self, square: f64) -> Integrals {
        let Self { height: h, distance: d, from, to, length, .. } = *self;
        let d2 = d * d;
        let angle = (d * length).atan2(d2 + from * to);
        let a2 = self.disc2;
        let sector = Integrals::sector(h, a2, angle);
        let flat = d * length;
        let triangle = Integrals {
            area: 0.5 * flat,
            second: 0.125 * flat * (2.0 * a2 - d2 - (to * to + to * from + from * from) / 3.0),
            beyond: 0.0,
        };
        let part = sector.minus(triangle);
        let centre2 = self.centre2();
        if square <= FOR_TWELVE * centre2 {
            // A chord of a small disc, whose sector's volume is as small as the part's: the rest of it at Gauss points.
            let rest = if square <= FOR_EIGHT * centre2 { self.rest(&EIGHT) } else { self.rest(&TWELVE) };
            return Integrals { beyond: sector.beyond - rest, ..part };
        }
        let beyond = edge_angle(h, d, from, to) / 3.0 + h * (flat + (h * h - 3.0) * angle) / 6.0;
        Integrals { beyond, ..part }
    }

    /// distance/6 ∫ [2/(u(u + height)) − height] dt: what the sector's volume has more than that of the part beyond.
    fn rest<const N: usize>(&self, rule: &[(f64, f64); N]) -> f64 {
        let h = self.height;
        let (h2, l2, a2) = (h * h, h * h + self.distance * self.distance, self.disc2);
        let eta = a2 / (1.0 + h);
        let half = 0.5 * self.length;
        let (before, after) = (self.before, self.after);
        let mut sum = 0.0;
        for &(x, weight) in rule {
            for x in [x, -x] {
                let (left, right) = (half * (1.0 + x), half * (1.0 - x));
                let t = self.from + left;
                let p = (before + left) * (after + right);
                let u = (l2 + t * t).sqrt();
                // 2 − h u (u + h) as a sum of positive terms.
                let above = p * (1.0 + u + h2) + (eta * u * u + a2) * (1.0 + u);
                sum += weight * above / (u * (u + h) * (1.0 + u));
            }
        }
        self.distance * half * sum / 6.0
    }

    /// ∫ p/2 dt, p = 1 − u² as above.
    pub(in crate::overlap) fn push(&self) -> f64 {
        let half = 0.5 * self.length;
        half * ((self.before + half) * (self.after + half) - half * half / 3.0)
    }
}

/// Solid angle under which the centre sees the part of a plane at height `h` beyond the edge at distance `d` from the foot of the
/// centre, from `s` to `t` along it: the rise of atan(h t/(d u)).
pub(in crate::overlap) fn edge_angle(h: f64, d: f64, s: f64, t: f64) -> f64 {
    let l2 = h * h + d * d;
    let (u, v) = ((l2 + s * s).sqrt(), (l2 + t * t).sqrt());
    // t u − s v, without cancellation on one side of the nearest point.
    let across = if s * t > 0.0 { l2 * (t - s) * (t + s) / (t * u + s * v) } else { t * u - s * v };
    (h * d * across).atan2(d * d * u * v + h * h * s * t)
}

/// Solid angle of the triangle `p`, `q`, `r` seen from the origin, positive when it is counter-clockwise seen from beyond
/// (van Oosterom & Strackee 1983, IEEE Trans. Biomed. Eng. 30, 125–126).
pub(in crate::overlap) fn solid_angle([p, q, r]: [interfaces::Vector; 3]) -> f64 {
    let (a, b, c) = (p.norm(), q.norm(), r.norm());
    2.0 * p.dot(&q.cross(&r)).atan2(a * b * c + p.dot(&q) * c + q.dot(&r) * a + r.dot(&p) * b)
}
