//! The levels and the V-cycle.
use super::axis::{AxisLevel, Transfer};
use super::coarsen::{Scratch, coarsen};
use super::coarsest::Coarsest;
use super::level::Level;
use super::stencil::Real;

/// Cells of the coarsest level at most, if the box can be coarsened so far.
const COARSEST: usize = 64;

/// Levels from fine to coarse. Approximates the inverse of `unit` A.
pub(super) struct Hierarchy<T> {
    pub(super) levels: Vec<Level<T>>,
    coarsest: Coarsest,
    sweeps: usize,
    scratch: Scratch,
}

impl<T: Real> Hierarchy<T> {
    /// `merge`: cells up to this wide \[m\] are merged first.
    pub(super) fn new(
        axes: [AxisLevel; 3],
        unit: f64,
        shift: f64,
        variable: bool,
        sweeps: usize,
        merge: f64,
        singular: bool,
    ) -> Self {
        let cells = |axes: &[AxisLevel; 3]| axes.iter().map(AxisLevel::cells).product::<usize>();
        let (mut axes, mut levels, mut width) = (axes, Vec::new(), merge);
        while cells(&axes) > COARSEST {
            // Wide enough to be worth a level.
            let (groups, next) = loop {
                let limit = 2.0 * width * (1.0 + 1e-6);
                let groups = axes.each_ref().map(|axis| axis.groups(limit, levels.len() % 2 == 1));
                let next: [AxisLevel; 3] = std::array::from_fn(|a| axes[a].merged(&groups[a]));
                if 5 * cells(&next) <= 4 * cells(&axes) {
                    break (groups, next);
                }
                width *= 1.25;
            };
            width *= 2.0;
            let mut groups = groups.into_iter();
            let transfer = axes.each_ref().map(|axis| Transfer::new(axis, groups.next().unwrap_or_default()));
            levels.push(Level::new(axes, Some(transfer), unit, shift, variable));
            axes = next;
        }
        let coarsest = Coarsest::new(&axes);
        levels.push(Level::new(axes, None, unit, shift, variable));
        let mut hierarchy = Self { levels, coarsest, sweeps, scratch: Scratch::default() };
        hierarchy.factorise(singular);
        hierarchy
    }

    /// Copies β of the faces normal to `axes` to the finest level and coarsens it from there.
    pub(super) fn renew(&mut self, beta: &[Vec<f64>; 3], axes: &[usize], singular: bool) {
        if let Some(own) = self.levels.first_mut().and_then(|level| level.stencil.beta.as_mut()) {
            for &axis in axes {
                own[axis].iter_mut().zip(&beta[axis]).for_each(|(own, &b)| *own = T::of(b));
            }
        }
        for l in 1..self.levels.len() {
            let (fine, coarse) = self.levels.split_at_mut(l);
            coarsen(&mut fine[l - 1], &mut coarse[0], axes, &mut self.scratch);
        }
        self.levels.iter_mut().for_each(|level| level.stencil.find_spans());
        self.factorise(singular);
    }

    /// Factorises the operator of the coarsest level.
    fn factorise(&mut self, singular: bool) {
        if let Some(Level { stencil, phi, f, .. }) = self.levels.last_mut() {
            self.coarsest.factorise(stencil, singular, phi, f);
        }
    }

    /// One V-cycle from φ = 0, with f on the finest level. The sweeps after the coarse correction mirror those before
    /// it, so that f ↦ φ is symmetric and positive in the volume-weighted product.
    pub(super) fn cycle(&mut self) {
        let last = self.levels.len() - 1;
        for l in 0..last {
            let (fine, coarse) = self.levels.split_at_mut(l + 1);
            for sweep in 0..self.sweeps {
                fine[l].smooth(0, sweep == 0);
            }
            fine[l].restrict(&mut coarse[0]);
        }
        let Level { stencil, phi, f, .. } = &mut self.levels[last];
        self.coarsest.solve(stencil, f, phi);
        for l in (0..last).rev() {
            let (fine, coarse) = self.levels.split_at_mut(l + 1);
            fine[l].prolong(&coarse[0]);
            for _ in 0..self.sweeps {
                fine[l].smooth(1, false);
            }
        }
    }
}
