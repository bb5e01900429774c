//! Which bodies are near one another.
//!
//! [`PairList`] lists pairs of boxes that meet, over periodic sides too; a [`BroadPhase`] finds those that meet one box.
mod automatic;
mod grid;
mod hierarchical_grid;
mod images;
mod linked_cells;
mod pair_list;
mod pair_list_error;
mod r_tree;
mod sweep;

#[cfg(test)]
mod tests;

pub use automatic::Automatic;
pub use hierarchical_grid::HierarchicalGrid;
pub use linked_cells::LinkedCells;
pub use pair_list::{NearPair, PairList};
pub use pair_list_error::PairListError;
pub use r_tree::RTree;
pub use sweep::Sweep;

use interfaces::Aabb;
use std::fmt::Debug;

/// Finds boxes that meet. Corners have to be finite, the lower one first ([`PairList`] sees to it), and there have
/// to be fewer than 2³¹ boxes.
pub trait BroadPhase: Send + Sync + Debug {
    /// Takes these boxes instead of those before.
    fn rebuild(&mut self, boxes: &[Aabb]);
    /// Box `i` is another one now.
    fn update(&mut self, i: usize, to: &Aabb);
    /// Appends the numbers of all boxes that meet `target` (touching counts), each once, in any order.
    fn meeting(&self, target: &Aabb, found: &mut Vec<u32>);
    /// A copy.
    fn boxed(&self) -> Box<dyn BroadPhase>;
    /// All numbers in an order in which neighbours in space follow one another, or nothing if that is their own order. To go through
    /// the boxes in this order finds what is asked for in the cache.
    fn order(&self) -> &[u32] {
        &[]
    }
    /// Appends partners of `target`, the box at this `place` of [`Self::order`]: over all places every two boxes that meet are
    /// found once, by one of them. Spares half of the work or more where it is known which half; else the smaller number finds
    /// the larger one.
    fn partners(&self, place: usize, target: &Aabb, found: &mut Vec<u32>) {
        higher_partners(self, place, target, found);
    }
}

impl Clone for Box<dyn BroadPhase> {
    fn clone(&self) -> Self {
        self.as_ref().boxed()
    }
}

/// Those of higher number than the box at `place`.
fn higher_partners(all: &(impl BroadPhase + ?Sized), place: usize, target: &Aabb, found: &mut Vec<u32>) {
    let id = all.order().get(place).map_or(place as u32, |id| *id);
    let first = found.len();
    all.meeting(target, found);
    let mut end = first;
    for at in first..found.len() {
        let other = found[at];
        found[end] = other;
        end += usize::from(other > id);
    }
    found.truncate(end);
}

/// Whether two boxes share a point.
#[inline]
fn meet(a: &Aabb, b: &Aabb) -> bool {
    // Without branches: which of the six fails cannot be foretold.
    (a.min.x <= b.max.x)
        & (b.min.x <= a.max.x)
        & (a.min.y <= b.max.y)
        & (b.min.y <= a.max.y)
        & (a.min.z <= b.max.z)
        & (b.min.z <= a.max.z)
}
