//! The flow algorithm for time-accurate runs.
use crate::kernels::{self, Advance};
use crate::poisson::{AxisBounds, DirectPoisson};
use crate::{CartesianGrid, Field, FlowError, FlowStatistics, Side, Sides, Velocity, statistics, walls};
use interfaces::{Checkpoint, RestartError, Vector, VelocityField};

/// A Newtonian fluid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fluid {
    /// Density ρ \[kg/m³\].
    pub density: f64,
    /// Kinematic viscosity ν \[m²/s\].
    pub viscosity: f64,
}

/// Incompressible flow by incremental pressure projection on a staggered grid:
///
/// ```text
/// u*   = uⁿ + dt [ (1 + r/2) Hⁿ − (r/2) Hⁿ⁻¹ − ∇pⁿ/ρ + b ],   H = −∇·(u⊗u) + ν∇²u,  r = dt/dt_last
/// ∇²φ  = (ρ/dt) ∇·u*,    uⁿ⁺¹ = u* − (dt/ρ) ∇φ,    pⁿ⁺¹ = pⁿ + φ
/// ```
///
/// (Adams–Bashforth with variable step: second order in time; central differences: second order in
/// space; pⁿ⁺¹ belongs to the middle of the step.) The two halves of a step are public, so that an
/// immersed boundary can act between them: [`predict`](Self::predict) and
/// [`project`](Self::project); [`advance`](Self::advance) is both. A step allocates nothing when it
/// runs inside a rayon pool.
pub struct Projection<const D: usize> {
    grid: CartesianGrid<D>,
    sides: Sides<D>,
    fluid: Fluid,
    velocity: Velocity<D>,
    next: [Field<D>; D],
    tendency: [Field<D>; D],
    pressure: Field<D>,
    phi: Vec<f64>,
    poisson: DirectPoisson<D>,
    time: f64,
    step: u64,
    last_dt: f64,
    largest: [f64; D],
    /// Friction of the walls at the last two predictor steps, and their impulse in the last step.
    friction: [Vector; 2],
    wall_impulse: Vector,
}

/// Adams–Bashforth is used while a step is at most so many times longer than the last.
const LONGEST_GROWTH: f64 = 10.0;

impl<const D: usize> Projection<D> {
    /// Fluid at rest in a box; `sides[axis]` are its lower and upper side.
    ///
    /// # Errors
    /// [`FlowError`] for sides or fluid properties that make no sense.
    pub fn new(grid: CartesianGrid<D>, sides: [[Side; 2]; D], fluid: Fluid) -> Result<Self, FlowError> {
        let sides = Sides::new(sides)?;
        for (name, value, unit) in
            [("density", fluid.density, "kg/m³"), ("kinematic viscosity", fluid.viscosity, "m²/s")]
        {
            // An inviscid fluid is allowed; one without mass is not.
            if !(value.is_finite() && (value > 0.0 || value == 0.0 && unit == "m²/s")) {
                return Err(FlowError::Fluid { name, value, unit });
            }
        }
        let bounds =
            std::array::from_fn(
                |a| {
                    if sides.periodic(a) { AxisBounds::Periodic } else { AxisBounds::Neumann }
                },
            );
        let poisson = DirectPoisson::new(grid.cells(), grid.spacing(), bounds)?;
        let field = || std::array::from_fn(|_| Field::zeros(&grid));
        let mut flow = Self {
            velocity: Velocity::zeros(&grid, &sides),
            next: field(),
            tendency: field(),
            pressure: Field::zeros(&grid),
            phi: vec![0.0; grid.n_cells()],
            poisson,
            time: 0.0,
            step: 0,
            last_dt: 0.0,
            largest: [0.0; D],
            friction: [Vector::zeros(); 2],
            wall_impulse: Vector::zeros(),
            grid,
            sides,
            fluid,
        };
        flow.fill_velocity();
        Ok(flow)
    }

    /// Sets every velocity component to `u(x)[c]` at its nodes \[m/s\].
    pub fn set_velocity(&mut self, u: impl Fn([f64; D]) -> [f64; D]) {
        for c in 0..D {
            let lattice = *self.velocity.lattice(c);
            let [nx, ny, nz] = lattice.shape;
            let data = self.velocity.components[c].data_mut();
            for node in 0..nx * ny * nz {
                let index = [node % nx, node / nx % ny, node / (nx * ny)].map(|i| i as isize);
                let x = lattice.position(index);
                if let Some(o) = lattice.index(index) {
                    data[o] = u(std::array::from_fn(|a| x[a]))[c];
                }
            }
        }
        self.fill_velocity();
        self.largest = std::array::from_fn(|c| statistics::largest(&self.velocity.components[c]));
    }

    /// First half of a step: the velocity becomes u*, under the body force `force` per mass
    /// \[m/s²\].
    ///
    /// # Errors
    /// [`FlowError::TimeStep`] for a step that is not positive and finite, [`FlowError::Unstable`]
    /// for one beyond the [`viscous_limit`](Self::viscous_limit).
    pub fn predict(&mut self, dt: f64, force: [f64; D]) -> Result<(), FlowError> {
        if !(dt.is_finite() && dt > 0.0) {
            return Err(FlowError::TimeStep { dt, time: self.time });
        }
        if dt > self.viscous_limit() {
            return Err(FlowError::Unstable { dt, limit: self.viscous_limit() });
        }
        // The last step's tendency and pressure are no guide at the start, and after a much shorter step:
        // what changes at once (a wall set moving, an immersed body's slip) is a pressure ∝ 1/dt.
        let mut r = dt / self.last_dt;
        if self.step == 0 {
            r = 0.0;
        } else if r > LONGEST_GROWTH {
            r = 0.0;
            self.pressure.data_mut().fill(0.0);
        }
        let weights = [1.0 + 0.5 * r, -0.5 * r];
        let friction =
            walls::friction(&self.grid, &self.sides, &self.velocity.components, self.fluid.viscosity);
        self.friction = [friction, self.friction[0]];
        self.wall_impulse =
            dt * self.fluid.density * (weights[0] * self.friction[0] + weights[1] * self.friction[1]);
        for c in 0..D {
            let k = Advance {
                dt,
                weights,
                viscosity: self.fluid.viscosity,
                specific_volume: 1.0 / self.fluid.density,
                force: force[c],
            };
            kernels::advance_component(
                &self.grid,
                c,
                k,
                &self.velocity.components,
                &self.pressure,
                &mut self.next[c],
                &mut self.tendency[c],
            );
        }
        for c in 0..D {
            std::mem::swap(&mut self.velocity.components[c], &mut self.next[c]);
        }
        self.last_dt = dt;
        self.fill_velocity();
        Ok(())
    }

    /// Makes the velocity free of divergence and adds what that took to the pressure. May be
    /// called several times within one step, each time with the velocity forced anew.
    ///
    /// # Errors
    /// [`FlowError::Diverged`] when the velocity is not finite.
    pub fn project(&mut self, dt: f64) -> Result<(), FlowError> {
        self.fill_velocity();
        let scale = self.fluid.density / dt;
        let (grid, velocity) = (&self.grid, &self.velocity.components);
        let solved = self.poisson.solve_rows(
            // Called from code that is compiled for the processor at hand.
            #[inline(always)]
            |r, row: &mut [f64]| kernels::divergence_row(grid, r, velocity, scale, row),
            &mut self.phi,
        );
        if let Err(error) = solved {
            return Err(match error {
                crate::poisson::PoissonError::NonFinite { .. } => self.diverged(dt),
                other => other.into(),
            });
        }
        for c in 0..D {
            kernels::correct_component(
                &self.grid,
                c,
                self.sides.periodic(c),
                dt / self.fluid.density,
                &self.phi,
                &mut self.velocity.components[c],
            );
        }
        kernels::add_dense(&self.grid, &self.phi, &mut self.pressure);
        self.sides.fill_pressure(&self.grid, &mut self.pressure);
        self.fill_velocity();
        Ok(())
    }

    /// Ends a step: the time moves on by `dt`.
    ///
    /// # Errors
    /// [`FlowError::Diverged`] when the velocity is not finite.
    pub fn finish(&mut self, dt: f64) -> Result<(), FlowError> {
        let largest = std::array::from_fn(|c| statistics::largest(&self.velocity.components[c]));
        if largest.iter().any(|u: &f64| !u.is_finite()) {
            return Err(self.diverged(dt));
        }
        self.largest = largest;
        self.wall_impulse += dt * walls::thrust(&self.grid, &self.sides, &self.pressure);
        self.time += dt;
        self.step += 1;
        Ok(())
    }

    /// One whole step of length `dt` under the body force `force` per mass \[m/s²\].
    ///
    /// # Errors
    /// See [`predict`](Self::predict) and [`project`](Self::project).
    pub fn advance(&mut self, dt: f64, force: [f64; D]) -> Result<(), FlowError> {
        self.predict(dt, force)?;
        self.project(dt)?;
        self.finish(dt)
    }

    fn fill_velocity(&mut self) {
        for c in 0..D {
            self.sides.fill_velocity(&self.grid, c, &mut self.velocity.components[c]);
        }
    }

    fn diverged(&self, dt: f64) -> FlowError {
        FlowError::Diverged { step: self.step, time: self.time, dt, courant: self.courant(dt) }
    }

    /// Courant number dt Σ_a max|u_a|/h_a of a step of length `dt`.
    pub fn courant(&self, dt: f64) -> f64 {
        let h = self.grid.spacing();
        dt * (0..D).map(|a| self.largest[a] / h[a]).sum::<f64>()
    }

    /// The longest step \[s\] for which Adams–Bashforth diffusion is stable, 1/(4ν Σ 1/h²).
    pub fn viscous_limit(&self) -> f64 {
        let h = self.grid.spacing();
        1.0 / (4.0 * self.fluid.viscosity * h.iter().map(|h| 1.0 / (h * h)).sum::<f64>())
    }

    /// The longest step \[s\] with Courant number ≤ `courant` and a tenth inside the viscous limit.
    pub fn stable_dt(&self, courant: f64) -> f64 {
        (courant / self.courant(1.0)).min(0.9 * self.viscous_limit())
    }

    /// Sums and extremes of the velocity, as it is now.
    pub fn statistics(&mut self) -> FlowStatistics {
        statistics::measure(
            &self.grid,
            &self.velocity.components,
            self.fluid.density,
            self.fluid.viscosity,
            &mut self.phi,
        )
    }

    /// The grid.
    pub fn grid(&self) -> &CartesianGrid<D> {
        &self.grid
    }
    /// The sides of the box.
    pub fn sides(&self) -> &Sides<D> {
        &self.sides
    }
    /// The fluid.
    pub fn fluid(&self) -> Fluid {
        self.fluid
    }
    /// The velocity \[m/s\]; between the halves of a step it is u*.
    pub fn velocity(&self) -> &Velocity<D> {
        &self.velocity
    }
    /// The velocity, for an immersed boundary to change between the halves of a step.
    pub fn velocity_mut(&mut self) -> &mut Velocity<D> {
        &mut self.velocity
    }
    /// The pressure at the cell centres \[Pa\], without the hydrostatic part.
    pub fn pressure(&self) -> &Field<D> {
        &self.pressure
    }
    /// Impulse of the bounded sides on the fluid during the last step \[N s\].
    pub fn wall_impulse(&self) -> Vector {
        self.wall_impulse
    }
    /// Length of the last step \[s\].
    pub fn last_dt(&self) -> f64 {
        self.last_dt
    }
    /// Time \[s\].
    pub fn time(&self) -> f64 {
        self.time
    }
    /// Steps made.
    pub fn steps(&self) -> u64 {
        self.step
    }
    /// Sets the clock exactly (to the end of an interval that was cut into equal steps).
    pub fn set_time(&mut self, time: f64) {
        self.time = time;
    }
    /// The mean of the velocity component `c` at the two faces of every cell, row after row.
    pub fn centred_velocity(&self, c: usize) -> impl Iterator<Item = f64> + '_ {
        let (n, s) = (self.grid.cells()[0], self.grid.stride()[c]);
        let u = self.velocity.components[c].data();
        (0..self.pressure.n_rows()).flat_map(move |r| {
            let o = self.pressure.row_start(r);
            (o..o + n).map(move |i| 0.5 * (u[i] + u[i + s]))
        })
    }
}

impl<const D: usize> Checkpoint for Projection<D> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        for c in 0..D {
            sink(&format!("velocity{c}"), self.velocity.components[c].data());
            sink(&format!("tendency{c}"), self.tendency[c].data());
        }
        sink("pressure", self.pressure.data());
        sink("clock", &[self.time, self.step as f64, self.last_dt]);
        sink("largest", &self.largest);
        sink("friction", self.friction[0].as_slice());
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        let n = self.grid.storage();
        for c in 0..D {
            let u = RestartError::take(source, &format!("velocity{c}"), n)?;
            self.velocity.components[c].data_mut().copy_from_slice(u);
            let h = RestartError::take(source, &format!("tendency{c}"), n)?;
            self.tendency[c].data_mut().copy_from_slice(h);
        }
        self.pressure.data_mut().copy_from_slice(RestartError::take(source, "pressure", n)?);
        let clock = RestartError::take(source, "clock", 3)?;
        (self.time, self.step, self.last_dt) = (clock[0], clock[1] as u64, clock[2]);
        self.largest.copy_from_slice(RestartError::take(source, "largest", D)?);
        self.friction[0] = Vector::from_column_slice(RestartError::take(source, "friction", 3)?);
        Ok(())
    }
}
