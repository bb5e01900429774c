//! Sums over the flow field.
use crate::grid::GHOSTS;
use crate::metrics::{Metrics, Nodes};
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
    /// the discrete viscous term takes from the kinetic energy, walls at rest included.
    pub dissipation: f64,
    /// Largest |∇·u| \[1/s\].
    pub divergence: f64,
}

/// Independent partial sums, so that reductions run in vector registers in a fixed order.
const LANES: usize = 8;

#[inline(always)]
fn total(sum: &[f64; LANES]) -> f64 {
    ((sum[0] + sum[1]) + (sum[2] + sum[3])) + ((sum[4] + sum[5]) + (sum[6] + sum[7]))
}

/// The cell (i, j, k) where a component is not finite, or else largest.
pub(crate) fn worst_cell<const D: usize>(velocity: &[Field<D>; D]) -> [usize; 3] {
    let (mut cell, mut top) = ([0; 3], -1.0);
    for u in velocity {
        for (i, u) in u.values().enumerate() {
            let size = if u.is_finite() { u.abs() } else { f64::INFINITY };
            if size > top {
                top = size;
                cell[..D].copy_from_slice(&velocity[0].grid().cell(i));
            }
        }
    }
    cell
}

/// Are all cells' values finite?
pub(crate) fn is_finite<const D: usize>(u: &Field<D>) -> bool {
    // 0·x is 0 for every finite x and NaN for the others.
    let mut check = [0.0; LANES];
    for r in 0..u.n_rows() {
        let (whole, rest) = u.row(r).as_chunks::<LANES>();
        for row in whole {
            check.iter_mut().zip(row).for_each(|(sum, x)| *sum += 0.0 * x);
        }
        check.iter_mut().zip(rest).for_each(|(sum, x)| *sum += 0.0 * x);
    }
    total(&check) == 0.0
}

/// Largest |u_c|/h over all cells, h the distance of the nodes along c \[1/s\], or NaN if any value is not finite.
pub(crate) fn largest_rate<const D: usize>(
    grid: &CartesianGrid<D>,
    metrics: &Metrics<D>,
    c: usize,
    u: &Field<D>,
) -> f64 {
    Arch::new().dispatch(LargestRate { grid, inv: &metrics.of(Some(c), c).inv_volume[GHOSTS..], c, u })
}

struct LargestRate<'a, const D: usize> {
    grid: &'a CartesianGrid<D>,
    inv: &'a [f64],
    c: usize,
    u: &'a Field<D>,
}

impl<const D: usize> WithSimd for LargestRate<'_, D> {
    type Output = f64;
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> f64 {
        let Self { grid, inv, c, u } = self;
        let mut top = [0.0_f64; LANES];
        // 0·x is 0 for every finite x and NaN for the others.
        let mut check = [0.0_f64; LANES];
        let mut take = |x: &[f64], inv: &[f64], scale: f64| {
            for (l, (x, inv)) in x.iter().zip(inv).enumerate() {
                let a = x.abs() * inv * scale;
                top[l] = if a > top[l] { a } else { top[l] };
                check[l] += 0.0 * x;
            }
        };
        for r in 0..u.n_rows() {
            let (whole, rest) = u.row(r).as_chunks::<LANES>();
            if c == 0 {
                let (scales, last) = inv[..u.row(r).len()].as_chunks::<LANES>();
                whole.iter().zip(scales).for_each(|(x, inv)| take(x, inv, 1.0));
                take(rest, last, 1.0);
            } else {
                let scale = inv[kernels::row_place(grid, r)[c]];
                whole.iter().for_each(|x| take(x, &[1.0; LANES], scale));
                take(rest, &[1.0; LANES], scale);
            }
        }
        top.into_iter().fold(0.0, f64::max) + check.into_iter().sum::<f64>()
    }
}

/// Weights of the sums over the nodes of the velocity components.
#[derive(Clone, Debug)]
pub(crate) struct Measure<const D: usize> {
    /// Per component and axis: width of the part of the control volume inside the box, nodes 0 to n.
    pub(crate) volumes: [[Vec<f64>; D]; D],
    /// Per component and axis: 1/distance of node i − 1 and node i, or the part of it that is inside the box.
    pub(crate) gaps: [[Vec<f64>; D]; D],
}

impl<const D: usize> Measure<D> {
    pub(crate) fn new(grid: &CartesianGrid<D>, metrics: &Metrics<D>) -> Self {
        let list = |c: usize, b: usize, gaps: bool| {
            let (n, nodes) = (grid.cells()[b], metrics.of(Some(c), b));
            let faces = Metrics::<D>::family(Some(c), b) == Nodes::Faces;
            let part = |i: usize| match (metrics.periodic[b], faces, gaps) {
                (true, ..) | (false, false, false) => f64::from(u8::from(i < n)),
                (false, true, true) => f64::from(u8::from(i > 0)),
                // A face on the side has half a control volume, a centre beside it half a gap.
                _ => [1.0, 0.5][usize::from(i == 0 || i == n)],
            };
            let values = if gaps { &nodes.inv_gap } else { &nodes.volume };
            (0..=n).map(|i| part(i) * values[GHOSTS + i]).collect()
        };
        Self {
            volumes: std::array::from_fn(|c| std::array::from_fn(|b| list(c, b, false))),
            gaps: std::array::from_fn(|c| std::array::from_fn(|b| list(c, b, true))),
        }
    }

    /// `scratch` holds at least one row.
    pub(crate) fn of(
        &self,
        grid: &CartesianGrid<D>,
        metrics: &Metrics<D>,
        velocity: &[Field<D>; D],
        [density, viscosity]: [f64; 2],
        scratch: &mut [f64],
    ) -> FlowStatistics {
        let n = grid.cells();
        let mut out = FlowStatistics::default();
        let layers = if D == 3 { n[D - 1] + 1 } else { 1 };
        for (k, j) in (0..layers).flat_map(|k| (0..=n[1]).map(move |j| (k, j))) {
            for c in 0..D {
                let at = [0, j, k];
                let Sums { flow, square, gradient } =
                    Arch::new().dispatch(Row { measure: self, grid, u: velocity[c].data(), c, at });
                out.volume_flow[c] += flow;
                out.kinetic_energy += 0.5 * density * square;
                out.dissipation += density * viscosity * gradient;
            }
        }
        for r in 0..velocity[0].n_rows() {
            let row = Divergence { grid, metrics, velocity, r, scratch: &mut scratch[..n[0]] };
            out.divergence = out.divergence.max(Arch::new().dispatch(row));
        }
        out
    }
}

/// Sums over one row of one component: u, u² and (Δu)²/gap, times the volumes that go with them.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    flow: f64,
    square: f64,
    gradient: f64,
}

struct Row<'a, const D: usize> {
    measure: &'a Measure<D>,
    grid: &'a CartesianGrid<D>,
    u: &'a [f64],
    c: usize,
    at: [usize; 3],
}

impl<const D: usize> WithSimd for Row<'_, D> {
    type Output = Sums;
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Sums {
        let Self { measure, grid, u, c, at } = self;
        let s = grid.stride();
        let (volumes, gaps) = (&measure.volumes[c], &measure.gaps[c]);
        let o = grid.base() + (1..D).map(|b| at[b] * s[b]).sum::<usize>();
        let n = grid.cells()[0] + 1;
        let across: f64 = (1..D).map(|b| volumes[b][at[b]]).product();
        let mut sums = [[0.0; LANES]; 2];
        let mut gradients = [[0.0; LANES]; D];
        let below: [_; D] = std::array::from_fn(|b| u[o - s[b]..][..n].as_chunks::<LANES>());
        let [here, along, gap] = [&u[o..], &volumes[0], &gaps[0]].map(|x| x[..n].as_chunks::<LANES>());
        // Whole chunks first: the inner loops fit vector registers.
        for k in 0..n / LANES {
            let (here, along) = (&here.0[k], &along.0[k]);
            for l in 0..LANES {
                sums[0][l] += along[l] * here[l];
                sums[1][l] += along[l] * here[l] * here[l];
            }
            for (b, (sum, below)) in gradients.iter_mut().zip(&below).enumerate() {
                let (weight, below) = (if b == 0 { &gap.0[k] } else { along }, &below.0[k]);
                for l in 0..LANES {
                    sum[l] += weight[l] * ((here[l] - below[l]) * (here[l] - below[l]));
                }
            }
        }
        for (l, (here, along)) in here.1.iter().zip(along.1).enumerate() {
            sums[0][l] += along * here;
            sums[1][l] += along * here * here;
            for (b, (sum, below)) in gradients.iter_mut().zip(&below).enumerate() {
                let weight = if b == 0 { gap.1[l] } else { *along };
                sum[l] += weight * ((here - below.1[l]) * (here - below.1[l]));
            }
        }
        let gradient = |b: usize| {
            let others: f64 = (1..D).filter(|&d| d != b).map(|d| volumes[d][at[d]]).product();
            let weight = if b == 0 { across } else { gaps[b][at[b]] * others };
            weight * total(&gradients[b])
        };
        Sums {
            flow: across * total(&sums[0]),
            square: across * total(&sums[1]),
            gradient: (0..D).map(gradient).sum(),
        }
    }
}

/// Σ V s and Σ V s u over the unknowns of component `c`: what the acceleration `source` does to momentum and energy, per density.
pub(crate) fn acted<const D: usize>(
    grid: &CartesianGrid<D>,
    metrics: &Metrics<D>,
    c: usize,
    [source, u]: [&Field<D>; 2],
) -> [f64; 2] {
    let first = usize::from(!metrics.periodic[c]);
    let volume = |b: usize, i: usize| metrics.of(Some(c), b).volume[GHOSTS + i];
    let mut sums = [0.0; 2];
    for r in 0..u.n_rows() {
        let at = kernels::row_place(grid, r);
        if c > 0 && at[c] < first {
            continue;
        }
        let skip = if c == 0 { first } else { 0 };
        let (source, u, n) = (&source.row(r)[skip..], &u.row(r)[skip..], u.row(r).len() - skip);
        let along = &metrics.of(Some(c), 0).volume[GHOSTS + skip..][..n];
        let across: f64 = (1..D).map(|b| volume(b, at[b])).product();
        let [impulse, power] = Arch::new().dispatch(Acted { along, source, u });
        sums[0] += across * impulse;
        sums[1] += across * power;
    }
    sums
}

/// The same of one row, but for its extent across.
struct Acted<'a> {
    along: &'a [f64],
    source: &'a [f64],
    u: &'a [f64],
}

impl WithSimd for Acted<'_> {
    type Output = [f64; 2];
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> [f64; 2] {
        let mut sums = [[0.0; LANES]; 2];
        let mut take = |along: &[f64], source: &[f64], u: &[f64]| {
            for (l, ((along, source), u)) in along.iter().zip(source).zip(u).enumerate() {
                sums[0][l] += along * source;
                sums[1][l] += along * source * u;
            }
        };
        let [along, source, u] = [self.along, self.source, self.u].map(<[f64]>::as_chunks::<LANES>);
        for ((along, source), u) in along.0.iter().zip(source.0).zip(u.0) {
            take(along, source, u);
        }
        take(along.1, source.1, u.1);
        sums.each_ref().map(total)
    }
}

/// Largest |∇·u| of one row.
struct Divergence<'a, const D: usize> {
    grid: &'a CartesianGrid<D>,
    metrics: &'a Metrics<D>,
    velocity: &'a [Field<D>; D],
    r: usize,
    scratch: &'a mut [f64],
}

impl<const D: usize> WithSimd for Divergence<'_, D> {
    type Output = f64;
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> f64 {
        let Self { grid, metrics, velocity, r, scratch } = self;
        kernels::divergence_row(grid, metrics, r, velocity, 1.0, scratch);
        let mut top = [0.0; LANES];
        let mut take = |row: &[f64]| {
            for (top, d) in top.iter_mut().zip(row) {
                *top = if d.abs() > *top { d.abs() } else { *top };
            }
        };
        let (whole, rest) = scratch.as_chunks::<LANES>();
        whole.iter().for_each(|row| take(row));
        take(rest);
        top.into_iter().fold(0.0, f64::max)
    }
}
