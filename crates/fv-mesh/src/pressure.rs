//! The pressure equation of a flow and who solves it.
use crate::CartesianGrid;
use crate::boundary::{Boundaries, FaceKind};
use crate::poisson::multigrid::{MultigridCg, MultigridParams};
use crate::poisson::{AxisBounds, Poisson, PoissonAxis, PoissonChoice, PoissonError, PoissonInfo};

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

/// What multigrid to a tolerance of 10⁻⁶ costs per cell \[ns\], by `cargo bench -p fv-mesh --bench multigrid`.
const MULTIGRID_COST: f64 = 200.0;

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
        let kinds: [_; D] = std::array::from_fn(|a| boundaries.kinds(a));
        let given = |k: &FaceKind| *k == FaceKind::Pressure;
        let mut partial = None;
        let axes: [PoissonAxis; D] = std::array::from_fn(|a| {
            let ends = match &kinds[a] {
                None => AxisBounds::Periodic,
                Some(ends) => {
                    if ends.iter().any(|k| k.iter().any(given) && !k.iter().all(given)) {
                        partial = Some(a);
                    }
                    match ends.each_ref().map(|k| k.iter().all(given)) {
                        [false, false] => AxisBounds::Neumann,
                        [true, true] => AxisBounds::Dirichlet,
                        [false, true] => AxisBounds::NeumannDirichlet,
                        [true, false] => AxisBounds::DirichletNeumann,
                    }
                }
            };
            PoissonAxis::from_axis(grid.axis(a), ends)
        });
        let cost = PoissonChoice::new(&axes).nanoseconds_per_cell;
        let (params, why) = match (wanted, partial) {
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
                let solver = Poisson::new(axes, 0.0)?;
                let reason = format!("direct: {}", solver.choice());
                return Ok(Self {
                    solver: Solver::Direct(Box::new(solver)),
                    reason,
                    info: PoissonInfo::default(),
                });
            }
        };
        let params = MultigridParams { variable: params.variable || partial.is_some(), ..params };
        let mut solver = MultigridCg::new(axes, 0.0, params)?;
        if partial.is_some() {
            for (a, ends) in kinds.iter().enumerate() {
                for (upper, kinds) in ends.iter().flatten().enumerate() {
                    let zero: Vec<bool> = kinds.iter().map(given).collect();
                    solver.multigrid().set_ends(a, upper == 1, &zero)?;
                }
            }
        }
        let reason = format!("multigrid, {why}: {}", solver.describe());
        Ok(Self { solver: Solver::Multigrid(Box::new(solver)), reason, info: PoissonInfo::default() })
    }

    /// Solves for the right-hand side that `fill` makes row by row; `phi` holds the last correction and receives the new one.
    pub(crate) fn solve_rows<F>(&mut self, fill: F, phi: &mut [f64]) -> Result<(), PoissonError>
    where
        F: Fn(usize, &mut [f64]) + Sync,
    {
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
