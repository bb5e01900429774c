//! Overlaps summed on the cells of a mesh.
use super::Overlap;
use super::solver::check;
use super::tree::grow::{NONE, Tree};
use super::tree::seen::{Seen, shared};
use super::tree::{AdaptiveTree, Oriented, Refinement, Surfaces};
use crate::overlap::tree::columns::Sums;
use crate::{DemError, Shape};
use interfaces::{MeshGeometry, Point, Pose, Vector};
use nalgebra::Matrix3;

/// Sums what two bodies share over the cells of a mesh, as a flow solver without a mesh of its own for contacts would
/// (Studeník et al. 2022); the memory stays.
///
/// A cell near both bodies is divided into eight, `levels` times, where a surface cuts it, as adaptive refinement of the mesh
/// would do; what is cut in the end is closed as in the adaptive tree. All regions count as one patch.
#[derive(Clone, Debug, Default)]
pub struct CellOverlap {
    levels: u8,
    tree: Tree,
    cells: usize,
}

impl CellOverlap {
    /// With cells as they are (0), or divided up to 8 times.
    ///
    /// # Errors
    /// [`DemError::Refinement`] for more.
    pub fn new(levels: u8) -> Result<Self, DemError> {
        if levels > 0 {
            Refinement::Levels(levels).check()?;
        }
        Ok(Self { levels, ..Self::default() })
    }

    /// What the two share within the mesh, if anything.
    ///
    /// # Errors
    /// [`DemError::Unsupported`] for plane shapes, and for half-spaces with one another; [`DemError::Pose`] when a pose is
    /// not finite.
    pub fn overlap(
        &mut self,
        mesh: &impl MeshGeometry,
        a: &dyn Shape,
        at_a: &Pose,
        b: &dyn Shape,
        at_b: &Pose,
    ) -> Result<Option<Overlap>, DemError> {
        for (shape, at) in [(a, at_a), (b, at_b)] {
            check(shape, at)?;
        }
        if !AdaptiveTree::supports(a, b) {
            return Err(DemError::Unsupported { a: a.name(), b: b.name() });
        }
        self.cells = 0;
        let Some(both) = shared(&a.aabb().posed(at_a), &b.aabb().posed(at_b)) else { return Ok(None) };
        let origin = nalgebra::center(&both.min, &both.max).coords;
        let bodies = [Seen::new(a, at_a, origin), Seen::new(b, at_b, origin)];
        let (cut, mut sums) = (Surfaces { shapes: [a, b] }, Sums::default());
        mesh.for_cells_in(&both, |cell| {
            let centre = cell.centre.coords - origin;
            let within = bodies.map(|body| body.within(&Matrix3::identity(), centre));
            let half = 0.5 * cell.edges;
            self.tree.grow_levels(&within, half, self.levels, &cut);
            // Of cells that do not fill their box.
            let share = cell.volume / cell.edges.product();
            for node in self.tree.nodes.iter().filter(|n| n.leaf != NONE) {
                sums.add(&self.tree.leaves[node.leaf as usize].content.sums.moved(centre, share));
                self.cells += 1;
            }
        });
        if sums.volume <= 0.0 {
            return Ok(None);
        }
        let between = (at_a.position - at_b.position).try_normalize(0.0).unwrap_or(Vector::x());
        let world =
            Oriented { centre: Vector::zeros(), axes: Matrix3::identity(), half: 0.5 * both.extent() };
        Ok(Some(world.overlap(&sums, Point::from(origin), between)))
    }

    /// How many cells, parts of cells counted singly, went into the last sum.
    pub fn n_cells(&self) -> usize {
        self.cells
    }
}
