//! Momentum of the faces of given pressure.
use super::face_excess::{FaceExcess, Lateral};
use super::side_state::is_beside_cut;
use super::{Boundaries, FaceKind};
use crate::eddy_stress::OnWall;
use crate::grid::GHOSTS;
use crate::metrics::Metrics;
use crate::{Field, Fluid};

/// State and step with which the faces of given pressure are advanced.
#[derive(Clone, Copy)]
pub(crate) struct OutletStep<'a, const D: usize> {
    pub(crate) metrics: &'a Metrics<D>,
    /// Velocity before the step.
    pub(crate) velocity: &'a [Field<D>; D],
    /// Pressure of the predictor, with its ghosts.
    pub(crate) pressure: &'a Field<D>,
    pub(crate) fluid: Fluid,
    /// 1/Δt \[1/s\]; zero in a steady iteration.
    pub(crate) inverse_step: f64,
    /// 1/α − 1 of a steady iteration with the relaxation factor α, and the part of the viscous terms that it counts; zero in a time step.
    pub(crate) relaxation: [f64; 2],
}

/// Eddy viscosity with its ghosts, and that on walls where a model gives it.
pub(crate) type OutletStress<'a, const D: usize> = (&'a Field<D>, &'a [OnWall]);

impl<const D: usize> Boundaries<D> {
    /// Prepares the diffusion of d along the sides of given pressure in a fluid of this `viscosity` \[m²/s\], with the eddy viscosity
    /// and the friction of walls by `stress`.
    pub(crate) fn set_outlet_diffusion(
        &mut self,
        metrics: &Metrics<D>,
        viscosity: f64,
        stress: Option<OutletStress<D>>,
    ) {
        for a in 0..D {
            for upper in 0..2 {
                let Some(state) = self.states[a].as_mut().map(|pair| &mut pair[upper]) else { continue };
                if state.has_pressure() {
                    let mut excess = std::mem::take(&mut state.excess);
                    self.diffuse([a, upper], metrics, viscosity, stress, &mut excess);
                    if let Some(pair) = &mut self.states[a] {
                        pair[upper].excess = excess;
                    }
                }
            }
        }
    }

    /// Writes the viscous coefficients of side `upper` of axis `a`.
    fn diffuse(
        &self,
        [a, upper]: [usize; 2],
        metrics: &Metrics<D>,
        viscosity: f64,
        stress: Option<OutletStress<D>>,
        excess: &mut FaceExcess,
    ) {
        let (grid, lines) = (&self.grid, &self.lines[a]);
        for (l, o) in lines.starts().enumerate().filter(|&(l, _)| lines.inside(l)) {
            let inside = lines.ends(o, upper).0;
            for t in 0..D - 1 {
                let b = lines.across[t];
                let (s, at, n) = (grid.stride()[b], lines.place(l)[t], grid.cells()[b]);
                let nodes = &metrics.axes[b].centres;
                let lists = &mut excess.lateral[t].viscous;
                lists[2][l] = 0.0;
                for (k, coefficient) in [nodes.down[at], nodes.up[at]].into_iter().enumerate() {
                    let beside = if k == 0 { inside - s } else { inside + s };
                    let eddy =
                        stress.map_or(0.0, |(eddy, _)| 0.5 * (eddy.data()[inside] + eddy.data()[beside]));
                    let rate = coefficient * (viscosity + eddy).max(0.0);
                    let on_side = at + k == GHOSTS + k * n;
                    lists[k][l] = match &self.states[b] {
                        Some(pair) if on_side => {
                            if !pair[k].laws[a].free[self.corner([a, upper], b, l)] {
                                // The side is half as far away as the ghost.
                                lists[2][l] += 2.0 * rate;
                            }
                            0.0
                        }
                        _ => rate,
                    };
                }
            }
        }
        // Viscous fluxes through walls whose friction a model gives are zero by the ghosts of the eddy viscosity.
        for wall in stress.iter().flat_map(|stress| stress.1).filter(|wall| wall.axis != a) {
            let Some(cell) = grid.cell_at(wall.inside) else { continue };
            if cell[a] == upper * (grid.cells()[a] - 1) {
                let width = grid.axis(wall.axis).width(cell[wall.axis]);
                let place = |t: usize| if t < D - 1 { GHOSTS + cell[lines.across[t]] } else { 0 };
                let t = usize::from(lines.across[0] != wall.axis);
                excess.lateral[t].viscous[2][place(0) + lines.count[0] * place(1)] +=
                    2.0 * (viscosity + wall.eddy) / (width * width);
            }
        }
    }

    /// Number of the line along `b` through the node of component `a` on side `upper` of axis `a` that ends line `l`.
    fn corner(&self, [a, upper]: [usize; 2], b: usize, l: usize) -> usize {
        let (own, other) = (&self.lines[a], &self.lines[b]);
        let place = own.place(l);
        let at = |t: usize| match other.across[t] {
            c if c == a => GHOSTS + upper * self.grid.cells()[a],
            c => place[usize::from(own.across[0] != c)],
        };
        at(0) + if D == 3 { other.count[0] * at(1) } else { 0 }
    }

    /// Takes d of all faces of sides of given pressure from `velocity`.
    pub(crate) fn measure_excess(&mut self, velocity: &[Field<D>; D]) {
        self.each_side_of_pressure(|lines, [a, upper], state| {
            let u = velocity[a].data();
            for (l, o) in lines.starts().enumerate() {
                state.excess.value[l] =
                    state.normal[l] - u[lines.ends(o, upper).0 + (1 - upper) * lines.step];
            }
        });
    }

    /// Sets the velocity through the faces of given pressure to d more than one cell inside.
    pub(crate) fn apply_excess(&mut self, velocity: &[Field<D>; D]) {
        self.each_side_of_pressure(|lines, [a, upper], state| {
            let u = velocity[a].data();
            for (l, o) in lines.starts().enumerate().filter(|&(l, _)| lines.inside(l)) {
                if state.kind[l] == FaceKind::Pressure {
                    let inside = lines.ends(o, upper).0 + (1 - upper) * lines.step;
                    state.normal[l] = u[inside] + state.excess.value[l];
                }
            }
        });
    }

    /// Advances d = u_b − u_i of the faces of given pressure: the momentum of the half cell before the side, less that of the
    /// control volume of u_i,
    ///
    /// ```text
    /// ∂d/∂t = (∂p/∂n /ρ)_i − (∂p/∂n /ρ)_b + (u ∂u/∂n)_i − (|u| + 2ν/w) d/w − u_s·∇_s d + ∇_s·((ν + ν_t) ∇_s d)
    /// ```
    ///
    /// w the width of the cell, ∇_s along the side (convection upwind), d = 0 where a lateral side gives the velocity. Without the last
    /// two terms only the flow through the face balances a pressure that is not that of the flow, and next to a wall, where this is slow,
    /// d becomes many times u. Faces that immersed walls cut, and those next to them, have d = 0. Implicit, factorised by the lateral axes in three dimensions.
    pub(crate) fn advance_excess(&mut self, step: OutletStep<D>) {
        let OutletStep { metrics, velocity, pressure, fluid, inverse_step, relaxation } = step;
        self.measure_excess(velocity);
        let (cells, stride, p) = (self.grid.cells(), self.grid.stride(), pressure.data());
        let repeats: [usize; D] = std::array::from_fn(|b| if self.sides.periodic(b) { cells[b] } else { 0 });
        self.each_side_of_pressure(|lines, [a, upper], state| {
            let (s, axis) = (stride[a], &metrics.axes[a]);
            let at = GHOSTS + if upper == 1 { cells[a] - 1 } else { 1 };
            let width = axis.width[if upper == 1 { at } else { at - 1 }];
            let periods = [0, 1].map(|t| if t < D - 1 { repeats[lines.across[t]] } else { 0 });
            let (u, excess) = (velocity[a].data(), &mut state.excess);
            for (l, o) in lines.starts().enumerate().filter(|&(l, _)| lines.inside(l)) {
                let cell = lines.ends(o, upper).0;
                excess.decay[l] = (state.normal[l].abs() + 2.0 * fluid.viscosity / width) / width;
                let mut rate = excess.decay[l];
                for t in 0..D - 1 {
                    let (b, place) = (lines.across[t], lines.place(l)[t]);
                    let v = velocity[b].data();
                    let inverse = metrics.axes[b].centres.inv_volume[place];
                    let Lateral { viscous, total } = &mut excess.lateral[t];
                    total[2][l] = viscous[2][l];
                    rate += relaxation[1] * viscous.iter().map(|list| list[l]).sum::<f64>();
                    for (k, enters) in [v[cell], -v[cell + stride[b]]].into_iter().enumerate() {
                        let passing = inverse * enters.max(0.0);
                        rate += passing;
                        // Without a neighbour behind it a lateral side gives the velocity.
                        let bounded = periods[t] == 0 && place + k == GHOSTS + k * cells[b];
                        total[k][l] = viscous[k][l];
                        total[if bounded { 2 } else { k }][l] += passing;
                    }
                }
                excess.inertia[l] = inverse_step + relaxation[0] * rate;
            }
            let (kind, open) = (&state.kind, &state.open);
            let free =
                |l: usize| lines.inside(l) && kind[l] == FaceKind::Pressure && !is_beside_cut(open, lines, l);
            for (l, o) in lines.starts().enumerate().filter(|&(l, _)| free(l)) {
                let cell = lines.ends(o, upper).0;
                let (i, above) = (cell + (1 - upper) * s, cell + upper * s);
                let rise = |k: usize, at: usize| axis.faces.inv_gap[at] * (u[k] - u[k - s]);
                let slope = 0.5 * (rise(i, at) + rise(i + s, at + 1));
                let gradient = axis.faces.inv_volume[at] * (p[i] - p[i - s]);
                let outer = (p[above] - p[above - s]) / width;
                let drive = (gradient - outer) / fluid.density + u[i] * slope;
                excess.change[l] =
                    drive - excess.decay[l] * excess.value[l] + excess.acceleration(lines, l, periods);
            }
            for t in 0..D - 1 {
                if t == 1 {
                    (0..lines.len()).for_each(|l| excess.change[l] *= excess.rate(l));
                }
                excess.solve_along(lines, t, periods[t], &free);
            }
            (0..lines.len()).filter(|&l| free(l)).for_each(|l| excess.value[l] += excess.change[l]);
        });
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
        boundaries.set_outlet_diffusion(&metrics, fluid.viscosity, None);
        boundaries.advance_excess(OutletStep {
            metrics: &metrics,
            velocity: &velocity(old),
            pressure: &p,
            fluid,
            inverse_step: DT.recip(),
            relaxation: [0.0; 2],
        });
        boundaries.apply_excess(&velocity(new));
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
