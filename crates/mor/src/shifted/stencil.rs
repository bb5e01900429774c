//! Weights of neighbouring values, and sums along one axis.
use std::f64::consts::PI;

/// How a field is known between the centres of its cells, `h` their distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Interpolation {
    /// Between two values; error ¼ h² |q″| / 2.
    Lagrange1,
    /// Polynomials through four values; error (9/16) h⁴ |q⁗| / 4!.
    Lagrange3,
    /// Polynomials through six values; error (225/64) h⁶ |q⁽⁶⁾| / 6!.
    Lagrange5,
    /// Twice continuously differentiable, of third degree.
    CubicSpline,
    /// Four times continuously differentiable, of fifth degree.
    QuinticSpline,
    /// The trigonometric polynomial through all values of a period: exact for all waves of more
    /// than two cells. The wave of two cells, whose phase is not known, is multiplied by cos(π
    /// s/h), so that a real field stays real. On a bounded axis of n cells, the polynomial through
    /// the values and their mirror image (a cosine series of period 2n): spectral accuracy for
    /// fields with slope 0 at the ends.
    Spectral,
}

impl Interpolation {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Lagrange1,
        Self::Lagrange3,
        Self::Lagrange5,
        Self::CubicSpline,
        Self::QuinticSpline,
        Self::Spectral,
    ];

    /// What tables and files call it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Lagrange1 => "Lagrange polynomials of degree 1",
            Self::Lagrange3 => "Lagrange polynomials of degree 3",
            Self::Lagrange5 => "Lagrange polynomials of degree 5",
            Self::CubicSpline => "cubic spline",
            Self::QuinticSpline => "quintic spline",
            Self::Spectral => "spectral",
        }
    }

    /// A point between two values takes `reach` values on either side.
    pub(super) fn reach(self) -> usize {
        match self {
            Self::Lagrange1 => 1,
            Self::Lagrange3 | Self::CubicSpline => 2,
            Self::Lagrange5 | Self::QuinticSpline | Self::Spectral => 3,
        }
    }

    /// Weights of the values (of the coefficients of a spline) at 1 − reach … reach for the point t in [0, 1) behind that at 0.
    pub(super) fn weights(self, t: f64) -> [f64; 6] {
        let lagrange = |p: i32| {
            std::array::from_fn(|l| {
                let at = l as i32 + 1 - p;
                let others = (1 - p..=p).filter(|&m| m != at && at <= p);
                let product: f64 = others.map(|m| (t - f64::from(m)) / f64::from(at - m)).product();
                if at <= p { product } else { 0.0 }
            })
        };
        match self {
            Self::Lagrange1 => lagrange(1),
            Self::Lagrange3 => lagrange(2),
            Self::Lagrange5 => lagrange(3),
            Self::CubicSpline => std::array::from_fn(|l| cubic((t + 1.0 - l as f64).abs())),
            Self::QuinticSpline | Self::Spectral => {
                std::array::from_fn(|l| quintic((t + 2.0 - l as f64).abs()))
            }
        }
    }

    /// The values of its basis function at 0, 1 and 2, if that is not 1, 0, 0.
    pub(super) fn basis(self) -> Option<[f64; 3]> {
        match self {
            Self::Lagrange1 | Self::Lagrange3 | Self::Lagrange5 => None,
            Self::CubicSpline => Some([0, 1, 2].map(|x| cubic(f64::from(x)))),
            Self::QuinticSpline | Self::Spectral => Some([0, 1, 2].map(|x| quintic(f64::from(x)))),
        }
    }
}

/// The centred B-spline of third degree at x ≥ 0.
fn cubic(x: f64) -> f64 {
    let part = |edge: f64| (edge - x).max(0.0).powi(3);
    (part(2.0) - 4.0 * part(1.0)) / 6.0
}

/// The centred B-spline of fifth degree at x ≥ 0.
fn quintic(x: f64) -> f64 {
    let part = |edge: f64| (edge - x).max(0.0).powi(5);
    (part(3.0) - 6.0 * part(2.0) + 15.0 * part(1.0)) / 120.0
}

/// What a shift by `s` cells does to the wave number `m` of `n` cells: e^(−2πi m s/n), and cos(π s) if m = n/2.
pub(super) fn phase(m: usize, n: usize, s: f64) -> [f64; 2] {
    let signed = if 2 * m > n { m as f64 - n as f64 } else { m as f64 };
    // Whole periods are taken away first, so that long ways cost no digits.
    let (sin, cos) = (-2.0 * PI * signed * (s.rem_euclid(n as f64) / n as f64)).sin_cos();
    if 2 * m == n { [(PI * s.rem_euclid(2.0)).cos(), 0.0] } else { [cos, sin] }
}

/// An array by blocks of `inner` values: `outer` × `n` of them, to be summed along `n`.
#[derive(Clone, Copy)]
pub(super) struct Lines {
    pub(super) n: usize,
    pub(super) inner: usize,
}

impl Lines {
    /// out(i) = Σ_l w_l q(index(i + l)).
    pub(super) fn gather(
        self,
        weights: &[f64],
        index: &[usize],
        from: &[f64],
        n_from: usize,
        out: &mut [f64],
    ) {
        let Self { n, inner } = self;
        let mut line = vec![0.0; index.len()];
        for (out, from) in out.chunks_exact_mut(n * inner).zip(from.chunks_exact(n_from * inner)) {
            if inner == 1 {
                line.iter_mut().zip(index).for_each(|(x, &i)| *x = from[i]);
                out.fill(0.0);
                for (l, w) in weights.iter().enumerate() {
                    out.iter_mut().zip(&line[l..]).for_each(|(out, x)| *out += w * x);
                }
                continue;
            }
            for (i, out) in out.chunks_exact_mut(inner).enumerate() {
                out.fill(0.0);
                for (w, &at) in weights.iter().zip(&index[i..]) {
                    let row = &from[at * inner..][..inner];
                    out.iter_mut().zip(row).for_each(|(out, x)| *out += w * x);
                }
            }
        }
    }

    /// The transpose: out(index(i + l)) += w_l q(i), from zero.
    pub(super) fn scatter(
        self,
        weights: &[f64],
        index: &[usize],
        from: &[f64],
        n_out: usize,
        out: &mut [f64],
    ) {
        let Self { n, inner } = self;
        out.fill(0.0);
        for (out, from) in out.chunks_exact_mut(n_out * inner).zip(from.chunks_exact(n * inner)) {
            for (i, row) in from.chunks_exact(inner).enumerate() {
                for (w, &at) in weights.iter().zip(&index[i..]) {
                    let out = &mut out[at * inner..][..inner];
                    out.iter_mut().zip(row).for_each(|(out, x)| *out += w * x);
                }
            }
        }
    }
}
