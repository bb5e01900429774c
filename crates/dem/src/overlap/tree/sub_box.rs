//! The boxes of a tree, to look at.
use super::around::Oriented;
use super::grow::{Leaf, Node, State, Tree};
use interfaces::{Point, Vector};
use nalgebra::Matrix3;

/// Where a box of the adaptive tree is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoxKind {
    /// Inside both bodies.
    Inside,
    /// Cut by the surface of one body, or of both at places that its models do not see.
    Cut,
    /// Cut by the surfaces of both.
    Edge,
}

/// A box of the adaptive tree, in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SubBox {
    /// Its centre \[m\].
    pub centre: Point,
    /// Its axes are the columns.
    pub axes: Matrix3<f64>,
    /// Half-widths along them \[m\].
    pub half: Vector,
    /// How often its root was divided.
    pub level: u8,
    /// Where it is.
    pub kind: BoxKind,
    /// How much of it is in both bodies \[m³\].
    pub volume: f64,
}

impl SubBox {
    pub(crate) fn new(node: &Node, tree: &Tree, root: &Oriented, origin: Point) -> Self {
        let leaf = &tree.leaves[node.leaf as usize];
        let half = tree.half_at(node.level);
        let full = leaf.content.sums.volume > (1.0 - 1e-12) * 8.0 * half.product();
        let kind = match &leaf.states {
            [State::Inside, State::Inside] => BoxKind::Inside,
            // Near a surface, but not cut by it.
            _ if full => BoxKind::Inside,
            _ if leaf.is_edge() => BoxKind::Edge,
            _ => BoxKind::Cut,
        };
        Self {
            centre: origin + (root.centre + root.axes * node.centre),
            axes: root.axes,
            half,
            level: node.level,
            kind,
            volume: leaf.content.sums.volume,
        }
    }
}

impl Leaf {
    /// Do the planes of both surfaces cut it?
    pub(crate) fn is_edge(&self) -> bool {
        self.states.iter().all(|s| s.quadric().is_some_and(super::quadric::Quadric::cuts))
    }
}
