//! A box that moves on by whole cells, to stay with what it shows.
use crate::flow_state::FlowState;
use crate::grid::GHOSTS;
use crate::{CartesianGrid, Field, FlowError};
use interfaces::VelocityField;
use std::ops::RangeInclusive;

/// What is stored along the axis of the move.
#[derive(Clone, Copy)]
pub(crate) enum Along {
    /// One value per cell.
    Cells,
    /// One per face, those on the sides of the box included.
    Faces,
    /// One per face between two cells.
    InnerFaces,
}

/// A move by `cells` cells along `axis`.
#[derive(Clone, Copy)]
pub(crate) struct Slide {
    axis: usize,
    cells: i64,
}

impl Slide {
    /// Values stay where they are in space; those that come in are the last ones before them.
    pub(crate) fn field<const D: usize>(self, field: &mut Field<D>, along: Along) {
        let grid = field.grid().clone();
        let n = grid.cells()[self.axis];
        let kept = match along {
            Along::Cells => GHOSTS..=GHOSTS + n - 1,
            Along::Faces => GHOSTS..=GHOSTS + n,
            Along::InnerFaces => GHOSTS + 1..=GHOSTS + n - 1,
        };
        slide(field.data_mut(), grid.stride()[self.axis], n + 2 * GHOSTS, kept, self.cells);
    }
    /// The same for velocity component `c`.
    pub(crate) fn velocity<const D: usize>(self, field: &mut Field<D>, c: usize) {
        self.field(field, if c == self.axis { Along::Faces } else { Along::Cells });
    }
    /// The same for what changes velocity component `c` between the sides.
    pub(crate) fn change<const D: usize>(self, field: &mut Field<D>, c: usize) {
        self.field(field, if c == self.axis { Along::InnerFaces } else { Along::Cells });
    }
    /// The same for one value per cell without ghosts.
    pub(crate) fn dense<const D: usize>(self, values: &mut [f64], grid: &CartesianGrid<D>) {
        let n = grid.cells();
        let stride = n[..self.axis].iter().product();
        slide(values, stride, n[self.axis], 0..=n[self.axis] - 1, self.cells);
    }
}

/// Moves the layers `kept` of all `layers` layers, each of `stride` values, down by `by`.
fn slide(values: &mut [f64], stride: usize, layers: usize, kept: RangeInclusive<usize>, by: i64) {
    let (low, high) = (*kept.start(), *kept.end());
    let by_layers = usize::try_from(by.unsigned_abs()).unwrap_or(usize::MAX).min(high + 1 - low);
    let at = |layer: usize| layer * stride;
    for block in values.chunks_exact_mut(at(layers)) {
        if by > 0 {
            block.copy_within(at(low + by_layers)..at(high + 1), at(low));
            for layer in high + 1 - by_layers..high {
                block.copy_within(at(high)..at(high + 1), at(layer));
            }
        } else {
            block.copy_within(at(low)..at(high + 1 - by_layers), at(low + by_layers));
            for layer in low + 1..low + by_layers {
                block.copy_within(at(low)..at(low + 1), at(layer));
            }
        }
    }
}

impl<const D: usize> FlowState<D> {
    /// Moves the box by `cells` cells along `axis` on its fluid; the caller moves what it stores besides.
    ///
    /// # Errors
    /// Those of [`Projection::move_window`](crate::Projection::move_window); nothing has moved then.
    pub(crate) fn slide(&mut self, axis: usize, cells: i64) -> Result<Slide, FlowError> {
        let fail = |what| Err(FlowError::Window { axis, what });
        if axis >= D {
            return fail("the flow has no such axis; give 0 for x, 1 for y, 2 for z in space");
        }
        if self.metrics.periodic[axis] {
            return fail("it is periodic, so the fluid that leaves is what comes in; no move is needed");
        }
        if !self.grid.axis(axis).is_uniform() {
            return fail("its cells are not all equal; give a uniform axis");
        }
        if self.grid.cells()[axis] < 2 {
            return fail("it has one cell; give two or more");
        }
        if self.boundaries.patched_beside(axis) {
            return fail("patches on the sides along it would have to move; give whole sides");
        }
        let mut window = self.window;
        window[axis] = window[axis].saturating_add(cells);
        self.set_window(window)?;
        let slide = Slide { axis, cells };
        for (c, component) in self.velocity.components.iter_mut().enumerate() {
            slide.velocity(component, c);
        }
        slide.field(&mut self.pressure, Along::Cells);
        self.boundaries.take_through(axis, self.velocity.component(axis));
        self.fill_velocity();
        self.fill_pressure();
        self.measure_rates();
        Ok(slide)
    }
}

#[cfg(test)]
mod tests;
