//! Flow with a scalar or a closure, by hand.
use siltflow::flow::{
    CellTransport, FlowError, Modelled, Projection, Scalar, ScalarSide, ScalarTransport, TransportParams,
};
use siltflow::interfaces::{Closure, SolveError, Transport, WallRow};

/// A scalar that flows along, on the cells of a box with periodic sides.
pub(crate) fn scalar(flow: &Projection<2>, diffusivity: f64) -> Result<Scalar<2>, FlowError> {
    let sides = [const { [ScalarSide::Periodic, ScalarSide::Periodic] }; 2];
    let mut scalar = Scalar::new(flow.grid(), sides, diffusivity)?;
    scalar.set(|x| (x[0] * 628.32).sin());
    Ok(scalar)
}

/// A step of flow and scalar, without any slot.
pub(crate) fn with_scalar(
    flow: &mut Projection<2>,
    scalar: &mut Scalar<2>,
    dt: f64,
) -> Result<(), FlowError> {
    scalar.advance(flow.velocity(), flow.time(), dt)?;
    flow.predict(dt, [0.0; 2])?;
    flow.project(dt)?;
    flow.finish(dt)
}

/// A closure that looks at the strain rate, and does nothing to the flow: what a model does costs the same either way.
pub(crate) struct Strain(Vec<f64>);

impl Closure for Strain {
    fn eddy_viscosity(&self) -> Option<&[f64]> {
        None
    }
    fn correct(
        &mut self,
        flow: &mut dyn Transport,
        _: &[WallRow],
        _: f64,
        _: Option<f64>,
    ) -> Result<(), SolveError> {
        flow.strain_rate(&mut self.0)
    }
}

/// The closure in its slot.
pub(crate) fn modelled(flow: &Projection<2>) -> Result<Modelled<2, Strain>, FlowError> {
    Modelled::new(
        Strain(vec![0.0; flow.grid().n_cells()]),
        flow.grid(),
        flow.sides(),
        TransportParams::default(),
    )
}

/// The closure, and the equations on the flow's cells.
pub(crate) fn closure_and_cells(flow: &Projection<2>) -> Result<(Strain, CellTransport<2>), FlowError> {
    let cells = CellTransport::new(flow.grid(), flow.sides(), TransportParams::default())?;
    Ok((Strain(vec![0.0; flow.grid().n_cells()]), cells))
}

/// A step of flow and closure, without any slot.
pub(crate) fn with_closure(
    flow: &mut Projection<2>,
    closure: &mut Strain,
    cells: &mut CellTransport<2>,
    dt: f64,
) -> Result<(), FlowError> {
    flow.predict(dt, [0.0; 2])?;
    flow.project(dt)?;
    flow.finish(dt)?;
    let corrected = closure.correct(&mut cells.on(flow.velocity())?, &[], flow.fluid().viscosity, Some(dt));
    corrected.map_err(|source| FlowError::Closure { time: flow.time(), source })
}
