//! Where the cells of a mesh are.
use crate::{Aabb, Point, Vector};

/// A cell of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Its centre \[m\].
    pub centre: Point,
    /// Edge lengths \[m\]: those of the cell if it is a box along the axes, else of the box around it. 0 along z in a plane mesh.
    pub edges: Vector,
    /// Its volume \[m³\]; area \[m²\] in a plane mesh.
    pub volume: f64,
}

/// Any mesh.
pub trait MeshGeometry: Sync {
    /// Shows all cells whose boxes meet `b`, each once.
    fn for_cells_in(&self, b: &Aabb, see: impl FnMut(&Cell));
}
