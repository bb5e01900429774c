//! The staggered velocity.
use crate::{CartesianGrid, Field, Sides};
use interfaces::{Lattice, VelocityField};

/// Velocity with component `c` on the faces normal to axis `c` (marker-and-cell staggering,
/// Harlow & Welch 1965): entry (i, j, k) of component 0 is on the lower x face of cell (i, j, k).
///
/// [`VelocityField`] has the places of the nodes and the values, also to change;
/// [`Sampler`](crate::Sampler) interpolates.
#[derive(Clone, Debug)]
pub struct Velocity<const D: usize> {
    pub(crate) components: [Field<D>; D],
    lattices: [Lattice; D],
}

impl<const D: usize> Velocity<D> {
    pub(crate) fn zeros(grid: &CartesianGrid<D>, sides: &Sides<D>) -> Self {
        Self {
            components: std::array::from_fn(|_| Field::zeros(grid)),
            lattices: std::array::from_fn(|c| grid.lattice(Some(c), sides)),
        }
    }
    /// The same values on a grid of the same size.
    pub(crate) fn set_grid(&mut self, grid: &CartesianGrid<D>, sides: &Sides<D>) {
        for (c, component) in self.components.iter_mut().enumerate() {
            component.set_grid(grid);
            self.lattices[c] = grid.lattice(Some(c), sides);
        }
    }
    /// The field of component `c` \[m/s\].
    pub fn field(&self, c: usize) -> &Field<D> {
        &self.components[c]
    }
}

impl<const D: usize> VelocityField for Velocity<D> {
    fn dim(&self) -> usize {
        D
    }
    fn lattice(&self, c: usize) -> &Lattice {
        &self.lattices[c]
    }
    fn component(&self, c: usize) -> &[f64] {
        self.components[c].data()
    }
    fn component_mut(&mut self, c: usize) -> &mut [f64] {
        self.components[c].data_mut()
    }
}
