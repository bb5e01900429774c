//! A box that moves on.
use super::Piso;
use crate::FlowError;
use crate::window::Along;

impl<const D: usize> Piso<D> {
    /// Moves the box on by so many `cells` along `axis`, as [`Projection::move_window`](crate::Projection::move_window) does.
    /// Velocities that were [imposed](Self::impose) are free again, and an eddy viscosity moves along.
    ///
    /// # Errors
    /// Those of [`Projection::move_window`](crate::Projection::move_window).
    pub fn move_window(&mut self, axis: usize, cells: i64) -> Result<(), FlowError> {
        let slide = self.state.slide(axis, cells)?;
        self.set_grid();
        for (c, old) in self.old.iter_mut().enumerate() {
            slide.velocity(old, c);
        }
        if let Some(eddy) = &mut self.eddy {
            slide.field(eddy, Along::Cells);
        }
        self.imposed.iter_mut().for_each(Vec::clear);
        Ok(())
    }

    /// Puts all fields on the box's grid.
    pub(super) fn set_grid(&mut self) {
        let grid = &self.state.grid;
        let fields = self
            .old
            .iter_mut()
            .chain(&mut self.older)
            .chain(&mut self.last)
            .chain(&mut self.carrier)
            .chain(&mut self.eddy);
        fields.for_each(|field| field.set_grid(grid));
    }
}
