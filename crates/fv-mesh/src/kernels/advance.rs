//! The predictor sweep.
use super::{for_layers, row_place};
use crate::field::row_start;
use crate::grid::GHOSTS;
use crate::metrics::{InterfaceWeights, Metrics, NodeMetrics};
use crate::spans::Spans;
use crate::{CartesianGrid, Convection, Field};
use pulp::{Arch, Simd, WithSimd};

/// Coefficients of one predictor sweep.
#[derive(Clone, Copy)]
pub(crate) struct Advance<const D: usize> {
    /// Step \[s\].
    pub(crate) dt: f64,
    /// Weights of the new and the last tendency: 1 + r/2 and −r/2 with r = dt/dt_last.
    pub(crate) weights: [f64; 2],
    /// Kinematic viscosity \[m²/s\] along the axes whose diffusion is explicit (else zero) …
    pub(crate) explicit: [f64; D],
    /// … and along those whose diffusion is implicit.
    pub(crate) implicit: [f64; D],
    /// 1/density \[m³/kg\].
    pub(crate) specific_volume: f64,
    /// Body force per mass along this component \[m/s²\].
    pub(crate) force: f64,
}

/// What the predictor needs to know of the grid and the convection scheme.
#[derive(Clone, Debug)]
pub(crate) struct Momentum<const D: usize> {
    grid: CartesianGrid<D>,
    metrics: Metrics<D>,
    /// Interface weights of component c along axis b; empty for the central scheme.
    weights: [[InterfaceWeights; D]; D],
    scheme: Convection,
    /// Per axis and end: does the side follow a law of the wall?
    law: [[bool; 2]; D],
    pub(crate) spans: Spans,
}

/// The forms of an interface value.
#[derive(Clone, Copy, Debug)]
enum Kind {
    /// ½(φ_U + φ_D).
    Mean,
    /// φ_U + a (φ_D − φ_U) + b (φ_U − φ_UU).
    Linear,
    /// φ_U + a (φ_D − φ_U) + b h(φ_D − φ_U, g (φ_U − φ_UU)), h the half harmonic mean.
    Limited,
}

impl Kind {
    fn of(scheme: Convection) -> Self {
        match scheme {
            Convection::Central => Self::Mean,
            Convection::Upwind | Convection::LinearUpwind | Convection::Quick => Self::Linear,
            Convection::Limited => Self::Limited,
        }
    }
}

const MEAN: u8 = 0;
pub(crate) const LINEAR: u8 = 1;
pub(crate) const LIMITED: u8 = 2;

impl<const D: usize> Momentum<D> {
    pub(crate) fn new(grid: &CartesianGrid<D>, metrics: &Metrics<D>, scheme: Convection) -> Self {
        Self::beside(grid, metrics, scheme, [[false; 2]; D])
    }

    /// Between sides of which some follow a law of the wall.
    fn beside(
        grid: &CartesianGrid<D>,
        metrics: &Metrics<D>,
        scheme: Convection,
        law: [[bool; 2]; D],
    ) -> Self {
        let weights = std::array::from_fn(|c| {
            std::array::from_fn(|b| match Kind::of(scheme) {
                Kind::Mean => InterfaceWeights::default(),
                _ => metrics.weights(scheme, b, Metrics::<D>::family(Some(c), b), law[b]),
            })
        });
        let (grid, metrics, spans) = (grid.clone(), metrics.clone(), Spans::default());
        Self { grid, metrics, weights, scheme, law, spans }
    }

    /// Which sides follow a law of the wall, by axis and end.
    pub(crate) fn set_law(&mut self, law: [[bool; 2]; D]) {
        if self.law != law {
            let spans = std::mem::take(&mut self.spans);
            *self = Self { spans, ..Self::beside(&self.grid, &self.metrics, self.scheme, law) };
        }
    }

    /// One component of
    ///
    /// ```text
    /// next = uⁿ + dt (w₀ Hⁿ + w₁ Hⁿ⁻¹ + Dⁿ − ∂p/∂x_c /ρ + b),  H = −∇·(u u_c) + ν∇²u_c (explicit axes),  D = ν∇²u_c (implicit axes)
    /// ```
    ///
    /// on control volumes around the faces, by differences that conserve momentum and, with the central scheme and
    /// ∇·u = 0, kinetic energy (Harlow & Welch 1965; Verstappen & Veldman 2003). `tendency` leaves as Hⁿ; Hⁿ⁻¹ is
    /// in `last`, or in `tendency` if that is `None`.
    pub(crate) fn advance(
        &self,
        c: usize,
        k: Advance<D>,
        velocity: &[Field<D>; D],
        pressure: &Field<D>,
        next: &mut Field<D>,
        (tendency, last): (&mut Field<D>, Option<&Field<D>>),
    ) {
        let last = last.map(Field::data);
        let u: [&[f64]; D] = std::array::from_fn(|b| velocity[b].data());
        let p = pressure.data();
        for_layers(&self.grid, next, tendency, |rows, start, next, tendency| {
            let job = Rows { momentum: self, rows, start, k, u, p, last, next, tendency };
            match c {
                0 => job.of_component::<0>(),
                1 => job.of_component::<1>(),
                _ => job.of_component::<2>(),
            }
        });
    }
}

/// A run of rows.
struct Rows<'a, const D: usize> {
    momentum: &'a Momentum<D>,
    rows: std::ops::Range<usize>,
    /// Storage index of the first entry of `next` and `tendency`.
    start: usize,
    k: Advance<D>,
    u: [&'a [f64]; D],
    p: &'a [f64],
    last: Option<&'a [f64]>,
    next: &'a mut [f64],
    tendency: &'a mut [f64],
}

impl<const D: usize> Rows<'_, D> {
    fn of_component<const C: usize>(self) {
        match Kind::of(self.momentum.scheme) {
            Kind::Mean => Arch::new().dispatch(Typed::<D, C, MEAN>(self)),
            Kind::Linear => Arch::new().dispatch(Typed::<D, C, LINEAR>(self)),
            Kind::Limited => Arch::new().dispatch(Typed::<D, C, LIMITED>(self)),
        }
    }
}

// Types rather than closures: `pulp` compiles the body of `with_simd` for the processor at hand, while a
// closure that may be called more than once is compiled for the oldest.
struct Typed<'a, const D: usize, const C: usize, const KIND: u8>(Rows<'a, D>);

impl<const D: usize, const C: usize, const KIND: u8> WithSimd for Typed<'_, D, C, KIND> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Rows { momentum, rows, start, k, u, p, last, next, tendency } = self.0;
        let n = momentum.grid.cells()[0];
        for r in rows {
            let span = momentum.spans.of(r, n);
            let o = row_start(&momentum.grid, r) + span.start;
            let mut at = row_place(&momentum.grid, r);
            at[0] = span.start;
            let local = o - start..o - start + span.len();
            if let Some(last) = last {
                tendency[local.clone()].copy_from_slice(&last[o..][..span.len()]);
            }
            let out = [&mut next[local.clone()], &mut tendency[local]];
            advance_row::<D, C, KIND>(momentum, (o, at), k, (u, p), out);
        }
    }
}

/// A list of numbers along x, or the one number that holds for the whole row.
macro_rules! along {
    ($b:expr, $i:expr, $list:expr, $value:expr) => {
        if $b == 0 { $list[$i] } else { $value }
    };
}

/// One row of the new velocity and of the tendency; `o` is the storage index of its first cell, `at` its place, `u` and `p` are velocity
/// and pressure.
#[inline(always)]
fn advance_row<const D: usize, const C: usize, const KIND: u8>(
    momentum: &Momentum<D>,
    (o, at): (usize, [usize; D]),
    k: Advance<D>,
    (u, p): ([&[f64]; D], &[f64]),
    [next, tendency]: [&mut [f64]; 2],
) {
    let (n, s) = (next.len(), momentum.grid.stride());
    let axes = &momentum.metrics.axes;
    let tendency = &mut tendency[..n];
    // Rows of this component at distance ± one node along each axis, and of the components that
    // carry it: u_b on the lower and upper edge of this node's control volume along b.
    let here = &u[C][o..o + n];
    let above: [&[f64]; D] = std::array::from_fn(|b| &u[C][o + s[b]..][..n]);
    let below: [&[f64]; D] = std::array::from_fn(|b| &u[C][o - s[b]..][..n]);
    let above2: [&[f64]; D] = std::array::from_fn(|b| &u[C][o + 2 * s[b]..][..n]);
    let below2: [&[f64]; D] = std::array::from_fn(|b| &u[C][o - 2 * s[b]..][..n]);
    let lower: [[&[f64]; 2]; D] = std::array::from_fn(|b| [&u[b][o - s[C]..][..n], &u[b][o..][..n]]);
    let upper: [[&[f64]; 2]; D] =
        std::array::from_fn(|b| [&u[b][o + s[b] - s[C]..][..n], &u[b][o + s[b]..][..n]]);
    let p = [&p[o..][..n], &p[o - s[C]..][..n]];

    // Distances: lists along x, one number along the other axes.
    let nodes: [&NodeMetrics; D] = std::array::from_fn(|b| momentum.metrics.of(Some(C), b));
    let first: [usize; D] = std::array::from_fn(|b| GHOSTS + at[b]);
    let inv = &nodes[0].inv_volume[first[0]..][..n];
    let (up, down) = (&nodes[0].up[first[0]..][..n], &nodes[0].down[first[0]..][..n]);
    let inv_b: [f64; D] = std::array::from_fn(|b| nodes[b].inv_volume[first[b]]);
    let up_b: [f64; D] = std::array::from_fn(|b| nodes[b].up[first[b]]);
    let down_b: [f64; D] = std::array::from_fn(|b| nodes[b].down[first[b]]);
    let gap = &nodes[0].inv_volume[first[0]..][..n];
    let share = [&axes[0].share[0][first[0]..][..n], &axes[0].share[1][first[0]..][..n]];
    let share_c = [axes[C].share[0][first[C]], axes[C].share[1][first[C]]];
    let weights = &momentum.weights[C];

    let gradient = k.dt * k.specific_volume;
    let [new, old] = k.weights.map(|w| w * k.dt);
    let (dt, force) = (k.dt, k.dt * k.force);
    for i in 0..n {
        let centre = here[i];
        let (mut sum, mut diffusion) = (0.0, 0.0);
        for b in 0..D {
            let (high, low) = (above[b][i], below[b][i]);
            // Twice the speed that carries.
            let (carry_up, carry_down) = if b == C {
                (centre + high, low + centre)
            } else {
                let (s0, s1) = (along!(C, i, share[0], share_c[0]), along!(C, i, share[1], share_c[1]));
                (
                    2.0 * (s0 * upper[b][0][i] + s1 * upper[b][1][i]),
                    2.0 * (s0 * lower[b][0][i] + s1 * lower[b][1][i]),
                )
            };
            // Twice the value that is carried.
            let (value_up, value_down) = if KIND == MEAN {
                (centre + high, low + centre)
            } else {
                let j = if b == 0 { first[0] + i } else { first[b] };
                let value = |j: usize, carry: f64, line: [f64; 4]| {
                    2.0 * interface::<KIND>(&weights[b], j, carry, line)
                };
                (
                    value(j + 1, carry_up, [low, centre, high, above2[b][i]]),
                    value(j, carry_down, [below2[b][i], low, centre, high]),
                )
            };
            let inv = along!(b, i, inv, inv_b[b]);
            let second =
                along!(b, i, up, up_b[b]) * (high - centre) - along!(b, i, down, down_b[b]) * (centre - low);
            sum += 0.25 * inv * (carry_down * value_down - carry_up * value_up) + k.explicit[b] * second;
            diffusion += k.implicit[b] * second;
        }
        let slope = gradient * along!(C, i, gap, inv_b[C]) * (p[0][i] - p[1][i]);
        next[i] = centre + (new * sum + old * tendency[i]) + dt * diffusion - slope + force;
        tendency[i] = sum;
    }
}

/// The value on interface `j` between the middle two of four nodes in a row, carried by a speed with the sign of `carry`.
#[inline(always)]
fn interface<const KIND: u8>(w: &InterfaceWeights, j: usize, carry: f64, [m2, m1, p1, p2]: [f64; 4]) -> f64 {
    let rising = upwinded::<KIND>(w.a[0][j], w.b[0][j], w.g[0][j], [m2, m1, p1]);
    let falling = upwinded::<KIND>(w.a[1][j], w.b[1][j], w.g[1][j], [p2, p1, m1]);
    if carry > 0.0 { rising } else { falling }
}

/// The value between the upwind node `u` and the downwind node `d`.
#[inline(always)]
pub(crate) fn upwinded<const KIND: u8>(a: f64, b: f64, g: f64, [far, u, d]: [f64; 3]) -> f64 {
    let (ahead, behind) = (d - u, u - far);
    if KIND == LIMITED {
        let behind = g * behind;
        let product = ahead * behind;
        // Where both slopes have one sign their sum is not zero.
        let mean = if product > 0.0 { product / (ahead + behind) } else { 0.0 };
        u + a * ahead + b * mean
    } else {
        u + a * ahead + b * behind
    }
}

/// Momentum flux per area that convection and viscosity carry along axis `b` between the nodes o − s_b and o of component
/// `c` (entry `j` of the metrics along b, `i` along c), as the predictor computes it: carried by `carrier`, diffused.
pub(crate) fn flux<const D: usize>(
    momentum: &Momentum<D>,
    [carrier, velocity]: [&[Field<D>; D]; 2],
    [c, b]: [usize; 2],
    o: usize,
    [i, j]: [usize; 2],
) -> [f64; 2] {
    let s = momentum.grid.stride();
    let (u, v) = (velocity[c].data(), carrier[b].data());
    let carry = if b == c {
        0.5 * (v[o] + v[o - s[b]])
    } else {
        let share = &momentum.metrics.axes[c].share;
        share[0][i] * v[o - s[c]] + share[1][i] * v[o]
    };
    let line = || {
        // Boundary interfaces are plain means and never look so far.
        let at = |k: usize| u.get(k).copied().unwrap_or(0.0);
        [at(o.wrapping_sub(2 * s[b])), u[o - s[b]], u[o], at(o + s[b])]
    };
    let value = match Kind::of(momentum.scheme) {
        Kind::Mean => 0.5 * (u[o] + u[o - s[b]]),
        Kind::Linear => interface::<LINEAR>(&momentum.weights[c][b], j, carry, line()),
        Kind::Limited => interface::<LIMITED>(&momentum.weights[c][b], j, carry, line()),
    };
    let slope = momentum.metrics.of(Some(c), b).inv_gap[j] * (u[o] - u[o - s[b]]);
    [carry * value, slope]
}
