//! The operators against manufactured fields and discrete identities.
mod identities;
mod order;

use crate::metrics::Metrics;
use crate::{Axis, CartesianGrid, Cluster, Field, Side, Sides, Velocity};

/// Families of grids of the unit box that are refined smoothly.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Family {
    Uniform,
    /// Gathered at both ends, at the lower and at the upper one.
    Tanh,
    /// Cell-to-cell ratio 1.05 at 16 cells, its root at twice as many.
    Geometric,
    /// One axis of each.
    Mixed,
}

/// All families; in space, where work is dear, those of one kind and the mixture.
pub(crate) fn families(d: usize) -> &'static [Family] {
    if d == 2 {
        &[Family::Uniform, Family::Tanh, Family::Geometric]
    } else {
        &[Family::Uniform, Family::Mixed]
    }
}

impl Family {
    pub(crate) fn grid<const D: usize>(self, n: usize) -> CartesianGrid<D> {
        let kind = |a: usize| match self {
            Self::Mixed => [Self::Tanh, Self::Uniform, Self::Geometric][a],
            family => family,
        };
        let axis = |a: usize| match kind(a) {
            Self::Uniform | Self::Mixed => Axis::uniform(n, 0.0, 1.0),
            Self::Tanh => Axis::tanh(n, 0.0, 1.0, 1.2, [Cluster::Both, Cluster::Lower, Cluster::Upper][a]),
            Self::Geometric => Axis::geometric(n, 0.0, 1.0, 1.05_f64.powf([-16.0, 16.0, -8.0][a] / n as f64)),
        };
        CartesianGrid::from_axes(std::array::from_fn(|a| axis(a).unwrap())).unwrap()
    }
}

/// The field of `f` with exact ghosts; `face` is the axis whose faces carry the values.
pub(crate) fn exact<const D: usize>(
    grid: &CartesianGrid<D>,
    metrics: &Metrics<D>,
    face: Option<usize>,
    f: impl Fn([f64; D]) -> f64,
) -> Field<D> {
    let mut field = Field::zeros(grid);
    let stride = grid.stride();
    for (o, value) in field.data_mut().iter_mut().enumerate() {
        let mut rest = o;
        let mut x = [0.0; D];
        for a in (0..D).rev() {
            x[a] = metrics.of(face, a).x[rest / stride[a]];
            rest %= stride[a];
        }
        *value = f(x);
    }
    field
}

/// The staggered velocity of `u` with exact ghosts.
pub(crate) fn exact_velocity<const D: usize>(
    grid: &CartesianGrid<D>,
    metrics: &Metrics<D>,
    u: impl Fn([f64; D]) -> [f64; D],
) -> Velocity<D> {
    let sides =
        std::array::from_fn(|a| [Side::FreeSlip, Side::Periodic][usize::from(metrics.periodic[a])].both());
    let mut velocity = Velocity::zeros(grid, &Sides::new(sides).unwrap());
    for c in 0..D {
        velocity.components[c] = exact(grid, metrics, Some(c), |x| u(x)[c]);
    }
    velocity
}

/// Norms of differences, weighted with a function of the place.
pub(crate) struct Norms {
    weight: Vec<f64>,
    volume: Vec<f64>,
}

impl Norms {
    pub(crate) fn new<const D: usize>(grid: &CartesianGrid<D>, weight: impl Fn([f64; D]) -> f64) -> Self {
        let cells = || (0..grid.n_cells()).map(|i| grid.cell(i));
        Self {
            weight: cells().map(|cell| weight(grid.centre(cell))).collect(),
            volume: cells().map(|cell| grid.cell_volume(cell)).collect(),
        }
    }
    /// Root of the mean square, and the largest.
    pub(crate) fn of<const D: usize>(&self, a: &Field<D>, b: &Field<D>) -> [f64; 2] {
        let (mut sum, mut volume, mut top) = (0.0, 0.0, 0.0_f64);
        for ((a, b), (w, v)) in a.values().zip(b.values()).zip(self.weight.iter().zip(&self.volume)) {
            let e = w * (a - b).abs();
            (sum, volume, top) = (sum + v * e * e, volume + v, top.max(e));
        }
        [(sum / volume).sqrt(), top]
    }
}

/// [`Norms`] of one difference.
pub(crate) fn norms<const D: usize>(
    a: &Field<D>,
    b: &Field<D>,
    weight: impl Fn([f64; D]) -> f64,
) -> [f64; 2] {
    Norms::new(a.grid(), weight).of(a, b)
}

/// Asserts that errors at n and 2n cells fall with this order: within 0.1 in the 2-norm and 0.2 in the largest.
pub(crate) fn assert_order(what: &str, coarse: [f64; 2], fine: [f64; 2], order: f64) {
    let found = [0, 1].map(|k| (coarse[k] / fine[k]).log2());
    assert!(
        (found[0] - order).abs() < 0.1 && (found[1] - order).abs() < 0.2,
        "{what}: orders {found:.3?}, {order} expected; errors {coarse:?} {fine:?}"
    );
}
