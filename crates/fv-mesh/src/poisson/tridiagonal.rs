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

    /// Solves all modes of block `b`: reads them from the layers of `spectra`, which are `stride`
    /// real numbers apart, and writes them to the rows of `out`.
    #[inline(always)]
    pub(super) fn solve_block(&self, b: usize, modes: &Modes, spectra: &[f64], out: &mut [f64]) {
        let Block { ratio: r, power, terms } = &self.blocks[b];
        let segments = modes.blocks[b].map(|place| 2 * place);
        let stride = 2 * modes.layer_stride;
        let layer = |s: usize| load(&spectra[s * stride..(s + 1) * stride], segments);
        let swap = |z: &Lanes| swapped(z, &modes.mirror);
        let reflect = |z: &Lanes| reflected(z, &modes.mirror, self.bounds);

        // The starting sum.
        let mut sum = [0.0; LANES];
        for s in (0..self.layers.min(*terms)).rev() {
            recur(&mut sum, r, &layer(s));
        }
        if *terms > self.layers {
            let mut beyond = [0.0; LANES];
            for s in 0..self.layers - usize::from(self.odd) {
                recur(&mut beyond, r, &layer(s));
            }
            self.close(r, power, &mut sum, &swap(&beyond), |z| swap(&reflect(z)));
        }

        // From the outer end to the centre and back.
        let mut w = reflect(&sum);
        let mut last = w;
        let mut rows = out.chunks_exact_mut(LANES).enumerate();
        for (s, row) in rows.by_ref() {
            last = w;
            recur(&mut w, r, &layer(s));
            row.copy_from_slice(&w);
        }
        let ghost = swap(if self.odd { &last } else { &w });
        let mut v: Lanes = std::array::from_fn(|i| (w[i] + r[i] * ghost[i]) / (1.0 - r[i] * r[i]));
        let factor = r.map(|r| -r * self.scale);
        let mut rows = out.chunks_exact_mut(LANES).rev();
        if let Some(row) = rows.next() {
            row.copy_from_slice(&std::array::from_fn::<_, LANES, _>(|i| factor[i] * v[i]));
        }
        for row in rows {
            for i in 0..LANES {
                v[i] = v[i].mul_add(r[i], row[i]);
                row[i] = factor[i] * v[i];
            }
        }
    }

    /// Adds the terms beyond the centre to the starting sum Y. After n terms Y comes back as Q Y with
    /// Q = `around`, so Y = G + ρ Q Y with ρ = r^n and Y = (G + ρ Q G) / (1 − ρ² Q²); Q² is ±1.
    #[inline(always)]
    fn close(&self, r: &Lanes, power: &Lanes, sum: &mut Lanes, beyond: &Lanes, around: impl Fn(&Lanes) -> Lanes) {
        let mixed = matches!(self.bounds, AxisBounds::NeumannDirichlet | AxisBounds::DirichletNeumann);
        let square = if mixed { -1.0 } else { 1.0 };
        for i in 0..LANES {
            sum[i] += power[i] * beyond[i];
        }
        let turned = around(sum);
        for i in 0..LANES {
            // Zero ratios belong to no mode.
            let ahead = if self.odd && r[i] > 0.0 { power[i] / r[i] } else { power[i] };
            let rho = power[i] * ahead;
            sum[i] = (sum[i] + rho * turned[i]) / (1.0 - square * rho * rho);
        }
    }
}

/// The block's modes in one layer.
#[inline(always)]
fn load(layer: &[f64], segments: [usize; 2]) -> Lanes {
    let [low, high] = segments.map(|at| &layer[at..at + 2 * SEGMENT]);
    std::array::from_fn(|i| if i < 2 * SEGMENT { low[i] } else { high[i - 2 * SEGMENT] })
}

/// w ← r w + z.
#[inline(always)]
fn recur(w: &mut Lanes, r: &Lanes, z: &Lanes) {
    for i in 0..LANES {
        w[i] = w[i].mul_add(r[i], z[i]);
    }
}

/// a + ib → b + ia.
#[inline(always)]
fn swapped(z: &Lanes, mirror: &[usize; WIDTH]) -> Lanes {
    std::array::from_fn(|i| z[2 * mirror[i / 2] + 1 - i % 2])
}

/// What a + ib looks like behind the outer ends.
#[inline(always)]
fn reflected(z: &Lanes, mirror: &[usize; WIDTH], bounds: AxisBounds) -> Lanes {
    // a − ib.
    let conjugate = |sign: f64| {
        std::array::from_fn(|i| {
            let part = sign * z[2 * mirror[i / 2] + i % 2];
            if i % 2 == 0 { part } else { -part }
        })
    };
    match bounds {
        AxisBounds::Periodic => swapped(z, mirror),
        AxisBounds::Neumann => *z,
        AxisBounds::Dirichlet => z.map(|z| -z),
        AxisBounds::NeumannDirichlet => conjugate(1.0),
        AxisBounds::DirichletNeumann => conjugate(-1.0),
    }
}
