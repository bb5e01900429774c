//! Boundary faces and ghost layers of fields.
use super::{Boundaries, Extrapolation, FaceKind, Law, Lines, SideState};
use crate::Field;

impl<const D: usize> Boundaries<D> {
    /// Boundary faces and ghost layers of velocity component `c`.
    pub(crate) fn fill_velocity(&self, c: usize, u: &mut Field<D>) {
        let u = u.data_mut();
        for (a, (lines, pair)) in self.lines.iter().zip(&self.states).enumerate() {
            for (upper, state) in pair.iter().flat_map(|p| p.iter()).enumerate() {
                if a == c { state.through(lines, upper, u) } else { state.along(lines, upper, c, u) }
            }
        }
        self.wrap(u);
    }

    /// Ghost layer of a pressure: periodic, without normal gradient, or given on the side.
    pub(crate) fn fill_pressure(&self, p: &mut Field<D>) {
        self.fill_cells(p, 2.0);
    }

    /// Ghost layer of a pressure correction: the same with zero where the pressure is given.
    pub(crate) fn fill_correction(&self, phi: &mut Field<D>) {
        self.fill_cells(phi, 0.0);
    }

    fn fill_cells(&self, p: &mut Field<D>, factor: f64) {
        let p = p.data_mut();
        for (lines, pair) in self.lines.iter().zip(&self.states) {
            for (upper, state) in pair.iter().flat_map(|p| p.iter()).enumerate() {
                for (l, o) in lines.starts().enumerate() {
                    let (inside, ghost) = lines.ends(o, upper);
                    p[ghost] = match state.kind[l] {
                        FaceKind::Pressure => factor * state.pressure[l] - p[inside],
                        _ => p[inside],
                    };
                }
            }
        }
        self.wrap(p);
    }

    /// Ghosts of the periodic axes: last, so that they repeat those of the bounded ones.
    fn wrap(&self, u: &mut [f64]) {
        for lines in self.lines.iter().filter(|l| self.sides.periodic(l.axis)) {
            lines.wrap(u);
        }
    }
}

impl<const D: usize> SideState<D> {
    /// The component through the side.
    fn through(&self, lines: &Lines, upper: usize, u: &mut [f64]) {
        let (n, s) = (lines.cells, lines.step);
        for (l, o) in lines.starts().enumerate() {
            let wall = self.normal[l];
            let fixed = self.kind[l].is_fixed();
            let beyond = |inside: f64| if fixed { 2.0 * wall - inside } else { wall };
            if upper == 1 {
                u[o + n * s] = wall;
                u[o + (n + 1) * s] = beyond(u[o + (n - 1) * s]);
            } else {
                u[o] = wall;
                u[o - s] = beyond(u[o + s]);
                u[o - 2 * s] = beyond(u[o + n.min(2) * s]);
            }
        }
    }

    /// A component along the side.
    fn along(&self, lines: &Lines, upper: usize, c: usize, u: &mut [f64]) {
        let (n, s) = (lines.cells, lines.step);
        let Law { value, free, .. } = &self.laws[c];
        let Extrapolation { wall, first, second } = self.beyond;
        let inward = if n > 1 { s } else { 0 };
        for (o, (&value, &free)) in lines.starts().zip(value.iter().zip(free)) {
            let (u0, u1, ghosts) = if upper == 1 {
                let last = o + (n - 1) * s;
                (u[last], u[last - inward], [last + s, last + 2 * s])
            } else {
                (u[o], u[o + inward], [o - s, o - 2 * s])
            };
            u[ghosts[0]] = if free { u0 } else { wall * value + first * u0 + second * u1 };
            u[ghosts[1]] = if free { u1 } else { 2.0 * value - u1 };
        }
    }
}
