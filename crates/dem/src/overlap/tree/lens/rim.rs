//! The rim of a lens: where both surfaces meet, azimuth by azimuth.
use super::super::seen::Seen;
use interfaces::Vector;

/// A point of the rim: `q` is the square of its distance from the axis over that of the ellipse with the frame's half-axes,
/// `z` its height \[m\].
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Rim {
    pub(super) q: f64,
    pub(super) z: f64,
    /// Of each body's distance, the slopes along q and z.
    pub(super) slope: [[f64; 2]; 2],
}

impl Rim {
    /// Between two others.
    pub(super) fn between(&self, o: &Self) -> Self {
        let mean = |a: f64, b: f64| 0.5 * (a + b);
        let slope = [0, 1].map(|i| [0, 1].map(|k| mean(self.slope[i][k], o.slope[i][k])));
        Self { q: mean(self.q, o.q), z: mean(self.z, o.z), slope }
    }
    /// The change of q and z that takes both distances `f` to zero if they go on as the slopes say.
    /// None where the gap between the surfaces would not open outwards.
    pub(super) fn step(&self, f: [f64; 2]) -> Option<[f64; 2]> {
        let [a, b] = self.slope;
        let det = a[0] * b[1] - a[1] * b[0];
        (det < 0.0).then(|| [(a[1] * f[1] - b[1] * f[0]) / det, (b[0] * f[0] - a[0] * f[1]) / det])
    }
}

/// Both bodies in the frame of a lens: u and v across, z along its axis from the first body to the second.
#[derive(Clone, Copy)]
pub(super) struct Sight<'a> {
    pub(super) bodies: [Seen<'a>; 2],
    /// Half-axes of the rim, about \[m\].
    pub(super) wide: [f64; 2],
    /// Half the thickness, about \[m\].
    pub(super) thick: f64,
}

impl Sight<'_> {
    /// Farther no point is looked at than distances are known.
    fn band(&self) -> f64 {
        8.0 * (self.wide[0] + self.wide[1] + self.thick)
    }
    pub(super) fn distance(&self, body: usize, x: Vector) -> f64 {
        self.bodies[body].distance(x, self.band())
    }
    /// Of both, at a place of the half-plane of `azimuth`, its cosine and sine.
    pub(super) fn both(&self, azimuth: [f64; 2], q: f64, z: f64) -> [f64; 2] {
        let x = self.place(azimuth, q.sqrt(), z);
        [0, 1].map(|i| self.distance(i, x))
    }
    pub(super) fn place(&self, azimuth: [f64; 2], r: f64, z: f64) -> Vector {
        Vector::new(r * self.wide[0] * azimuth[0], r * self.wide[1] * azimuth[1], z)
    }

    /// Where body `i` ends on the axis, and the mean slope from `f`, its distance at the centre, to there.
    pub(super) fn pole(&self, i: usize, f: f64, accuracy: f64) -> Option<[f64; 2]> {
        let way = if i == 0 { 1.0 } else { -1.0 };
        let mut slope = way;
        let (mut z, mut d) = (0.0, f);
        for _ in 0..24 {
            let step = -d / slope;
            let next = z + step;
            if step.abs() <= accuracy * next.abs() {
                return (next != 0.0 && f != 0.0).then_some([next, -f / next]);
            }
            let there = self.distance(i, Vector::new(0.0, 0.0, next));
            let secant = (there - d) / step;
            // Where it does not grow, no farther than it is to the surface.
            slope = if secant * way > 0.0 { secant } else { way };
            (z, d) = (next, there);
        }
        None
    }

    /// The rim in one half-plane from a guess of it, to a share of `accuracy` of width and thickness; `steep` are the slopes of the
    /// distances along the axis.
    pub(super) fn rim(&self, azimuth: [f64; 2], guess: Rim, accuracy: f64, steep: [f64; 2]) -> Option<Rim> {
        let found = self.steps(azimuth, guess, accuracy);
        found.or_else(|| self.steps(azimuth, self.march(azimuth, steep)?, accuracy))
    }

    /// From the axis outwards along the places that are as far from the one surface as from the other, until they are outside.
    fn march(&self, azimuth: [f64; 2], steep: [f64; 2]) -> Option<Rim> {
        let even = |q: f64, mut z: f64| {
            let mut f = self.both(azimuth, q, z);
            for _ in 0..2 {
                z -= (f[0] - f[1]) / (steep[0] - steep[1]);
                f = self.both(azimuth, q, z);
            }
            (z, f)
        };
        let mut r = 0.25 * self.thick / self.wide[0].max(self.wide[1]);
        let (mut low, (mut z, mut f)) = (r * r, even(r * r, 0.0));
        for _ in 0..24 {
            r *= 1.3;
            let q = r * r;
            let (there, g) = even(q, z);
            if g[0] + g[1] >= 0.0 {
                let slope = [0, 1].map(|i| [(g[i] - f[i] - steep[i] * (there - z)) / (q - low), steep[i]]);
                let share = (f[0] + f[1]) / (f[0] + f[1] - g[0] - g[1]);
                return Some(Rim { q: low + share * (q - low), z: z + share * (there - z), slope });
            }
            (low, z, f) = (q, there, g);
        }
        None
    }

    /// By steps from the guess (Broyden 1965).
    fn steps(&self, azimuth: [f64; 2], guess: Rim, accuracy: f64) -> Option<Rim> {
        let mut at = guess;
        let mut f = self.both(azimuth, at.q, at.z);
        for _ in 0..12 {
            let [dq, dz] = at.step(f)?;
            // No farther than the slopes can be trusted.
            let mut share = 1.0_f64;
            if dq > 3.0 * at.q {
                share = 3.0 * at.q / dq;
            } else if dq < -0.75 * at.q {
                share = -0.75 * at.q / dq;
            }
            let (dq, dz) = (share * dq, share * dz);
            let last = dq.abs() <= accuracy * at.q && dz.abs() <= accuracy * self.thick;
            at.q += dq;
            at.z += dz;
            if last {
                return Some(at);
            }
            let there = self.both(azimuth, at.q, at.z);
            // What the slopes did not foresee is put down to the direction gone.
            let (along, across) = (dq / at.q, dz / self.thick);
            let square = along * along + across * across;
            for i in 0..2 {
                let odd = there[i] - (1.0 - share) * f[i];
                at.slope[i][0] += odd * along / (square * at.q);
                at.slope[i][1] += odd * across / (square * self.thick);
            }
            f = there;
        }
        None
    }
}
