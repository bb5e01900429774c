//! Boxes in a tree of boxes.
use super::BroadPhase;
use interfaces::Aabb;
use rstar::AABB;
use rstar::primitives::{GeomWithData, Rectangle};

type Entry = GeomWithData<Rectangle<[f64; 3]>, u32>;

/// An R*-tree (Beckmann et al. 1990, crate `rstar`), bulk loaded: for boxes that stand in clusters far apart, where cells
/// would be too large or too many.
///
/// Rebuild O(n log n), update O(log n), query O(log n + found) where few boxes overlap. Its nodes are allocated anew.
#[derive(Clone, Debug, Default)]
pub struct RTree {
    tree: rstar::RTree<Entry>,
    boxes: Vec<Aabb>,
}

impl RTree {
    /// Without boxes.
    pub fn new() -> Self {
        Self::default()
    }
}

fn entry(b: &Aabb, id: usize) -> Entry {
    GeomWithData::new(Rectangle::from_corners(b.min.into(), b.max.into()), id as u32)
}

impl BroadPhase for RTree {
    fn boxed(&self) -> Box<dyn BroadPhase> {
        Box::new(self.clone())
    }
    fn rebuild(&mut self, boxes: &[Aabb]) {
        self.boxes.clear();
        self.boxes.extend_from_slice(boxes);
        self.tree = rstar::RTree::bulk_load(boxes.iter().enumerate().map(|(i, b)| entry(b, i)).collect());
    }
    fn update(&mut self, i: usize, to: &Aabb) {
        self.tree.remove(&entry(&self.boxes[i], i));
        self.tree.insert(entry(to, i));
        self.boxes[i] = *to;
    }
    fn meeting(&self, target: &Aabb, found: &mut Vec<u32>) {
        let target = AABB::from_corners(target.min.into(), target.max.into());
        let here = self.tree.locate_in_envelope_intersecting(target);
        found.extend(here.map(|e| e.data));
    }
}
