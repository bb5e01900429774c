//! Flow and what is immersed in it.
use crate::{CouplingError, Evolving, FlowRate, FlowSolver};
use fv_mesh::Projection;
use interfaces::{Checkpoint, RestartError, Vector};
use std::time::{Duration, Instant};

/// What is immersed in a flow `A`; `()` is nothing.
pub trait Immersed<const D: usize, A = Projection<D>>: Checkpoint {
    /// Between predictor and end of a step: moves what is immersed, forces the velocity and makes
    /// it free of divergence.
    ///
    /// # Errors
    /// [`CouplingError`] when flow or bodies cannot go on.
    fn couple(&mut self, flow: &mut A, dt: f64, timings: &mut Timings) -> Result<(), CouplingError>;

    /// Can this be immersed in this flow?
    ///
    /// # Errors
    /// [`CouplingError`] that names what does not fit and why.
    fn check(&self, _flow: &A) -> Result<(), CouplingError> {
        Ok(())
    }

    /// Before the predictor of every step; the first time, what has to be known of the flow at the start.
    ///
    /// # Errors
    /// [`CouplingError`] when this cannot be put on the flow's grid.
    fn begin(&mut self, _flow: &mut A) -> Result<(), CouplingError> {
        Ok(())
    }

    /// Σ (ρ_s − ρ_f) V g \[N\], what gravity pulls beyond buoyancy on what is free to fall.
    fn net_weight(&self) -> Vector {
        Vector::zeros()
    }
}

impl<const D: usize, A: FlowSolver<D>> Immersed<D, A> for () {
    fn couple(&mut self, flow: &mut A, dt: f64, timings: &mut Timings) -> Result<(), CouplingError> {
        for _ in 0..flow.rounds() {
            timings.measure(Module::Pressure, || flow.project(dt))?;
        }
        Ok(())
    }
}

/// What holds up the net weight of bodies in a periodic box, which would else fall ever faster
/// together with the fluid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WeightBalance {
    /// Nothing: for boxes with walls, which bear it as pressure.
    None,
    /// The uniform body force −Σ(ρ_s − ρ_f) V g / V_Ω: the momentum of fluid and bodies together
    /// stays what it was, and ∫_Ω u dV stays within Σ(ρ_s − ρ_f)/ρ_f · V U of zero.
    #[default]
    NetWeight,
    /// The uniform body force that holds ∫_Ω u dV over fluid and solid at zero exactly.
    ZeroFlow,
}

/// The parts of a step whose time is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Module {
    /// Convection, diffusion and the old pressure gradient.
    Advance,
    /// Motion of the bodies and their contacts.
    Contact,
    /// λ, markers and stencils of bodies that moved.
    SolidFraction,
    /// Reading and forcing the velocity, and the bodies' new velocities.
    Forcing,
    /// Divergence, pressure solution, correction.
    Pressure,
    /// Extremes, clock.
    Finish,
}

impl Module {
    /// All of them, in order.
    pub const ALL: [Self; 6] =
        [Self::Advance, Self::Contact, Self::SolidFraction, Self::Forcing, Self::Pressure, Self::Finish];
    /// A name for tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Advance => "advance",
            Self::Contact => "contact",
            Self::SolidFraction => "lambda",
            Self::Forcing => "forcing",
            Self::Pressure => "pressure",
            Self::Finish => "finish",
        }
    }
}

/// Wall time by module.
#[derive(Clone, Copy, Debug, Default)]
pub struct Timings([Duration; 6]);

impl Timings {
    /// Runs `f` on the account of `module`.
    pub fn measure<R>(&mut self, module: Module, f: impl FnOnce() -> R) -> R {
        let start = Instant::now();
        let out = f();
        self.0[module as usize] += start.elapsed();
        out
    }
    /// Seconds spent in `module`.
    pub fn seconds(&self, module: Module) -> f64 {
        self.0[module as usize].as_secs_f64()
    }
}

/// A body force per mass \[m/s²\], of the time \[s\].
type Drive = Box<dyn Fn(f64) -> Vector + Send + Sync>;

/// A flow `A` and what is immersed in it (`P`; `()` for nothing).
pub struct Simulation<const D: usize, P = (), A = Projection<D>> {
    /// The flow.
    pub flow: A,
    /// What is immersed.
    pub particles: P,
    balance: WeightBalance,
    drive: Option<Drive>,
    flow_rate: Option<FlowRate>,
    force: Vector,
    /// Increase of the Courant number per step length, per time, over the last step and the one
    /// before it \[1/s²\].
    slopes: [f64; 2],
    timings: Timings,
}

impl<const D: usize, P: Immersed<D, A>, A: FlowSolver<D>> Simulation<D, P, A> {
    /// Puts the two together.
    ///
    /// # Errors
    /// [`CouplingError`] when the two do not fit ([`Immersed::check`]).
    pub fn new(flow: A, particles: P, balance: WeightBalance) -> Result<Self, CouplingError> {
        particles.check(&flow)?;
        let (drive, force, slopes) = (None, Vector::zeros(), [0.0; 2]);
        let (flow_rate, timings) = (None, Timings::default());
        Ok(Self { flow, particles, balance, drive, flow_rate, force, slopes, timings })
    }

    /// The same driven by a body force per mass \[m/s²\] besides, the same everywhere: `force(t)` of the time \[s\], in the middle of each step. Bodies feel it as they feel
    /// the mean pressure gradient it stands for.
    #[must_use]
    pub fn with_force(mut self, force: impl Fn(f64) -> Vector + Send + Sync + 'static) -> Self {
        self.drive = Some(Box::new(force));
        self
    }

    /// The same with a further body force that holds this mean velocity.
    #[must_use]
    pub fn with_flow_rate(mut self, flow_rate: FlowRate) -> Self {
        self.flow_rate = Some(flow_rate);
        self
    }

    /// One step of length `dt` \[s\].
    ///
    /// # Errors
    /// [`CouplingError`] when flow or bodies cannot go on.
    pub fn step(&mut self, dt: f64) -> Result<(), CouplingError> {
        self.particles.begin(&mut self.flow)?;
        self.advance(dt)
    }

    /// The same after [`Immersed::begin`].
    fn advance(&mut self, dt: f64) -> Result<(), CouplingError> {
        let Self { flow, particles, drive, flow_rate, timings, .. } = self;
        let rate = flow.courant(1.0);
        self.force = match self.balance {
            WeightBalance::None => Vector::zeros(),
            WeightBalance::NetWeight => {
                -particles.net_weight() / (flow.fluid().density * flow.grid().volume())
            }
            // What brings back the flow that the last step left, and the net weight ahead.
            WeightBalance::ZeroFlow => {
                let volume = flow.grid().volume();
                -particles.net_weight() / (flow.fluid().density * volume)
                    - flow.statistics().volume_flow / (volume * dt)
            }
        };
        if let Some(drive) = drive {
            self.force += drive(flow.time() + 0.5 * dt);
        }
        if let Some(rate) = flow_rate {
            let mean = flow.statistics().volume_flow[rate.axis] / flow.grid().volume();
            self.force[rate.axis] += rate.force(mean, flow.time(), dt);
        }
        let force = std::array::from_fn(|a| self.force[a]);
        timings.measure(Module::Advance, || flow.predict(dt, force))?;
        particles.couple(flow, dt, timings)?;
        timings.measure(Module::Finish, || flow.finish(dt))?;
        self.slopes = [(flow.courant(1.0) - rate) / dt, self.slopes[0]];
        Ok(())
    }

    /// The longest step \[s\] that ends with a Courant number ≤ `courant` if its rate r = Σ
    /// max|u_a|/h_a grows by no more than over the last step and by what this differs from the step
    /// before: the root of dt (r + s dt) = C, s = max(s₁, 0) + |s₁ − s₂|. (A linear extrapolation s
    /// = s₁ alone is exceeded wherever r has a minimum.)
    fn convective_dt(&self, courant: f64) -> f64 {
        let [last, before] = self.slopes;
        let (rate, growth) = (self.flow.courant(1.0), last.max(0.0) + (last - before).abs());
        2.0 * courant / (rate + (rate * rate + 4.0 * growth * courant).sqrt())
    }
}

impl<const D: usize, P: Immersed<D, A>, A: FlowSolver<D>> Evolving for Simulation<D, P, A> {
    fn begin(&mut self) -> Result<(), CouplingError> {
        self.particles.begin(&mut self.flow)
    }
    fn step(&mut self, dt: f64) -> Result<(), CouplingError> {
        self.advance(dt)
    }
    fn time(&self) -> f64 {
        self.flow.time()
    }
    fn set_time(&mut self, time: f64) {
        self.flow.set_time(time);
    }
    fn steps(&self) -> u64 {
        self.flow.steps()
    }
    fn last_dt(&self) -> f64 {
        self.flow.last_dt()
    }
    fn courant(&self, dt: f64) -> f64 {
        self.flow.courant(dt)
    }
    fn stable_dt(&self, courant: f64) -> f64 {
        self.flow.stable_dt(courant).min(self.convective_dt(courant))
    }
    fn longest_dt(&self) -> f64 {
        self.flow.viscous_limit()
    }
}

impl<const D: usize, P, A> Simulation<D, P, A> {
    /// The body force of the last step, per mass \[m/s²\].
    pub fn body_force(&self) -> Vector {
        self.force
    }
    /// Where the time went.
    pub fn timings(&self) -> &Timings {
        &self.timings
    }
}

impl<const D: usize, P: Immersed<D, A>, A: FlowSolver<D>> Checkpoint for Simulation<D, P, A> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        self.flow.save(&mut |name, values| sink(&format!("flow.{name}"), values));
        self.particles.save(&mut |name, values| sink(&format!("particles.{name}"), values));
        sink("slopes", &self.slopes);
        self.flow_rate.save(&mut |name, values| sink(&format!("flow_rate.{name}"), values));
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.flow.restore(&|name| source(&format!("flow.{name}")))?;
        self.particles.restore(&|name| source(&format!("particles.{name}")))?;
        RestartError::fill(source, "slopes", &mut self.slopes)?;
        self.flow_rate.restore(&|name| source(&format!("flow_rate.{name}")))
    }
    fn save_start(&mut self, sink: &mut dyn FnMut(&str, &[f64])) {
        self.flow.save_start(&mut |name, values| sink(&format!("flow.{name}"), values));
        self.particles.save_start(&mut |name, values| sink(&format!("particles.{name}"), values));
        sink("slopes", &self.slopes);
        self.flow_rate.save_start(&mut |name, values| sink(&format!("flow_rate.{name}"), values));
    }
    fn take_back<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.flow.take_back(&|name| source(&format!("flow.{name}")))?;
        self.particles.take_back(&|name| source(&format!("particles.{name}")))?;
        RestartError::fill(source, "slopes", &mut self.slopes)?;
        self.flow_rate.take_back(&|name| source(&format!("flow_rate.{name}")))
    }
}
