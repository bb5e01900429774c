//! Sums over the flow field.
use crate::grid::GHOSTS;
use crate::metrics::{Metrics, Nodes};
use crate::parts::each_result;
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
    /// Per component and axis: width of the part of the control volume inside the box, nodes 0 to n; along x zeros fill up the last [`LANES`].
    pub(crate) volumes: [[Vec<f64>; D]; D],
    /// Per component and axis: 1/distance of node i − 1 and node i, or the part of it that is inside the box.
    pub(crate) gaps: [[Vec<f64>; D]; D],
    /// Per component: the longest run of [`LANES`] along x whose weights are all the same.
    even: [std::ops::Range<usize>; D],
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
            let mut list: Vec<f64> = (0..=n).map(|i| part(i) * values[GHOSTS + i]).collect();
            if b == 0 {
                list.resize(list.len().next_multiple_of(LANES), 0.0);
            }
            list
        };
        let lists = |gaps: bool| std::array::from_fn(|c| std::array::from_fn(|b| list(c, b, gaps)));
        let [volumes, gaps]: [[[Vec<f64>; D]; D]; 2] = [false, true].map(lists);
        let even = std::array::from_fn(|c| even(&volumes[c][0], &gaps[c][0]));
        Self { volumes, gaps, even }
    }

    /// One pass over the field. Layers go to threads in fixed parts, so that the sums do not depend on the number of threads.
    pub(crate) fn of(
        &self,
        grid: &CartesianGrid<D>,
        metrics: &Metrics<D>,
        velocity: &[Field<D>; D],
        [density, viscosity]: [f64; 2],
    ) -> FlowStatistics {
        let layers = grid.cells()[D - 1];
        let per_task = kernels::layers_per_task(layers);
        // At most 16 tasks.
        let mut parts = [Sums::default(); 16];
        each_result(grid.n_cells(), &mut parts[..layers.div_ceil(per_task)], &|task, part| {
            let first = task * per_task;
            // The last has the nodes on the upper side, too.
            let end = if first + per_task < layers { first + per_task } else { layers + 1 };
            *part =
                Arch::new().dispatch(Layers { measure: self, grid, metrics, velocity, layers: first..end });
        });
        let mut out = FlowStatistics::default();
        for part in parts {
            out.volume_flow += Vector::from(part.flow);
            out.kinetic_energy += 0.5 * density * part.square;
            out.dissipation += density * viscosity * part.gradient;
            out.divergence = out.divergence.max(part.divergence);
        }
        out
    }
}

/// The longest run of lanes with the same volumes and gaps.
fn even(volumes: &[f64], gaps: &[f64]) -> std::ops::Range<usize> {
    let (volumes, gaps) = (volumes.as_chunks::<LANES>().0, gaps.as_chunks::<LANES>().0);
    // A part in 10¹⁵ may lie between widths that are meant to be the same.
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-14 * b.abs();
    let same = |list: &[f64; LANES], first: f64| list.iter().all(|x| near(*x, first));
    let (mut longest, mut start) = (0..0, 0);
    for k in 0..volumes.len() {
        if !(same(&volumes[k], volumes[start][0]) && same(&gaps[k], gaps[start][0])) {
            start = if same(&volumes[k], volumes[k][0]) && same(&gaps[k], gaps[k][0]) { k } else { k + 1 };
        }
        if k + 1 > start && k + 1 - start > longest.len() {
            longest = start..k + 1;
        }
    }
    longest
}

/// Sums over some layers: u, u² and (Δu)²/gap, times the volumes that go with them, and the largest |∇·u|.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    flow: [f64; 3],
    square: f64,
    gradient: f64,
    divergence: f64,
}

/// The same in lanes.
#[derive(Clone, Copy, Default)]
struct Lanes {
    flow: [f64; LANES],
    square: [f64; LANES],
    gradient: [f64; LANES],
}

struct Layers<'a, const D: usize> {
    measure: &'a Measure<D>,
    grid: &'a CartesianGrid<D>,
    metrics: &'a Metrics<D>,
    velocity: &'a [Field<D>; D],
    layers: std::ops::Range<usize>,
}

impl<const D: usize> WithSimd for Layers<'_, D> {
    type Output = Sums;
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Sums {
        let n = self.grid.cells();
        let (mut sums, mut top) = ([Lanes::default(); D], [0.0; LANES]);
        for layer in self.layers.clone() {
            let rows = if D == 3 { n[1] } else { 0 };
            for row in 0..=rows {
                let at = if D == 3 { [0, row, layer] } else { [0, layer, 0] };
                for (c, sums) in sums.iter_mut().enumerate() {
                    self.add::<S>(c, at, sums);
                }
                if (1..D).all(|b| at[b] < n[b]) {
                    let row = self.diverge::<S>(at);
                    top.iter_mut().zip(row).for_each(|(top, size)| *top = size.max(*top));
                }
            }
        }
        let mut out = Sums::default();
        for (c, lanes) in sums.iter().enumerate() {
            out.flow[c] = total(&lanes.flow);
            out.square += total(&lanes.square);
            out.gradient += total(&lanes.gradient);
        }
        out.divergence = top.into_iter().fold(0.0, f64::max);
        out
    }
}

impl<const D: usize> Layers<'_, D> {
    /// Adds a row of component `c`.
    #[inline(always)]
    fn add<S: Simd>(&self, c: usize, at: [usize; 3], out: &mut Lanes) {
        let (u, s) = (self.velocity[c].data(), self.grid.stride());
        let (volumes, gaps) = (&self.measure.volumes[c], &self.measure.gaps[c]);
        let o = self.grid.base() + (1..D).map(|b| at[b] * s[b]).sum::<usize>();
        let across: f64 = (1..D).map(|b| volumes[b][at[b]]).product();
        let beside: [f64; D] = std::array::from_fn(|b| {
            let others = (1..D).filter(|&d| d != b).map(|d| volumes[d][at[d]]);
            if b == 0 { 0.0 } else { gaps[b][at[b]] * others.product::<f64>() }
        });
        if across == 0.0 && beside == [0.0; D] {
            return;
        }
        let [along, gap] = [&volumes[0], &gaps[0]].map(|x| x.as_chunks::<LANES>().0);
        let row = |o: usize| u[o..][..LANES * along.len()].as_chunks::<LANES>().0;
        let (here, below): (_, [_; D]) = (row(o), std::array::from_fn(|b| row(o - s[b])));
        let (mut sums, mut gradients) = ([[0.0; LANES]; 2], [[0.0; LANES]; D]);
        let even = self.measure.even[c].clone();
        if let Some((along, gap)) = along.get(even.start).zip(gap.get(even.start)) {
            for k in even.clone() {
                let here = &here[k];
                for l in 0..LANES {
                    sums[0][l] += here[l];
                    sums[1][l] = fused::<S>(here[l], here[l], sums[1][l]);
                }
                for b in 0..D {
                    let below = &below[b][k];
                    for l in 0..LANES {
                        let change = here[l] - below[l];
                        gradients[b][l] = fused::<S>(change, change, gradients[b][l]);
                    }
                }
            }
            for l in 0..LANES {
                sums.iter_mut().for_each(|sum| sum[l] *= along[l]);
                for b in 0..D {
                    gradients[b][l] *= if b == 0 { gap[l] } else { along[l] };
                }
            }
        }
        for k in (0..even.start).chain(even.end..along.len()) {
            let (here, along, gap) = (&here[k], &along[k], &gap[k]);
            for l in 0..LANES {
                let part = along[l] * here[l];
                sums[0][l] += part;
                sums[1][l] = fused::<S>(part, here[l], sums[1][l]);
            }
            for b in 0..D {
                let (weight, below) = (if b == 0 { gap } else { along }, &below[b][k]);
                for l in 0..LANES {
                    let change = here[l] - below[l];
                    gradients[b][l] = fused::<S>(weight[l] * change, change, gradients[b][l]);
                }
            }
        }
        for l in 0..LANES {
            out.flow[l] += across * sums[0][l];
            out.square[l] += across * sums[1][l];
            for b in 0..D {
                out.gradient[l] += if b == 0 { across } else { beside[b] } * gradients[b][l];
            }
        }
    }

    /// The largest |∇·u| of a row of cells, in lanes.
    #[inline(always)]
    fn diverge<S: Simd>(&self, at: [usize; 3]) -> [f64; LANES] {
        let (n, s) = (self.grid.cells()[0], self.grid.stride());
        let o = self.grid.base() + (1..D).map(|b| at[b] * s[b]).sum::<usize>();
        let lower: [_; D] = std::array::from_fn(|b| &self.velocity[b].data()[o..][..n]);
        let upper: [_; D] = std::array::from_fn(|b| &self.velocity[b].data()[o + s[b]..][..n]);
        let inv = &self.metrics.axes[0].centres.inv_volume[GHOSTS..][..n];
        let inv_b: [f64; D] =
            std::array::from_fn(|b| self.metrics.axes[b].centres.inv_volume[GHOSTS + at[b]]);
        // By value, which stays in registers.
        let over = [&lower, &upper];
        if n < LANES {
            return (0..n).fold([0.0; LANES], |top, i| largest::<S, 1, D>(i, over, inv, &inv_b, top));
        }
        let mut top = [0.0; LANES];
        for first in 0..n / LANES {
            top = largest::<S, LANES, D>(first * LANES, over, inv, &inv_b, top);
        }
        // Some have been seen.
        largest::<S, LANES, D>(n - LANES, over, inv, &inv_b, top)
    }
}

/// a b + c, in one instruction where vectors have it.
#[inline(always)]
fn fused<S: Simd>(a: f64, b: f64, c: f64) -> f64 {
    if S::IS_SCALAR { a * b + c } else { a.mul_add(b, c) }
}

/// The largest |∇·u| of `W` cells of a row, or what has been the largest.
#[inline(always)]
fn largest<S: Simd, const W: usize, const D: usize>(
    first: usize,
    [lower, upper]: [&[&[f64]; D]; 2],
    inv: &[f64],
    inv_b: &[f64; D],
    mut top: [f64; LANES],
) -> [f64; LANES] {
    let mut sum = [0.0; W];
    for b in 0..D {
        let (lower, upper) = (&lower[b][first..][..W], &upper[b][first..][..W]);
        if b == 0 {
            let inv = &inv[first..][..W];
            for l in 0..W {
                sum[l] = inv[l] * (upper[l] - lower[l]);
            }
        } else {
            for l in 0..W {
                sum[l] = fused::<S>(inv_b[b], upper[l] - lower[l], sum[l]);
            }
        }
    }
    for l in 0..W {
        let size = sum[l].abs();
        top[l] = if size > top[l] { size } else { top[l] };
    }
    top
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

#[cfg(test)]
mod tests {
    use super::FlowStatistics;
    use crate::grid::GHOSTS;
    use crate::metrics::Metrics;
    use crate::{Axis, CartesianGrid, Field};

    fn field<const D: usize>(grid: &CartesianGrid<D>) -> [Field<D>; D] {
        std::array::from_fn(|c| {
            let mut field = Field::zeros(grid);
            let wave = |i: usize| ((i * (7 + c)) as f64 * 0.1).sin() + 0.1 * c as f64;
            field.data_mut().iter_mut().enumerate().for_each(|(i, u)| *u = wave(i));
            field
        })
    }

    /// The sums node by node, as their formulas stand.
    fn node_by_node<const D: usize>(
        grid: &CartesianGrid<D>,
        metrics: &Metrics<D>,
        u: &[Field<D>; D],
    ) -> FlowStatistics {
        let (measure, n, s) = (super::Measure::new(grid, metrics), grid.cells(), grid.stride());
        let mut out = FlowStatistics::default();
        let last = |b: usize| if b < D { n[b] } else { 0 };
        for at in
            (0..=last(2)).flat_map(|k| (0..=last(1)).flat_map(move |j| (0..=last(0)).map(move |i| [i, j, k])))
        {
            let o = grid.base() + (0..D).map(|b| at[b] * s[b]).sum::<usize>();
            for c in 0..D {
                let data = u[c].data();
                let volume = |skip: usize| -> f64 {
                    (0..D).filter(|&b| b != skip).map(|b| measure.volumes[c][b][at[b]]).product()
                };
                out.volume_flow[c] += volume(D) * data[o];
                out.kinetic_energy += 0.5 * volume(D) * data[o] * data[o];
                for b in 0..D {
                    let change = data[o] - data[o - s[b]];
                    out.dissipation += volume(b) * measure.gaps[c][b][at[b]] * change * change;
                }
            }
            if (0..D).all(|b| at[b] < n[b]) {
                let part = |b: usize| {
                    let data = u[b].data();
                    metrics.axes[b].centres.inv_volume[GHOSTS + at[b]] * (data[o + s[b]] - data[o])
                };
                out.divergence = out.divergence.max((0..D).map(part).sum::<f64>().abs());
            }
        }
        out
    }

    fn check<const D: usize>(grid: &CartesianGrid<D>, periodic: [bool; D]) {
        let metrics = Metrics::new(grid, periodic);
        let (measure, u) = (super::Measure::new(grid, &metrics), field(grid));
        let by = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| measure.of(grid, &metrics, &u, [1.0; 2]))
        };
        let (found, expected) = (by(1), node_by_node(grid, &metrics, &u));
        assert_eq!(found, by(3), "{grid:?}");
        let near = |a: f64, b: f64| (a - b).abs() < 1e-11 * (1.0 + b.abs());
        assert!((found.volume_flow - expected.volume_flow).norm() < 1e-11, "{found:?} {expected:?}");
        assert!(near(found.kinetic_energy, expected.kinetic_energy), "{found:?} {expected:?}");
        assert!(near(found.dissipation, expected.dissipation), "{found:?} {expected:?}");
        assert!(near(found.divergence, expected.divergence), "{found:?} {expected:?}");
    }

    /// Whatever the number of cells, their widths, the sides and the number of threads.
    #[test]
    fn sums_are_those_of_the_nodes() {
        for cells in [1, 2, 7, 8, 9, 40, 45] {
            for periodic in [[true; 2], [false; 2], [true, false]] {
                check(&CartesianGrid::new([cells, 21], [1.0, 2.0]).unwrap(), periodic);
            }
            check(&CartesianGrid::new([cells, 3, 9], [1.0, 2.0, 0.5]).unwrap(), [false, true, false]);
        }
        // Even in the middle alone.
        let faces = (0..=40).map(|i| i as f64 + if i < 9 { -0.02 * ((9 - i) * (9 - i)) as f64 } else { 0.0 });
        let axis = || Axis::from_faces(faces.clone().collect::<Vec<_>>()).unwrap();
        check(&CartesianGrid::from_axes([axis(), axis()]).unwrap(), [false; 2]);
    }
}
