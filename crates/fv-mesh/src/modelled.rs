//! Turbulence models in a flow.
use crate::diffusion::stiffness_of_cells;
use crate::metrics::Metrics;
use crate::transport::{CellTransport, WallFaces};
use crate::{CartesianGrid, EddyStress, Field, FlowError, Projection, Sides, TransportParams, Velocity};
use interfaces::{Bodies, Checkpoint, Closure, RestartError, SolveError, WallRow};

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
    /// Before a step, and when bodies in the flow have moved in it: for models that see them as walls. Unless told otherwise it is nothing.
    ///
    /// # Errors
    /// [`FlowError::Closure`].
    #[inline(always)]
    fn follow(&mut self, flow: &Projection<D>, bodies: &dyn Bodies) -> Result<(), FlowError> {
        let _ = (flow, bodies);
        Ok(())
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
    fn follow(&mut self, flow: &Projection<D>, bodies: &dyn Bodies) -> Result<(), FlowError> {
        self.as_mut().map_or(Ok(()), |model| model.follow(flow, bodies))
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
    /// Cells in which the momentum has ν_t of an immersed wall: cell, row among the immersed ones, share.
    film: Vec<(usize, usize, f64)>,
    /// ν_t of every cell as the momentum has it, where there is a film.
    filmed: Vec<f64>,
    /// Cells with their centre in a solid, ascending.
    solid: Vec<usize>,
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
            film: Vec::new(),
            filmed: Vec::new(),
            solid: Vec::new(),
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

    /// The stress of what the model says now in a fluid of this viscosity \[m²/s\], if there is any; `time` is for errors.
    ///
    /// # Errors
    /// [`FlowError::Closure`] for an eddy viscosity of another length than the grid.
    pub fn eddy_stress(&mut self, viscosity: f64, time: f64) -> Result<Option<&EddyStress<D>>, FlowError> {
        let given = self.refresh(viscosity, time)?;
        let on_walls = self.closure.wall_viscosity();
        let on_walls = &on_walls[..self.walls.rows().len().min(on_walls.len())];
        let rate = rate(&self.stiffness, self.seen_eddies(), on_walls);
        self.stress.iter_mut().for_each(|stress| stress.rate = rate);
        Ok(self.stress.as_ref().filter(|_| given))
    }

    /// Is there a film, and the model's ν_t on the walls under it?
    fn has_film(&self) -> bool {
        !self.film.is_empty() && self.closure.wall_viscosity().len() == self.rows.len()
    }

    /// ν_t of every cell as the momentum had it last.
    fn seen_eddies(&self) -> &[f64] {
        if self.has_film() { &self.filmed } else { self.closure.eddy_viscosity().unwrap_or_default() }
    }

    /// Makes the stress of what the model says now, all but its rate. Is there any?
    pub(crate) fn refresh(&mut self, viscosity: f64, time: f64) -> Result<bool, FlowError> {
        let Some(mut eddy) = self.closure.eddy_viscosity() else { return Ok(false) };
        let (grid, on_walls) = (self.transport.grid(), self.closure.wall_viscosity());
        let failed = |what, expected, found| {
            Err(FlowError::Closure { time, source: SolveError::Length { what, expected, found } })
        };
        self.walls.move_to(time);
        if eddy.len() != grid.n_cells() {
            return failed("the eddy viscosity", grid.n_cells(), eddy.len());
        }
        let rows = self.walls.rows().len();
        if self.has_film() {
            self.filmed.clear();
            self.filmed.extend_from_slice(eddy);
            for &(cell, row, share) in &self.film {
                // Layers behind one another.
                let (wall, own) = (viscosity + on_walls[rows + row], viscosity + eddy[cell]);
                self.filmed[cell] = wall * own / (share * own + (1.0 - share) * wall) - viscosity;
            }
            eddy = &self.filmed;
        }
        // Before the first update behind a restart rows are not listed: the model has ν_t of all.
        let known = on_walls.len() == self.rows.len() || self.rows.is_empty();
        let on_walls = if known { &on_walls[..rows.min(on_walls.len())] } else { on_walls };
        if !on_walls.is_empty() && on_walls.len() != rows {
            return failed("the eddy viscosity on walls", rows, on_walls.len());
        }
        let stress = self.stress.get_or_insert_with(|| EddyStress::of(Field::zeros(grid)));
        self.transport.spread(eddy, &mut stress.eddy);
        if on_walls.is_empty() {
            stress.friction.iter_mut().for_each(Vec::clear);
            stress.walls.clear();
        } else {
            self.walls.rub(on_walls, viscosity, stress);
            self.transport.wrap(&mut stress.eddy);
        }
        Ok(true)
    }

    /// Bodies that a forcing moves are somewhere else, with these `rows` beside them, which have k. `film` lists cells in which the momentum
    /// has ν_t of a wall: cell, row, and the share in 0 … 1.
    ///
    /// # Errors
    /// [`FlowError::Closure`] for rows, cells and shares that make no sense.
    pub fn see_walls(
        &mut self,
        flow: &Projection<D>,
        rows: &[WallRow],
        film: &[(usize, usize, f64)],
    ) -> Result<(), FlowError> {
        let (n, viscosity, time) = (self.transport.grid().n_cells(), flow.fluid().viscosity, flow.time());
        let failed = |source| FlowError::Closure { time, source };
        if let Some(&(cell, row, share)) = film
            .iter()
            .find(|(cell, row, share)| *cell >= n || *row >= rows.len() || !(0.0..=1.0).contains(share))
        {
            let (what, range) = ("the share of a film", "in 0 … 1, in a cell of the flow, of a row");
            let value = if row < rows.len() { share } else { row as f64 };
            return Err(failed(SolveError::Value { what, cell: Some(cell), value, range }));
        }
        self.film.clear();
        self.film.extend_from_slice(film);
        self.list_rows(flow.velocity(), rows, viscosity, time);
        self.closure.see_walls(&self.rows, viscosity).map_err(failed)
    }

    /// Cells `solid`, in ascending order, have their centre in a solid from now on. What has come out of one takes its state from the cells beside it that
    /// have not.
    ///
    /// # Errors
    /// [`FlowError::Closure`] for a cell that is none, or out of order.
    pub fn immerse(&mut self, solid: &[usize], time: f64) -> Result<(), FlowError> {
        if solid == self.solid {
            self.closure.immerse(solid, &[]);
            return Ok(());
        }
        let n = self.transport.grid().n_cells();
        let wrong = (0..solid.len()).find(|&i| solid[i] >= n || i > 0 && solid[i] <= solid[i - 1]);
        if let Some(cell) = wrong.map(|i| solid[i]) {
            let (what, range) =
                ("the number of a cell in a solid", "a cell of the flow, beyond the one before it");
            let source = SolveError::Value { what, cell: Some(cell), value: cell as f64, range };
            return Err(FlowError::Closure { time, source });
        }
        let holds = |cells: &[usize], cell: usize| cells.binary_search(&cell).is_ok();
        let came_out = self.solid.iter().filter(|&&cell| !holds(solid, cell));
        let fresh: Vec<_> = came_out
            .map(|&cell| {
                let mut from = self.transport.around(cell);
                from.retain(|&c| !holds(solid, c) && !holds(&self.solid, c));
                (cell, from)
            })
            .collect();
        self.closure.immerse(solid, &fresh);
        self.wall_off(solid.to_vec());
        Ok(())
    }

    /// Brings the model up to date with the flow after a step of `dt` \[s\]; `immersed` are the rows beside bodies that a forcing moves.
    ///
    /// # Errors
    /// [`FlowError::Closure`].
    pub fn correct_beside(
        &mut self,
        flow: &Projection<D>,
        immersed: &[WallRow],
        dt: f64,
    ) -> Result<(), FlowError> {
        self.update(flow.velocity(), immersed, flow.fluid().viscosity, flow.time(), Some(dt))
    }

    /// The rows of the box's walls, and immersed ones.
    fn list_rows(&mut self, velocity: &Velocity<D>, immersed: &[WallRow], viscosity: f64, time: f64) {
        self.walls.move_to(time);
        let rows = self.walls.fill(velocity, self.closure.kinetic_energy(), viscosity);
        self.rows.clear();
        self.rows.extend(rows.iter().chain(immersed));
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
        self.list_rows(velocity, immersed, viscosity, time);
        self.transport.see_layers(self.closure.kinetic_energy(), viscosity);
        let mut cells = self.transport.on(velocity)?;
        let corrected = self.closure.correct(&mut cells, &self.rows, viscosity, dt);
        corrected.map_err(|source| FlowError::Closure { time, source })
    }
}

impl<const D: usize, C: Closure> ClosureSlot<D> for Modelled<D, C> {
    fn stress(&mut self, flow: &Projection<D>) -> Result<Option<&EddyStress<D>>, FlowError> {
        self.eddy_stress(flow.fluid().viscosity, flow.time())
    }
    fn correct(&mut self, flow: &Projection<D>, dt: f64) -> Result<(), FlowError> {
        self.correct_beside(flow, &[], dt)
    }
    fn fastest(&self) -> f64 {
        let eddy = self.closure.eddy_viscosity().unwrap_or_default();
        rate(&self.stiffness, eddy, self.closure.wall_viscosity())
    }
}

impl<const D: usize, C> Modelled<D, C> {
    /// Takes cells in solids out of the equations.
    fn wall_off(&mut self, solid: Vec<usize>) {
        self.transport.set_walls(solid.iter().map(|&cell| (cell, Vec::new())).collect(), true);
        self.solid = solid;
    }
}

/// The model's state, and the cells in solids that it knows of.
impl<const D: usize, C: Checkpoint> Checkpoint for Modelled<D, C> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        self.closure.save(sink);
        if !self.solid.is_empty() {
            sink("solid", &self.solid.iter().map(|&cell| cell as f64).collect::<Vec<_>>());
        }
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.closure.restore(source)?;
        let n = self.transport.grid().n_cells();
        let solid: Vec<usize> =
            source("solid").unwrap_or_default().iter().map(|&cell| cell as usize).collect();
        if solid.last().is_some_and(|&last| last >= n) || !solid.is_sorted() {
            return Err(RestartError::Differs("solid".into()));
        }
        if solid != self.solid {
            self.wall_off(solid);
        }
        Ok(())
    }
}
