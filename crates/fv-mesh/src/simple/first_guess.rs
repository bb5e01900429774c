//! The flow before the first iteration.
use super::{LONG, Simple};
use crate::FlowError;
use crate::flow_state::FlowState;
use crate::momentum_matrix as momentum;

/// Σ |∇·u| V over Σ |u| A that may be left, and the most solutions of the pressure equation to get there.
const LEFT: f64 = 1e-4;
const MOST: usize = 20;

impl<const D: usize> Simple<D> {
    /// Adds the potential to the velocity that frees it of divergence: u ← u − ∇φ. The momentum equations of a flow that
    /// passes through walls send it anywhere.
    ///
    /// # Errors
    /// As [`iterate`](Self::iterate).
    pub(super) fn free_first_guess(&mut self) -> Result<(), FlowError> {
        let (centre, lower, upper) = self.matrix.parts_mut();
        centre.fill(1.0);
        lower.into_iter().chain(upper).for_each(|list| list.fill(0.0));
        for c in 0..D {
            self.correction.set(c, &self.matrix, None, 1.0);
            for &cell in &self.pinned[c] {
                self.correction.freeze(c, cell);
            }
            if let Some(walls) = &self.walls {
                walls.narrow(c, &mut self.correction);
            }
        }
        let FlowState { metrics, boundaries, fluid, velocity, .. } = &mut self.state;
        boundaries.advance_outlets(metrics, &velocity.components, LONG, fluid.viscosity)?;
        boundaries.reset_outlets(&velocity.components);
        self.state.fill_velocity();
        let has_solids = self.walls.is_some() || self.pinned.iter().any(|p| !p.is_empty());
        let FlowState { boundaries, fluid, .. } = &mut self.state;
        self.correction.update(boundaries, fluid.viscosity)?;
        for _ in 0..MOST {
            let FlowState { grid, metrics, boundaries, fluid, velocity, .. } = &mut self.state;
            let velocity = &mut velocity.components;
            if let Some(walls) = &self.walls {
                walls.show_fluxes(velocity);
            }
            let through = momentum::throughput(grid, metrics, velocity);
            let divergence = self.correction.measure(boundaries, velocity, None, fluid.density);
            let done = divergence <= LEFT * through;
            if !done {
                if has_solids {
                    self.correction.skip_frozen();
                }
                self.correction.solve(false)?;
                self.correction.correct(boundaries, velocity);
            }
            if let Some(walls) = &self.walls {
                walls.show_nodes(velocity);
            }
            self.state.fill_velocity();
            if done {
                break;
            }
        }
        Ok(())
    }
}
