//! Iterations of the pressure equation at immersed walls, which an inverse replaces during a run.
use crate::view::View;
use fv_mesh::InverseOutlook;

/// Iterations of the first steps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WallIterations {
    /// Iterations of a step.
    per_step: f64,
    /// CPU time of one \[s\].
    time: f64,
    /// Cut cells: the inverse takes as many solutions, and is made after as many iterations.
    unknowns: f64,
}

impl WallIterations {
    /// Iterations of the last step, whose CPU time is this `share` of their wall time; none without
    /// an inverse to come.
    pub(crate) fn of(view: &dyn View, share: f64) -> Option<Self> {
        let InverseOutlook { unknowns, iterations, seconds } = view.inverse_outlook()?;
        Some(Self {
            per_step: view.pressure_iterations() as f64,
            time: share * seconds / iterations as f64,
            unknowns: unknowns as f64,
        })
    }

    /// Iterations of a scene with `ratio` times as many cells, of which there are then `cells`, and
    /// `surface` times as many at surfaces.
    pub(crate) fn scaled(self, ratio: f64, cells: usize, surface: f64) -> Option<Self> {
        let unknowns = surface * self.unknowns;
        InverseOutlook::pays(unknowns as usize, cells).then_some(Self {
            time: ratio * self.time,
            unknowns,
            ..self
        })
    }

    /// Memory of the matrix, its factors and its inverse \[bytes\].
    pub(crate) fn memory(&self) -> f64 {
        3.0 * 8.0 * self.unknowns * self.unknowns
    }

    /// CPU time of so many steps, the first of which take `step` each \[s\].
    pub(crate) fn cost_of(self, steps: f64, step: f64) -> f64 {
        let all = steps * self.per_step;
        if all <= self.unknowns {
            return steps * step;
        }
        let spared = (all - 2.0 * self.unknowns) * self.time;
        (steps * step - spared).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_inverse_is_paid_for_once() {
        let iterations = WallIterations { per_step: 10.0, time: 2.0, unknowns: 100.0 };
        assert_eq!(iterations.cost_of(10.0, 25.0), 250.0);
        // 10 steps with iterations, 100 solutions of the inverse, 20 steps without iterations.
        assert_eq!(iterations.cost_of(30.0, 25.0), 250.0 + 200.0 + 20.0 * 5.0);
    }

    #[test]
    fn larger_scenes_may_have_too_many_cut_cells() {
        let iterations = WallIterations { per_step: 10.0, time: 2.0, unknowns: 1000.0 };
        let larger = iterations.scaled(8.0, 800_000, 4.0).unwrap();
        assert_eq!((larger.time, larger.unknowns), (16.0, 4000.0));
        assert!(iterations.scaled(8.0, 800_000, 8.0).is_none());
    }
}
