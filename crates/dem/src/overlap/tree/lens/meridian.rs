//! One half-plane through the axis of a lens.
use super::rim::{Rim, Sight};
use interfaces::Vector;

/// Lobatto's points and weights on [0, 1] without the ends, whose weights are 1/((n + 1)(n + 2)) with n points between them.
const LOBATTO: [&[[f64; 2]]; 6] = [
    &[[0.276_393_202_250_021, 0.416_666_666_666_667], [0.723_606_797_749_979, 0.416_666_666_666_667]],
    &[
        [0.172_673_164_646_011, 0.272_222_222_222_222],
        [0.5, 0.355_555_555_555_556],
        [0.827_326_835_353_989, 0.272_222_222_222_222],
    ],
    &[
        [0.117_472_338_035_268, 0.189_237_478_148_924],
        [0.357_384_241_759_677, 0.277_429_188_517_743],
        [0.642_615_758_240_323, 0.277_429_188_517_743],
        [0.882_527_661_964_732, 0.189_237_478_148_923],
    ],
    &[
        [0.084_888_051_860_717, 0.138_413_023_680_783],
        [0.265_575_603_264_643, 0.215_872_690_604_931],
        [0.5, 0.243_809_523_809_524],
        [0.734_424_396_735_357, 0.215_872_690_604_931],
        [0.915_111_948_139_283, 0.138_413_023_680_783],
    ],
    &[
        [0.064_129_925_745_196, 0.105_352_113_571_753],
        [0.204_149_909_283_429, 0.170_561_346_241_752],
        [0.395_350_391_048_761, 0.206_229_397_329_352],
        [0.604_649_608_951_239, 0.206_229_397_329_352],
        [0.795_850_090_716_571, 0.170_561_346_241_752],
        [0.935_870_074_254_803, 0.105_352_113_571_753],
    ],
    &[
        [0.050_121_002_294_27, 0.082_747_680_780_403],
        [0.161_406_860_244_631, 0.137_269_356_250_081],
        [0.318_441_268_086_911, 0.173_214_255_486_523],
        [0.5, 0.185_759_637_188_209],
        [0.681_558_731_913_089, 0.173_214_255_486_523],
        [0.838_593_139_755_369, 0.137_269_356_250_081],
        [0.949_878_997_705_73, 0.082_747_680_780_403],
    ],
];
/// Fewest points between the ends.
pub(super) const FEWEST: usize = 2;
/// Most of them.
pub(super) const MOST: usize = FEWEST + LOBATTO.len() - 1;

/// Rims farther from the middle of the poles than this, in half thicknesses, are out of sight from the centre.
pub(super) const BENT: f64 = 1.2;

/// Shares of the way to a surface at which it is looked whether it is met once only.
const BEFORE: f64 = 0.8;
const BEYOND: f64 = 1.15;

/// How points of the surfaces are looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lines {
    /// From the centre: for lenses however thick.
    Rays,
    /// Along the axis, from a surface through the rim: for thin ones, however bent.
    Columns,
}

/// How far a surface is from where it was guessed along one line, as a share of the line, and how steeply the distance grows along
/// the line there.
#[derive(Clone, Copy, Debug, Default)]
struct Hit {
    t: f64,
    slope: f64,
}

/// The rim in one half-plane and both surfaces from the axis to it.
///
/// The guess of a surface is a paraboloid from the pole through the rim, r = R√s and z = z₀(1 − s) + z₁s: of a flat lens both
/// surfaces are just that, so that few points tell the rest.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Meridian {
    pub(super) rim: Rim,
    n: usize,
    hits: [[Hit; MOST]; 2],
}

/// What a half-plane adds per angle, in the frame's units across.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Wedge {
    pub(super) volume: f64,
    /// Outwards and along the axis.
    pub(super) first: [f64; 2],
}

/// What all half-planes share.
#[derive(Clone, Copy)]
pub(super) struct Poles {
    pub(super) lines: Lines,
    /// Heights of both poles.
    pub(super) z: [f64; 2],
    /// Slopes of the distances from the centre to them.
    pub(super) slope: [f64; 2],
    /// A share of the lines that may be missed.
    pub(super) accuracy: f64,
}

impl Meridian {
    /// The one of `azimuth` with `n` lines to each surface, beginning at this `rim` and the lines of those `near` it.
    pub(super) fn new(
        sight: &Sight<'_>,
        poles: &Poles,
        azimuth: [f64; 2],
        rim: Rim,
        n: usize,
        near: [Option<&Self>; 2],
    ) -> Option<Self> {
        let rim = sight.rim(azimuth, rim, 2.0 * poles.accuracy, poles.slope)?;
        if poles.lines == Lines::Rays && rim.z.abs() > BENT * sight.thick {
            return None;
        }
        let mut this = Self { rim, n, hits: Default::default() };
        let level = |share: f64, z: f64| {
            let [a, b] = sight.both(azimuth, share * share * rim.q, z);
            a.max(b)
        };
        // The way to it is within both bodies, what follows is not.
        let (share, z) = match poles.lines {
            Lines::Rays => (BEFORE, BEFORE * rim.z),
            Lines::Columns => (BEFORE, poles.middle() + BEFORE * BEFORE * (rim.z - poles.middle())),
        };
        if level(BEYOND, rim.z) <= 0.0 || level(share, z) >= 0.0 {
            return None;
        }
        let r = rim.q.sqrt();
        let between = near.iter().all(Option::is_some);
        for (j, [p, _]) in LOBATTO[n - FEWEST].iter().enumerate() {
            let s = p * p;
            for i in 0..2 {
                let (from, to) = this.line(poles, i, s);
                let from = sight.place(azimuth, r * from[0], from[1]);
                let along = sight.place(azimuth, r * to[0], to[1]) - from;
                let start = Self::guess(near, i, s, poles, rim.z);
                let hit = poles.hit(sight, i, from, along, start, between)?;
                this.hits[i][j] = hit;
                // Between others that were looked at every other line is, of either body.
                if between && (i + j) % 2 == 1 {
                    continue;
                }
                // Within the other body; this one's surface is met there only.
                let other = sight.distance(1 - i, from + hit.t * along);
                if other > 0.05 * (poles.z[i] * poles.slope[i]).abs()
                    || sight.distance(i, from + (BEYOND * hit.t) * along) <= 0.0
                    || sight.distance(i, from + (poles.before() * hit.t) * along) >= 0.0
                {
                    return None;
                }
            }
        }
        Some(this)
    }

    /// The ends of line `s` as (r/R, z).
    fn line(&self, poles: &Poles, i: usize, s: f64) -> ([f64; 2], [f64; 2]) {
        let r = s.sqrt();
        let to = poles.z[i] * (1.0 - s) + self.rim.z * s;
        match poles.lines {
            Lines::Rays => ([0.0; 2], [r, to]),
            Lines::Columns => ([r, poles.middle() * (1.0 - s) + self.rim.z * s], [r, to]),
        }
    }

    /// From the lines next to it.
    fn guess(near: [Option<&Self>; 2], i: usize, s: f64, poles: &Poles, rim: f64) -> Hit {
        let (mut sum, mut n) = (Hit::default(), 0.0);
        for other in near.into_iter().flatten() {
            let hit = other.between(poles, i, s);
            sum = Hit { t: sum.t + hit.t, slope: sum.slope + hit.slope };
            n += 1.0;
        }
        if n > 0.0 {
            return Hit { t: sum.t / n, slope: sum.slope / n };
        }
        let steep = match poles.lines {
            Lines::Rays => poles.z[i] + s * (poles.z[i] - rim),
            Lines::Columns => (poles.z[i] - poles.middle()) * (1.0 - s),
        };
        Hit { t: 1.0, slope: (steep * poles.slope[i]).abs() }
    }

    /// Straight from line to line.
    fn between(&self, poles: &Poles, i: usize, s: f64) -> Hit {
        let nodes = LOBATTO[self.n - FEWEST];
        let hits = &self.hits[i];
        let j = nodes.iter().position(|[p, _]| p * p >= s).unwrap_or(self.n);
        // Columns get shorter towards the rim.
        let length = |s: f64| if poles.lines == Lines::Columns { 1.0 - s } else { 1.0 };
        let node = |j: usize| {
            let s = nodes[j][0] * nodes[j][0];
            [s, hits[j].t, hits[j].slope / length(s)]
        };
        let [low, high] = match j {
            0 => [[0.0, 1.0, node(0)[2]], node(0)],
            _ if j == self.n => [node(j - 1), [1.0, 1.0, node(j - 1)[2]]],
            _ => [node(j - 1), node(j)],
        };
        let share = (s - low[0]) / (high[0] - low[0]);
        let [t, slope] = [1, 2].map(|k| low[k] + share * (high[k] - low[k]));
        Hit { t, slope: slope * length(s) }
    }

    /// The sums over both sides.
    pub(super) fn wedge(&self, poles: &Poles) -> Wedge {
        let mut out = Wedge::default();
        let (q, n) = (self.rim.q, self.n as f64);
        let end = 1.0 / ((n + 1.0) * (n + 2.0));
        let r = q.sqrt();
        for i in 0..2 {
            let sense = if i == 0 { 1.0 } else { -1.0 };
            let mut add = |s: f64, t: f64, weight: f64| {
                let (from, to) = self.line(poles, i, s);
                match poles.lines {
                    Lines::Rays => {
                        // y·(∂y/∂s × ∂y/∂θ) of the paraboloid y.
                        let area = 0.5 * q * (poles.z[i] + s * (poles.z[i] - self.rim.z)) * sense;
                        let cone = weight * area * t.powi(3) / 3.0;
                        out.volume += cone;
                        out.first[0] += 0.75 * cone * t * r * to[0];
                        out.first[1] += 0.75 * cone * t * to[1];
                    }
                    Lines::Columns => {
                        let along = t * (to[1] - from[1]);
                        let column = weight * 0.5 * q * along * sense;
                        out.volume += column;
                        out.first[0] += column * r * to[0];
                        out.first[1] += column * (from[1] + 0.5 * along);
                    }
                }
            };
            // Over p, s = p²: on the axis nothing is smooth in s.
            add(1.0, 1.0, 2.0 * end);
            for ([p, weight], hit) in LOBATTO[self.n - FEWEST].iter().zip(&self.hits[i]) {
                add(p * p, hit.t, 2.0 * p * weight);
            }
        }
        out
    }

    /// How far beyond the guesses the surfaces are, at most.
    pub(super) fn beyond(&self) -> f64 {
        self.hits.iter().flat_map(|hits| &hits[..self.n]).map(|h| h.t).fold(1.0, f64::max)
    }
}

impl Poles {
    /// Where it is looked whether a line has left the body before: columns begin within.
    fn before(&self) -> f64 {
        if self.lines == Lines::Rays { BEFORE } else { 0.0 }
    }

    pub(super) fn middle(&self) -> f64 {
        0.5 * (self.z[0] + self.z[1])
    }

    /// Where the surface of body `i` is on a line: by secants from the guess, or, if they fail, from the line's beginning, no
    /// farther at a time than it is to the surface. Guesses `between` others are good ones.
    fn hit(
        &self,
        sight: &Sight<'_>,
        i: usize,
        from: Vector,
        along: Vector,
        start: Hit,
        between: bool,
    ) -> Option<Hit> {
        // What is left of a step is its share by which the slope is wrong.
        let short = self.accuracy * if between { 5.0 } else { 0.5 };
        self.secants(sight, i, from, along, start, short).or_else(|| {
            let (length, mut t) = (along.norm(), 0.0);
            for _ in 0..20 {
                let step = -sight.distance(i, from + t * along) / length;
                t += step;
                if step.abs() < 0.05 {
                    return self.secants(sight, i, from, along, Hit { t, slope: length }, 0.0);
                }
            }
            None
        })
    }

    /// By secants, unless the first step is a `short` one.
    fn secants(
        &self,
        sight: &Sight<'_>,
        i: usize,
        from: Vector,
        along: Vector,
        start: Hit,
        mut short: f64,
    ) -> Option<Hit> {
        let f = |t: f64| sight.distance(i, from + t * along);
        let Hit { mut t, mut slope } = start;
        let mut d = f(t);
        for _ in 0..8 {
            let step = (-d / slope).clamp(-0.5, 1.0);
            if step.abs() <= short.max(0.5 * self.accuracy) {
                return Some(Hit { t: t + step, slope });
            }
            let next = t + step;
            let there = f(next);
            let secant = (there - d) / step;
            if !(secant > 0.0 && secant.is_finite()) {
                return None;
            }
            let second = -there / secant;
            if (second * step).abs() <= 0.2 * self.accuracy {
                return Some(Hit { t: next + second, slope: secant });
            }
            (t, d, slope, short) = (next, there, secant, 0.0);
        }
        None
    }
}
