//! Smooth kernels that carry values between a lattice and points on a surface.

/// A one-dimensional kernel φ(r), r in cells; kernels of several dimensions are products of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kernel {
    /// Roma's three-point kernel smoothed over one cell, φ*(r) = ∫ φ(s) ds from r − ½ to r + ½
    /// (Yang et al. 2009, J. Comput. Phys. 228, 7821): support ± 2.
    Yang,
    /// The quartic B-spline: support ± 2½, three times differentiable.
    QuarticSpline,
    /// The quintic B-spline: support ± 3, four times differentiable.
    QuinticSpline,
}

/// The widest support of any kernel, in nodes.
pub const WIDEST: usize = 6;

impl Kernel {
    /// The one with the least cost whose forces stay quiet as a body crosses the grid: [`QuarticSpline`](Self::QuarticSpline) in
    /// the plane; [`Yang`](Self::Yang) in space, where more markers share what the grid does to each, and stencils are dearer.
    pub fn suited(dim: usize) -> Self {
        if dim == 2 { Self::QuarticSpline } else { Self::Yang }
    }
    /// The support, in cells: so many nodes lie in it.
    pub fn width(self) -> usize {
        match self {
            Self::Yang => 4,
            Self::QuarticSpline => 5,
            Self::QuinticSpline => 6,
        }
    }
    /// Half of it.
    pub(crate) fn reach(self) -> f64 {
        0.5 * self.width() as f64
    }
    /// φ at the nodes around a point: entry i belongs to node i − ⌊(width − 1)/2⌋ from the one which is `t` cells behind the
    /// point: the nearest one (−½ ≤ t < ½) if the width is odd, else the last one before it (0 ≤ t < 1). The others are zero.
    pub fn weights(self, t: f64) -> [f64; WIDEST] {
        self.weights_of([t]).map(|[w]| w)
    }
    /// The same for several points at once, in loops that the compiler makes vectors of: first entry 0 of each, …
    #[inline(always)]
    pub(crate) fn weights_of<const N: usize>(self, t: [f64; N]) -> [[f64; N]; WIDEST] {
        let mut out = [[0.0; N]; WIDEST];
        match self {
            Self::Yang => {
                // The two inner nodes from the closed form, which share root and arc sine; the two
                // outer ones because the weights sum to one and keep the first moment.
                for p in 0..N {
                    let (t, rise) = (t[p], t[p] * (1.0 - t[p]));
                    let (odd, root) = (2.0 * t - 1.0, (1.0 + 12.0 * rise).sqrt());
                    // arcsin(x) = 2 arctan(x/(1 + √(1 − x²))) with x = √¾ (2t − 1), for which √(1 − x²) is half the root.
                    let arc = ROOT_3 / 6.0 * small_arctan(ROOT_3 * odd / (2.0 + root));
                    let even = 17.0 / 48.0 + ROOT_3 * std::f64::consts::PI / 108.0 + 0.25 * rise;
                    let odd = -root * odd / 16.0 - arc;
                    let (here, next) = (even + odd, even - odd);
                    let rest = 1.0 - here - next;
                    let last = (t * here - (1.0 - t) * next + (1.0 + t) * rest) / 3.0;
                    (out[0][p], out[1][p], out[2][p], out[3][p]) = (rest - last, here, next, last);
                }
            }
            Self::QuarticSpline => {
                // Polynomials of the outer nodes and the middle one; the others because the weights sum to one and keep the
                // first moment.
                for p in 0..N {
                    let t = t[p];
                    let (square, before, after) = (t * t, (0.5 - t) * (0.5 - t), (0.5 + t) * (0.5 + t));
                    let (first, last) = (before * before / 24.0, after * after / 24.0);
                    let middle = 115.0 / 192.0 + square * (0.25 * square - 0.625);
                    let (sum, difference) = (1.0 - first - middle - last, t + 2.0 * (first - last));
                    (out[0][p], out[2][p], out[4][p]) = (first, middle, last);
                    (out[1][p], out[3][p]) = (0.5 * (sum - difference), 0.5 * (sum + difference));
                }
            }
            Self::QuinticSpline => {
                for (i, out) in out.iter_mut().enumerate() {
                    for p in 0..N {
                        let r = (i as f64 - 2.0 - t[p]).abs();
                        let power = |a: f64| {
                            let x = if a > r { a - r } else { 0.0 };
                            x * x * (x * x) * x
                        };
                        out[p] = (power(3.0) - 6.0 * power(2.0) + 15.0 * power(1.0)) / 120.0;
                    }
                }
            }
        }
        out
    }
    /// c = ⟨Σ_i φ(i − s)²⟩ over all offsets s: a sheet of markers that spreads a force and reads
    /// the velocity back sees c times it, so 1/c is the relaxation of a forcing pass.
    pub fn self_overlap(self) -> f64 {
        match self {
            Self::Yang => 0.445_935_177_7,
            Self::QuarticSpline => 0.430_417_769_0,
            Self::QuinticSpline => 0.393_925_565_2,
        }
    }
    /// How far markers stand inside the surface, in cells: with a sheet of markers at no slip, the
    /// linear shear outside extrapolates to zero this far outside the sheet:
    /// r_d = ½ ⟨Σ_ij φ(i−s) φ(j−s) |i−j|⟩.
    pub fn retraction(self) -> f64 {
        match self {
            Self::Yang => 0.311_607_020_2,
            Self::QuarticSpline => 0.327_821_869_5,
            Self::QuinticSpline => 0.366_040_113_4,
        }
    }
}

const ROOT_3: f64 = 1.732_050_807_568_877_2;

/// arctan(y) for y² ≤ ⅓, but for round-off: a fit of arctan(y)/y by a polynomial of y² at Chebyshev points. The library's is a
/// call per number.
#[inline(always)]
fn small_arctan(y: f64) -> f64 {
    const TERMS: [f64; 14] = [
        1.0,
        -0.333_333_333_333_324_4,
        0.199_999_999_998_250_5,
        -0.142_857_142_721_794_76,
        0.111_111_105_626_985_95,
        -0.090_908_957_215_496_52,
        0.076_920_953_640_809_75,
        -0.066_643_605_491_214_98,
        0.058_647_108_127_846_334,
        -0.051_665_357_405_276_89,
        0.043_807_658_502_577_104,
        -0.032_670_927_971_294_98,
        0.018_105_276_817_683_272,
        -0.005_285_678_082_762_665,
    ];
    let s = y * y;
    let mut sum = 0.0;
    for term in TERMS.iter().rev() {
        sum = sum * s + term;
    }
    y * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_arctan_is_the_arctan() {
        for step in -1000..=1000 {
            let y = f64::from(step) * 1e-3 / ROOT_3;
            assert!((small_arctan(y) - y.atan()).abs() <= 4.5e-16 * y.abs(), "{y}");
        }
    }

    const KERNELS: [Kernel; 3] = [Kernel::Yang, Kernel::QuarticSpline, Kernel::QuinticSpline];

    /// Step `step` of `steps` over all offsets of a point from its nodes.
    fn offset(kernel: Kernel, step: usize, steps: usize) -> f64 {
        (step as f64 + 0.5) / steps as f64 - if kernel.width() % 2 == 1 { 0.5 } else { 0.0 }
    }

    #[test]
    fn weights_sum_to_one_and_keep_the_first_moment() {
        for kernel in KERNELS {
            for step in 0..100 {
                let t = offset(kernel, step, 100);
                let (w, first) = (kernel.weights(t), -(((kernel.width() - 1) / 2) as f64));
                let sum: f64 = w.iter().sum();
                let moment: f64 = w.iter().enumerate().map(|(i, w)| w * (first + i as f64 - t)).sum();
                assert!((sum - 1.0).abs() < 1e-14 && moment.abs() < 1e-14, "{kernel:?} {t}: {sum} {moment}");
            }
        }
    }

    #[test]
    fn yang_is_roma_smoothed_over_a_cell() {
        // Roma, Peskin & Berger 1999, integrated by the midpoint rule.
        let roma = |r: f64| match r.abs() {
            r if r <= 0.5 => (1.0 + (1.0 - 3.0 * r * r).sqrt()) / 3.0,
            r if r <= 1.5 => (5.0 - 3.0 * r - (1.0 - 3.0 * (1.0 - r) * (1.0 - r)).max(0.0).sqrt()) / 6.0,
            _ => 0.0,
        };
        for step in 0..20 {
            let t = f64::from(step) / 20.0;
            for (i, w) in Kernel::Yang.weights(t).into_iter().take(4).enumerate() {
                let (centre, n) = (i as f64 - 1.0 - t, 20_000);
                let mean =
                    (0..n).map(|k| roma(centre - 0.5 + (f64::from(k) + 0.5) / f64::from(n))).sum::<f64>();
                assert!((w - mean / f64::from(n)).abs() < 1e-7, "{t} {i}: {w}");
            }
        }
    }

    /// Σ_k (−1)^k C(n + 1, k) (½(n + 1) − k − |r|)₊ⁿ / n! is the B-spline of degree n.
    #[test]
    fn splines_are_what_their_name_says() {
        let spline = |degree: i32, r: f64| {
            let order = degree + 1;
            let (mut sum, mut signed_binomial) = (0.0, 1.0);
            for k in 0..=order {
                sum +=
                    signed_binomial * (0.5 * f64::from(order) - f64::from(k) - r.abs()).max(0.0).powi(degree);
                signed_binomial *= -f64::from(order - k) / f64::from(k + 1);
            }
            sum / (1..=degree).map(f64::from).product::<f64>()
        };
        for (kernel, degree) in [(Kernel::QuarticSpline, 4), (Kernel::QuinticSpline, 5)] {
            for step in 0..20 {
                let t = offset(kernel, step, 20);
                for (i, w) in kernel.weights(t).into_iter().enumerate().take(kernel.width()) {
                    let r = i as f64 - ((kernel.width() - 1) / 2) as f64 - t;
                    assert!((w - spline(degree, r)).abs() < 1e-14, "{kernel:?} {r}: {w}");
                }
            }
        }
    }

    #[test]
    fn constants_follow_from_the_kernel() {
        for kernel in KERNELS {
            let (mut c, mut spread) = (0.0, 0.0);
            let samples = 20_000;
            for step in 0..samples {
                let w = kernel.weights(offset(kernel, step, samples));
                for (i, wi) in w.into_iter().enumerate() {
                    c += wi * wi;
                    for (j, wj) in w.into_iter().enumerate() {
                        spread += 0.5 * wi * wj * i.abs_diff(j) as f64;
                    }
                }
            }
            let n = samples as f64;
            assert!((c / n - kernel.self_overlap()).abs() < 1e-9, "{kernel:?} c {}", c / n);
            assert!((spread / n - kernel.retraction()).abs() < 1e-9, "{kernel:?} r_d {}", spread / n);
        }
    }
}
