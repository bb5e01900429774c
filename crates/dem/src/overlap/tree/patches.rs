//! Which leaves of a tree hang together.
use super::grow::{NONE, Tree};

/// Sets of leaves, each known by one of its members.
#[derive(Clone, Debug, Default)]
pub(crate) struct Patches {
    above: Vec<u32>,
}

impl Patches {
    /// Unites the leaves that share a face and hold volume both.
    pub(crate) fn find(&mut self, tree: &Tree) {
        self.above.clear();
        self.above.extend(0..tree.leaves.len() as u32);
        if !tree.nodes.is_empty() {
            self.within(tree, 0);
        }
    }

    /// The member by which the set of `leaf` is known.
    pub(crate) fn of(&mut self, mut leaf: u32) -> u32 {
        while self.above[leaf as usize] != leaf {
            let next = self.above[leaf as usize];
            self.above[leaf as usize] = self.above[next as usize];
            leaf = next;
        }
        leaf
    }

    fn within(&mut self, tree: &Tree, node: u32) {
        let first = tree.nodes[node as usize].children;
        if first == NONE {
            return;
        }
        for i in 0..8 {
            self.within(tree, first + i);
            for axis in 0..3 {
                if i >> axis & 1 == 0 {
                    self.across(tree, first + i, first + (i | 1 << axis), axis);
                }
            }
        }
    }

    /// Unites what is on both sides of the face between two boxes, the first below it along `axis`.
    fn across(&mut self, tree: &Tree, below: u32, above: u32, axis: u32) {
        let (p, q) = (&tree.nodes[below as usize], &tree.nodes[above as usize]);
        if p.children == NONE && q.children == NONE {
            let full = |leaf: u32| leaf != NONE && tree.leaves[leaf as usize].content.sums.volume > 0.0;
            if full(p.leaf) && full(q.leaf) {
                let (a, b) = (self.of(p.leaf), self.of(q.leaf));
                self.above[a.max(b) as usize] = a.min(b);
            }
            return;
        }
        if (p.children == NONE && p.leaf == NONE) || (q.children == NONE && q.leaf == NONE) {
            return;
        }
        for i in (0..8).filter(|i| i >> axis & 1 == 0) {
            let side = |node: u32, children: u32, i: u32| if children == NONE { node } else { children + i };
            let (low, high) = (side(below, p.children, i | 1 << axis), side(above, q.children, i));
            self.across(tree, low, high, axis);
        }
    }
}
