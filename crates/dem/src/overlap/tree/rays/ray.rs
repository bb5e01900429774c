//! One ray.
use super::super::deepest::{Deepest, Search};
use super::super::seen::Seen;
use super::LATTICE;
use interfaces::Vector;
use nalgebra::Matrix3;

/// Steps of a ray that is traced, at most.
const STEPS: usize = 300;
/// Surfaces along the rays are met by few of them, with large weights: no steeper than this counts.
const ALONG: f64 = 1e-2;

/// What is on a ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ray {
    /// Place on the lattice.
    pub(super) at: [u16; 2],
    /// The least of the larger of both distances \[m\], and where \[m\]; to a fraction of itself.
    pub(super) least: f64,
    pub(super) middle: f64,
    /// Which body is not there, if one is not.
    pub(super) absent: usize,
    /// From where to where it is in both.
    pub(super) span: [f64; 2],
    /// Change of the span's length per length along the plane.
    pub(super) slope: [f64; 2],
    /// n/|n_t| and x × n/|n_t| of each body's surface, over both ends.
    pub(super) flux: [Vector; 2],
    pub(super) turn: [Vector; 2],
}

impl Ray {
    pub(super) fn key_of(at: [u16; 2]) -> usize {
        usize::from(at[1]) * (usize::from(LATTICE) + 1) + usize::from(at[0])
    }
    pub(super) fn key(&self) -> usize {
        Self::key_of(self.at)
    }
    pub(super) fn meets(&self) -> bool {
        self.least < 0.0
    }
    pub(super) fn length(&self) -> f64 {
        self.span[1] - self.span[0]
    }
}

/// Casts rays along the third axis of a frame around the deepest place.
pub(super) struct Caster<'a> {
    bodies: [Seen<'a>; 2],
    pub(super) low: Vector,
    pub(super) high: Vector,
    /// Of the first body's distance less the second's along a ray.
    sense: f64,
    /// No steps smaller than this are made \[m\].
    grain: f64,
    /// Ends are known so well \[m\].
    fine: f64,
    band: f64,
}

/// A place on a ray and both distances there.
#[derive(Clone, Copy)]
struct Place {
    t: f64,
    d: [f64; 2],
}

impl Place {
    fn level(&self) -> f64 {
        self.d[0].max(self.d[1])
    }
}

impl<'a> Caster<'a> {
    pub(super) fn new(
        search: &Search<'a>,
        deepest: &Deepest,
        axes: &Matrix3<f64>,
        [low, high]: [Vector; 2],
        tolerance: f64,
    ) -> Self {
        let depth = -deepest.level;
        Self {
            bodies: search.bodies.map(|b| b.within(axes, deepest.at)),
            low,
            high,
            sense: deepest.across.dot(&axes.column(2)).signum(),
            grain: (0.05 * depth).max(2e-3 * (high.z - low.z)),
            fine: 0.1 * tolerance * depth,
            band: 4.0 * search.size(),
        }
    }

    pub(super) fn place(&self, at: [u16; 2]) -> [f64; 2] {
        [0, 1].map(|a| self.low[a] + (self.high[a] - self.low[a]) * f64::from(at[a]) / f64::from(LATTICE))
    }
    /// Lower and upper corner of a square.
    pub(super) fn corners(&self, at: [u16; 2], level: u16) -> [[f64; 2]; 2] {
        let size = 1 << (super::LEVELS + 1 - level);
        [self.place(at), self.place([at[0] + size, at[1] + size])]
    }

    fn look(&self, x: [f64; 2], t: f64) -> Place {
        let y = Vector::new(x[0], x[1], t);
        Place { t, d: self.bodies.map(|b| b.distance(y, self.band)) }
    }

    /// A ray of which nothing is known, from end to end; `None` if it meets the region more than once.
    pub(super) fn trace(&self, at: [u16; 2]) -> Option<Ray> {
        let x = self.place(at);
        let mut best = self.look(x, self.low.z);
        let (mut t, mut spans, mut within) = (self.low.z, 0, false);
        let mut level = best.level();
        for step in 0.. {
            if (level < 0.0) != within {
                within = !within;
                spans += usize::from(within);
            }
            t += level.abs().max(self.grain);
            if t > self.high.z {
                break;
            }
            if spans > 1 || step == STEPS {
                return None;
            }
            let place = self.look(x, t);
            level = place.level();
            if level < best.level() {
                best = place;
            }
        }
        self.finish(at, x, self.settle(x, best), [None; 2])
    }

    /// A ray between others.
    pub(super) fn cast<'r>(&self, at: [u16; 2], near: impl Iterator<Item = &'r Ray> + Clone) -> Option<Ray> {
        let mean = |some: &dyn Fn(&Ray) -> bool, of: &dyn Fn(&Ray) -> f64| {
            let (mut n, mut sum) = (0.0, 0.0);
            for ray in near.clone().filter(|r| some(r)) {
                (n, sum) = (n + 1.0, sum + of(ray));
            }
            (n > 0.0).then(|| sum / n)
        };
        let x = self.place(at);
        let any = mean(&|_| true, &|r| r.middle)?;
        let middle = mean(&Ray::meets, &|r| r.middle).unwrap_or(any);
        let place = self.settle(x, self.look(x, middle));
        let ends = [0, 1].map(|end| mean(&Ray::meets, &|r| r.span[end]));
        self.finish(at, x, place, ends)
    }

    /// To where the larger distance is least: between bodies, where both are the same.
    fn settle(&self, x: [f64; 2], from: Place) -> Place {
        let (mut best, mut here) = (from, from);
        let mut slope = 2.0 * self.sense;
        for _ in 0..6 {
            let apart = here.d[0] - here.d[1];
            let level = best.level();
            if apart.abs() <= if level < 0.0 { -0.5 * level } else { 0.05 * level } {
                break;
            }
            let t = (here.t - apart / slope).clamp(self.low.z, self.high.z);
            if (t - here.t).abs() < self.fine {
                break;
            }
            let next = self.look(x, t);
            let change = (next.d[0] - next.d[1] - apart) / (t - here.t) * self.sense;
            slope = change.clamp(0.2, 2.0) * self.sense;
            if next.level() < best.level() {
                best = next;
            }
            here = next;
        }
        best
    }

    fn finish(&self, at: [u16; 2], x: [f64; 2], middle: Place, guess: [Option<f64>; 2]) -> Option<Ray> {
        let mut ray = Ray {
            at,
            least: middle.level(),
            middle: middle.t,
            absent: usize::from(middle.d[1] > middle.d[0]),
            span: [middle.t; 2],
            slope: [0.0; 2],
            flux: [Vector::zeros(); 2],
            turn: [Vector::zeros(); 2],
        };
        if !ray.meets() {
            return Some(ray);
        }
        for (end, sign) in [-1.0, 1.0].into_iter().enumerate() {
            let (t, body, d) = self.end(x, middle, sign, guess[end])?;
            let y = Vector::new(x[0], x[1], t);
            let step = 10.0 * self.fine;
            let there = [Vector::x(), Vector::y(), Vector::z()].map(|e| y + step * e);
            let there = self.bodies[body].distances(&there, self.band);
            let n = Vector::from(there.map(|f| (f - d) / step));
            let along = (sign * n.z).max(ALONG * n.norm()).max(f64::MIN_POSITIVE);
            let n = Vector::new(n.x / along, n.y / along, sign);
            ray.span[end] = t;
            for a in 0..2 {
                // z = t − n_x/n_t x …
                ray.slope[a] -= n[a];
            }
            ray.flux[body] += n;
            ray.turn[body] += y.cross(&n);
        }
        ray.middle = 0.5 * (ray.span[0] + ray.span[1]);
        Some(ray)
    }

    /// From within both along `sign` to where one of them ends: the place, which one, and its distance there.
    fn end(&self, x: [f64; 2], from: Place, sign: f64, guess: Option<f64>) -> Option<(f64, usize, f64)> {
        let mut inner = from;
        let ahead = |t: f64| (t - from.t) * sign > 0.0;
        let mut t = guess.filter(|t| ahead(*t)).unwrap_or(from.t - 1.5 * sign * from.level());
        let mut outer = loop {
            let place = self.look(x, t);
            if place.level() >= 0.0 {
                break place;
            }
            if t <= self.low.z || t >= self.high.z {
                return None;
            }
            let step = (-1.5 * place.level()).max(0.2 * (t - inner.t).abs()).max(self.fine);
            inner = place;
            t += sign * step;
        };
        loop {
            let body = usize::from(outer.d[1] > outer.d[0]);
            // Regula falsi with the Illinois rule.
            let (mut a, mut b) = ([inner.t, inner.d[body]], [outer.t, outer.d[body]]);
            let mut at = b;
            for _ in 0..20 {
                if at[1].abs() <= self.fine || (b[0] - a[0]).abs() <= self.fine {
                    break;
                }
                let t = b[0] - b[1] * (b[0] - a[0]) / (b[1] - a[1]);
                let d = self.bodies[body].distance(Vector::new(x[0], x[1], t), self.band);
                at = [t, d];
                if (d < 0.0) == (b[1] < 0.0) {
                    a[1] *= 0.5;
                } else {
                    a = b;
                }
                b = at;
            }
            let other = 1 - body;
            let d = self.bodies[other].distance(Vector::new(x[0], x[1], at[0]), self.band);
            if d <= self.fine {
                return Some((at[0], body, at[1]));
            }
            let mut d2 = [at[1]; 2];
            d2[other] = d;
            outer = Place { t: at[0], d: d2 };
        }
    }
}
