//! Accelerations that vary in space.
use super::Projection;
use crate::flow_state::FlowState;
use crate::statistics::acted;
use crate::{CartesianGrid, EddyStress, Field, FlowError};
use interfaces::{RestartError, Vector};

/// What forces that vary in space and an eddy viscosity ([`Hooks`](crate::Hooks)) did to the fluid in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SourceWork {
    /// Impulse of both \[N s\]; of an eddy viscosity that of walls whose friction a model gives, less the fluid's own friction there.
    pub impulse: Vector,
    /// Work of the forces \[J\].
    pub work: f64,
    /// Energy that the eddy viscosity took, less what walls that move gave by its friction \[J\].
    pub eddy_dissipation: f64,
}

/// Per density and time: ∫ f dV, ∫ f·u dV of forces, and the same of the eddy viscosity's stress.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Rates {
    impulse: Vector,
    power: [f64; 2],
}

/// What accelerates the fluid in the next predictor step; its fields are made when first needed.
#[derive(Default)]
pub(super) struct Sources<const D: usize> {
    fields: Option<Box<[Field<D>; D]>>,
    /// Is there anything in `fields`?
    given: bool,
    /// The largest Σ ν_t/h² of the last step with a closure \[1/s\].
    eddy_rate: f64,
    /// Is what they do measured?
    counted: bool,
    /// Of what is given for the next step, and of what was for the last.
    rates: [Rates; 2],
    /// In the last step.
    pub(super) done: SourceWork,
}

impl<const D: usize> Sources<D> {
    /// Takes note of what the step of `dt` does with these weights of the tendencies.
    pub(super) fn act(&mut self, density: f64, dt: f64, weights: [f64; 2]) {
        let now = if self.given { self.rates[0] } else { Rates::default() };
        let [a, b] = weights.map(|w| w * density * dt);
        let last = std::mem::replace(&mut self.rates, [Rates::default(), now])[1];
        self.done = SourceWork {
            impulse: a * now.impulse + b * last.impulse,
            work: a * now.power[0] + b * last.power[0],
            eddy_dissipation: -(a * now.power[1] + b * last.power[1]),
        };
    }

    /// What a restart needs of it; nothing where nothing acts.
    pub(super) fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        let Rates { impulse: i, power: [work, stress] } = self.rates[1];
        if self.rates[1] != Rates::default() {
            sink("sources", &[i.x, i.y, i.z, work, stress]);
        }
    }
    pub(super) fn restore<'a>(
        &mut self,
        source: &dyn Fn(&str) -> Option<&'a [f64]>,
    ) -> Result<(), RestartError> {
        self.forget();
        self.rates = [Rates::default(); 2];
        if source("sources").is_some()
            && let &[x, y, z, work, stress] = RestartError::take(source, "sources", 5)?
        {
            self.rates[1] = Rates { impulse: Vector::new(x, y, z), power: [work, stress] };
        }
        Ok(())
    }

    /// The largest Σ ν_t/h² that is given, or was in the last step \[1/s\].
    pub(super) fn eddy_rate(&self) -> f64 {
        self.eddy_rate
    }

    /// Forgets the eddy viscosity of an earlier step; returns whether nothing is given for this one.
    pub(super) fn start(&mut self) -> bool {
        if !self.given {
            self.eddy_rate = 0.0;
        }
        !self.given
    }

    /// Takes back accelerations that no predictor step used.
    pub(super) fn forget(&mut self) {
        (self.given, self.eddy_rate) = (false, 0.0);
    }

    /// Puts them on another grid of the same size.
    pub(super) fn set_grid(&mut self, grid: &CartesianGrid<D>) {
        self.fields.iter_mut().flat_map(|f| f.iter_mut()).for_each(|field| field.set_grid(grid));
    }

    /// What was given since the last call.
    pub(super) fn take(&mut self) -> Option<&[Field<D>; D]> {
        std::mem::take(&mut self.given).then_some(self.fields.as_deref())?
    }
}

impl<const D: usize> Projection<D> {
    /// Has what forces that vary in space and an eddy viscosity do measured from the next step on: two sums over the fields.
    pub fn keep_books(&mut self) {
        self.sources.counted = true;
    }

    /// What these did in the last step, once [books are kept](Self::keep_books).
    pub fn source_work(&self) -> SourceWork {
        self.sources.done
    }

    /// Lets `f` add accelerations that vary in space \[m/s²\] for the next predictor step.
    pub(crate) fn with_sources(&mut self, f: impl FnOnce(&Self, &mut [Field<D>; D])) {
        self.gather(0, f);
    }

    /// The same on the account of forces (0) or of an eddy viscosity (1).
    fn gather(&mut self, account: usize, f: impl FnOnce(&Self, &mut [Field<D>; D])) {
        let zeros = || Box::new(std::array::from_fn(|_| Field::zeros(&self.state.grid)));
        let mut fields = self.sources.fields.take().unwrap_or_else(zeros);
        if !self.sources.given {
            fields.iter_mut().for_each(|s| s.data_mut().fill(0.0));
            self.sources.rates[0] = Rates::default();
        }
        f(self, &mut fields);
        if self.sources.counted {
            self.count(account, &fields);
        }
        self.sources.fields = Some(fields);
        self.sources.given = true;
    }

    /// Puts on an account what `fields` do beyond what is on the other one.
    fn count(&mut self, account: usize, fields: &[Field<D>; D]) {
        let FlowState { grid, metrics, velocity, .. } = &self.state;
        let rates = &mut self.sources.rates[0];
        let other = rates.power[1 - account];
        *rates = Rates::default();
        for (c, (source, u)) in fields.iter().zip(&velocity.components).enumerate() {
            let [impulse, power] = acted(grid, metrics, c, [source, u]);
            rates.impulse[c] = impulse;
            rates.power[account] += power;
        }
        rates.power[account] -= other;
        rates.power[1 - account] = other;
    }

    /// Takes back accelerations that no predictor step used.
    pub(crate) fn forget_sources(&mut self) {
        self.sources.forget();
        self.reset_outlet_diffusion();
    }

    /// Diffusion along outlets by the fluid's own viscosity.
    pub(super) fn reset_outlet_diffusion(&mut self) {
        let FlowState { metrics, boundaries, fluid, .. } = &mut self.state;
        boundaries.set_outlet_diffusion(metrics, fluid.viscosity, None);
    }

    /// Tells [`stable_dt`](Self::stable_dt) of the largest Σ ν_t/h² in the next step \[1/s\].
    pub(crate) fn expect_eddy_viscosity(&mut self, rate: f64) {
        self.sources.eddy_rate = rate;
    }

    /// Adds ∇·[ν_t(∇u + ∇uᵀ)] and the friction of walls to the next predictor step of `dt`.
    pub(crate) fn add_eddy_stress(&mut self, stress: &EddyStress<D>, dt: f64) -> Result<(), FlowError> {
        stress.eddy.check(&self.state.grid)?;
        self.sources.eddy_rate = stress.rate;
        self.momentum.set_law(stress.law());
        let FlowState { metrics, boundaries, fluid, .. } = &mut self.state;
        boundaries.set_outlet_diffusion(metrics, fluid.viscosity, Some((&stress.eddy, &stress.walls)));
        self.choose_implicit(dt)?;
        self.gather(1, |flow, sources| {
            sources.iter_mut().enumerate().for_each(|(c, source)| stress.add(c, &flow.state, source));
        });
        Ok(())
    }
}
