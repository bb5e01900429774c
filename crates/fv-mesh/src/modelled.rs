//! Turbulence models in a flow.
use crate::diffusion::stiffness_of_cells;
use crate::metrics::Metrics;
use crate::transport::{CellTransport, WallFaces};
use crate::{CartesianGrid, EddyStress, Field, FlowError, Projection, Sides, TransportParams, Velocity};
use interfaces::{Checkpoint, Closure, RestartError, SolveError, WallRow};

/// The largest Σ ν_t/h² over the axes, of cells (x fastest) or on walls \[1/s\].
fn rate<const D: usize>(stiffness: &[Vec<f64>; D], eddy: &[f64], on_walls: &[f64]) -> f64 {
    let [along, across @ ..] = &stiffness[..] else { return 0.0 };
    let mut most = 0.0_f64;
    for (number, row) in eddy.chunks(along.len()).enumerate() {
        let mut rest = number;
        let mut others = 0.0;
        for axis in across {
            others += axis[rest % axis.len()];
            rest /= axis.len();
        }
        most = row.iter().zip(along).map(|(nu, s)| nu * (s + others)).fold(most, f64::max);
    }
    let stiffest: f64 = stiffness.iter().map(|axis| axis.iter().copied().fold(0.0, f64::max)).sum();
    on_walls.iter().map(|nu| nu * stiffest).fold(most, f64::max)
}

/// What a turbulence model does to a flow; `()` does nothing.
pub trait ClosureSlot<const D: usize> {
    /// The stress of the model; `None` if there is none.
    ///
    /// # Errors
    /// [`FlowError::Closure`].
    fn stress(&mut self, flow: &Projection<D>) -> Result<Option<&EddyStress<D>>, FlowError>;
    /// Brings the model up to date with the flow after a step of `dt` \[s\].
    ///
    /// # Errors
    /// [`FlowError::Closure`].
    fn correct(&mut self, flow: &Projection<D>, dt: f64) -> Result<(), FlowError>;
    /// How fast it diffuses momentum at most: the largest Σ ν_t/h² of any cell or wall, over the axes \[1/s\].
    fn fastest(&self) -> f64;
    /// Is there no model at all, so that friction is that of the fluid's own viscosity?
    fn is_absent(&self) -> bool {
        false
    }
}

impl<const D: usize> ClosureSlot<D> for () {
    #[inline(always)]
    fn stress(&mut self, _flow: &Projection<D>) -> Result<Option<&EddyStress<D>>, FlowError> {
        Ok(None)
    }
    #[inline(always)]
    fn correct(&mut self, _flow: &Projection<D>, _dt: f64) -> Result<(), FlowError> {
        Ok(())
    }
    #[inline(always)]
    fn fastest(&self) -> f64 {
        0.0
    }
    #[inline(always)]
    fn is_absent(&self) -> bool {
        true
    }
}

/// A model, or none.
impl<const D: usize, C: ClosureSlot<D>> ClosureSlot<D> for Option<C> {
    fn stress(&mut self, flow: &Projection<D>) -> Result<Option<&EddyStress<D>>, FlowError> {
        self.as_mut().map_or(Ok(None), |model| model.stress(flow))
    }
    fn correct(&mut self, flow: &Projection<D>, dt: f64) -> Result<(), FlowError> {
        self.as_mut().map_or(Ok(()), |model| model.correct(flow, dt))
    }
    fn fastest(&self) -> f64 {
        self.as_ref().map_or(0.0, C::fastest)
    }
    fn is_absent(&self) -> bool {
        self.as_ref().is_none_or(C::is_absent)
    }
}

/// A [`Closure`], the equations it may ask for on a flow's cells, and the walls of the box as it sees them.
///
/// Where the model gives ν_t on walls, the friction τ_w/ρ = (ν + ν_t) u_t/y of every wall face is taken from the two velocity nodes
/// of each component beside it, half from each, and nothing else passes through the wall.
pub struct Modelled<const D: usize, C> {
    /// The model.
    pub closure: C,
    transport: CellTransport<D>,
    walls: WallFaces<D>,
    /// Of the cells along each axis \[1/m²\].
    stiffness: [Vec<f64>; D],
    pub(crate) stress: Option<EddyStress<D>>,
    /// The rows of the box's walls, then those of immersed ones.
    rows: Vec<WallRow>,
}

impl<const D: usize, C: Closure> Modelled<D, C> {
    /// The model on the cells of `grid` between `sides`.
    ///
    /// # Errors
    /// [`FlowError`] for parameters that make no sense.
    pub fn new(
        closure: C,
        grid: &CartesianGrid<D>,
        sides: &Sides<D>,
        params: TransportParams,
    ) -> Result<Self, FlowError> {
        let metrics = Metrics::new(grid, std::array::from_fn(|a| sides.periodic(a)));
        Ok(Self {
            closure,
            transport: CellTransport::new(grid, sides, params)?,
            walls: WallFaces::new(grid, &metrics, sides),
            stiffness: std::array::from_fn(|a| stiffness_of_cells(&metrics.axes[a], grid.cells()[a])),
            stress: None,
            rows: Vec::new(),
        })
    }
    /// The equations on the flow's cells.
    pub fn transport(&self) -> &CellTransport<D> {
        &self.transport
    }
    /// The equations on the flow's cells; their wall distance may be changed.
    pub fn transport_mut(&mut self) -> &mut CellTransport<D> {
        &mut self.transport
    }
    /// The cells beside the walls of the box, then those beside immersed walls, as the model last saw them.
    pub fn wall_rows(&self) -> &[WallRow] {
        &self.rows
    }

    /// Makes the stress of what the model says now. Is there any?
    pub(crate) fn refresh(&mut self, viscosity: f64, time: f64) -> Result<bool, FlowError> {
        let Some(eddy) = self.closure.eddy_viscosity() else { return Ok(false) };
        let (grid, on_walls) = (self.transport.grid(), self.closure.wall_viscosity());
        let failed = |what, expected, found| {
            Err(FlowError::Closure { time, source: SolveError::Length { what, expected, found } })
        };
        if eddy.len() != grid.n_cells() {
            return failed("the eddy viscosity", grid.n_cells(), eddy.len());
        }
        let rows = self.walls.rows().len();
        let on_walls =
            if on_walls.len() == self.rows.len() { &on_walls[..rows.min(on_walls.len())] } else { on_walls };
        if !on_walls.is_empty() && on_walls.len() != rows {
            return failed("the eddy viscosity on walls", rows, on_walls.len());
        }
        let stress = self.stress.get_or_insert_with(|| EddyStress::of(Field::zeros(grid)));
        stress.rate = rate(&self.stiffness, eddy, on_walls);
        self.transport.spread(eddy, &mut stress.eddy);
        if on_walls.is_empty() {
            stress.friction.iter_mut().for_each(Vec::clear);
        } else {
            self.walls.rub(on_walls, viscosity, stress);
            self.transport.wrap(&mut stress.eddy);
        }
        Ok(true)
    }

    /// Brings the model up to date with `velocity`.
    pub(crate) fn update(
        &mut self,
        velocity: &Velocity<D>,
        immersed: &[WallRow],
        viscosity: f64,
        time: f64,
        dt: Option<f64>,
    ) -> Result<(), FlowError> {
        let rows = self.walls.fill(velocity, self.closure.kinetic_energy(), viscosity);
        self.rows.clear();
        self.rows.extend(rows.iter().chain(immersed));
        let mut cells = self.transport.on(velocity)?;
        let corrected = self.closure.correct(&mut cells, &self.rows, viscosity, dt);
        corrected.map_err(|source| FlowError::Closure { time, source })
    }
}

impl<const D: usize, C: Closure> ClosureSlot<D> for Modelled<D, C> {
    fn stress(&mut self, flow: &Projection<D>) -> Result<Option<&EddyStress<D>>, FlowError> {
        let given = self.refresh(flow.fluid().viscosity, flow.time())?;
        Ok(self.stress.as_ref().filter(|_| given))
    }
    fn correct(&mut self, flow: &Projection<D>, dt: f64) -> Result<(), FlowError> {
        self.update(flow.velocity(), &[], flow.fluid().viscosity, flow.time(), Some(dt))
    }
    fn fastest(&self) -> f64 {
        let eddy = self.closure.eddy_viscosity().unwrap_or_default();
        rate(&self.stiffness, eddy, self.closure.wall_viscosity())
    }
}

/// The model's state.
impl<const D: usize, C: Checkpoint> Checkpoint for Modelled<D, C> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        self.closure.save(sink);
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.closure.restore(source)
    }
}
