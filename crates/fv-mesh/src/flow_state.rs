//! What all flow algorithms hold.
use crate::boundary::Boundaries;
use crate::grid::GHOSTS;
use crate::metrics::Metrics;
use crate::per_dimension::per_dimension;
use crate::statistics::{self, Measure};
use crate::{CartesianGrid, Field, FlowError, FlowStatistics, Fluid, Side, SidePower, Sides, Velocity};
use interfaces::RestartError;

/// A fluid in a box: its sides, velocity and pressure, and the clock.
pub(crate) struct FlowState<const D: usize> {
    /// Where the box was at first, and by how many cells it has moved since.
    home: CartesianGrid<D>,
    pub(crate) window: [i64; D],
    pub(crate) grid: CartesianGrid<D>,
    pub(crate) metrics: Metrics<D>,
    pub(crate) boundaries: Boundaries<D>,
    pub(crate) fluid: Fluid,
    pub(crate) velocity: Velocity<D>,
    pub(crate) pressure: Field<D>,
    /// Time \[s\].
    pub(crate) time: f64,
    /// Steps or iterations made.
    pub(crate) step: u64,
    /// Length of the last step \[s\].
    pub(crate) last_dt: f64,
    /// Largest |u_c|/h_c \[1/s\], sides included.
    pub(crate) rates: [f64; D],
    measure: Measure<D>,
}

impl<const D: usize> FlowState<D> {
    /// Fluid at rest.
    ///
    /// # Errors
    /// [`FlowError`] for sides or fluid properties that make no sense.
    pub(crate) fn new(
        grid: CartesianGrid<D>,
        sides: [[Side; 2]; D],
        fluid: Fluid,
    ) -> Result<Self, FlowError> {
        let sides = Sides::new(sides)?;
        fluid.check()?;
        let metrics = Metrics::new(&grid, std::array::from_fn(|a| sides.periodic(a)));
        let mut state = Self {
            velocity: Velocity::zeros(&grid, &sides),
            boundaries: Boundaries::new(&grid, sides, &metrics)?,
            pressure: Field::zeros(&grid),
            measure: Measure::new(&grid, &metrics),
            time: 0.0,
            step: 0,
            last_dt: 0.0,
            rates: [0.0; D],
            home: grid.clone(),
            window: [0; D],
            grid,
            metrics,
            fluid,
        };
        state.fill_velocity();
        state.fill_pressure();
        state.measure_rates();
        Ok(state)
    }

    /// Puts the box `window` cells from where it was at first; values stay as they are stored.
    pub(crate) fn set_window(&mut self, window: [i64; D]) -> Result<(), FlowError> {
        if window == self.window {
            return Ok(());
        }
        self.grid = self.home.slid(window)?;
        self.window = window;
        self.metrics.slide(&self.grid);
        self.boundaries.set_grid(&self.grid);
        self.velocity.set_grid(&self.grid, &self.boundaries.sides);
        self.pressure.set_grid(&self.grid);
        Ok(())
    }

    /// Sets every velocity component to `u(x)[c]` at its nodes \[m/s\], outlets included; walls and inlets keep theirs.
    pub(crate) fn set_velocity(&mut self, u: impl Fn([f64; D]) -> [f64; D]) {
        for (c, component) in self.velocity.components.iter_mut().enumerate() {
            let data = component.data_mut();
            each_node(&self.grid, &self.metrics, c, |o, x| data[o] = u(x)[c]);
        }
        self.boundaries.start(&self.metrics, u);
        self.fill_velocity();
        self.measure_rates();
    }

    /// Boundary faces and ghosts of the velocity.
    pub(crate) fn fill_velocity(&mut self) {
        per_dimension!(self, FlowState, fill_velocity_here() -> ())
    }

    fn fill_velocity_here(&mut self) {
        for (c, component) in self.velocity.components.iter_mut().enumerate() {
            self.boundaries.fill_velocity(c, component);
        }
    }
    /// Ghosts of the pressure.
    pub(crate) fn fill_pressure(&mut self) {
        self.boundaries.fill_pressure(&mut self.pressure);
    }

    /// Brings the rates up to date; they keep what is not finite.
    pub(crate) fn measure_rates(&mut self) {
        per_dimension!(self, FlowState, measure_rates_here() -> ())
    }

    fn measure_rates_here(&mut self) {
        let given = self.boundaries.rates(&self.metrics);
        let u = &self.velocity.components;
        self.rates = std::array::from_fn(|c| {
            let inside = statistics::largest_rate(&self.grid, &self.metrics, c, &u[c]);
            if inside > given[c] || inside.is_nan() { inside } else { given[c] }
        });
    }

    /// Courant number dt Σ_a max(|u_a|/h_a) of a step of length `dt`.
    pub(crate) fn courant(&self, dt: f64) -> f64 {
        dt * self.rates.iter().sum::<f64>()
    }

    /// # Errors
    /// [`FlowError::TimeStep`] for a step that is not positive and finite.
    pub(crate) fn check_step(&self, dt: f64) -> Result<(), FlowError> {
        if dt.is_finite() && dt > 0.0 { Ok(()) } else { Err(FlowError::TimeStep { dt, time: self.time }) }
    }

    /// The error of a step of `dt` that ended in a velocity which is not finite, or too large.
    pub(crate) fn diverged(&self, dt: f64) -> FlowError {
        let cell = statistics::worst_cell(&self.velocity.components);
        FlowError::Diverged { step: self.step, time: self.time, dt, courant: self.courant(dt), cell }
    }

    /// Ends a step of `dt`.
    pub(crate) fn tick(&mut self, dt: f64) {
        self.time += dt;
        self.step += 1;
    }

    /// Sums and extremes of the velocity, as it is now.
    pub(crate) fn statistics(&mut self) -> FlowStatistics {
        per_dimension!(self, FlowState, measure_here() -> FlowStatistics)
    }

    fn measure_here(&mut self) -> FlowStatistics {
        let fluid = [self.fluid.density, self.fluid.viscosity];
        self.measure.of(&self.grid, &self.metrics, &self.velocity.components, fluid)
    }

    /// The same with the divergence of the fluxes that `show` puts in the place of the velocity.
    pub(crate) fn statistics_of_fluxes(&mut self, show: impl FnOnce(&mut Self)) -> FlowStatistics {
        let sums = self.statistics();
        let nodes = self.velocity.components.clone();
        show(self);
        let divergence = self.statistics().divergence;
        self.velocity.components = nodes;
        FlowStatistics { divergence, ..sums }
    }

    /// What the bounded sides do to the kinetic energy.
    pub(crate) fn side_power(&self) -> SidePower {
        let Self { grid, metrics, velocity, pressure, fluid, .. } = self;
        self.measure.side_power(grid, metrics, &velocity.components, pressure, *fluid)
    }

    /// Hands velocity, pressure, sides and clock to `sink`.
    pub(crate) fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        for (c, component) in self.velocity.components.iter().enumerate() {
            sink(&format!("velocity{c}"), component.data());
        }
        sink("pressure", self.pressure.data());
        if self.window != [0; D] {
            sink("window", &self.window.map(|cells| cells as f64));
        }
        self.save_clock(sink);
    }

    /// Passes everything but the fields to `sink`: sides and clock.
    pub(crate) fn save_clock(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        sink("clock", &[self.time, self.step as f64, self.last_dt]);
        sink("rates", &self.rates);
        let mut sides = Vec::new();
        self.boundaries.memory(&mut sides);
        sink("sides", &sides);
    }

    /// Takes back what [`save`](Self::save) gave.
    pub(crate) fn restore<'a>(
        &mut self,
        source: &dyn Fn(&str) -> Option<&'a [f64]>,
    ) -> Result<(), RestartError> {
        let mut window = [0; D];
        if source("window").is_some() {
            let saved = RestartError::take(source, "window", D)?;
            window = std::array::from_fn(|a| saved[a] as i64);
        }
        self.set_window(window).map_err(|_| RestartError::Differs("window".into()))?;
        for (c, component) in self.velocity.components.iter_mut().enumerate() {
            RestartError::fill(source, &format!("velocity{c}"), component.data_mut())?;
        }
        RestartError::fill(source, "pressure", self.pressure.data_mut())?;
        self.restore_clock(source)
    }

    /// Restores what [`save_clock`](Self::save_clock) saved.
    pub(crate) fn restore_clock<'a>(
        &mut self,
        source: &dyn Fn(&str) -> Option<&'a [f64]>,
    ) -> Result<(), RestartError> {
        let clock = RestartError::take(source, "clock", 3)?;
        (self.time, self.step, self.last_dt) = (clock[0], clock[1] as u64, clock[2]);
        RestartError::fill(source, "rates", &mut self.rates)?;
        let mut sides = Vec::new();
        self.boundaries.memory(&mut sides);
        self.boundaries.recall(RestartError::take(source, "sides", sides.len())?);
        Ok(())
    }
}

/// Calls `f` with the storage index and the place of every node of component `c` (those on bounded sides too).
pub(crate) fn each_node<const D: usize>(
    grid: &CartesianGrid<D>,
    metrics: &Metrics<D>,
    c: usize,
    mut f: impl FnMut(usize, [f64; D]),
) {
    each_cell(grid, |o, cell| {
        f(o, std::array::from_fn(|a| metrics.of(Some(c), a).x[GHOSTS + cell[a]]));
    });
}

/// Calls `f` with the storage index and the place of every cell.
pub(crate) fn each_cell<const D: usize>(grid: &CartesianGrid<D>, mut f: impl FnMut(usize, [usize; D])) {
    for cell in (0..grid.n_cells()).map(|i| grid.cell(i)) {
        f(grid.place(cell), cell);
    }
}

/// What all flow algorithms show of their state.
macro_rules! show_state {
    () => {
        /// What the bounded sides do to the kinetic energy of the fluid, as it is now.
        pub fn side_power(&self) -> $crate::SidePower {
            self.state.side_power()
        }
        /// The grid.
        pub fn grid(&self) -> &$crate::CartesianGrid<D> {
            &self.state.grid
        }
        /// The sides of the box.
        pub fn sides(&self) -> &$crate::Sides<D> {
            &self.state.boundaries.sides
        }
        /// The fluid.
        pub fn fluid(&self) -> $crate::Fluid {
            self.state.fluid
        }
        /// The velocity \[m/s\]; between the parts of a step it is u*.
        pub fn velocity(&self) -> &$crate::Velocity<D> {
            &self.state.velocity
        }
        /// The pressure at the cell centres \[Pa\], without the hydrostatic part.
        pub fn pressure(&self) -> &$crate::Field<D> {
            &self.state.pressure
        }
        /// The mean of the velocity component `c` at the two faces of every cell, row after row.
        pub fn centred_velocity(&self, c: usize) -> impl Iterator<Item = f64> + '_ {
            let $crate::flow_state::FlowState { grid, velocity, pressure, .. } = &self.state;
            let (n, s) = (grid.cells()[0], grid.stride()[c]);
            let u = velocity.components[c].data();
            (0..pressure.n_rows()).flat_map(move |r| {
                let o = pressure.row_start(r);
                u[o..o + n].iter().zip(&u[o + s..o + s + n]).map(|(a, b)| 0.5 * (a + b))
            })
        }
    };
}
/// What the unsteady ones show of their clock.
macro_rules! show_clock {
    () => {
        /// The velocity, for an immersed boundary to change between the parts of a step.
        pub fn velocity_mut(&mut self) -> &mut $crate::Velocity<D> {
            &mut self.state.velocity
        }
        /// Courant number dt Σ_a max(|u_a|/h_a) of a step of length `dt`, what moves at the sides included.
        pub fn courant(&self, dt: f64) -> f64 {
            self.state.courant(dt)
        }
        /// Length of the last step \[s\].
        pub fn last_dt(&self) -> f64 {
            self.state.last_dt
        }
        /// Time \[s\].
        pub fn time(&self) -> f64 {
            self.state.time
        }
        /// Steps made.
        pub fn steps(&self) -> u64 {
            self.state.step
        }
        /// By how many cells along each axis the box has [moved](Self::move_window).
        pub fn window(&self) -> [i64; D] {
            self.state.window
        }
        /// Sets the clock exactly (to the end of an interval that was cut into equal steps).
        pub fn set_time(&mut self, time: f64) {
            self.state.time = time;
        }
    };
}
pub(crate) use {show_clock, show_state};
