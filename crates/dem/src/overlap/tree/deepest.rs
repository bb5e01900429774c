//! Where two bodies overlap most, and how far.
use super::seen::Seen;
use interfaces::Vector;

/// A place where both bodies are deep, max(d_A, d_B) < 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Deepest {
    pub(crate) at: Vector,
    /// d_A and d_B there \[m\].
    pub(crate) distances: [f64; 2],
    /// max(d_A, d_B) there \[m\], negative.
    pub(crate) level: f64,
    /// From the first body to the second, of unit length.
    pub(crate) across: Vector,
}

/// Where the larger one of both distances is least.
pub(super) struct Least {
    pub(super) at: Vector,
    pub(super) distances: [f64; 2],
    /// Of the distances, before the last step.
    pub(super) slopes: [Vector; 2],
}

/// Both bodies, in the frame around the `half`-widths that their boxes share.
#[derive(Clone, Copy)]
pub(crate) struct Search<'a> {
    pub(crate) bodies: [Seen<'a>; 2],
    pub(crate) half: Vector,
}

/// Of the size of what the boxes share: differences over more than this are no slopes, over less than that no numbers.
const STEPS: [f64; 2] = [1e-7, 1e-3];
/// Is nothing more than this share of the depth to gain, the place is deep enough.
const ENOUGH: f64 = 0.1;

impl Search<'_> {
    pub(crate) fn size(&self) -> f64 {
        self.half.norm()
    }
    pub(crate) fn distances(&self, y: Vector) -> [f64; 2] {
        // Far enough for any place in the box to be told from any other.
        self.bodies.map(|b| b.distance(y, 4.0 * self.size()))
    }
    /// Of one body's distance, which is `d` at `x`.
    pub(crate) fn slope(&self, body: usize, x: Vector, d: f64, step: f64) -> Vector {
        let places = [Vector::x(), Vector::y(), Vector::z()].map(|e| x + step * e);
        let there = self.bodies[body].distances(&places, 4.0 * self.size());
        Vector::from(there.map(|f| (f - d) / step))
    }
    fn slopes(&self, x: Vector, d: [f64; 2], step: f64) -> [Vector; 2] {
        [0, 1].map(|i| self.slope(i, x, d[i], step))
    }

    /// Down from `x` in steps of about `t` at first to where both bodies are deep, if there is such a place.
    pub(crate) fn descend(&self, x: Vector, t: f64) -> Option<Deepest> {
        let Least { at, distances, slopes } = self.least(x, t, ENOUGH);
        Self::deep(at, distances, slopes)
    }
    /// A place in both bodies as it is.
    pub(crate) fn stay(&self, x: Vector) -> Option<Deepest> {
        let d = self.distances(x);
        Self::deep(x, d, self.slopes(x, d, STEPS[1] * d[0].max(d[1]).abs()))
    }
    fn deep(at: Vector, d: [f64; 2], slopes: [Vector; 2]) -> Option<Deepest> {
        let level = d[0].max(d[1]);
        if level >= 0.0 {
            return None;
        }
        // One of them alone decides deep within the other.
        let [a, b] = slopes;
        let across = match () {
            _ if (d[0] - d[1]).abs() <= 0.5 * level.abs() && (a - b).norm_squared() > 0.25 => a - b,
            _ if d[0] > d[1] => a,
            _ => -b,
        };
        let across = across.try_normalize(0.0).unwrap_or(Vector::z());
        Some(Deepest { at, distances: d, level, across })
    }

    /// Down from `x` in steps of about `t` at first: the least of the larger of two functions by proximal steps,
    /// min over s of max(d_A + g_A·s, d_B + g_B·s) + s²/2t, until no more than this share of it is left to gain.
    pub(super) fn least(&self, mut x: Vector, mut t: f64, enough: f64) -> Least {
        let size = self.size();
        let mut d = self.distances(x);
        let mut fine = STEPS[1] * size;
        let mut slopes = [Vector::zeros(); 2];
        for _ in 0..60 {
            slopes = self.slopes(x, d, fine);
            let [a, b] = slopes;
            let apart = a - b;
            let square = apart.norm_squared();
            let level = d[0].max(d[1]);
            let mut moved = false;
            // What is left to gain.
            let mut gain = 0.0;
            for _ in 0..12 {
                let share = ((d[0] - d[1]) / t - b.dot(&apart)) / square;
                let share = if square > 1e-12 { share.clamp(0.0, 1.0) } else { f64::from(d[0] > d[1]) };
                let slope = b + share * apart;
                let least = share * d[0] + (1.0 - share) * d[1] - t * slope.norm_squared();
                gain = level - least;
                let next = x - t * slope;
                let there = self.distances(next);
                let won = level - there[0].max(there[1]);
                if won > 0.1 * gain {
                    (x, d, moved) = (next, there, true);
                    fine = (0.02 * t * slope.norm()).clamp(STEPS[0] * size, fine);
                    if won > 0.6 * gain {
                        t *= 2.0;
                    }
                    break;
                }
                t *= 0.25;
            }
            let level = d[0].max(d[1]);
            // Only a little is left to gain, all in all.
            if !moved || gain < enough * level.abs() {
                break;
            }
        }
        Least { at: x, distances: d, slopes }
    }
}
