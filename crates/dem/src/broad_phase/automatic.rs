//! The choice of a broad phase.
use super::{BroadPhase, HierarchicalGrid, RTree, Sweep};
use interfaces::Aabb;

/// Up to so many boxes are swept.
const FEW: usize = 48;
/// Cells with so many boxes for each are no help.
const CROWDED: f64 = 64.0;

/// Picks by the number of boxes and how they stand: a few are swept, many are put in cells by size, and in a tree if
/// most cells would be empty and the others crowded.
#[derive(Clone, Debug, Default)]
pub struct Automatic {
    pick: Pick,
    sweep: Sweep,
    grid: HierarchicalGrid,
    tree: RTree,
}

#[derive(Clone, Copy, Debug, Default)]
enum Pick {
    #[default]
    Sweep,
    Grid,
    Tree,
}

impl Automatic {
    /// Without boxes.
    pub fn new() -> Self {
        Self::default()
    }
    #[cfg(test)]
    pub(super) fn is_tree(&self) -> bool {
        matches!(self.pick, Pick::Tree)
    }
    fn picked(&self) -> &dyn BroadPhase {
        match self.pick {
            Pick::Sweep => &self.sweep,
            Pick::Grid => &self.grid,
            Pick::Tree => &self.tree,
        }
    }
}

impl BroadPhase for Automatic {
    fn boxed(&self) -> Box<dyn BroadPhase> {
        Box::new(self.clone())
    }
    fn rebuild(&mut self, boxes: &[Aabb]) {
        if boxes.len() <= FEW {
            self.pick = Pick::Sweep;
            return self.sweep.rebuild(boxes);
        }
        self.pick = Pick::Grid;
        self.grid.rebuild(boxes);
        if self.grid.crowding() > CROWDED {
            self.pick = Pick::Tree;
            self.tree.rebuild(boxes);
        }
    }
    fn update(&mut self, i: usize, to: &Aabb) {
        match self.pick {
            Pick::Sweep => self.sweep.update(i, to),
            Pick::Grid => self.grid.update(i, to),
            Pick::Tree => self.tree.update(i, to),
        }
    }
    fn meeting(&self, target: &Aabb, found: &mut Vec<u32>) {
        self.picked().meeting(target, found);
    }
    fn order(&self) -> &[u32] {
        self.picked().order()
    }
    fn partners(&self, place: usize, target: &Aabb, found: &mut Vec<u32>) {
        self.picked().partners(place, target, found);
    }
}
