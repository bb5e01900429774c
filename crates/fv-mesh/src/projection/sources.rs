//! Accelerations that vary in space.
use super::Projection;
use crate::{CartesianGrid, EddyStress, Field, FlowError};

/// What accelerates the fluid in the next predictor step; its fields are made when first needed.
#[derive(Default)]
pub(super) struct Sources<const D: usize> {
    fields: Option<Box<[Field<D>; D]>>,
    /// Is there anything in `fields`?
    given: bool,
    /// The largest Σ ν_t/h² of the last step with a closure \[1/s\].
    eddy_rate: f64,
}

impl<const D: usize> Sources<D> {
    /// The largest Σ ν_t/h² that is given, or was in the last step \[1/s\].
    pub(super) fn eddy_rate(&self) -> f64 {
        self.eddy_rate
    }

    /// Forgets the eddy viscosity of an earlier step.
    pub(super) fn start(&mut self) {
        if !self.given {
            self.eddy_rate = 0.0;
        }
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
    /// Lets `f` add accelerations that vary in space \[m/s²\] for the next predictor step.
    pub(crate) fn with_sources(&mut self, f: impl FnOnce(&Self, &mut [Field<D>; D])) {
        let zeros = || Box::new(std::array::from_fn(|_| Field::zeros(&self.state.grid)));
        let mut fields = self.sources.fields.take().unwrap_or_else(zeros);
        if !self.sources.given {
            fields.iter_mut().for_each(|s| s.data_mut().fill(0.0));
        }
        f(self, &mut fields);
        self.sources.fields = Some(fields);
        self.sources.given = true;
    }

    /// Takes back accelerations that no predictor step used.
    pub(crate) fn forget_sources(&mut self) {
        self.sources.forget();
    }

    /// Tells [`stable_dt`](Self::stable_dt) of the largest Σ ν_t/h² in the next step \[1/s\].
    pub(crate) fn expect_eddy_viscosity(&mut self, rate: f64) {
        self.sources.eddy_rate = rate;
    }

    /// Adds ∇·[ν_t(∇u + ∇uᵀ)] and the friction of walls to the next predictor step of `dt`.
    pub(crate) fn add_eddy_stress(&mut self, stress: &EddyStress<D>, dt: f64) -> Result<(), FlowError> {
        stress.eddy.check(&self.state.grid)?;
        self.sources.eddy_rate = stress.rate;
        self.choose_implicit(dt)?;
        self.with_sources(|flow, sources| {
            sources.iter_mut().enumerate().for_each(|(c, source)| stress.add(c, &flow.state, source));
        });
        Ok(())
    }
}
