//! The explicit part of a scalar's step.
use crate::Field;
use crate::field::row_start;
use crate::grid::GHOSTS;
use crate::kernels::{for_layers, row_place};
use crate::operators::{Carried, with_kind};
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

/// Coefficients of one step.
#[derive(Clone, Copy)]
pub(super) struct Step<const D: usize> {
    /// Length \[s\].
    pub(super) dt: f64,
    /// Weights of the new and the last tendency.
    pub(super) weights: [f64; 2],
    /// Diffusivity \[m²/s\] along the axes whose diffusion is explicit (else zero) …
    pub(super) explicit: [f64; D],
    /// … and along those whose diffusion is implicit.
    pub(super) implicit: [f64; D],
}

/// What is read.
#[derive(Clone, Copy)]
pub(super) struct Input<'a, const D: usize> {
    pub(super) carried: Carried<'a, D>,
    /// Stored like φ; absent if there is none.
    pub(super) source: Option<&'a [f64]>,
    /// A row of zeros, which stands for it then.
    pub(super) zeros: &'a [f64],
}

/// next = φ + dt (w₀ Hⁿ + w₁ Hⁿ⁻¹ + Dⁿ), H = −∇·(uφ) + Γ∇²φ (explicit axes) + S, D = Γ∇²φ (implicit axes). `tendency`
/// leaves as Hⁿ; Hⁿ⁻¹ is in `last`, or in `tendency` if that is `None`.
pub(super) fn advance<const D: usize>(
    input: Input<'_, D>,
    step: Step<D>,
    next: &mut Field<D>,
    (tendency, last): (&mut Field<D>, Option<&Field<D>>),
) {
    let last = last.map(Field::data);
    for_layers(input.carried.grid, next, tendency, |rows, start, next, tendency| {
        with_kind!(input.carried.carrier, KIND => {
            Arch::new().dispatch(Rows::<KIND, D> { input, step, rows, start, last, next, tendency });
        });
    });
}

struct Rows<'a, const KIND: u8, const D: usize> {
    input: Input<'a, D>,
    step: Step<D>,
    rows: Range<usize>,
    /// Storage index of the first entry of `next` and `tendency`.
    start: usize,
    last: Option<&'a [f64]>,
    next: &'a mut [f64],
    tendency: &'a mut [f64],
}

impl<const KIND: u8, const D: usize> WithSimd for Rows<'_, KIND, D> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { input, step, rows, start, last, next, tendency } = self;
        let grid = input.carried.grid;
        let n = grid.cells()[0];
        for r in rows {
            let o = row_start(grid, r);
            let local = o - start..o - start + n;
            let at = row_place(grid, r);
            if let Some(last) = last {
                tendency[local.clone()].copy_from_slice(&last[o..][..n]);
            }
            advance_row::<KIND, D>(input, step, at, o, &mut next[local.clone()], &mut tendency[local]);
        }
    }
}

#[inline(always)]
fn advance_row<const KIND: u8, const D: usize>(
    input: Input<'_, D>,
    step: Step<D>,
    at: [usize; D],
    o: usize,
    next: &mut [f64],
    tendency: &mut [f64],
) {
    let n = next.len();
    let tendency = &mut tendency[..n];
    let row = input.carried.row(at, [o, n]);
    let source = input.source.map_or(&input.zeros[..n], |s| &s[o..][..n]);
    let axes = &input.carried.metrics.axes;
    let (up, down) = (&axes[0].centres.up[GHOSTS..][..n], &axes[0].centres.down[GHOSTS..][..n]);
    let up_b: [f64; D] = std::array::from_fn(|b| axes[b].centres.up[GHOSTS + at[b]]);
    let down_b: [f64; D] = std::array::from_fn(|b| axes[b].centres.down[GHOSTS + at[b]]);
    let [new, old] = step.weights.map(|w| w * step.dt);
    for i in 0..n {
        let centre = row.here[i];
        let mut sum = row.convection::<KIND>(i) + source[i];
        let mut diffusion = 0.0;
        for b in 0..D {
            let (up, down) = if b == 0 { (up[i], down[i]) } else { (up_b[b], down_b[b]) };
            let second = up * (row.above[b][i] - centre) - down * (centre - row.below[b][i]);
            sum += step.explicit[b] * second;
            diffusion += step.implicit[b] * second;
        }
        next[i] = centre + (new * sum + old * tendency[i]) + step.dt * diffusion;
        tendency[i] = sum;
    }
}
