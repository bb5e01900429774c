//! Immersed walls in a flow.
use super::Projection;
use crate::cut::{InverseOutlook, Walls, check};
use crate::flow_state::FlowState;
use crate::per_dimension::per_dimension;
use crate::{FlowError, FlowStatistics};
use interfaces::{CutWalls, Wrench};

impl<const D: usize> Projection<D> {
    /// Puts immersed walls into the flow, or takes them out: the viscous terms go to the walls along cut links, the fluxes
    /// through the open parts of the faces, and the pressure acts on those. Diffusion is explicit then. Scalars and eddy
    /// viscosities do not see the walls. The pressure solver should be the direct one: an iterative one has to be as exact as
    /// the faces' equation is to be solved.
    ///
    /// Walls that are where the last ones were cost nothing. The first solutions with new ones iterate,
    /// until the inverse of their equation pays (see [`inverse_outlook`](Self::inverse_outlook)).
    ///
    /// # Errors
    /// [`FlowError::Parameter`] for walls on another grid and for
    /// [`Diffusion::Implicit`](crate::Diffusion::Implicit). The walls are then as before the call.
    pub fn set_walls(&mut self, walls: Option<CutWalls>) -> Result<(), FlowError> {
        per_dimension!(self, Projection, set_walls_here(walls: Option<CutWalls>) -> Result<(), FlowError>)
    }

    fn set_walls_here(&mut self, walls: Option<CutWalls>) -> Result<(), FlowError> {
        let Some(cuts) = walls else {
            (self.walls, self.diffusion.walled) = (None, false);
            return Ok(());
        };
        self.diffusion.walled = true;
        let placed = self.diffusion.mode().and_then(|_| self.place(cuts));
        self.diffusion.walled = self.walls.is_some();
        placed
    }

    fn place(&mut self, cuts: CutWalls) -> Result<(), FlowError> {
        let FlowState { grid, metrics, boundaries, velocity, pressure, .. } = &mut self.state;
        check(&cuts, grid, metrics)?;
        match &mut self.walls {
            Some(walls) if walls.cuts.same_shape(&cuts) => walls.cuts = cuts,
            walls => *walls = Some(Box::new(Walls::new(cuts, grid, metrics, boundaries))),
        }
        if let Some(walls) = &mut self.walls {
            walls.projected = false;
            walls.start(&mut velocity.components, pressure);
        }
        self.state.fill_velocity();
        self.state.fill_pressure();
        self.state.measure_rates();
        Ok(())
    }

    /// Sums and extremes of the velocity, as it is now. With immersed walls ∇·u is that of the fluxes through the open parts of the faces, of which
    /// the last projection made the flow free.
    pub fn statistics(&mut self) -> FlowStatistics {
        match &self.walls {
            None => self.state.statistics(),
            Some(walls) => self.state.statistics_of_fluxes(|state| {
                walls.show_conserved(&mut state.velocity.components);
                state.fill_velocity();
            }),
        }
    }

    /// Progress of the iterations at immersed walls to the inverse that replaces them, which takes
    /// as many solutions of the box's equation as there are cut cells and leaves two for each step;
    /// none if the inverse is made, or if so many cells are cut that none will be.
    pub fn inverse_outlook(&self) -> Option<InverseOutlook> {
        self.walls.as_ref().and_then(|walls| walls.pressure.inverse_outlook())
    }

    /// Impulse of the fluid on each body of the walls in the last step \[N s, N m s\], about the body's centre of mass.
    pub fn wall_impulses(&self) -> &[Wrench] {
        self.walls.as_ref().map_or(&[], |walls| &walls.impulses)
    }
}
