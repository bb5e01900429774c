//! What is asked of a flow.
use fv_mesh::{
    BodyForce, CartesianGrid, ClosureSlot, Field, FlowError, FlowStatistics, Fluid, Hooked, Piso, Projection,
    ScalarTransport, SidePower, Sides, SourceWork, Velocity,
};
use ibm::ViscousStep;
use interfaces::{Bodies, Checkpoint, Vector};

/// An algorithm for incompressible flow whose step has parts, so that bodies can act in between: `predict`, then as many
/// [`rounds`](Self::rounds) of forcing and `project` as it asks for, then `finish`.
pub trait FlowSolver<const D: usize>: Checkpoint {
    /// First part of a step of `dt` \[s\] under the body force `force` per mass \[m/s²\]: the velocity becomes u*.
    ///
    /// # Errors
    /// [`FlowError`] when the step cannot be made.
    fn predict(&mut self, dt: f64, force: [f64; D]) -> Result<(), FlowError>;
    /// Makes the velocity free of divergence.
    ///
    /// # Errors
    /// [`FlowError`] when the pressure cannot be found.
    fn project(&mut self, dt: f64) -> Result<(), FlowError>;
    /// Ends the step.
    ///
    /// # Errors
    /// [`FlowError`] when the velocity is not finite.
    fn finish(&mut self, dt: f64) -> Result<(), FlowError>;
    /// How often the pressure is solved for in a step, at least.
    fn rounds(&self) -> usize {
        1
    }
    /// The fluid's inertia in this step is (w₀uⁿ⁺¹ + w₁uⁿ + w₂uⁿ⁻¹)/dt; this is w: (1, −1, 0) for schemes that know two times, (3, −4, 1)/2 for BDF2 with equal
    /// steps.
    fn weights(&self) -> [f64; 3] {
        [1.0, -1.0, 0.0]
    }
    /// Moves the box by `cells` cells along `axis` on its fluid ([`Projection::move_window`]).
    ///
    /// # Errors
    /// [`FlowError`] when it cannot move; it has not then.
    fn move_window(&mut self, axis: usize, cells: i64) -> Result<(), FlowError>;
    /// The grid.
    fn grid(&self) -> &CartesianGrid<D>;
    /// The sides of the box.
    fn sides(&self) -> &Sides<D>;
    /// The fluid.
    fn fluid(&self) -> Fluid;
    /// The velocity \[m/s\]; between the parts of a step it is u*.
    fn velocity(&self) -> &Velocity<D>;
    /// The same, to be changed.
    fn velocity_mut(&mut self) -> &mut Velocity<D>;
    /// Component `c` of the velocity at the start of the last step \[m/s\].
    fn before(&self, c: usize) -> &Field<D>;
    /// The pressure \[Pa\].
    fn pressure(&self) -> &Field<D>;
    /// Component `c` of the velocity at the centres of the cells.
    fn centred_velocity(&self, c: usize) -> impl Iterator<Item = f64> + '_;
    /// Sums and extremes.
    fn statistics(&mut self) -> FlowStatistics;
    /// Impulse of the bounded sides on the fluid during the last step \[N s\].
    fn wall_impulse(&self) -> Vector;
    /// What the bounded sides do to the kinetic energy of the fluid, as it is now.
    fn side_power(&self) -> SidePower;
    /// What acts on the fluid by itself ([`Hooked`]), the same everywhere, in the last step \[m/s²\].
    fn own_force(&self) -> [f64; D] {
        [0.0; D]
    }
    /// Has what else acts on it by itself measured from the next step on.
    fn keep_books(&mut self) {}
    /// What that did in the last step.
    fn source_work(&self) -> SourceWork {
        SourceWork::default()
    }
    /// Time \[s\].
    fn time(&self) -> f64;
    /// Sets the clock exactly.
    fn set_time(&mut self, time: f64);
    /// Steps made.
    fn steps(&self) -> u64;
    /// Length of the last step \[s\].
    fn last_dt(&self) -> f64;
    /// Courant number of a step of `dt`.
    fn courant(&self, dt: f64) -> f64;
    /// The longest step \[s\] with Courant number ≤ `courant` that is stable.
    fn stable_dt(&self, courant: f64) -> f64;
    /// Tells what acts on the flow where bodies are that it sees as walls: before a step, and when they have moved in it. Flows that carry
    /// no turbulence model have nothing to do.
    ///
    /// # Errors
    /// [`FlowError::Closure`].
    #[inline(always)]
    fn follow_walls(&mut self, bodies: &dyn Bodies) -> Result<(), FlowError> {
        let _ = bodies;
        Ok(())
    }
    /// What viscosity does in the step under way, of `dt` \[s\]; `None` where forces on walls do not follow from the fluid's own viscosity alone: beside models for turbulence, or where diffusion sees the
    /// forcing.
    fn viscous_step(&self, _dt: f64) -> Option<ViscousStep> {
        None
    }
    /// The longest step that viscous terms allow \[s\]; infinite if any is stable.
    fn viscous_limit(&self) -> f64 {
        f64::INFINITY
    }
}

/// What the types have anyway: themselves, or the flow in them.
macro_rules! forward {
    ($self:ident => $flow:expr) => {
        fn finish(&mut $self, dt: f64) -> Result<(), FlowError> {
            $flow.finish(dt)
        }
        fn grid(&$self) -> &CartesianGrid<D> {
            $flow.grid()
        }
        fn sides(&$self) -> &Sides<D> {
            $flow.sides()
        }
        fn fluid(&$self) -> Fluid {
            $flow.fluid()
        }
        fn velocity(&$self) -> &Velocity<D> {
            $flow.velocity()
        }
        fn velocity_mut(&mut $self) -> &mut Velocity<D> {
            $flow.velocity_mut()
        }
        fn before(&$self, c: usize) -> &Field<D> {
            $flow.before(c)
        }
        fn pressure(&$self) -> &Field<D> {
            $flow.pressure()
        }
        fn centred_velocity(&$self, c: usize) -> impl Iterator<Item = f64> + '_ {
            $flow.centred_velocity(c)
        }
        fn statistics(&mut $self) -> FlowStatistics {
            $flow.statistics()
        }
        fn wall_impulse(&$self) -> Vector {
            $flow.wall_impulse()
        }
        fn side_power(&$self) -> SidePower {
            $flow.side_power()
        }
        fn time(&$self) -> f64 {
            $flow.time()
        }
        fn set_time(&mut $self, time: f64) {
            $flow.set_time(time);
        }
        fn steps(&$self) -> u64 {
            $flow.steps()
        }
        fn last_dt(&$self) -> f64 {
            $flow.last_dt()
        }
        fn courant(&$self, dt: f64) -> f64 {
            $flow.courant(dt)
        }
    };
}
pub(crate) use forward;

impl<const D: usize> FlowSolver<D> for Projection<D> {
    forward!(self => self);
    fn predict(&mut self, dt: f64, force: [f64; D]) -> Result<(), FlowError> {
        Projection::predict(self, dt, force)
    }
    fn move_window(&mut self, axis: usize, cells: i64) -> Result<(), FlowError> {
        Projection::move_window(self, axis, cells)
    }
    fn stable_dt(&self, courant: f64) -> f64 {
        Projection::stable_dt(self, courant)
    }
    fn project(&mut self, dt: f64) -> Result<(), FlowError> {
        Projection::project(self, dt)
    }
    fn viscous_limit(&self) -> f64 {
        Projection::viscous_limit(self)
    }
    fn viscous_step(&self, dt: f64) -> Option<ViscousStep> {
        let (implicit, diffused) = (self.implicit_axes(), Projection::fluid(self).viscosity * dt);
        let implicit = Vector::from_fn(|a, _| if a < D && implicit[a] { 0.5 } else { 0.0 });
        Some(ViscousStep { diffused, implicit })
    }
}

impl<const D: usize> FlowSolver<D> for Piso<D> {
    forward!(self => self);
    fn predict(&mut self, dt: f64, force: [f64; D]) -> Result<(), FlowError> {
        Piso::predict(self, dt, force)
    }
    fn move_window(&mut self, axis: usize, cells: i64) -> Result<(), FlowError> {
        Piso::move_window(self, axis, cells)
    }
    fn stable_dt(&self, courant: f64) -> f64 {
        Piso::stable_dt(self, courant)
    }
    fn project(&mut self, dt: f64) -> Result<(), FlowError> {
        self.correct(dt)
    }
    fn rounds(&self) -> usize {
        self.params().correctors
    }
    fn weights(&self) -> [f64; 3] {
        Piso::weights(self)
    }
}

impl<const D: usize, B, C, S> FlowSolver<D> for Hooked<D, B, C, S>
where
    B: BodyForce<D, S>,
    C: ClosureSlot<D> + Checkpoint,
    S: ScalarTransport<D> + Checkpoint,
{
    forward!(self => self);
    fn predict(&mut self, dt: f64, force: [f64; D]) -> Result<(), FlowError> {
        Hooked::predict(self, dt, force)
    }
    fn move_window(&mut self, axis: usize, cells: i64) -> Result<(), FlowError> {
        Hooked::move_window(self, axis, cells)
    }
    fn stable_dt(&self, courant: f64) -> f64 {
        Hooked::stable_dt(self, courant)
    }
    fn project(&mut self, dt: f64) -> Result<(), FlowError> {
        Hooked::project(self, dt)
    }
    fn own_force(&self) -> [f64; D] {
        Hooked::own_force(self)
    }
    fn keep_books(&mut self) {
        Hooked::keep_books(self);
    }
    fn source_work(&self) -> SourceWork {
        Hooked::source_work(self)
    }
    fn follow_walls(&mut self, bodies: &dyn Bodies) -> Result<(), FlowError> {
        Hooked::follow_walls(self, bodies)
    }
    fn viscous_limit(&self) -> f64 {
        self.flow.viscous_limit()
    }
    fn viscous_step(&self, dt: f64) -> Option<ViscousStep> {
        if self.hooks.closure.is_absent() { self.flow.viscous_step(dt) } else { None }
    }
}
