//! Smooth kernels that carry values between a lattice and points on a surface.

/// A one-dimensional kernel φ(r), r in cells; kernels of several dimensions are products of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kernel {
    /// Roma's three-point kernel smoothed over one cell, φ*(r) = ∫ φ(s) ds from r − ½ to r + ½
    /// (Yang et al. 2009, J. Comput. Phys. 228, 7821): support ± 2.
    #[default]
    Yang,
    /// The quintic B-spline: support ± 3, four times differentiable.
    QuinticSpline,
}

/// The widest support of any kernel, in nodes.
pub const WIDEST: usize = 6;

impl Kernel {
    /// Half the support, in cells.
    pub(crate) fn reach(self) -> usize {
        match self {
            Self::Yang => 2,
            Self::QuinticSpline => 3,
        }
    }
    /// φ at the distances of the 2·reach nodes around a point: entry i belongs to the node
    /// i + 1 − reach cells from the last node not after the point, which is 0 ≤ `t` < 1 behind.
    pub fn weights(self, t: f64) -> [f64; WIDEST] {
        match self {
            Self::Yang => {
                // The two inner nodes from the closed form, which share root and arc sine; the two
                // outer ones because the weights sum to one and keep the first moment.
                let root = (1.0 + 12.0 * t * (1.0 - t)).sqrt() * (1.0 - 2.0 * t) / 16.0;
                let arc = 3.0_f64.sqrt() / 12.0 * (0.75_f64.sqrt() * (2.0 * t - 1.0)).asin();
                let even = 17.0 / 48.0 + 3.0_f64.sqrt() * std::f64::consts::PI / 108.0 + 0.25 * t * (1.0 - t);
                let odd = root - arc;
                let (here, next) = (even + odd, even - odd);
                let rest = 1.0 - here - next;
                let last = (t * here - (1.0 - t) * next + (1.0 + t) * rest) / 3.0;
                [rest - last, here, next, last, 0.0, 0.0]
            }
            Self::QuinticSpline => std::array::from_fn(|i| {
                let r = (i as f64 - 2.0 - t).abs();
                let p = |a: f64| (a - r).max(0.0).powi(5);
                (p(3.0) - 6.0 * p(2.0) + 15.0 * p(1.0)) / 120.0
            }),
        }
    }
    /// c = ⟨Σ_i φ(i − s)²⟩ over all offsets s: a sheet of markers that spreads a force and reads
    /// the velocity back sees c times it, so 1/c is the relaxation of a forcing pass.
    pub fn self_overlap(self) -> f64 {
        match self {
            Self::Yang => 0.445_935_177_7,
            Self::QuinticSpline => 0.393_925_565_2,
        }
    }
    /// How far markers stand inside the surface, in cells: with a sheet of markers at no slip, the
    /// linear shear outside extrapolates to zero this far outside the sheet:
    /// r_d = ½ ⟨Σ_ij φ(i−s) φ(j−s) |i−j|⟩.
    pub fn retraction(self) -> f64 {
        match self {
            Self::Yang => 0.311_607_020_2,
            Self::QuinticSpline => 0.366_040_113_4,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KERNELS: [Kernel; 2] = [Kernel::Yang, Kernel::QuinticSpline];

    #[test]
    fn weights_sum_to_one_and_keep_the_first_moment() {
        for kernel in KERNELS {
            for step in 0..100 {
                let t = f64::from(step) / 100.0;
                let (w, first) = (kernel.weights(t), 1.0 - kernel.reach() as f64);
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

    #[test]
    fn constants_follow_from_the_kernel() {
        for kernel in KERNELS {
            let (mut c, mut spread) = (0.0, 0.0);
            let samples = 20_000;
            for step in 0..samples {
                let w = kernel.weights((f64::from(step) + 0.5) / f64::from(samples));
                for (i, wi) in w.into_iter().enumerate() {
                    c += wi * wi;
                    for (j, wj) in w.into_iter().enumerate() {
                        spread += 0.5 * wi * wj * i.abs_diff(j) as f64;
                    }
                }
            }
            let n = f64::from(samples);
            assert!((c / n - kernel.self_overlap()).abs() < 1e-9, "{kernel:?} c {}", c / n);
            assert!((spread / n - kernel.retraction()).abs() < 1e-9, "{kernel:?} r_d {}", spread / n);
        }
    }
}
