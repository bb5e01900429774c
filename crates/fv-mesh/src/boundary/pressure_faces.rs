//! Faces through which the velocity follows from a given pressure.
use super::{Boundaries, FaceKind};
use crate::grid::GHOSTS;
use crate::metrics::Metrics;
use crate::{Field, Fluid};

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

    /// Moves the velocity u_b through faces of given pressure on by `dt`, from `old` to the predicted one, by the momentum
    /// equation there with what acts one face inside, at i,
    ///
    /// ```text
    /// ∂u_b/∂t = [∂u/∂t + ∂p/∂n /ρ + u ∂u/∂n]_i − (∂p/∂n /ρ)_b − (|u| + 2ν/w)(u_b − u_i)/w
    /// ```
    ///
    /// w the width of the cell between them, the last term implicit. `pressure`, ghosts filled, is that of the predictor:
    /// its gradient at b, to the given value, is what keeps the level of the pressure inside.
    pub(crate) fn advance_pressure_faces(
        &mut self,
        metrics: &Metrics<D>,
        [old, new]: [&[Field<D>; D]; 2],
        pressure: &Field<D>,
        fluid: Fluid,
        dt: f64,
    ) {
        let (stride, cells, p) = (self.grid.stride(), self.grid.cells(), pressure.data());
        self.each_pressure_face(|face, normal| {
            let (a, s) = (face.axis, stride[face.axis]);
            let (axis, i) = (&metrics.axes[a], face.inside(stride));
            let at = GHOSTS + if face.upper { cells[a] - 1 } else { 1 };
            let (before, after) = (old[a].data(), new[a].data()[i]);
            let rise = |k: usize, at: usize| axis.faces.inv_gap[at] * (before[k] - before[k - s]);
            let slope = 0.5 * (rise(i, at) + rise(i + s, at + 1));
            let gradient = axis.faces.inv_gap[at] * (p[i] - p[i - s]);
            let width = axis.width[if face.upper { at } else { at - 1 }];
            let above = if face.upper { face.index + s } else { face.index };
            let outer = (p[above] - p[above - s]) / width;
            let rate = (gradient - outer) / fluid.density + before[i] * slope;
            let relax = dt / width * (normal.abs() + 2.0 * fluid.viscosity / width);
            *normal = (*normal + after - before[i] + dt * rate + relax * after) / (1.0 + relax);
        });
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

impl PressureFace {
    /// Storage index of the face one cell inside, where the velocity along the axis is an unknown.
    fn inside<const D: usize>(&self, stride: [usize; D]) -> usize {
        if self.upper { self.index } else { self.index + stride[self.axis] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operators::tests::exact;
    use crate::{CartesianGrid, Side, Sides};

    const DT: f64 = 0.1;
    const WIDTH: f64 = 0.25;

    /// The velocity through the faces x = −1 and 1 at `given` pressure, after a step in which it was `start(x)` and the one
    /// inside went from `old(x)` to `new(x)` under `pressure(x)`.
    fn advanced(
        start: impl Fn(f64) -> f64,
        [old, new]: [&dyn Fn(f64) -> f64; 2],
        (pressure, given): (impl Fn(f64) -> f64, f64),
        fluid: Fluid,
    ) -> Vec<f64> {
        let grid = CartesianGrid::new([8, 2], [2.0, 1.0]).unwrap().with_origin([-1.0, 0.0]).unwrap();
        let sides = Sides::new([Side::PressureOutlet(given).both(), Side::Periodic.both()]).unwrap();
        let metrics = Metrics::new(&grid, [false, true]);
        let mut boundaries = Boundaries::new(&grid, sides, &metrics).unwrap();
        boundaries.start(&metrics, |x| [start(x[0]), 0.0]);
        let velocity =
            |u: &dyn Fn(f64) -> f64| [exact(&grid, &metrics, Some(0), |x| u(x[0])), Field::zeros(&grid)];
        let mut p = exact(&grid, &metrics, None, |x| pressure(x[0]));
        boundaries.fill_pressure(&mut p);
        boundaries.advance_pressure_faces(&metrics, [&velocity(old), &velocity(new)], &p, fluid, DT);
        let mut found = Vec::new();
        boundaries.each_pressure_face(|_, normal| found.push(*normal));
        found
    }

    /// u = βx with p = −ρβ²x²/2 is steady without viscosity: u u′ = β²x balances the pressure, but for the gradient at the face,
    /// which the line to the given value takes a quarter of a cell inside: β²w/4 too little.
    #[test]
    fn flow_that_parts_before_two_pressures_is_steady() {
        let (rate, density) = (0.8, 1.7);
        let u = |x: f64| rate * x;
        let p = |x: f64| -0.5 * density * (rate * x).powi(2);
        let found = advanced(u, [&u, &u], (p, p(1.0)), Fluid { density, viscosity: 0.0 });
        let change = -DT * rate * rate * WIDTH / 4.0 / (1.0 + DT * rate / WIDTH);
        assert_eq!(found.len(), 4);
        for (found, side) in found.iter().zip([-1.0, -1.0, 1.0, 1.0]) {
            assert!((found - side * (rate + change)).abs() < 1e-14, "{found} at {side}, change {change}");
        }
    }

    /// Under a uniform pressure a face follows the acceleration inside, and what it is ahead by decays at (|u| + 2ν/w)/w.
    #[test]
    fn a_face_follows_the_flow_inside() {
        let (ahead, viscosity) = (0.3, 0.05);
        let found = advanced(
            |_| 1.0 + ahead,
            [&|_| 1.0, &|_| 1.2],
            (|_| 4.0, 4.0),
            Fluid { density: 1.7, viscosity },
        );
        let decay = 1.0 + DT / WIDTH * (1.0 + ahead + 2.0 * viscosity / WIDTH);
        for found in found {
            assert!((found - 1.2 - ahead / decay).abs() < 1e-14, "{found}");
        }
    }
}
