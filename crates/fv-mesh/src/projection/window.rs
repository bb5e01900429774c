//! A box that moves on.
use super::Projection;
use crate::FlowError;

impl<const D: usize> Projection<D> {
    /// Moves the box on by so many `cells` along `axis` (down if negative): a window on a larger flow, which stays with a body
    /// that sinks for long. Velocity, pressure and what time stepping remembers stay where they are in space, to the bit; the sides
    /// hold at the box's new ends. In the cells that come in, the fluid is as in the last ones before them, so
    /// nothing may happen there: put the ends where the fluid is at rest or flows out. The next step makes it free of
    /// divergence.
    ///
    /// The axis is bounded and uniform. Places remain those of the laboratory: [`grid`](Self::grid) tells where the box is, and
    /// fields of your own have to be on it. An eddy viscosity or a source for the next step is given after the move.
    ///
    /// # Errors
    /// [`FlowError::Window`] for an axis that is periodic or not uniform, patches on the sides along it, and immersed walls at
    /// rest ([`set_walls`](Self::set_walls)); [`FlowError::Grid`] beyond what coordinates can tell apart. Nothing has moved
    /// then.
    pub fn move_window(&mut self, axis: usize, cells: i64) -> Result<(), FlowError> {
        if self.walls.is_some() {
            let what = "immersed walls at rest would stay behind; take them out";
            return Err(FlowError::Window { axis, what });
        }
        let slide = self.state.slide(axis, cells)?;
        self.set_grid();
        self.sources.forget();
        for (c, tendency) in self.tendency.iter_mut().enumerate() {
            slide.change(tendency, c);
        }
        if self.pressure_solver.remembers() {
            slide.dense(&mut self.phi, &self.state.grid);
        }
        Ok(())
    }

    /// Puts all fields on the box's grid.
    pub(super) fn set_grid(&mut self) {
        let grid = &self.state.grid;
        self.next
            .iter_mut()
            .chain(&mut self.tendency)
            .chain(&mut self.correction)
            .chain(
                self.start
                    .iter_mut()
                    .flat_map(|start| start.tendency.iter_mut().chain([&mut start.pressure])),
            )
            .for_each(|field| field.set_grid(grid));
        self.sources.set_grid(grid);
    }
}
