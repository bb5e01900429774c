//! One axis of a level: metrics, which cells to merge, and the transfer to the next coarser level.
use super::coarsen::Path;
use super::stencil::Real;
use crate::poisson::AxisBounds;

/// What holds behind the ends of an axis of a level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    Periodic,
    ZeroGradient,
    ZeroValue,
}

/// The ends, low then high.
pub(super) fn ends(bounds: AxisBounds) -> [End; 2] {
    match bounds {
        AxisBounds::Periodic => [End::Periodic; 2],
        AxisBounds::Neumann => [End::ZeroGradient; 2],
        AxisBounds::Dirichlet => [End::ZeroValue; 2],
        AxisBounds::NeumannDirichlet => [End::ZeroGradient, End::ZeroValue],
        AxisBounds::DirichletNeumann => [End::ZeroValue, End::ZeroGradient],
    }
}

/// Widths of the cells along an axis and its ends.
#[derive(Clone, Debug)]
pub(super) struct AxisLevel {
    pub(super) widths: Vec<f64>,
    pub(super) ends: [End; 2],
}

impl AxisLevel {
    pub(super) fn cells(&self) -> usize {
        self.widths.len()
    }

    pub(super) fn periodic(&self) -> bool {
        self.ends[0] == End::Periodic
    }

    /// Coefficients 1/(w d) of the differences to the lower and to the upper neighbour. Behind a face of zero
    /// value, and if `all_faces` behind one of zero gradient too, stands the face itself: 2/w².
    pub(super) fn coefficients(&self, all_faces: bool) -> [Vec<f64>; 2] {
        let (w, n) = (&self.widths, self.cells());
        let at_end = |end: usize, i: usize, other: usize| match self.ends[end] {
            End::Periodic if n == 1 => 0.0,
            End::Periodic => 2.0 / (w[i] * (w[i] + w[other])),
            End::ZeroGradient if !all_faces => 0.0,
            End::ZeroGradient | End::ZeroValue => 2.0 / (w[i] * w[i]),
        };
        let inner = |i: usize, other: usize| 2.0 / (w[i] * (w[i] + w[other]));
        let low = (0..n).map(|i| if i == 0 { at_end(0, 0, n - 1) } else { inner(i, i - 1) }).collect();
        let high = (0..n).map(|i| if i + 1 == n { at_end(1, i, 0) } else { inner(i, i + 1) }).collect();
        [low, high]
    }

    /// First cells of the groups after merging neighbours that are together no wider than `limit`; the pairs
    /// are counted from the high end if `from_high`. The last entry is the number of cells.
    pub(super) fn groups(&self, limit: f64, from_high: bool) -> Vec<usize> {
        let n = self.cells();
        let mut starts = Vec::with_capacity(n + 1);
        if from_high {
            let mut end = n;
            while end > 0 {
                starts.push(end);
                end -= if end > 1 && self.widths[end - 1] + self.widths[end - 2] <= limit { 2 } else { 1 };
            }
            starts.push(0);
            starts.reverse();
        } else {
            let mut start = 0;
            while start < n {
                starts.push(start);
                start +=
                    if start + 1 < n && self.widths[start] + self.widths[start + 1] <= limit { 2 } else { 1 };
            }
            starts.push(n);
        }
        starts
    }

    /// The axis of the groups.
    pub(super) fn merged(&self, groups: &[usize]) -> Self {
        let widths = groups.windows(2).map(|g| self.widths[g[0]..g[1]].iter().sum()).collect();
        Self { widths, ends: self.ends }
    }

    fn centres(&self) -> Vec<f64> {
        let mut face = 0.0;
        self.widths
            .iter()
            .map(|w| {
                face += w;
                face - 0.5 * w
            })
            .collect()
    }
}

/// Linear interpolation along an axis from the groups to the cells, and its adjoint.
///
/// Cell i gets `weights[i][0]` φ(`parents[i][0]`) + `weights[i][1]` φ(`parents[i][1]`).
pub(super) struct Transfer<T> {
    /// First cells of the groups, then the number of cells.
    pub(super) groups: Vec<usize>,
    pub(super) parents: Vec<[usize; 2]>,
    pub(super) weights: Vec<[T; 2]>,
    /// Weights of the restriction, `weights[i][m]` w_i / W: the adjoint for volume-weighted products.
    pub(super) shares: Vec<[T; 2]>,
    /// The group on the other side of the cell's half of its group, and whether there is one: beyond an end there is
    /// none, nor in a group of one cell.
    pub(super) neighbours: Vec<(usize, bool)>,
    /// For each group the cells that contribute to it, consecutive modulo the number of cells.
    pub(super) children: Vec<Vec<(usize, T)>>,
    /// From each group to the next, those of the ends included.
    pub(super) paths: Vec<Path>,
}

impl<T: Real> Transfer<T> {
    pub(super) fn new(fine: &AxisLevel, groups: Vec<usize>) -> Self {
        let coarse = fine.merged(&groups);
        let (n, count) = (fine.cells(), coarse.cells());
        let length: f64 = fine.widths.iter().sum();
        let (x, centre) = (fine.centres(), coarse.centres());
        let mut parents = vec![[0; 2]; n];
        let mut weights = vec![[1.0, 0.0]; n];
        for g in 0..count {
            for i in groups[g]..groups[g + 1] {
                parents[i] = [g, g];
                if groups[g + 1] - groups[g] == 1 {
                    continue;
                }
                let low = x[i] < centre[g];
                let offset = (x[i] - centre[g]).abs();
                let (at_end, end) = if low { (g == 0, fine.ends[0]) } else { (g + 1 == count, fine.ends[1]) };
                if at_end && end == End::ZeroGradient || count == 1 && end == End::Periodic {
                    continue;
                }
                if at_end && end == End::ZeroValue {
                    weights[i] = [1.0 - offset / (0.5 * coarse.widths[g]), 0.0];
                    continue;
                }
                let (other, distance) = match (at_end, low) {
                    (false, true) => (g - 1, centre[g] - centre[g - 1]),
                    (false, false) => (g + 1, centre[g + 1] - centre[g]),
                    (true, true) => (count - 1, centre[g] + length - centre[count - 1]),
                    (true, false) => (0, centre[0] + length - centre[g]),
                };
                let t = offset / distance;
                parents[i] = [g, other];
                weights[i] = [1.0 - t, t];
            }
        }
        let share = |i: usize, m: usize| weights[i][m] * fine.widths[i] / coarse.widths[parents[i][m]];
        let neighbour = |i: usize| {
            let g = parents[i][0];
            let (single, low) = (groups[g + 1] - groups[g] == 1, x[i] < centre[g]);
            let at_end = if low { g == 0 } else { g + 1 == count };
            match (single || at_end && !fine.periodic(), low) {
                (true, _) => (g, false),
                (false, true) => ((g + count - 1) % count, true),
                (false, false) => ((g + 1) % count, true),
            }
        };
        let mut children = vec![Vec::new(); count];
        for (g, list) in children.iter_mut().enumerate() {
            // From a cell below the group to a cell above it, around the box if need be.
            for at in groups[g] + n - 1..groups[g + 1] + n + 1 {
                let i = at % n;
                let total: f64 = (0..2).filter(|&m| parents[i][m] == g).map(|m| share(i, m)).sum();
                let known = list.iter().any(|&(known, _)| known == i);
                if total > 0.0 && !known {
                    list.push((i, T::of(total)));
                }
            }
        }
        Self {
            shares: (0..n).map(|i| [T::of(share(i, 0)), T::of(share(i, 1))]).collect(),
            weights: weights.iter().map(|w| w.map(T::of)).collect(),
            neighbours: (0..n).map(neighbour).collect(),
            paths: (0..groups.len()).map(|g| Path::new(fine, &groups, g)).collect(),
            groups,
            parents,
            children,
        }
    }
}
