//! Gradients in some of the cells of a grid.
use crate::least_squares::gradient_weights;
use crate::neighbours::around;
use crate::operators::Operators;

/// A value in a cell, and its gradient.
pub(crate) type Linear<const D: usize> = (f64, [f64; D]);

/// Least squares over those cells around that have fluid at their centre.
#[derive(Clone, Debug)]
pub(crate) struct CellGradients<const D: usize> {
    /// Dense numbers, and ends of their terms.
    cells: Vec<(usize, usize)>,
    /// Cells around, by their dense numbers, and their weights.
    terms: Vec<(usize, [f64; D])>,
    /// Of every cell of the grid its place in the list, while that is made.
    places: Vec<usize>,
}

impl<const D: usize> CellGradients<D> {
    /// None yet, on a grid of so many cells.
    pub(crate) fn new(n_cells: usize) -> Self {
        Self { cells: Vec::new(), terms: Vec::new(), places: vec![usize::MAX; n_cells] }
    }

    /// The place of a cell in the list, to which it is added if it is not there.
    pub(crate) fn place(&mut self, ops: &Operators<D>, dry: &[bool], cell: usize) -> usize {
        if self.places[cell] == usize::MAX {
            self.places[cell] = self.cells.len();
            let (found, steps): (Vec<_>, Vec<_>) =
                around(ops, cell).filter(|&(other, _)| !dry[other]).unzip();
            self.terms.extend(found.into_iter().zip(gradient_weights(&steps)));
            self.cells.push((cell, self.terms.len()));
        }
        self.places[cell]
    }

    /// The list is done.
    pub(crate) fn close(&mut self) {
        self.places = Vec::new();
    }

    /// Dense number of the cell at a place in the list.
    pub(crate) fn cell(&self, place: usize) -> usize {
        self.cells[place].0
    }
    /// Dense numbers of all in the list.
    pub(crate) fn cells(&self) -> impl ExactSizeIterator<Item = usize> {
        self.cells.iter().map(|&(cell, _)| cell)
    }
    /// Dense numbers of the cells around them.
    pub(crate) fn seen(&self) -> impl Iterator<Item = usize> {
        self.terms.iter().map(|&(cell, _)| cell)
    }

    /// Values and gradients of what has `value` in the cells.
    pub(crate) fn look(&self, value: impl Fn(usize) -> f64, out: &mut Vec<Linear<D>>) {
        out.clear();
        let mut start = 0;
        for &(cell, end) in &self.cells {
            let here = value(cell);
            let mut slope = [0.0; D];
            for &(other, weight) in &self.terms[start..end] {
                (0..D).for_each(|a| slope[a] += weight[a] * (value(other) - here));
            }
            out.push((here, slope));
            start = end;
        }
    }
}
