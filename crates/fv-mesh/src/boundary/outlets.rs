//! Convective outlets, and what enters set against what leaves.
use super::side_state::SideState;
use super::{Boundaries, FaceKind};
use crate::metrics::Metrics;
use crate::{Field, FlowError};

/// The largest imbalance of inlets, relative to what enters, that is put down to summing over faces.
const SUMMING_ERROR: f64 = 0.02;

impl<const D: usize> Boundaries<D> {
    /// Moves the convective outlets on by `dt`; `velocity` is the predicted one.
    ///
    /// # Errors
    /// [`FlowError::MassBalance`] if what enters cannot leave.
    pub(crate) fn advance_outlets(
        &mut self,
        metrics: &Metrics<D>,
        velocity: &[Field<D>; D],
        dt: f64,
        viscosity: f64,
    ) -> Result<(), FlowError> {
        for state in
            self.states.iter_mut().flatten().flat_map(|pair| pair.iter_mut()).filter(|state| !state.fixed)
        {
            let SideState { before, normal, .. } = state;
            before.clone_from(normal);
        }
        self.repeat_outlets(metrics, velocity, dt, viscosity)
    }

    /// Repeats [`advance_outlets`](Self::advance_outlets) of the step under way, if there is one, with a velocity that has been
    /// forced: next to a body that passes the side its faces move as the body does.
    ///
    /// # Errors
    /// Those of [`advance_outlets`](Self::advance_outlets).
    pub(crate) fn repeat_outlets(
        &mut self,
        metrics: &Metrics<D>,
        velocity: &[Field<D>; D],
        dt: f64,
        viscosity: f64,
    ) -> Result<(), FlowError> {
        if self.sides.closed() {
            return Ok(());
        }
        let mut outlets = false;
        for (a, (lines, pair)) in self.lines.iter().zip(&mut self.states).enumerate() {
            let u = velocity[a].data();
            let Some(pair) = pair else { continue };
            for (upper, state) in pair.iter_mut().enumerate() {
                if state.before.is_empty() {
                    continue;
                }
                outlets = true;
                // The largest speed, and that of viscosity, so that what is left when the outflow stops leaves too.
                let fastest = (0..lines.len())
                    .filter(|&l| lines.inside(l) && state.kind[l] == FaceKind::Convective)
                    .fold(0.0, |top: f64, l| top.max(state.before[l].abs()));
                let gap = self.grid.axis(a).width(if upper == 1 { lines.cells - 1 } else { 0 });
                let courant = (fastest + viscosity / gap) * dt / gap;
                for (l, o) in lines.starts().enumerate().filter(|&(l, _)| lines.inside(l)) {
                    if state.kind[l] == FaceKind::Convective {
                        let inside =
                            u[if upper == 1 { o + (lines.cells - 1) * lines.step } else { o + lines.step }];
                        state.normal[l] = (state.before[l] + courant * inside) / (1.0 + courant);
                    }
                }
            }
        }
        // Inlets alone have been balanced.
        if outlets { self.balance(metrics) } else { Ok(()) }
    }

    /// Ends the step: outlets are advanced no further.
    pub(crate) fn keep_outlets(&mut self) {
        self.states
            .iter_mut()
            .flatten()
            .flat_map(|pair| pair.iter_mut())
            .for_each(|state| state.before.clear());
    }

    /// Shifts what leaves through convective outlets so that it equals what enters. Without outlets the inlets are
    /// shifted, if what they miss is no more than the error of summing a smooth function over faces may be.
    pub(super) fn balance(&mut self, metrics: &Metrics<D>) -> Result<(), FlowError> {
        let (mut net, mut inflow) = (0.0, 0.0);
        let (mut outlet, mut inlet, mut free) = (0.0, 0.0, false);
        let mut fastest = 0.0_f64;
        for (lines, pair) in self.lines.iter().zip(&self.states) {
            for (upper, state) in pair.iter().flat_map(|p| p.iter()).enumerate() {
                for l in (0..lines.len()).filter(|&l| lines.inside(l)) {
                    let along = state.laws.iter().filter_map(|law| law.value.get(l));
                    fastest = along.chain([&state.normal[l]]).fold(fastest, |top, u| top.max(u.abs()));
                    let face = state.open.get(l).unwrap_or(&1.0) * lines.face_area(metrics, l);
                    let outward = [-1.0, 1.0][upper] * face * state.normal[l];
                    net += outward;
                    inflow += (-outward).max(0.0);
                    match state.kind[l] {
                        FaceKind::Closed => {}
                        FaceKind::Inlet => inlet += face,
                        FaceKind::Convective => outlet += face,
                        FaceKind::Pressure => free = true,
                    }
                }
            }
        }
        self.imbalance = 0.0;
        if !net.is_finite() {
            let what = "a velocity at an inlet that is not finite; give a function that is".into();
            return Err(FlowError::Boundary { what });
        }
        if free || net == 0.0 {
            return Ok(());
        }
        // Round-off of a lid, say, given by a function.
        let round_off = 1e-12 * inlet * fastest;
        if outlet == 0.0 && net.abs() > round_off.max(SUMMING_ERROR * inflow.max(inflow + net)) {
            return Err(FlowError::MassBalance { net, inflow });
        }
        let (kind, area) =
            if outlet > 0.0 { (FaceKind::Convective, outlet) } else { (FaceKind::Inlet, inlet) };
        self.imbalance = net;
        let shift = net / area;
        for pair in self.states.iter_mut().flatten() {
            for (upper, state) in pair.iter_mut().enumerate() {
                for (normal, _) in state.normal.iter_mut().zip(&state.kind).filter(|&(_, k)| *k == kind) {
                    *normal -= [-1.0, 1.0][upper] * shift;
                }
            }
        }
        Ok(())
    }
}
