//! Implicit diffusion by factors along the axes.
use crate::boundary::{Boundaries, Extrapolation, Lines};
use crate::grid::GHOSTS;
use crate::kernels::layers_per_task;
use crate::metrics::Metrics;
use crate::parts::each_pair;
use crate::{CartesianGrid, Field};
use pulp::{Arch, Simd, WithSimd};

/// Solves (1 − κ_x L_x)(1 − κ_y L_y)(1 − κ_z L_z) δ = r for the change δ of one velocity component, L_a the second
/// difference along axis a, κ = ½ν dt (Crank–Nicolson; factorisation error of order dt³: Kim & Moin 1985). Axes with
/// κ = 0 are left out.
#[derive(Clone, Debug)]
pub(crate) struct ImplicitDiffusion<const D: usize> {
    grid: CartesianGrid<D>,
    kappa: [f64; D],
    /// Factors per component and axis, for the four kinds of lines: bit 0 set if the lower end is free, bit 1 if the
    /// upper one is.
    factors: [[[Tridiagonal; 4]; D]; D],
    sweeps: Sweeps<D>,
}

/// What it takes to solve all lines along an axis.
#[derive(Clone, Debug)]
pub(crate) struct Sweeps<const D: usize> {
    grid: CartesianGrid<D>,
    /// Rows side by side and what periodic ones need; one per task.
    scratch: Vec<Vec<f64>>,
    /// One line.
    line: Vec<f64>,
    /// One layer of the last axis.
    layer: Vec<f64>,
}

/// Rows along x that are swept together.
const ROWS: usize = 8;

/// LU factors of 1 − κL on the nodes `first`, `first` + 1, … of a line.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tridiagonal {
    first: usize,
    below: Vec<f64>,
    inv: Vec<f64>,
    above: Vec<f64>,
    /// Periodic lines: x −= (x_first + ratio·x_last) correction.
    cyclic: Option<(f64, Vec<f64>)>,
}

impl Tridiagonal {
    /// Takes 1 − κL: `low` and `high` are what couples to the node below and above. `ends` say which parts of the two
    /// nodes at each end stand beyond it; `None` for a periodic line. Memory is made the first time only.
    pub(crate) fn set(
        &mut self,
        kappa: f64,
        first: usize,
        low: &[f64],
        high: &[f64],
        ends: Option<[[f64; 2]; 2]>,
    ) {
        let n = low.len();
        self.first = first;
        // Until the sweep below, `inv` holds the diagonal and `above` the upper one.
        let fill = |list: &mut Vec<f64>, value: &dyn Fn(usize) -> f64| {
            list.clear();
            list.extend((0..n).map(value));
        };
        fill(&mut self.below, &|i| kappa * low[i]);
        fill(&mut self.above, &|i| kappa * high[i]);
        fill(&mut self.inv, &|i| 1.0 + kappa * low[i] + kappa * high[i]);
        let Self { below, inv, above, cyclic, .. } = self;
        let mut corners = None;
        match ends {
            _ if n == 0 => return,
            Some([lower, upper]) => {
                let (low, high) = (below[0], above[n - 1]);
                inv[0] -= low * lower[0];
                inv[n - 1] -= high * upper[0];
                above[0] += low * lower[1];
                below[n - 1] += high * upper[1];
            }
            None if n == 1 => inv[0] = 1.0,
            None => {
                // Sherman & Morrison: the corners −low₀ and −high_{n−1} are a change of rank one.
                let (alpha, beta, gamma) = (-below[0], -above[n - 1], -inv[0]);
                inv[0] -= gamma;
                inv[n - 1] -= alpha * beta / gamma;
                corners = Some((alpha, beta, gamma));
            }
        }
        for i in 0..n {
            let pivot = if i == 0 { inv[0] } else { inv[i] - below[i] * above[i - 1] };
            inv[i] = 1.0 / pivot;
            above[i] *= inv[i];
        }
        let mut z = cyclic.take().map(|(_, z)| z).unwrap_or_default();
        let Some((alpha, beta, gamma)) = corners else { return };
        z.clear();
        z.resize(n, 0.0);
        (z[0], z[n - 1]) = (gamma, beta);
        self.solve_side_by_side(&mut z, |i| i, &mut [0.0]);
        let ratio = alpha / gamma;
        let scale = 1.0 / (1.0 + z[0] + ratio * z[n - 1]);
        z.iter_mut().for_each(|z| *z *= scale);
        self.cyclic = Some((ratio, z));
    }

    /// Solves lines that lie side by side: `rows(i)` is where node `first` + i starts in `data`; there are as many as `sums`
    /// is long.
    #[inline(always)]
    fn solve_side_by_side(&self, data: &mut [f64], rows: impl Fn(usize) -> usize, sums: &mut [f64]) {
        let (n, width) = (self.inv.len(), sums.len());
        if n == 0 {
            return;
        }
        let inv = self.inv[0];
        data[rows(0)..][..width].iter_mut().for_each(|x| *x *= inv);
        for i in 1..n {
            let (inv, below) = (self.inv[i], self.below[i]);
            let (done, todo) = data.split_at_mut(rows(i));
            let done = &done[rows(i - 1)..][..width];
            for (x, before) in todo[..width].iter_mut().zip(done) {
                *x = inv * (*x + below * before);
            }
        }
        for i in (0..n - 1).rev() {
            let above = self.above[i];
            let (todo, done) = data.split_at_mut(rows(i + 1));
            for (x, after) in todo[rows(i)..][..width].iter_mut().zip(&done[..width]) {
                *x += above * after;
            }
        }
        let Some((ratio, correction)) = &self.cyclic else { return };
        for (w, sum) in sums.iter_mut().enumerate() {
            *sum = data[rows(0) + w] + ratio * data[rows(n - 1) + w];
        }
        for (i, correction) in correction.iter().enumerate() {
            for (x, sum) in data[rows(i)..][..width].iter_mut().zip(&*sums) {
                *x -= correction * sum;
            }
        }
    }
}

impl<const D: usize> ImplicitDiffusion<D> {
    pub(crate) fn new(grid: &CartesianGrid<D>) -> Self {
        Self {
            kappa: [0.0; D],
            factors: std::array::from_fn(|_| std::array::from_fn(|_| Default::default())),
            sweeps: Sweeps::new(grid),
            grid: grid.clone(),
        }
    }

    /// Takes κ = ½ν dt along each axis.
    pub(crate) fn set(&mut self, metrics: &Metrics<D>, kappa: [f64; D]) {
        if kappa == self.kappa {
            return;
        }
        self.kappa = kappa;
        for (c, a) in (0..D).flat_map(|c| (0..D).map(move |a| (c, a))).filter(|&(_, a)| kappa[a] > 0.0) {
            let (nodes, n) = (metrics.of(Some(c), a), self.grid.cells()[a]);
            let first = usize::from(a == c && !metrics.periodic[a]);
            let inside = GHOSTS + first..GHOSTS + n;
            let (low, high) = (&nodes.down[inside.clone()], &nodes.up[inside]);
            // A value given on the next node (normal component), or half way to it.
            let fixed = |upper: bool| {
                let e = Extrapolation::beyond(&self.grid, a, upper);
                if a == c { [0.0; 2] } else { [e.first, e.second] }
            };
            for kind in 0..4 {
                let part = |bit: usize| if kind & bit != 0 { [1.0, 0.0] } else { fixed(bit == 2) };
                let ends = (!metrics.periodic[a]).then(|| [part(1), part(2)]);
                self.factors[c][a][kind].set(kappa[a], first, low, high, ends);
            }
        }
    }

    /// Turns r into δ for component `c`; the boundary values have been set to those of the end of the step.
    pub(crate) fn solve(
        &mut self,
        c: usize,
        metrics: &Metrics<D>,
        boundaries: &Boundaries<D>,
        delta: &mut Field<D>,
    ) {
        let kappa = self.kappa;
        for a in (0..D).filter(|&a| kappa[a] > 0.0) {
            let nodes = metrics.of(Some(c), a);
            let lines = boundaries.lines(a);
            let first = self.factors[c][a][0].first;
            let n = self.factors[c][a][0].inv.len();
            let mut kind = Some(0);
            if let Some(ends) = boundaries.ends(a, c) {
                kind = ends.common_kind();
                let coefficient = [
                    kappa[a] * nodes.down[GHOSTS + first],
                    kappa[a] * nodes.up[(GHOSTS + first + n).saturating_sub(1)],
                ];
                if n > 0 && ends.moving {
                    for (l, o) in lines.starts().enumerate() {
                        let [low, high] = ends.changes(l);
                        delta.data_mut()[o + first * lines.step] += coefficient[0] * low;
                        delta.data_mut()[o + (first + n - 1) * lines.step] += coefficient[1] * high;
                    }
                }
                if kind.is_none() {
                    let factors = &self.factors[c][a];
                    self.sweeps.each(lines, |l| &factors[ends.kind(l)], delta);
                    continue;
                }
            }
            self.sweeps.all(a, &self.factors[c][a][kind.unwrap_or(0)], delta);
        }
    }
}

impl<const D: usize> Sweeps<D> {
    pub(crate) fn new(grid: &CartesianGrid<D>) -> Self {
        let n = grid.cells();
        let tasks = n[D - 1].div_ceil(layers_per_task(n[D - 1]));
        let longest = n.into_iter().max().unwrap_or(0);
        Self {
            scratch: vec![vec![0.0; ROWS * n[0] + ROWS.max(n[0])]; tasks],
            line: vec![0.0; longest],
            layer: vec![0.0; grid.stride()[D - 1]],
            grid: grid.clone(),
        }
    }

    /// Solves all lines along axis `a`.
    pub(crate) fn all(&mut self, a: usize, factor: &Tridiagonal, delta: &mut Field<D>) {
        let first = factor.first;
        let layer = self.grid.stride()[D - 1];
        if a == D - 1 {
            let rows = |i: usize| (GHOSTS + first + i) * layer;
            Arch::new().dispatch(Sweep { factor, data: delta.data_mut(), rows, sums: &mut self.layer });
            return;
        }
        let per_task = layers_per_task(self.grid.cells()[D - 1]);
        let grid = &self.grid;
        each_pair(delta.layers_mut(), &mut self.scratch, [layer * per_task, 1], &|_, layers, scratch| {
            let scratch = &mut scratch[0];
            if a == 0 {
                Arch::new().dispatch(AlongX { grid, factor, layers, scratch });
                return;
            }
            let s = grid.stride()[1];
            for layer in layers.chunks_exact_mut(layer) {
                let sums = &mut scratch[..grid.cells()[0]];
                let rows = |i: usize| (GHOSTS + first + i) * s + GHOSTS;
                Arch::new().dispatch(Sweep { factor, data: layer, rows, sums });
            }
        });
    }

    /// Solves line by line, where the ends differ from line to line.
    pub(crate) fn each<'a>(
        &mut self,
        lines: &Lines,
        factor: impl Fn(usize) -> &'a Tridiagonal,
        delta: &mut Field<D>,
    ) {
        let data = delta.data_mut();
        for (l, o) in lines.starts().enumerate().filter(|&(l, _)| lines.inside(l)) {
            let factor = factor(l);
            let line = &mut self.line[..factor.inv.len()];
            let at = |i: usize| o + (factor.first + i) * lines.step;
            line.iter_mut().enumerate().for_each(|(i, x)| *x = data[at(i)]);
            factor.solve_side_by_side(line, |i| i, &mut [0.0]);
            line.iter().enumerate().for_each(|(i, x)| data[at(i)] = *x);
        }
    }
}

/// Lines side by side in memory.
struct Sweep<'a, R> {
    factor: &'a Tridiagonal,
    data: &'a mut [f64],
    rows: R,
    sums: &'a mut [f64],
}

impl<R: Fn(usize) -> usize> WithSimd for Sweep<'_, R> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.factor.solve_side_by_side(self.data, self.rows, self.sums);
    }
}

/// Rows along x, eight at a time.
struct AlongX<'a, const D: usize> {
    grid: &'a CartesianGrid<D>,
    factor: &'a Tridiagonal,
    /// Whole layers.
    layers: &'a mut [f64],
    scratch: &'a mut [f64],
}

impl<const D: usize> WithSimd for AlongX<'_, D> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { grid, factor, layers, scratch } = self;
        let (n, first) = (factor.inv.len(), factor.first);
        let row = grid.stride()[1];
        let (block, sums) = scratch.split_at_mut(ROWS * grid.cells()[0]);
        // Ghost rows of an inner axis are swept too; nobody reads them.
        for rows in layers.chunks_mut(ROWS * row) {
            let count = rows.len() / row;
            for (j, row) in rows.chunks_exact(row).enumerate() {
                for (i, x) in row[GHOSTS + first..][..n].iter().enumerate() {
                    block[i * ROWS + j] = *x;
                }
            }
            factor.solve_side_by_side(block, |i| i * ROWS, &mut sums[..ROWS]);
            for (j, row) in rows.chunks_exact_mut(row).enumerate().take(count) {
                for (i, x) in row[GHOSTS + first..][..n].iter_mut().enumerate() {
                    *x = block[i * ROWS + j];
                }
            }
        }
    }
}
