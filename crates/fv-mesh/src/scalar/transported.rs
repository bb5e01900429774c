//! A passive scalar that a flow carries.
use super::diffusion::ScalarDiffusion;
use super::kernel::{Input, Step, advance};
use super::mixing::{self, Mixing};
use super::walls::Walls;
use super::{ScalarBoundaries, ScalarSide};
use crate::diffusion::{SplitDiffusion, stiffness};
use crate::metrics::Metrics;
use crate::operators::{Carried, Carrier, integral};
use crate::{
    CartesianGrid, Convection, Diffusion, EddyStress, Field, FlowError, Sides, Velocity, kernels, statistics,
};
use interfaces::{Bodies, Checkpoint, RestartError, VelocityField};

/// Adams–Bashforth is used while a step is at most so many times longer than the last.
const LONGEST_GROWTH: f64 = 10.0;

/// A passive scalar φ at the cell centres (temperature, concentration) in a staggered velocity:
///
/// ```text
/// ∂φ/∂t + ∇·(uφ) = ∇·(Γ∇φ) + S
/// Π_a (1 − κ_a L_a)(φⁿ⁺¹ − φⁿ) = dt [(1 + r/2) Hⁿ − (r/2) Hⁿ⁻¹ + Γ L φⁿ],   r = dt/dt_last,   κ = ½Γ dt
/// ```
///
/// H = −∇·(uφ) + Γ∇²φ + ∇·(D_t∇φ) + S, with D_t where eddies [`mix`](Self::mix), takes the diffusion along the axes where the step is within its stability limit, L that along
/// the others ([`Diffusion`]): second order in time, after a first step of Euler's. In space second order with
/// [`Convection::Central`], which is the default, [`LinearUpwind`](Convection::LinearUpwind),
/// [`Quick`](Convection::Quick) and, away from extrema, [`Limited`](Convection::Limited). What leaves a cell enters its
/// neighbour, so that ∫φ dV changes by what the sides and S bring alone.
///
/// φ stays within its bounds with [`Upwind`](Convection::Upwind) up to Courant numbers Σ|u_a|dt/h_a of 4/9 and with
/// [`Limited`](Convection::Limited) up to 2/9 (steps that do not grow; explicit diffusion takes its share; Hundsdorfer,
/// Ruuth & Spiteri 2003), if the velocity is free of divergence; Crank–Nicolson keeps bounds while Γdt ≤ h².
#[derive(Clone, Debug)]
pub struct Scalar<const D: usize> {
    pub(super) grid: CartesianGrid<D>,
    pub(super) metrics: Metrics<D>,
    pub(super) boundaries: ScalarBoundaries<D>,
    pub(super) carrier: Carrier<D>,
    implicit: ScalarDiffusion<D>,
    pub(super) diffusivity: f64,
    diffusion: SplitDiffusion<D>,
    pub(super) phi: Field<D>,
    pub(super) next: Field<D>,
    pub(super) tendency: Field<D>,
    pub(super) source: Option<Field<D>>,
    pub(super) turbulent_prandtl: f64,
    pub(super) mixing: Option<Box<Mixing<D>>>,
    pub(super) walls: Option<Box<Walls<D>>>,
    pub(super) zeros: Vec<f64>,
    pub(super) step: u64,
    last_dt: f64,
    start: Option<Box<Start<D>>>,
}

/// Fields at the start of a step that can be taken back; φ is in `next`.
#[derive(Clone, Debug)]
struct Start<const D: usize> {
    tendency: Field<D>,
    /// Whether φ and the tendency are those of the step's end.
    advanced: bool,
}

impl<const D: usize> Scalar<D> {
    /// φ = 0 in a box whose periodic axes are those of the flow; `sides[axis]` are its lower and upper side,
    /// `diffusivity` is Γ \[m²/s\], which may be zero.
    ///
    /// # Errors
    /// [`FlowError::Boundary`] for sides and [`FlowError::Fluid`] for a diffusivity that make no sense.
    pub fn new(
        grid: &CartesianGrid<D>,
        sides: [[ScalarSide; 2]; D],
        diffusivity: f64,
    ) -> Result<Self, FlowError> {
        if !(diffusivity.is_finite() && diffusivity >= 0.0) {
            return Err(FlowError::Fluid { name: "diffusivity", value: diffusivity, unit: "m²/s" });
        }
        let boundaries = ScalarBoundaries::new(grid, sides)?;
        let metrics = Metrics::new(grid, boundaries.periodic());
        let mut new = Self {
            carrier: Carrier::new(&metrics, Convection::Central),
            implicit: ScalarDiffusion::new(&boundaries),
            diffusivity,
            diffusion: SplitDiffusion::new(
                diffusivity,
                std::array::from_fn(|a| stiffness(&metrics.axes[a].centres, grid.cells()[a])),
            ),
            phi: Field::zeros(grid),
            next: Field::zeros(grid),
            tendency: Field::zeros(grid),
            source: None,
            turbulent_prandtl: mixing::USUAL,
            mixing: None,
            walls: None,
            zeros: vec![0.0; grid.cells()[0]],
            step: 0,
            last_dt: 0.0,
            start: None,
            grid: grid.clone(),
            metrics,
            boundaries,
        };
        new.boundaries.fill_ghosts(&mut new.phi);
        Ok(new)
    }

    /// The same with another convection scheme than [`Convection::Central`].
    #[must_use]
    pub fn with_convection(mut self, scheme: Convection) -> Self {
        self.carrier = Carrier::new(&self.metrics, scheme);
        self
    }
    /// The same with diffusion as told rather than [`Diffusion::Auto`].
    #[must_use]
    pub fn with_diffusion(mut self, diffusion: Diffusion) -> Self {
        self.diffusion.mode = diffusion;
        self
    }

    /// Takes `phi(x)` at the cell centres x \[m\]. The next step starts anew, as an Euler step.
    pub fn set(&mut self, phi: impl FnMut([f64; D]) -> f64) {
        self.phi.set(phi);
        self.boundaries.fill_ghosts(&mut self.phi);
        self.step = 0;
    }
    /// Changes values between two steps, as immersed bodies do; `change` gets them as [`Field::data`] has them.
    pub fn impose(&mut self, change: impl FnOnce(&mut [f64])) {
        change(self.phi.data_mut());
        self.boundaries.fill_ghosts(&mut self.phi);
    }
    /// φ, ghosts filled.
    pub fn field(&self) -> &Field<D> {
        &self.phi
    }
    /// The source S per time, to write before each step: that at its start counts. It is zero, and costs nothing, until
    /// this is first called.
    pub fn source_mut(&mut self) -> &mut Field<D> {
        self.source.get_or_insert_with(|| Field::zeros(&self.grid))
    }
    /// Γ \[m²/s\].
    pub fn diffusivity(&self) -> f64 {
        self.diffusivity
    }
    pub(crate) fn metrics(&self) -> &Metrics<D> {
        &self.metrics
    }
    /// The grid.
    pub fn grid(&self) -> &CartesianGrid<D> {
        &self.grid
    }
    /// ∫ φ dV.
    pub fn integral(&self) -> f64 {
        integral(&self.grid, &self.metrics, &self.phi)
    }
    /// Steps made since the start or the last [`set`](Self::set).
    pub fn steps(&self) -> u64 {
        self.step
    }

    /// The longest step \[s\] for which explicit diffusion is stable along all axes: 1/(4Γ Σ 1/h²) on a uniform grid.
    pub fn diffusive_limit(&self) -> f64 {
        self.diffusion.limit(0.0, &[false; D])
    }

    pub(super) fn check_velocity(&self, velocity: &Velocity<D>) -> Result<(), FlowError> {
        velocity.components[0].check(&self.grid)?;
        let (own, flow) = (self.boundaries.periodic(), &velocity.lattice(0).axes);
        match (0..D).find(|&a| own[a] != flow[a].is_periodic()) {
            None => Ok(()),
            Some(a) => Err(FlowError::Boundary {
                what: format!("axis {a} periodic for either the flow or a scalar in it; make it so for both"),
            }),
        }
    }
}

/// Scalars that a flow carries along: `()` (none, at no cost), one [`Scalar`], a `Vec` of them, or your own.
pub trait ScalarTransport<const D: usize> {
    /// Moves from `time` on by `dt` \[s\]; `velocity` is that at `time`.
    ///
    /// # Errors
    /// [`FlowError::TimeStep`] for a step that is not positive and finite, [`FlowError::Unstable`] for one that is too
    /// long, [`FlowError::OtherGrid`] or [`FlowError::Boundary`] for a velocity that does not fit,
    /// [`FlowError::ScalarDiverged`] if a scalar is not finite any more.
    fn advance(&mut self, velocity: &Velocity<D>, time: f64, dt: f64) -> Result<(), FlowError>;

    /// The longest step \[s\] that diffusion allows where the largest Σ ν_t/h² of eddies is `eddy_rate` \[1/s\].
    fn longest_step(&self, eddy_rate: f64) -> f64;

    /// Whether there is no scalar at all, so that a box can move on over its fluid.
    fn is_absent(&self) -> bool {
        false
    }

    /// The stress of eddies in the step to come, for those whom they mix, too ([`Scalar::mix`]); `viscosity` is that of the fluid \[m²/s\].
    fn mix(&mut self, eddy: &EddyStress<D>, viscosity: f64) {
        let _ = (eddy, viscosity);
    }

    /// Bodies are where they are now, at `time` \[s\] of a flow on `grid` between `sides`: at the start, and when they have moved in a step, after
    /// [`advance`](Self::advance).
    ///
    /// # Errors
    /// [`FlowError::Scalar`] for bodies that cannot be represented on this grid.
    fn follow(
        &mut self,
        _grid: &CartesianGrid<D>,
        _sides: &Sides<D>,
        _time: f64,
        _bodies: &dyn Bodies,
    ) -> Result<(), FlowError> {
        Ok(())
    }
}

impl<const D: usize> ScalarTransport<D> for () {
    #[inline(always)]
    fn advance(&mut self, _: &Velocity<D>, _: f64, _: f64) -> Result<(), FlowError> {
        Ok(())
    }
    #[inline(always)]
    fn longest_step(&self, _: f64) -> f64 {
        f64::INFINITY
    }
    fn is_absent(&self) -> bool {
        true
    }
}

impl<const D: usize> ScalarTransport<D> for Vec<Scalar<D>> {
    fn advance(&mut self, velocity: &Velocity<D>, time: f64, dt: f64) -> Result<(), FlowError> {
        self.iter_mut().try_for_each(|scalar| scalar.advance(velocity, time, dt))
    }
    fn longest_step(&self, eddy_rate: f64) -> f64 {
        self.iter().map(|scalar| scalar.longest_step(eddy_rate)).fold(f64::INFINITY, f64::min)
    }
    fn is_absent(&self) -> bool {
        self.is_empty()
    }
    fn mix(&mut self, eddy: &EddyStress<D>, viscosity: f64) {
        self.iter_mut().for_each(|scalar| scalar.mix(eddy, viscosity));
    }
}

impl<const D: usize> ScalarTransport<D> for Scalar<D> {
    fn advance(&mut self, velocity: &Velocity<D>, time: f64, dt: f64) -> Result<(), FlowError> {
        if !(dt.is_finite() && dt > 0.0) {
            return Err(FlowError::TimeStep { dt, time });
        }
        self.check_velocity(velocity)?;
        let stirred = self.mixing.as_ref().map_or(0.0, |mixing| mixing.rate);
        let implicit = self.diffusion.choose(dt, stirred)?;
        if self.boundaries.time() != time {
            self.boundaries.set_time(time);
            self.boundaries.fill_ghosts(&mut self.phi);
        }
        self.stir();
        // The last tendency is no guide at the start, after a much shorter step, or if it holds other terms.
        let growth = dt / self.last_dt;
        let usable = self.step > 0 && growth <= LONGEST_GROWTH && implicit == self.diffusion.last;
        let r = if usable { growth } else { 0.0 };
        self.diffusion.last = implicit;
        let [explicit_part, implicit_part] = self.diffusion.parts(implicit);
        let input = Input {
            carried: Carried {
                grid: &self.grid,
                metrics: &self.metrics,
                carrier: &self.carrier,
                velocity: &velocity.components,
                phi: self.phi.data(),
            },
            source: mixing::sources(&self.mixing, &self.source),
            zeros: &self.zeros,
        };
        let weights = [1.0 + 0.5 * r, -0.5 * r];
        let step = Step { dt, weights, explicit: explicit_part, implicit: implicit_part };
        if let Some(start) = &mut self.start {
            std::mem::swap(&mut self.tendency, &mut start.tendency);
        }
        let last = self.start.as_ref().map(|start| &start.tendency);
        advance(input, step, &mut self.next, (&mut self.tendency, last));
        self.boundaries.set_time(time + dt);
        if implicit.contains(&true) {
            self.implicit.set(&self.metrics, implicit_part.map(|gamma| 0.5 * dt * gamma));
            kernels::change(&self.grid, -1.0, &self.phi, &mut self.next);
            self.implicit.solve(&self.metrics, &self.boundaries, &mut self.next);
            kernels::change(&self.grid, 1.0, &self.phi, &mut self.next);
        }
        std::mem::swap(&mut self.phi, &mut self.next);
        if let Some(start) = &mut self.start {
            start.advanced = true;
        }
        self.boundaries.fill_ghosts(&mut self.phi);
        self.step += 1;
        self.last_dt = dt;
        if !statistics::is_finite(&self.phi) {
            return Err(FlowError::ScalarDiverged { step: self.step, time, dt });
        }
        Ok(())
    }

    fn longest_step(&self, eddy_rate: f64) -> f64 {
        self.diffusion.longest_step(eddy_rate / self.turbulent_prandtl)
    }
    fn mix(&mut self, eddy: &EddyStress<D>, viscosity: f64) {
        Self::mix(self, eddy, viscosity);
    }
}

impl<const D: usize> Checkpoint for Scalar<D> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        sink("scalar", self.phi.data());
        sink("tendency", self.tendency.data());
        self.save_clock(sink);
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        RestartError::fill(source, "scalar", self.phi.data_mut())?;
        RestartError::fill(source, "tendency", self.tendency.data_mut())?;
        self.restore_clock(source)
    }
    fn save_start(&mut self, sink: &mut dyn FnMut(&str, &[f64])) {
        let tendency = || Field::zeros(&self.grid);
        self.start
            .get_or_insert_with(|| Box::new(Start { tendency: tendency(), advanced: false }))
            .advanced = false;
        self.save_clock(sink);
    }
    fn take_back<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        if let Some(start) = &mut self.start
            && std::mem::take(&mut start.advanced)
        {
            std::mem::swap(&mut self.phi, &mut self.next);
            std::mem::swap(&mut self.tendency, &mut start.tendency);
        }
        self.restore_clock(source)
    }
}

impl<const D: usize> Scalar<D> {
    /// Passes everything but φ and its tendency to `sink`.
    fn save_clock(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        sink("clock", &[self.step as f64, self.last_dt]);
        sink("implicit", &self.diffusion.last.map(|i| f64::from(u8::from(i))));
        if let Some(source) = &self.source {
            sink("source", source.data());
        }
    }

    fn restore_clock<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        let clock = RestartError::take(source, "clock", 2)?;
        (self.step, self.last_dt) = (clock[0] as u64, clock[1]);
        let implicit = RestartError::take(source, "implicit", D)?;
        self.diffusion.last = std::array::from_fn(|a| implicit[a] != 0.0);
        if source("source").is_none() {
            self.source = None;
            return Ok(());
        }
        let values = RestartError::take(source, "source", self.grid.storage())?;
        self.source_mut().data_mut().copy_from_slice(values);
        Ok(())
    }
}
