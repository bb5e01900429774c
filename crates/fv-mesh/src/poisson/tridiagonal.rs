//! The tridiagonal systems along the last axis, one per mode.
//!
//! For a mode with eigenvalue λ > 0 the system u_{j−1} − (2 + λ) u_j + u_{j+1} = z_j has constant
//! coefficients. With the ratio r < 1 that solves r + 1/r = 2 + λ it factors into two recurrences
//!
//! ```text
//! w_j = r w_{j−1} + z_j,      v_j = r v_{j+1} + w_j,      u = −r v,
//! ```
//!
//! so no table of pivots is read and nothing is divided. What the ends ask for enters through the
//! start of each recurrence. Layers j and n − 1 − j travel as the complex layer a + ib, j < n/2, so
//! both recurrences run over half of the layers and see two kinds of end: the outer one, where a
//! ghost layer is ±a, ±b or, in a periodic box, the other one of a and b; and the centre, where the
//! ghost of a is b and that of b is a. By images the start of the first recurrence is
//! `w_{−1} = R Σ_m r^m z_m`, with the reflection R at the outer end and z continued through the
//! centre; r^m cuts that sum short for all but the lowest modes, where it closes after n terms.
use super::AxisBounds;
use super::modes::{Modes, SEGMENT, WIDTH};
use pulp::{Simd, WithSimd};

/// Real numbers of a block in one layer.
pub(super) const LANES: usize = 2 * WIDTH;
type Lanes = [f64; LANES];

/// Coefficients of one block.
struct Block {
    /// r; zero where there is nothing to solve.
    ratio: Lanes,
    /// r to the power of the number of complex layers.
    power: Lanes,
    /// Terms that the starting sum needs, or more than there are layers for the closed sum.
    terms: usize,
}

/// The recurrences for all blocks.
pub(super) struct Sweep {
    bounds: AxisBounds,
    /// Complex layers.
    layers: usize,
    /// The last complex layer is the middle one, with a = b.
    odd: bool,
    /// Factor of the right-hand side.
    scale: f64,
    blocks: Vec<Block>,
}

/// Task for `pulp`: solves all modes of a block.
pub(super) struct BlockSolve<'a> {
    pub(super) sweep: &'a Sweep,
    pub(super) modes: &'a Modes,
    /// Which block.
    pub(super) b: usize,
    /// Real view of the transformed layers.
    pub(super) spectra: &'a [f64],
    /// Receives the solutions, layer by layer.
    pub(super) out: &'a mut [f64],
}

impl WithSimd for BlockSolve<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        // Registers that hold a block.
        match LANES / S::F64_LANES {
            2 => self.solve::<S, 2>(simd),
            4 => self.solve::<S, 4>(simd),
            8 => self.solve::<S, 8>(simd),
            _ => self.solve::<S, LANES>(simd),
        }
    }
}

impl Sweep {
    /// `lambda(kx, ky)` is the eigenvalue of a mode; zero leaves the mode out.
    pub(super) fn new(
        n: usize,
        bounds: AxisBounds,
        scale: f64,
        modes: &Modes,
        lambda: impl Fn(usize, usize) -> f64,
    ) -> Self {
        let layers = n.div_ceil(2);
        let block = |segments: &[usize; 2]| {
            let ratio: Lanes = std::array::from_fn(|lane| {
                let place = segments[lane / (2 * SEGMENT)] + lane / 2 % SEGMENT;
                let lambda = modes.at(place).map_or(0.0, |(kx, ky)| lambda(kx, ky));
                if lambda > 0.0 {
                    1.0 / (1.0 + 0.5 * lambda + (lambda + 0.25 * lambda * lambda).sqrt())
                } else {
                    0.0
                }
            });
            let largest = ratio.iter().fold(0.0_f64, |a, &r| a.max(r));
            // Terms below round-off of the sum: r^m < 1e-18 (1 − r).
            let terms = ((1e-18 * (1.0 - largest)).ln() / largest.ln()).ceil() as usize;
            Block { ratio, power: ratio.map(|r| r.powi(layers as i32)), terms }
        };
        let blocks = modes.blocks.iter().map(block).collect();
        Self { bounds, layers, odd: n % 2 == 1, scale, blocks }
    }
}

impl BlockSolve<'_> {
    #[inline(always)]
    fn solve<S: Simd, const N: usize>(self, simd: S) {
        let Sweep { bounds, layers, odd, scale, ref blocks } = *self.sweep;
        let block = &blocks[self.b];
        let mirror = &self.modes.mirror;
        let segments = self.modes.blocks[self.b].map(|place| 2 * place);
        let stride = 2 * self.modes.layer_stride;
        let r: [S::f64s; N] = to_registers::<S, N>(simd, &block.ratio);

        // The starting sum.
        let mut sum = [simd.splat_f64s(0.0); N];
        for s in (0..layers.min(block.terms)).rev() {
            recur(simd, &mut sum, &r, &load(simd, self.spectra, s * stride, segments));
        }
        let mut sum = to_lanes::<S, N>(&sum);
        if block.terms > layers {
            let mut beyond = [simd.splat_f64s(0.0); N];
            for s in 0..layers - usize::from(odd) {
                recur(simd, &mut beyond, &r, &load(simd, self.spectra, s * stride, segments));
            }
            self.sweep.close(block, &mut sum, &swapped(&to_lanes::<S, N>(&beyond), mirror), mirror);
        }

        // From the outer end to the centre.
        let mut w = to_registers::<S, N>(simd, &reflected(&sum, mirror, bounds));
        let mut last = w;
        for (s, row) in self.out.chunks_exact_mut(LANES).enumerate() {
            last = w;
            recur(simd, &mut w, &r, &load(simd, self.spectra, s * stride, segments));
            S::as_mut_simd_f64s(row).0.copy_from_slice(&w);
        }
        // The centre.
        let mut v = to_lanes::<S, N>(&w);
        let ghost = swapped(&to_lanes::<S, N>(if odd { &last } else { &w }), mirror);
        for (v, (ghost, r)) in v.iter_mut().zip(ghost.iter().zip(&block.ratio)) {
            *v = (*v + r * ghost) / (1.0 - r * r);
        }
        // And back; the centre's own row needs no recurrence.
        let mut v = to_registers::<S, N>(simd, &v);
        let mut factor = r;
        for f in &mut factor {
            *f = simd.mul_f64s(*f, simd.splat_f64s(-scale));
        }
        for (s, row) in self.out.chunks_exact_mut(LANES).enumerate().rev() {
            let row = S::as_mut_simd_f64s(row).0;
            for q in 0..N {
                if s + 1 < layers {
                    v[q] = simd.mul_add_e_f64s(v[q], r[q], row[q]);
                }
                row[q] = simd.mul_f64s(factor[q], v[q]);
            }
        }
    }
}

impl Sweep {
    /// Adds the terms beyond the centre to the starting sum Y. After n terms Y comes back as Q Y with
    /// Q = `around`, so Y = G + ρ Q Y with ρ = r^n and Y = (G + ρ Q G) / (1 − ρ² Q²); Q² is ±1.
    #[inline(always)]
    fn close(&self, block: &Block, sum: &mut Lanes, beyond: &Lanes, mirror: &[usize; WIDTH]) {
        let mixed = matches!(self.bounds, AxisBounds::NeumannDirichlet | AxisBounds::DirichletNeumann);
        let square = if mixed { -1.0 } else { 1.0 };
        for i in 0..LANES {
            sum[i] += block.power[i] * beyond[i];
        }
        let around = swapped(&reflected(sum, mirror, self.bounds), mirror);
        for i in 0..LANES {
            let (r, power) = (block.ratio[i], block.power[i]);
            // Zero ratios belong to no mode.
            let rho = if self.odd && r > 0.0 { power * (power / r) } else { power * power };
            sum[i] = (sum[i] + rho * around[i]) / (1.0 - square * rho * rho);
        }
    }
}

/// The block's modes in the layer that begins at `start`.
#[inline(always)]
fn load<S: Simd, const N: usize>(simd: S, spectra: &[f64], start: usize, segments: [usize; 2]) -> [S::f64s; N] {
    let [(low, _), (high, _)] = segments.map(|at| S::as_simd_f64s(&spectra[start + at..][..2 * SEGMENT]));
    let mut z = [simd.splat_f64s(0.0); N];
    z[..N / 2].copy_from_slice(low);
    z[N / 2..].copy_from_slice(high);
    z
}

/// w ← r w + z.
#[inline(always)]
fn recur<S: Simd, const N: usize>(simd: S, w: &mut [S::f64s; N], r: &[S::f64s; N], z: &[S::f64s; N]) {
    for q in 0..N {
        w[q] = simd.mul_add_e_f64s(w[q], r[q], z[q]);
    }
}

#[inline(always)]
fn to_registers<S: Simd, const N: usize>(simd: S, lanes: &Lanes) -> [S::f64s; N] {
    let mut registers = [simd.splat_f64s(0.0); N];
    registers.copy_from_slice(S::as_simd_f64s(lanes).0);
    registers
}

#[inline(always)]
fn to_lanes<S: Simd, const N: usize>(registers: &[S::f64s; N]) -> Lanes {
    let mut lanes = [0.0; LANES];
    S::as_mut_simd_f64s(&mut lanes).0.copy_from_slice(registers);
    lanes
}

/// a + ib → b + ia.
#[inline(always)]
fn swapped(z: &Lanes, mirror: &[usize; WIDTH]) -> Lanes {
    let mut swapped = [0.0; LANES];
    for (pair, &lane) in swapped.chunks_exact_mut(2).zip(mirror) {
        pair[0] = z[2 * lane + 1];
        pair[1] = z[2 * lane];
    }
    swapped
}

/// What a + ib looks like behind the outer ends.
#[inline(always)]
fn reflected(z: &Lanes, mirror: &[usize; WIDTH], bounds: AxisBounds) -> Lanes {
    // ±(a − ib) and so on.
    let (re, im) = match bounds {
        AxisBounds::Periodic => return swapped(z, mirror),
        AxisBounds::Neumann => return *z,
        AxisBounds::Dirichlet => return z.map(|z| -z),
        AxisBounds::NeumannDirichlet => (1.0, -1.0),
        AxisBounds::DirichletNeumann => (-1.0, 1.0),
    };
    let mut reflected = [0.0; LANES];
    for (pair, &lane) in reflected.chunks_exact_mut(2).zip(mirror) {
        pair[0] = re * z[2 * lane];
        pair[1] = im * z[2 * lane + 1];
    }
    reflected
}
