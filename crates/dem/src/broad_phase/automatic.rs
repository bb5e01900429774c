//! The choice of a broad phase.
use super::{BroadPhase, HierarchicalGrid, RTree, Sweep};
use interfaces::Aabb;

/// Up to so many boxes are swept: listing 20 dense ones takes 79 ns per body so and 80 by cells, 50 take 108 and 93.
const FEW: usize = 32;
/// Cells are no help where a body shares its own with so many: two clusters far apart take 475 ns per body by cells and 763 by the
/// tree if there are 1000 bodies, as long either way if there are 2000, 1768 and 1206 if there are 4000.
const CROWDED: f64 = 1000.0;

/// Picks by the number of boxes and how they stand: a few are swept, many are put in cells by size, and in a tree if
/// most cells would be empty and the others crowded.
///
/// CPU ns per body on one thread of a busy machine, best of many (`cargo bench -p siltflow-dem --bench broad_phase`); 5 pairs per body in the dense
/// scene, 2 to 4 in those of mixed sizes with as much volume in every decade of sizes:
///
/// | scene | bodies | rebuild | rebuild and list | refresh, 1 % moved | tree: rebuild and list |
/// |---|---|---|---|---|---|
/// | dense | 1000 | 19 | 129 | 16 | 983 |
/// | dense | 10 000 | 20 | 171 | 20 | 1343 |
/// | dense | 100 000 | 28 | 360 | 43 | 1842 |
/// | dense, periodic | 10 000 | 20 | 277 | 24 | 1532 |
/// | dense, one over all | 10 000 | 22 | 225 | 23 | 1411 |
/// | sizes 1 to 10 | 10 000 | 21 | 258 | 20 | 1424 |
/// | sizes 1 to 100 | 10 000 | 21 | 298 | 18 | 1311 |
/// | sizes 1 to 100 | 100 000 | 24 | 424 | 20 | 1720 |
///
/// The bodies are numbered at random. Two threads took 0.6 times as long for 100 000.
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
