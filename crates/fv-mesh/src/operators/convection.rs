//! Convection of a cell-centred scalar.
use super::rows::RowKernel;
use crate::grid::GHOSTS;
use crate::kernels::{LIMITED, LINEAR, upwinded};
use crate::metrics::{InterfaceWeights, Metrics};
use crate::{CartesianGrid, Convection, Field};

/// The forms of a face value.
pub(crate) const CENTRAL: u8 = LIMITED + 1;

/// Face values of a scalar by one [`Convection`] scheme.
#[derive(Clone, Debug)]
pub(crate) struct Carrier<const D: usize> {
    scheme: Convection,
    law: [[bool; 2]; D],
    /// Per axis.
    weights: [InterfaceWeights; D],
}

impl<const D: usize> Carrier<D> {
    pub(crate) fn new(metrics: &Metrics<D>, scheme: Convection) -> Self {
        Self::beside(metrics, scheme, [[false; 2]; D])
    }
    /// In a box whose sides follow a law of the wall where `law` says so, by axis and end.
    fn beside(metrics: &Metrics<D>, scheme: Convection, law: [[bool; 2]; D]) -> Self {
        let of = |a: usize| metrics.weights(scheme, a, Metrics::<D>::family(None, a), law[a]);
        Self { scheme, law, weights: std::array::from_fn(of) }
    }
    /// Takes these sides for those that follow a law of the wall.
    pub(crate) fn set_law(&mut self, metrics: &Metrics<D>, law: [[bool; 2]; D]) {
        if self.law != law {
            *self = Self::beside(metrics, self.scheme, law);
        }
    }
    pub(crate) fn scheme(&self) -> Convection {
        self.scheme
    }
    /// Which of [`CENTRAL`], [`LINEAR`] and [`LIMITED`] the scheme is.
    pub(crate) fn kind(&self) -> u8 {
        match self.scheme {
            Convection::Central => CENTRAL,
            Convection::Upwind | Convection::LinearUpwind | Convection::Quick => LINEAR,
            Convection::Limited => LIMITED,
        }
    }
}

/// Weights of one interface, for flow upwards and downwards.
#[derive(Clone, Copy)]
struct Interface {
    a: [f64; 2],
    b: [f64; 2],
    g: [f64; 2],
}

/// Weights of the interfaces of a row along x.
#[derive(Clone, Copy)]
struct Interfaces<'a> {
    a: [&'a [f64]; 2],
    b: [&'a [f64]; 2],
    g: [&'a [f64]; 2],
}

impl<'a> Interfaces<'a> {
    #[inline(always)]
    fn new(w: &'a InterfaceWeights, from: usize, n: usize) -> Self {
        let part = |lists: &'a [Vec<f64>; 2]| [&lists[0][from..][..n], &lists[1][from..][..n]];
        Self { a: part(&w.a), b: part(&w.b), g: part(&w.g) }
    }
    #[inline(always)]
    fn at(&self, i: usize) -> Interface {
        Interface {
            a: [self.a[0][i], self.a[1][i]],
            b: [self.b[0][i], self.b[1][i]],
            g: [self.g[0][i], self.g[1][i]],
        }
    }
}

/// Value between the middle two of four cells in a row, carried with speed `u`.
#[inline(always)]
fn face_value<const KIND: u8>(w: Interface, u: f64, [m2, m1, p1, p2]: [f64; 4]) -> f64 {
    if KIND == CENTRAL {
        return m1 + w.a[0] * (p1 - m1);
    }
    let rising = upwinded::<KIND>(w.a[0], w.b[0], w.g[0], [m2, m1, p1]);
    let falling = upwinded::<KIND>(w.a[1], w.b[1], w.g[1], [p2, p1, m1]);
    if u > 0.0 { rising } else { falling }
}

/// How fast the limited value between the upwind node `u` and the downwind node `d` grows with φ_U beyond it; 0 where it does not.
#[inline(always)]
fn steepness(b: f64, g: f64, [far, u, d]: [f64; 3]) -> f64 {
    let (ahead, behind) = (d - u, g * (u - far));
    let (sum, more) = (ahead + behind, g * ahead * ahead - behind * behind);
    let slope = b * more / (sum * sum);
    // Both: a branch would keep the loop from being vectorised.
    if (ahead * behind > 0.0) & (more > 0.0) { slope } else { 0.0 }
}

/// What is carried, by what and how.
#[derive(Clone, Copy)]
pub(crate) struct Carried<'a, const D: usize> {
    pub(crate) carrier: &'a Carrier<D>,
    pub(crate) grid: &'a CartesianGrid<D>,
    pub(crate) metrics: &'a Metrics<D>,
    pub(crate) velocity: &'a [Field<D>; D],
    pub(crate) phi: &'a [f64],
}

/// A row of cells, their neighbours and the speeds through their faces.
pub(crate) struct CarriedRow<'a, const D: usize> {
    pub(crate) here: &'a [f64],
    pub(crate) above: [&'a [f64]; D],
    pub(crate) below: [&'a [f64]; D],
    above2: [&'a [f64]; D],
    below2: [&'a [f64]; D],
    lower: [&'a [f64]; D],
    upper: [&'a [f64]; D],
    inv: &'a [f64],
    inv_b: [f64; D],
    along: [Interfaces<'a>; 2],
    across: [[Interface; 2]; D],
}

impl<'a, const D: usize> Carried<'a, D> {
    /// The row of `n` cells from storage index `o`, which is at `at`.
    #[inline(always)]
    pub(crate) fn row(self, at: [usize; D], [o, n]: [usize; 2]) -> CarriedRow<'a, D> {
        let Self { carrier, grid, metrics, velocity, phi } = self;
        let s = grid.stride();
        let axes = &metrics.axes;
        let weights = &carrier.weights;
        CarriedRow {
            here: &phi[o..][..n],
            above: std::array::from_fn(|b| &phi[o + s[b]..][..n]),
            below: std::array::from_fn(|b| &phi[o - s[b]..][..n]),
            above2: std::array::from_fn(|b| &phi[o + 2 * s[b]..][..n]),
            below2: std::array::from_fn(|b| &phi[o - 2 * s[b]..][..n]),
            lower: std::array::from_fn(|b| &velocity[b].data()[o..][..n]),
            upper: std::array::from_fn(|b| &velocity[b].data()[o + s[b]..][..n]),
            inv: &axes[0].centres.inv_volume[GHOSTS + at[0]..][..n],
            inv_b: std::array::from_fn(|b| axes[b].centres.inv_volume[GHOSTS + at[b]]),
            along: [0, 1].map(|k| Interfaces::new(&weights[0], GHOSTS + at[0] + k, n)),
            across: std::array::from_fn(|b| {
                [0, 1].map(|k| Interfaces::new(&weights[b], GHOSTS + at[b] + k, 1).at(0))
            }),
        }
    }
}

impl<const D: usize> CarriedRow<'_, D> {
    /// −∇·(uφ) of cell `i`.
    #[inline(always)]
    pub(crate) fn convection<const KIND: u8>(&self, i: usize) -> f64 {
        self.over_faces(i, |low, [u, v], [m2, m1, c, p1, p2], high| {
            let inflow = u * face_value::<KIND>(low, u, [m2, m1, c, p1]);
            inflow - v * face_value::<KIND>(high, v, [m1, c, p1, p2])
        })
    }

    /// How fast what the limited scheme lets flow out of cell `i` beyond what upwind values take grows with what is in it, where it
    /// does \[1/s\].
    #[inline(always)]
    fn steepness(&self, i: usize) -> f64 {
        self.over_faces(i, |low, [u, v], [_, m1, c, p1, _], high| {
            let out = [if u < 0.0 { -u } else { 0.0 }, if v > 0.0 { v } else { 0.0 }];
            out[0] * steepness(low.b[1], low.g[1], [p1, c, m1])
                + out[1] * steepness(high.b[0], high.g[0], [m1, c, p1])
        })
    }

    /// Sums what `axis` has of both faces along each axis, over the width: their weights and speeds, and the five cells in a row.
    #[inline(always)]
    fn over_faces(&self, i: usize, axis: impl Fn(Interface, [f64; 2], [f64; 5], Interface) -> f64) -> f64 {
        let mut sum = 0.0;
        for b in 0..D {
            let (m2, m1, c) = (self.below2[b][i], self.below[b][i], self.here[i]);
            let (p1, p2) = (self.above[b][i], self.above2[b][i]);
            let (low, high) = if b == 0 {
                (self.along[0].at(i), self.along[1].at(i))
            } else {
                (self.across[b][0], self.across[b][1])
            };
            let speeds = [self.lower[b][i], self.upper[b][i]];
            let inv = if b == 0 { self.inv[i] } else { self.inv_b[b] };
            sum += inv * axis(low, speeds, [m2, m1, c, p1, p2], high);
        }
        sum
    }
}

/// −∇·(uφ).
pub(crate) struct Convect<'a, const KIND: u8, const D: usize>(pub(crate) Carried<'a, D>);

impl<const KIND: u8, const D: usize> RowKernel<D> for Convect<'_, KIND, D> {
    #[inline(always)]
    fn row(&self, at: [usize; D], o: usize, out: &mut [f64]) {
        let row = self.0.row(at, [o, out.len()]);
        for (i, out) in out.iter_mut().enumerate() {
            *out = row.convection::<KIND>(i);
        }
    }
}

/// How fast what limited convection lets out of a cell beyond upwind values grows with what is in it, where it does \[1/s\].
pub(crate) struct Steepness<'a, const D: usize>(pub(crate) Carried<'a, D>);

impl<const D: usize> RowKernel<D> for Steepness<'_, D> {
    #[inline(always)]
    fn row(&self, at: [usize; D], o: usize, out: &mut [f64]) {
        let row = self.0.row(at, [o, out.len()]);
        for (i, out) in out.iter_mut().enumerate() {
            *out = row.steepness(i);
        }
    }
}

/// Runs `$body` with the constant `$kind` set to the carrier's kind.
macro_rules! with_kind {
    ($carrier:expr, $kind:ident => $body:expr) => {
        match $carrier.kind() {
            $crate::kernels::LINEAR => {
                const $kind: u8 = $crate::kernels::LINEAR;
                $body
            }
            $crate::kernels::LIMITED => {
                const $kind: u8 = $crate::kernels::LIMITED;
                $body
            }
            _ => {
                const $kind: u8 = $crate::operators::CENTRAL;
                $body
            }
        }
    };
}
pub(crate) use with_kind;
