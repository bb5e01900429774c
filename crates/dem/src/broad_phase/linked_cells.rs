//! Boxes in cells.
use super::{BroadPhase, HierarchicalGrid};
use interfaces::Aabb;

/// Cells about as large as the largest box, each with a list of the boxes that begin in it (Allen & Tildesley 1987,
/// section 5.3.2), in memory cell by cell. For bodies of like sizes; [`HierarchicalGrid`] is this once per class of
/// sizes, with the same complexity and memory.
#[derive(Clone, Debug)]
pub struct LinkedCells(HierarchicalGrid);

impl LinkedCells {
    /// Without boxes.
    pub fn new() -> Self {
        Self(HierarchicalGrid::with_levels(1))
    }
}

impl Default for LinkedCells {
    fn default() -> Self {
        Self::new()
    }
}

impl BroadPhase for LinkedCells {
    fn boxed(&self) -> Box<dyn BroadPhase> {
        Box::new(self.clone())
    }
    fn rebuild(&mut self, boxes: &[Aabb]) {
        self.0.rebuild(boxes);
    }
    fn update(&mut self, i: usize, to: &Aabb) {
        self.0.update(i, to);
    }
    fn meeting(&self, target: &Aabb, found: &mut Vec<u32>) {
        self.0.meeting(target, found);
    }
    fn order(&self) -> &[u32] {
        self.0.order()
    }
    fn partners(&self, place: usize, target: &Aabb, found: &mut Vec<u32>) {
        self.0.partners(place, target, found);
    }
}
