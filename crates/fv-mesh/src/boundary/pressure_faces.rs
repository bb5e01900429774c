//! Faces through which the velocity follows from a given pressure.
use super::{Boundaries, FaceKind, Lines, SideState};
use crate::Field;

/// A face through which the velocity follows from a given pressure.
pub(crate) struct PressureFace {
    pub(crate) axis: usize,
    pub(crate) upper: bool,
    /// Dense number and storage index of the cell before it.
    pub(crate) cell: usize,
    pub(crate) index: usize,
    /// Rate at which the velocity through it answers a pressure, as of the last step \[1/s\]; zero before the first.
    pub(crate) rate: f64,
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
                        let rate = state.excess.rate(l);
                        f(PressureFace { axis, upper, cell, index, rate }, &mut state.normal[l]);
                    }
                }
            }
        }
    }

    /// The velocity through faces of given pressure follows the correction: u −= `scale` ∂φ/∂n with φ = 0 on the side;
    /// `phi` is dense.
    pub(crate) fn correct(&mut self, scale: f64, phi: &[f64]) {
        for (a, (lines, pair)) in self.lines.iter().zip(&mut self.states).enumerate() {
            let Some(pair) = pair else { continue };
            for (upper, state) in pair.iter_mut().enumerate().filter(|(_, s)| s.has_pressure()) {
                let sign = [-1.0, 1.0][upper];
                let width = self.grid.axis(a).width(if upper == 1 { lines.cells - 1 } else { 0 });
                for l in (0..lines.len()).filter(|&l| lines.inside(l)) {
                    if state.kind[l] == FaceKind::Pressure {
                        let inside = phi[lines.end_cell(&self.grid, l, upper == 1)];
                        state.normal[l] += sign * scale * 2.0 * inside / width;
                    }
                }
            }
        }
    }

    /// −2 p/w² in the cells before faces of given pressure p, zero elsewhere (dense): the right-hand side of the harmonic
    /// pressure that takes those values. `None` without such faces.
    pub(crate) fn given_pressures(&self) -> Option<Vec<f64>> {
        let sides = || {
            self.lines.iter().zip(&self.states).flat_map(|(lines, pair)| {
                pair.iter()
                    .flat_map(|p| p.iter())
                    .enumerate()
                    .map(move |(upper, state)| (lines, upper, state))
            })
        };
        if !sides().any(|(_, _, state)| state.has_pressure()) {
            return None;
        }
        let mut rhs = vec![0.0; self.grid.n_cells()];
        for (lines, upper, state) in sides() {
            let width = self.grid.axis(lines.axis).width(if upper == 1 { lines.cells - 1 } else { 0 });
            for l in (0..lines.len()).filter(|&l| lines.inside(l) && state.kind[l] == FaceKind::Pressure) {
                rhs[lines.end_cell(&self.grid, l, upper == 1)] -= 2.0 * state.pressure[l] / (width * width);
            }
        }
        Some(rhs)
    }

    /// Velocity through the faces of given pressure as one cell inside.
    pub(crate) fn reset_outlets(&mut self, velocity: &[Field<D>; D]) {
        let stride = self.grid.stride();
        self.each_pressure_face(|face, normal| {
            *normal = velocity[face.axis].data()[face.inside(stride)];
        });
    }
}

impl<const D: usize> Boundaries<D> {
    /// Calls `f` with the lines, the axis and end, and the state of every side with faces of given pressure.
    pub(super) fn each_side_of_pressure(&mut self, mut f: impl FnMut(&Lines, [usize; 2], &mut SideState<D>)) {
        for (axis, (lines, pair)) in self.lines.iter().zip(&mut self.states).enumerate() {
            let sides = pair.iter_mut().flat_map(|p| p.iter_mut()).enumerate();
            sides
                .filter(|(_, state)| state.has_pressure())
                .for_each(|(upper, state)| f(lines, [axis, upper], state));
        }
    }
}

impl PressureFace {
    /// Storage index of the face one cell inside, where the velocity along the axis is an unknown.
    pub(super) fn inside<const D: usize>(&self, stride: [usize; D]) -> usize {
        if self.upper { self.index } else { self.index + stride[self.axis] }
    }
}
