//! What segregated algorithms need of the sides.
use super::{Boundaries, FaceKind};
use crate::Field;

/// A face through which the velocity follows from a given pressure.
pub(crate) struct PressureFace {
    pub(crate) axis: usize,
    pub(crate) upper: bool,
    /// Dense number and storage index of the cell before it.
    pub(crate) cell: usize,
    pub(crate) index: usize,
    /// Pressure on it \[Pa\].
    pub(crate) pressure: f64,
}

impl<const D: usize> Boundaries<D> {
    /// Calls `f` with all faces of given pressure, in a fixed order, and the velocity through them, to change.
    pub(crate) fn each_pressure_face(&mut self, mut f: impl FnMut(PressureFace, &mut f64)) {
        for (axis, (lines, pair)) in self.lines.iter().zip(&mut self.states).enumerate() {
            let Some(pair) = pair else { continue };
            for (upper, state) in pair.iter_mut().enumerate().filter(|(_, s)| s.has_pressure()) {
                let upper = upper == 1;
                for (l, o) in lines.starts().enumerate().filter(|&(l, _)| lines.inside(l)) {
                    if state.kind[l] == FaceKind::Pressure {
                        let cell = lines.end_cell(&self.grid, l, upper);
                        let index = if upper { o + (lines.cells - 1) * lines.step } else { o };
                        let pressure = state.pressure[l];
                        f(PressureFace { axis, upper, cell, index, pressure }, &mut state.normal[l]);
                    }
                }
            }
        }
    }

    /// Velocity through the faces of given pressure as one cell inside.
    pub(crate) fn reset_outlets(&mut self, velocity: &[Field<D>; D]) {
        let stride = self.grid.stride();
        self.each_pressure_face(|face, normal| {
            *normal = velocity[face.axis].data()[face.inside(stride)];
        });
    }
}

impl PressureFace {
    /// Storage index of the face one cell inside, where the velocity along the axis is an unknown.
    fn inside<const D: usize>(&self, stride: [usize; D]) -> usize {
        if self.upper { self.index } else { self.index + stride[self.axis] }
    }
}
