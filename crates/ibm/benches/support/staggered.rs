//! A velocity as flows store it.
use interfaces::{Lattice, Nodes, VelocityField};

/// A velocity field: component c on the lower faces along axis c of a periodic unit box, stored with two ghosts as flows do.
pub(crate) struct Staggered {
    lattices: Vec<Lattice>,
    values: Vec<Vec<f64>>,
}

impl Staggered {
    pub(crate) fn new<const D: usize>(cells: usize) -> Self {
        let h = 1.0 / cells as f64;
        let axis = |a, c| Nodes::uniform(if a == c { 0.0 } else { 0.5 * h }, h, cells, true);
        let padded = cells + 4;
        let stride: [usize; D] = std::array::from_fn(|a| padded.pow(a as u32));
        let base = 2 * stride.iter().sum::<usize>();
        let lattice = |c| Lattice::new(std::array::from_fn::<_, D, _>(|a| axis(a, c)), base, stride);
        Self { lattices: (0..D).map(lattice).collect(), values: vec![vec![0.0; padded.pow(D as u32)]; D] }
    }
}

impl VelocityField for Staggered {
    fn dim(&self) -> usize {
        self.lattices.len()
    }
    fn lattice(&self, c: usize) -> &Lattice {
        &self.lattices[c]
    }
    fn component(&self, c: usize) -> &[f64] {
        &self.values[c]
    }
    fn component_mut(&mut self, c: usize) -> &mut [f64] {
        &mut self.values[c]
    }
}
