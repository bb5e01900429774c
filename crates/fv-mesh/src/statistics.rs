//! Sums over the flow field.
use crate::{CartesianGrid, Field, kernels};
use interfaces::Vector;
use pulp::{Arch, Simd, WithSimd};

/// Integrals and extremes of a velocity field.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FlowStatistics {
    /// ∫ u dV \[m⁴/s\] (plane: m³/s per metre).
    pub volume_flow: Vector,
    /// ½ ρ ∫ |u|² dV \[J\].
    pub kinetic_energy: f64,
    /// ρ ν ∫ |∇u|² dV \[W\], differences taken between neighbouring nodes of each component: what
    /// the discrete viscous term takes from the kinetic energy.
    pub dissipation: f64,
    /// Largest |∇·u| \[1/s\].
    pub divergence: f64,
}

/// Independent partial sums, so that reductions run in vector registers in a fixed order.
const LANES: usize = 8;

#[inline(always)]
fn lanes(n: usize, mut term: impl FnMut(usize) -> f64) -> f64 {
    let mut sum = [0.0; LANES];
    let whole = n - n % LANES;
    for i in (0..whole).step_by(LANES) {
        for l in 0..LANES {
            sum[l] += term(i + l);
        }
    }
    for i in whole..n {
        sum[i - whole] += term(i);
    }
    ((sum[0] + sum[1]) + (sum[2] + sum[3])) + ((sum[4] + sum[5]) + (sum[6] + sum[7]))
}

/// Largest |u_c| over all rows, or NaN if any value is not finite.
pub(crate) fn largest<const D: usize>(u: &Field<D>) -> f64 {
    Arch::new().dispatch(Largest(u))
}

struct Largest<'a, const D: usize>(&'a Field<D>);

impl<const D: usize> WithSimd for Largest<'_, D> {
    type Output = f64;
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> f64 {
        let mut top = [0.0_f64; LANES];
        // 0·x is 0 for every finite x and NaN for the others.
        let mut check = [0.0_f64; LANES];
        let mut take = |x: &[f64]| {
            for (l, x) in x.iter().enumerate() {
                let a = x.abs();
                top[l] = if a > top[l] { a } else { top[l] };
                check[l] += 0.0 * x;
            }
        };
        for r in 0..self.0.n_rows() {
            let (whole, rest) = self.0.row(r).as_chunks::<LANES>();
            whole.iter().for_each(|x| take(x));
            take(rest);
        }
        top.into_iter().fold(0.0, f64::max) + check.into_iter().sum::<f64>()
    }
}

/// Sums of one row: per component Σu; Σu², Σ(difference/h)², max |∇·u| over all components.
struct RowSums<'a, const D: usize> {
    grid: &'a CartesianGrid<D>,
    velocity: &'a [Field<D>; D],
    row: usize,
    scratch: &'a mut [f64],
}

impl<const D: usize> WithSimd for RowSums<'_, D> {
    type Output = ([f64; D], f64, f64, f64);
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let Self { grid, velocity, row, scratch } = self;
        let (n, s, h) = (grid.cells()[0], grid.stride(), grid.spacing());
        let o = velocity[0].row_start(row);
        let (mut sum, mut square, mut gradient) = ([0.0; D], 0.0, 0.0);
        for c in 0..D {
            let u = velocity[c].data();
            let here = &u[o..][..n];
            sum[c] = lanes(n, |i| here[i]);
            square += lanes(n, |i| here[i] * here[i]);
            for b in 0..D {
                let below = &u[o - s[b]..][..n];
                gradient += lanes(n, |i| (here[i] - below[i]) * (here[i] - below[i])) / (h[b] * h[b]);
            }
        }
        kernels::divergence_row(grid, row, velocity, 1.0, scratch);
        let mut top = 0.0;
        for d in scratch.iter() {
            let d = d.abs();
            top = if d > top { d } else { top };
        }
        (sum, square, gradient, top)
    }
}

pub(crate) fn measure<const D: usize>(
    grid: &CartesianGrid<D>,
    velocity: &[Field<D>; D],
    density: f64,
    viscosity: f64,
    scratch: &mut [f64],
) -> FlowStatistics {
    let (n, volume) = (grid.cells()[0], grid.cell_volume());
    let mut out = FlowStatistics::default();
    for row in 0..velocity[0].n_rows() {
        let sums = RowSums { grid, velocity, row, scratch: &mut scratch[..n] };
        let (sum, square, gradient, divergence) = Arch::new().dispatch(sums);
        for c in 0..D {
            out.volume_flow[c] += sum[c] * volume;
        }
        out.kinetic_energy += 0.5 * density * volume * square;
        out.dissipation += density * viscosity * volume * gradient;
        out.divergence = out.divergence.max(divergence);
    }
    out
}
