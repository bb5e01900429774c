//! How a flow shows its velocity to whoever wants to read or force it.
use crate::{Nodes, Point};
use std::ops::Range;

/// The nodes of one scalar on a Cartesian lattice, and where their values are stored.
///
/// Node (i, j, k) stands at the i-th, j-th and k-th of the [`Nodes`] along x, y and z; its value is at
/// base + i·stride\[0\] + j·stride\[1\] + k·stride\[2\]. A plane lattice has one node along z, at 0 and 1 m wide.
#[derive(Clone, Debug, PartialEq)]
pub struct Lattice {
    /// Space dimensions, 2 or 3.
    pub dim: usize,
    /// The nodes along each axis.
    pub axes: [Nodes; 3],
    /// Storage index of node (0, 0, 0).
    pub base: usize,
    /// Storage distance of neighbours.
    pub stride: [usize; 3],
}

impl Lattice {
    /// The product of the given axes, two or three.
    pub fn new<const D: usize>(axes: [Nodes; D], base: usize, stride: [usize; D]) -> Self {
        let mut all = [const { None }; 3];
        for (slot, axis) in all.iter_mut().zip(axes) {
            *slot = Some(axis);
        }
        Self {
            dim: D,
            axes: all.map(|a| a.unwrap_or_else(|| Nodes::uniform(0.0, 1.0, 1, false))),
            base,
            stride: std::array::from_fn(|a| stride.get(a).copied().unwrap_or(0)),
        }
    }
    /// The same nodes with values stored one after the other, x fastest, from 0.
    #[must_use]
    pub fn dense(&self) -> Self {
        let [nx, ny, _] = self.shape();
        let stride = [1, nx, if self.dim == 2 { 0 } else { nx * ny }];
        Self { base: 0, stride, ..self.clone() }
    }
    /// Nodes along each axis that carry an unknown.
    pub fn shape(&self) -> [usize; 3] {
        std::array::from_fn(|a| self.axes[a].len())
    }
    /// Edges of the control volume of node `i` \[m\]; 1 along z in a plane lattice.
    #[inline]
    pub fn widths(&self, i: [isize; 3]) -> [f64; 3] {
        std::array::from_fn(|a| self.axes[a].width(i[a]))
    }
    /// Control volume of node `i` \[m³\]; area in a plane lattice.
    #[inline]
    pub fn volume(&self, i: [isize; 3]) -> f64 {
        self.widths(i).iter().product()
    }
    /// Place of node `i`, which may lie outside.
    #[inline]
    pub fn position(&self, i: [isize; 3]) -> [f64; 3] {
        std::array::from_fn(|a| self.axes[a].place(i[a]))
    }
    /// Storage index of node `i`, wrapped; `None` outside.
    #[inline]
    pub fn index(&self, i: [isize; 3]) -> Option<usize> {
        let mut at = self.base;
        for a in 0..3 {
            at += self.axes[a].wrap(i[a])? * self.stride[a];
        }
        Some(at)
    }
    /// The node with this storage index.
    #[inline]
    pub fn node(&self, index: usize) -> [isize; 3] {
        let mut rest = index - self.base;
        let mut node = [0; 3];
        for a in (0..self.dim).rev() {
            node[a] = (rest / self.stride[a]) as isize;
            rest %= self.stride[a];
        }
        node
    }
    /// The nodes whose coordinate along axis `a` lies in [lo, hi], as first..end, not wrapped;
    /// cut to the lattice where the axis is bounded.
    pub fn range(&self, a: usize, lo: f64, hi: f64) -> Range<isize> {
        if a >= self.dim { 0..1 } else { self.axes[a].range(lo, hi) }
    }
    /// The last node not above `x` along any axis, and how far x is from it towards the next ones.
    #[inline]
    pub fn locate(&self, x: Point) -> ([isize; 3], [f64; 3]) {
        let (mut node, mut part) = ([0; 3], [0.0; 3]);
        for a in 0..self.dim {
            (node[a], part[a]) = self.axes[a].locate(x[a]);
        }
        (node, part)
    }
}

/// A velocity field whose component `c` lives on a lattice of its own (staggered) or on one
/// that all share.
pub trait VelocityField: Sync {
    /// Space dimensions, 2 or 3, which is also the number of components.
    fn dim(&self) -> usize;
    /// The nodes of component `c`.
    fn lattice(&self, c: usize) -> &Lattice;
    /// The stored values of component `c` \[m/s\].
    fn component(&self, c: usize) -> &[f64];
    /// The same, to change.
    fn component_mut(&mut self, c: usize) -> &mut [f64];
}
