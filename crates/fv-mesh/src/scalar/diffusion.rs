//! Implicit diffusion of a scalar by factors along the axes.
use super::ScalarBoundaries;
use crate::Field;
use crate::grid::GHOSTS;
use crate::implicit::{Sweeps, Tridiagonal};
use crate::metrics::Metrics;

/// Solves Π_a (1 − κ_a L_a) δ = r for the change δ of a scalar, L_a the second difference along axis a, κ = ½Γ dt
/// (Crank–Nicolson). Axes with κ = 0 are left out.
#[derive(Clone, Debug)]
pub(super) struct ScalarDiffusion<const D: usize> {
    kappa: [f64; D],
    kinds: [Kinds; D],
    sweeps: Sweeps<D>,
}

/// The kinds of lines along an axis.
#[derive(Clone, Debug, Default)]
struct Kinds {
    /// Factors of the first ghosts at both ends, each pair once; `None` if periodic.
    ends: Vec<Option<[f64; 2]>>,
    /// Kind of each line; empty if there is one kind.
    of: Vec<usize>,
    factors: Vec<Tridiagonal>,
}

impl Kinds {
    fn new<const D: usize>(boundaries: &ScalarBoundaries<D>, a: usize) -> Self {
        let Some(ends) = boundaries.ends(a) else {
            return Self { ends: vec![None], ..Self::default() };
        };
        let mut new = Self::default();
        for l in 0..boundaries.lines(a).len() {
            let pair = Some([ends.factor[0][l], ends.factor[1][l]]);
            let kind = new.ends.iter().position(|p| *p == pair).unwrap_or_else(|| {
                new.ends.push(pair);
                new.ends.len() - 1
            });
            new.of.push(kind);
        }
        if new.ends.len() == 1 {
            new.of.clear();
        }
        new
    }
}

impl<const D: usize> ScalarDiffusion<D> {
    pub(super) fn new(boundaries: &ScalarBoundaries<D>) -> Self {
        Self {
            kappa: [0.0; D],
            kinds: std::array::from_fn(|a| Kinds::new(boundaries, a)),
            sweeps: Sweeps::new(boundaries.grid()),
        }
    }

    /// Takes κ along each axis.
    pub(super) fn set(&mut self, metrics: &Metrics<D>, kappa: [f64; D]) {
        if kappa == self.kappa {
            return;
        }
        self.kappa = kappa;
        for (a, kinds) in self.kinds.iter_mut().enumerate().filter(|&(a, _)| kappa[a] > 0.0) {
            let nodes = &metrics.axes[a].centres;
            let inside = GHOSTS..nodes.down.len() - GHOSTS;
            let (low, high) = (&nodes.down[inside.clone()], &nodes.up[inside]);
            kinds.factors.resize_with(kinds.ends.len(), Tridiagonal::default);
            for (factor, ends) in kinds.factors.iter_mut().zip(&kinds.ends) {
                let ends = ends.map(|parts| parts.map(|part| [part, 0.0]));
                factor.set(kappa[a], 0, low, high, ends);
            }
        }
    }

    /// Turns r into δ; the boundary values have been set to those of the end of the step.
    pub(super) fn solve(
        &mut self,
        metrics: &Metrics<D>,
        boundaries: &ScalarBoundaries<D>,
        delta: &mut Field<D>,
    ) {
        for (a, kinds) in self.kinds.iter().enumerate().filter(|&(a, _)| self.kappa[a] > 0.0) {
            let (nodes, lines) = (&metrics.axes[a].centres, boundaries.lines(a));
            if let Some(ends) = boundaries.ends(a).filter(|e| !e.steady) {
                let last = lines.cells - 1;
                let (low, high) =
                    (self.kappa[a] * nodes.down[GHOSTS], self.kappa[a] * nodes.up[GHOSTS + last]);
                let data = delta.data_mut();
                for (o, (lower, upper)) in lines.starts().zip(ends.change[0].iter().zip(ends.change[1])) {
                    data[o] += low * lower;
                    data[o + last * lines.step] += high * upper;
                }
            }
            if kinds.of.is_empty() {
                self.sweeps.all(a, &kinds.factors[0], delta);
            } else {
                self.sweeps.each(lines, |l| &kinds.factors[kinds.of[l]], delta);
            }
        }
    }
}
