//! The velocity as one vector, and its rate of change: the flow as a system of ordinary differential equations.
use super::{Prediction, Projection};
use crate::FlowError;
use crate::flow_state::each_cell;
use crate::grid::GHOSTS;

impl<const D: usize> Projection<D> {
    /// The velocity \[m/s\] as one vector: all components at the cells' lower faces, one component after the other, x fastest; then the velocities on the
    /// sides of the box.
    pub fn unknowns(&self) -> Vec<f64> {
        let mut sides = Vec::new();
        self.state.boundaries.memory(&mut sides);
        let components = self.state.velocity.components.iter().flat_map(|component| component.values());
        components.chain(sides).collect()
    }

    /// The control volume \[m³\] (plane: m²) of each of the [`unknowns`](Self::unknowns); 0 for those on sides, which follow the others. Half Σ v u² is the
    /// kinetic energy per density.
    pub fn unknown_volumes(&self) -> Vec<f64> {
        let mut volumes = Vec::new();
        for c in 0..D {
            each_cell(&self.state.grid, |_, cell| {
                let width = |a: usize| self.state.metrics.of(Some(c), a).volume[GHOSTS + cell[a]];
                let on_side = cell[c] == 0 && !self.state.metrics.periodic[c];
                volumes.push(if on_side { 0.0 } else { (0..D).map(width).product() });
            });
        }
        let mut sides = Vec::new();
        self.state.boundaries.memory(&mut sides);
        volumes.extend(sides.iter().map(|_| 0.0));
        volumes
    }

    /// Sets the velocity to what [`unknowns`](Self::unknowns) may have given; the pressure starts anew.
    ///
    /// # Errors
    /// [`FlowError::Parameter`] for another number of them.
    pub fn set_unknowns(&mut self, unknowns: &[f64]) -> Result<(), FlowError> {
        let n = self.state.grid.n_cells();
        let mut sides = Vec::new();
        self.state.boundaries.memory(&mut sides);
        if unknowns.len() != D * n + sides.len() {
            return Err(FlowError::Parameter {
                name: "number of unknowns",
                value: unknowns.len() as f64,
                range: "that of this flow, `unknowns().len()`",
            });
        }
        for (component, values) in self.state.velocity.components.iter_mut().zip(unknowns.chunks_exact(n)) {
            let mut values = values.iter();
            each_cell(&self.state.grid, |o, _| {
                if let Some(value) = values.next() {
                    component.data_mut()[o] = *value;
                }
            });
        }
        self.state.boundaries.recall(&unknowns[D * n..]);
        self.state.fill_velocity();
        self.state.measure_rates();
        // The last tendency belongs to another flow.
        self.state.last_dt = 0.0;
        self.reset_pressure();
        Ok(())
    }

    /// The rate of change of the [`unknowns`](Self::unknowns) \[m/s²\] into `rate`,
    ///
    /// ```text
    /// du/dt = P [ −∇·(u⊗u) + ν∇²u + b ],   P the projection on fields free of divergence
    /// ```
    ///
    /// as the difference over one step of Euler's method of length `dt`; for [`Diffusion::Explicit`](crate::Diffusion::Explicit) without immersed walls and outlets it
    /// does not depend on `dt`, else by O(dt). With [`Convection::Central`](crate::Convection::Central) it is a polynomial of second degree of the unknowns, as long as what
    /// leaves through an outlet does not turn back. The unknowns must be free of divergence, as those of a flow and their means are. Velocity, pressure and clock are then what they were; the next step is one of Euler's method.
    ///
    /// # Errors
    /// Those of [`set_unknowns`](Self::set_unknowns) and [`advance`](Self::advance).
    pub fn rate(
        &mut self,
        unknowns: &[f64],
        dt: f64,
        force: [f64; D],
        rate: &mut [f64],
    ) -> Result<(), FlowError> {
        let mut kept = Prediction::default();
        self.note(&mut kept);
        let (time, step) = (self.state.time, self.state.step);
        let made = self.set_unknowns(unknowns).and_then(|()| {
            self.predict(dt, force)?;
            self.project(dt)
        });
        if made.is_ok() {
            for ((rate, new), old) in rate.iter_mut().zip(self.unknowns()).zip(unknowns) {
                *rate = (new - old) / dt;
            }
        }
        self.go_back(&kept);
        self.state.fill_velocity();
        self.state.measure_rates();
        (self.state.time, self.state.step, self.state.last_dt) = (time, step, 0.0);
        made
    }
}

#[cfg(test)]
mod tests {
    use crate::{CartesianGrid, Diffusion, FlowError, Fluid, Projection, Side};

    fn flow() -> Projection<2> {
        let grid = CartesianGrid::new([24, 16], [3.0, 2.0]).unwrap();
        let sides = [Side::Periodic.both(), [Side::WALL, Side::Wall([1.0, 0.0, 0.0])]];
        let mut flow = Projection::new(grid, sides, Fluid { density: 2.0, viscosity: 0.01 })
            .unwrap()
            .with_diffusion(Diffusion::Explicit);
        flow.set_velocity(|x| {
            [x[1].sin() * (2.1 * x[0]).sin(), 0.3 * (2.1 * x[0]).cos() * x[1] * (2.0 - x[1])]
        });
        flow.project(1.0).unwrap();
        flow
    }

    /// Runge and Kutta's method on the rate goes where the flow's own steps go.
    #[test]
    fn rates_integrate_to_the_flow() {
        let mut flow = flow();
        let force = [0.2, -0.1];
        let (end, steps) = (0.4, 20);
        let mut u = flow.unknowns();
        let dt = end / f64::from(steps);
        let ahead = |u: &[f64], k: &[f64], dt: f64| -> Vec<f64> {
            u.iter().zip(k).map(|(u, k)| u + dt * k).collect()
        };
        let mut rate = |u: &[f64]| {
            let mut k = vec![0.0; u.len()];
            flow.rate(u, 0.3 * dt, force, &mut k).unwrap();
            k
        };
        for _ in 0..steps {
            let a = rate(&u);
            let b = rate(&ahead(&u, &a, 0.5 * dt));
            let c = rate(&ahead(&u, &b, 0.5 * dt));
            let d = rate(&ahead(&u, &c, dt));
            for i in 0..u.len() {
                u[i] += dt / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]);
            }
        }
        let off = |fine: i32| {
            let mut own = self::flow();
            (0..fine).for_each(|_| own.advance(end / f64::from(fine), force).unwrap());
            own.unknowns().iter().zip(&u).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        let (coarse, fine) = (off(50), off(100));
        assert!(fine < 1e-5 && (coarse / fine).log2() > 1.9, "{coarse:e} {fine:e}");
    }

    #[test]
    fn unknowns_come_back_and_the_flow_stays() {
        let mut flow = flow();
        flow.advance(0.01, [0.0; 2]).unwrap();
        let (u, p) = (flow.unknowns(), flow.pressure().data().to_vec());
        let [short, long] = [0.005, 0.01].map(|dt| {
            let mut rate = vec![0.0; u.len()];
            flow.rate(&u, dt, [0.0; 2], &mut rate).unwrap();
            rate
        });
        let most = short.iter().fold(0.0, |m: f64, r| m.max(r.abs()));
        assert!(most > 0.1 && short.iter().zip(&long).all(|(a, b)| (a - b).abs() < 1e-10 * most));
        assert_eq!(flow.unknowns(), u);
        assert_eq!(flow.pressure().data(), p);
        let mut other = self::flow();
        other.set_unknowns(&u).unwrap();
        assert_eq!(other.unknowns(), u);
        let energy: f64 = flow.unknown_volumes().iter().zip(&u).map(|(v, u)| 0.5 * 2.0 * v * u * u).sum();
        assert!((energy / flow.statistics().kinetic_energy - 1.0).abs() < 1e-12);
        assert!(matches!(other.set_unknowns(&u[1..]), Err(FlowError::Parameter { .. })));
    }
}
