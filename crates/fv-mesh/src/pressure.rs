//! The pressure equation of a flow and who solves it.
use crate::CartesianGrid;
use crate::boundary::{Boundaries, FaceKind};
use crate::poisson::multigrid::{MultigridCg, MultigridParams};
use crate::poisson::{AxisBounds, Poisson, PoissonAxis, PoissonChoice, PoissonError, PoissonInfo, Rows};

/// Solver of the pressure equation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum PressureSolver {
    /// The one that is expected to be fastest: the direct solver unless outlets of given pressure fill parts of sides
    /// only, or several long stretched axes make it dearer than multigrid.
    #[default]
    Auto,
    /// Transforms, products and sweeps, to round-off; see [`Poisson`].
    Direct,
    /// Conjugate gradients preconditioned by multigrid, to a tolerance.
    Multigrid(MultigridParams),
}

/// What multigrid to a tolerance of 10⁻⁶ costs per cell \[ns\], by `cargo bench -p siltflow-fv-mesh --bench multigrid`.
const MULTIGRID_COST: f64 = 200.0;

/// What holds for the pressure at the ends of the axes.
pub(crate) struct PressureEnds<const D: usize> {
    axes: [PoissonAxis; D],
    /// The first axis with a side of which only a part has a given pressure.
    partial: Option<usize>,
    /// Per bounded axis and side: where the pressure is given.
    given: [Option<[Vec<bool>; 2]>; D],
}

impl<const D: usize> PressureEnds<D> {
    pub(crate) fn new(grid: &CartesianGrid<D>, boundaries: &Boundaries<D>) -> Self {
        let given: [_; D] = std::array::from_fn(|a| {
            let given = |kinds: Vec<FaceKind>| kinds.into_iter().map(|k| k == FaceKind::Pressure).collect();
            Some(boundaries.kinds(a)?.map(given))
        });
        let all = |side: &Vec<bool>| side.iter().all(|&given| given);
        let axes = std::array::from_fn(|a| {
            let ends = match given[a].as_ref().map(|sides| sides.each_ref().map(all)) {
                None => AxisBounds::Periodic,
                Some([false, false]) => AxisBounds::Neumann,
                Some([true, true]) => AxisBounds::Dirichlet,
                Some([false, true]) => AxisBounds::NeumannDirichlet,
                Some([true, false]) => AxisBounds::DirichletNeumann,
            };
            PoissonAxis::from_axis(grid.axis(a), ends)
        });
        let partial =
            (0..D).find(|&a| given[a].iter().flatten().any(|side| side.contains(&true) && !all(side)));
        Self { axes, partial, given }
    }

    /// The solver that any ends can have.
    pub(crate) fn multigrid(self, params: MultigridParams) -> Result<MultigridCg<D>, PoissonError> {
        let params = MultigridParams { variable: params.variable || self.partial.is_some(), ..params };
        let mut solver = MultigridCg::new(self.axes, 0.0, params)?;
        if self.partial.is_some() {
            for (a, sides) in self.given.iter().enumerate() {
                for (upper, given) in sides.iter().flatten().enumerate() {
                    solver.multigrid().set_ends(a, upper == 1, given)?;
                }
            }
        }
        Ok(solver)
    }
}

/// The solver of one flow.
pub(crate) struct Pressure<const D: usize> {
    solver: Solver<D>,
    reason: String,
    info: PoissonInfo,
}

enum Solver<const D: usize> {
    Direct(Box<Poisson<D>>),
    Multigrid(Box<MultigridCg<D>>),
}

impl<const D: usize> Pressure<D> {
    /// # Errors
    /// [`PoissonError`] for parameters that make no sense, or a direct solver where only multigrid serves.
    pub(crate) fn new(
        grid: &CartesianGrid<D>,
        boundaries: &Boundaries<D>,
        wanted: PressureSolver,
    ) -> Result<Self, PoissonError> {
        let ends = PressureEnds::new(grid, boundaries);
        let cost = PoissonChoice::new(&ends.axes).nanoseconds_per_cell;
        let (params, why) = match (wanted, ends.partial) {
            (PressureSolver::Direct, Some(axis)) => return Err(PoissonError::PartialOutlet { axis }),
            (PressureSolver::Multigrid(params), _) => (params, "as asked".to_string()),
            (_, Some(axis)) => (
                MultigridParams::default(),
                format!("an outlet of given pressure on a part of a side of axis {axis}"),
            ),
            (PressureSolver::Auto, None) if cost > MULTIGRID_COST => (
                MultigridParams::default(),
                format!("the direct solver would take about {cost:.0} ns per cell"),
            ),
            (PressureSolver::Auto | PressureSolver::Direct, None) => {
                let solver = Poisson::new(ends.axes, 0.0)?;
                let reason = format!("direct: {}", solver.choice());
                return Ok(Self {
                    solver: Solver::Direct(Box::new(solver)),
                    reason,
                    info: PoissonInfo::default(),
                });
            }
        };
        let solver = ends.multigrid(params)?;
        let reason = format!("multigrid, {why}: {}", solver.describe());
        Ok(Self { solver: Solver::Multigrid(Box::new(solver)), reason, info: PoissonInfo::default() })
    }

    /// Solves for the right-hand side that `fill` makes row by row; `phi` holds the last correction and receives the new one.
    pub(crate) fn solve_rows(&mut self, fill: Rows<'_>, phi: &mut [f64]) -> Result<(), PoissonError> {
        self.info = match &mut self.solver {
            Solver::Direct(solver) => solver.solve_rows(fill, phi)?,
            Solver::Multigrid(solver) => solver.solve_rows(fill, phi, true)?,
        };
        Ok(())
    }

    /// Does a solution depend on the last one, where the iterations start?
    pub(crate) fn remembers(&self) -> bool {
        matches!(self.solver, Solver::Multigrid(_))
    }
    /// Which solver this is, and why.
    pub(crate) fn reason(&self) -> &str {
        &self.reason
    }
    /// What the last solve told.
    pub(crate) fn info(&self) -> PoissonInfo {
        self.info
    }
}
