//! How a flow shows its velocity to whoever wants to read or force it.

/// The nodes of one scalar on a uniform Cartesian lattice, and where their values are stored.
///
/// Node (i, j, k) stands at origin + (i hx, j hy, k hz); its value is at
/// base + i·stride\[0\] + j·stride\[1\] + k·stride\[2\]. In a plane lattice shape\[2\] = 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// Space dimensions, 2 or 3.
    pub dim: usize,
    /// Node (0, 0, 0) \[m\].
    pub origin: [f64; 3],
    /// Distance of neighbouring nodes \[m\]; 1 along z in a plane lattice.
    pub spacing: [f64; 3],
    /// Nodes along each axis that carry an unknown.
    pub shape: [usize; 3],
    /// Does the axis repeat after shape·spacing?
    pub periodic: [bool; 3],
    /// Storage index of node (0, 0, 0).
    pub base: usize,
    /// Storage distance of neighbours.
    pub stride: [usize; 3],
}

impl Lattice {
    /// Volume that belongs to a node \[m³\]; area in a plane lattice.
    pub fn cell_volume(&self) -> f64 {
        self.spacing[0] * self.spacing[1] * self.spacing[2]
    }
    /// Place of node `i`, which may lie outside.
    pub fn position(&self, i: [isize; 3]) -> [f64; 3] {
        std::array::from_fn(|a| self.origin[a] + i[a] as f64 * self.spacing[a])
    }
    /// Node number along axis `a` after wrapping; `None` outside a bounded axis.
    pub fn wrap(&self, a: usize, i: isize) -> Option<usize> {
        let n = self.shape[a] as isize;
        if self.periodic[a] {
            Some(i.rem_euclid(n) as usize)
        } else {
            (0..n).contains(&i).then_some(i as usize)
        }
    }
    /// Storage index of node `i`, wrapped; `None` outside.
    pub fn index(&self, i: [isize; 3]) -> Option<usize> {
        let mut at = self.base;
        for a in 0..3 {
            at += self.wrap(a, i[a])? * self.stride[a];
        }
        Some(at)
    }
    /// The nodes whose coordinate along axis `a` lies in [lo, hi], as first..end, not wrapped;
    /// cut to the lattice where the axis is bounded.
    pub fn range(&self, a: usize, lo: f64, hi: f64) -> std::ops::Range<isize> {
        let first = ((lo - self.origin[a]) / self.spacing[a]).ceil() as isize;
        let end = ((hi - self.origin[a]) / self.spacing[a]).floor() as isize + 1;
        let n = self.shape[a] as isize;
        if a >= self.dim {
            0..1
        } else if self.periodic[a] {
            first..end.max(first)
        } else {
            first.clamp(0, n)..end.clamp(first.clamp(0, n), n)
        }
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
