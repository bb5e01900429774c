//! One momentum equation after the other.
use super::{Implicit, MomentumSolver, Terms, assemble, fold_ends};
use crate::boundary::Boundaries;
use crate::kernels::{Advance, Momentum, add_eddy_stress, flux};
use crate::linear::StencilMatrix;
use crate::metrics::Metrics;
use crate::spans::Spans;
use crate::{CartesianGrid, Convection, Field, Fluid, walls};
use interfaces::Vector;

/// Makes and solves the equations of the velocity components in shared memory.
pub(crate) struct MomentumEquations<const D: usize> {
    grid: CartesianGrid<D>,
    metrics: Metrics<D>,
    fluid: Fluid,
    convection: Momentum<D>,
    implicit: Implicit,
    pub(crate) scheme: Convection,
    /// For the central scheme.
    central: Implicit,
    /// H, and memory for the sweep that makes it.
    tendency: Field<D>,
    scratch: Field<D>,
    sums: Vec<[f64; 2]>,
    /// Right-hand side of the equation made last.
    pub(crate) rhs: Vec<f64>,
    pub(crate) solver: MomentumSolver,
}

/// What differs from equation to equation.
#[derive(Clone, Copy)]
pub(crate) struct Equation<'a, const D: usize> {
    pub(crate) velocity: &'a [Field<D>; D],
    pub(crate) pressure: &'a Field<D>,
    /// u₁ and u₂ of the time derivative w₀ u + w₁ u₁ + w₂ u₂.
    pub(crate) history: [&'a Field<D>; 2],
    pub(crate) weights: [f64; 3],
    /// Body force per mass \[m/s²\].
    pub(crate) force: f64,
    /// What accelerates besides, at the nodes \[m/s²\].
    pub(crate) source: Option<&'a Field<D>>,
    /// Relaxation factor.
    pub(crate) relaxation: f64,
    /// Part of the viscous terms that relaxation counts.
    pub(crate) viscous_share: f64,
    pub(crate) eddy: Option<&'a Field<D>>,
}

impl<const D: usize> MomentumEquations<D> {
    /// `central` is what the matrix has of the central scheme; of the others it has the upwind part.
    pub(crate) fn new(
        grid: &CartesianGrid<D>,
        metrics: &Metrics<D>,
        fluid: Fluid,
        solver: MomentumSolver,
        central: Implicit,
    ) -> Self {
        let rows = grid.n_cells() / grid.cells()[0];
        Self {
            convection: Momentum::new(grid, metrics, Convection::Central),
            implicit: central,
            scheme: Convection::Central,
            central,
            tendency: Field::zeros(grid),
            scratch: Field::zeros(grid),
            sums: vec![[0.0; 2]; rows],
            rhs: vec![0.0; grid.n_cells()],
            grid: grid.clone(),
            metrics: metrics.clone(),
            fluid,
            solver,
        }
    }

    /// Momentum flux per area that convection and viscosity (per ν) carry through the edge of component c below node `o` along
    /// b, as in the right-hand side.
    pub(crate) fn edge_flux(
        &self,
        velocity: &[Field<D>; D],
        [c, b]: [usize; 2],
        o: usize,
        [i, j]: [usize; 2],
    ) -> [f64; 2] {
        flux(&self.convection, [velocity; 2], [c, b], o, [i, j])
    }

    /// Momentum of `velocity` per density and time that convection by `carrier` and viscosity (that of the fluid itself) carry through
    /// the bounded sides into the unknowns \[m⁴/s²\].
    pub(crate) fn side_flux(&self, carrier: &[Field<D>; D], velocity: &[Field<D>; D]) -> Vector {
        let (velocities, viscosity) = ([carrier, velocity], [self.fluid.viscosity; D]);
        let none = [0.0; D];
        walls::friction(&self.convection, &self.metrics, &self.grid, velocities, viscosity, none)[0]
    }

    /// H of the equation made last at the node with this storage index.
    pub(crate) fn tendency(&self, index: usize) -> f64 {
        self.tendency.data()[index]
    }

    /// Which sides follow a law of the wall, by axis and end.
    pub(crate) fn set_law(&mut self, law: [[bool; 2]; D]) {
        self.convection.set_law(law);
    }

    pub(crate) fn set_convection(&mut self, scheme: Convection) {
        let spans = std::mem::take(&mut self.convection.spans);
        self.convection = Momentum::new(&self.grid, &self.metrics, scheme);
        self.convection.spans = spans;
        self.scheme = scheme;
        self.implicit = if scheme == Convection::Central { self.central } else { Implicit::Upwind };
    }

    /// Outside of `spans` nothing is computed from now on.
    pub(crate) fn set_spans(&mut self, spans: &Spans) {
        self.convection.spans = spans.clone();
        self.tendency.data_mut().fill(0.0);
        self.rhs.fill(0.0);
    }

    /// Makes the equation of component `c`; gives Σ (|H| + |∂p/∂x_c|/ρ + |f|) V and Σ A_PP |u| V.
    pub(crate) fn make(
        &mut self,
        c: usize,
        e: Equation<D>,
        boundaries: &Boundaries<D>,
        matrix: &mut StencilMatrix<D>,
    ) -> [f64; 2] {
        let k = Advance {
            dt: 1.0,
            weights: [1.0, 0.0],
            explicit: [self.fluid.viscosity; D],
            implicit: [0.0; D],
            specific_volume: 0.0,
            force: 0.0,
        };
        self.convection.advance(c, k, e.velocity, e.pressure, &mut self.scratch, (&mut self.tendency, None));
        if let Some(eddy) = e.eddy {
            let place = (&self.grid, &self.metrics, &self.convection.spans);
            add_eddy_stress(place, c, e.velocity, eddy, &mut self.tendency);
        }
        if let Some(source) = e.source {
            let all = self.tendency.data_mut().iter_mut().zip(source.data());
            all.for_each(|(tendency, source)| *tendency += source);
        }
        let terms = Terms {
            velocity: e.velocity,
            tendency: &self.tendency,
            pressure: e.pressure,
            history: e.history,
            weights: e.weights,
            specific_volume: 1.0 / self.fluid.density,
            force: e.force,
            relaxation: 1.0 / e.relaxation,
            viscous_share: e.viscous_share,
            viscosity: self.fluid.viscosity,
            eddy: e.eddy,
            implicit: self.implicit,
        };
        let place = (&self.grid, &self.metrics, &self.convection.spans);
        assemble(place, c, terms, matrix, &mut self.rhs, &mut self.sums);
        fold_ends(&self.grid, boundaries, c, matrix);
        self.sums.iter().fold([0.0; 2], |sum, row| [sum[0] + row[0], sum[1] + row[1]])
    }
}
