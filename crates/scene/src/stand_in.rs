//! Small scene that stands for a large one.
use crate::build_error::BuildError;
use crate::setup::{Bodies, Setup};
use fv_mesh::{Axis, FlowError};
use std::sync::Arc;

/// Cells and bodies of a stand-in, at most.
const CELLS: usize = 100_000;
const BODIES: usize = 10_000;
/// Cells that each axis keeps, if it has them.
const FEWEST: usize = 8;

impl Setup {
    /// Scene with fewer bodies and wider cells, which may not resolve them: at most those for which
    /// there is `room`.
    pub(crate) fn smaller(&self, room: usize) -> Result<Self, BuildError> {
        let mut small = self.coarser(CELLS.min(room))?;
        small.bodies.list = self.bodies.list.iter().take(BODIES).cloned().collect();
        Ok(small)
    }

    /// This flow without bodies.
    pub(crate) fn without_bodies(mut self) -> Self {
        self.bodies = Bodies { list: Arc::new([]), inflows: Vec::new(), exits: Vec::new(), ..self.bodies };
        self.forces = None;
        self
    }

    /// Scene with `most` cells that are wider, if they can be that few, and without references and
    /// models.
    pub(crate) fn coarser(&self, most: usize) -> Result<Self, BuildError> {
        let numbers = |factor: usize| self.axes.iter().map(move |axis| cells(axis, factor));
        let enough = |&k: &usize| numbers(k).product::<usize>() <= most || numbers(k).eq(numbers(2 * k));
        let factor = (1..).find(enough).unwrap_or(1);
        self.with_cells(|axis| cells(axis, factor))
    }

    /// Scene with so many cells along each axis, and without references and models.
    pub(crate) fn with_cells(&self, cells: impl Fn(&Axis) -> usize) -> Result<Self, BuildError> {
        let mut small = self.clone();
        small.references.clear();
        small.models.clear();
        small.axes = self.axes.iter().map(|axis| coarse(axis, cells(axis))).collect::<Result<_, _>>()?;
        if let Some(images) = &mut small.output.images {
            let scaled = |a: usize, i: usize| i * small.axes[a].cells() / self.axes[a].cells();
            images.slice = images.slice.map(|(normal, layer)| (normal, scaled(normal, layer)));
            for (&a, region) in images.axes.iter().zip(&mut images.region) {
                let start = scaled(a, region.start);
                *region = start..scaled(a, region.end).max(start + 1);
            }
        }
        Ok(small)
    }
}

/// Number of cells `factor` times as wide as those of `axis`.
fn cells(axis: &Axis, factor: usize) -> usize {
    (axis.cells() / factor).max(FEWEST.min(axis.cells()))
}

/// Axis of `n` cells spaced as those of `axis`.
fn coarse(axis: &Axis, n: usize) -> Result<Axis, FlowError> {
    if axis.is_uniform() {
        return Axis::uniform(n, axis.lower(), axis.upper());
    }
    let (faces, last) = (axis.faces(), axis.cells() - 1);
    let face = |i: usize| {
        let place = (i * axis.cells()) as f64 / n as f64;
        let before = (place as usize).min(last);
        faces[before] + (place - before as f64) * (faces[before + 1] - faces[before])
    };
    Axis::from_faces((0..=n).map(face).collect::<Vec<f64>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coarse_axes_keep_ends_and_spacing() {
        let even = coarse(&Axis::uniform(64, -1.0, 1.0).unwrap(), 16).unwrap();
        assert!(even.is_uniform() && even.cells() == 16);
        let axis = Axis::geometric(60, 0.0, 1.0, 1.05).unwrap();
        let graded = coarse(&axis, 20).unwrap();
        assert_eq!((graded.cells(), graded.lower(), graded.upper()), (20, 0.0, 1.0));
        assert!((graded.width(10) / graded.width(9) - 1.05f64.powi(3)).abs() < 1e-9);
        let between = coarse(&axis, 25).unwrap();
        assert_eq!((between.cells(), between.lower(), between.upper()), (25, 0.0, 1.0));
        assert!((1..25).all(|i| between.width(i) > between.width(i - 1)));
        assert_eq!([10, 100].map(|n| cells(&Axis::uniform(n, 0.0, 1.0).unwrap(), 7)), [8, 14]);
    }
}
