//! What a closure (a turbulence model) may ask of a flow solver, and what the solver gets from it.
use crate::WallRow;
use std::fmt;
use std::ops::Range;

/// One convection–diffusion–reaction equation for values φ at the cells, dense, x fastest:
///
/// ```text
/// ∂φ/∂t + ∇·(uφ) − ∇·(Γ∇φ) + sink φ = source
/// ```
///
/// On inlets φ = `inlet`; on walls φ = `wall` or, without one, ∂φ/∂n = 0; on all other sides (outlets, planes of symmetry)
/// ∂φ/∂n = 0.
#[derive(Clone, Copy, Debug)]
pub struct Equation<'a> {
    /// Γ of every cell \[m²/s\], not negative.
    pub diffusivity: &'a [f64],
    /// What is produced in every cell per volume and time.
    pub source: &'a [f64],
    /// Rate at which φ is consumed in every cell \[1/s\], not negative: taken implicitly, so that a source that is
    /// not negative keeps φ so.
    pub sink: &'a [f64],
    /// Cells whose φ is given, and its value: their rows of the matrix become φ = value.
    pub pinned: &'a [(usize, f64)],
    /// Cells, weights w in 0 … 1 and values: their rows become (1 − w)·row + w a_P (φ − value), a_P the row's diagonal.
    pub blend: &'a [(usize, f64, f64)],
    /// φ on inlets.
    pub inlet: f64,
    /// φ on walls; `None` for ∂φ/∂n = 0.
    pub wall: Option<f64>,
    /// Time step \[s\], implicit Euler from the φ given; `None` for the steady equation.
    pub dt: Option<f64>,
    /// φ goes like 1/y near walls at distance y, as ω and ε do: what is smooth there is φy.
    pub inverse: bool,
    /// Cells, and shares in 0 … 1, in which φ goes like 1/y², as ω does in a viscous sublayer: between their centres 1/√φ is linear instead of
    /// φ, and what is consumed goes with φ² (the sink with φ).
    pub steep: &'a [(usize, f64)],
    /// Under-relaxation α in (0, 1] towards the φ given (Patankar 1980); 1 is none.
    pub relax: f64,
}

impl<'a> Equation<'a> {
    /// The steady one with nothing given, none flowing in, and no relaxation.
    pub fn new(diffusivity: &'a [f64], source: &'a [f64], sink: &'a [f64]) -> Self {
        Self {
            diffusivity,
            source,
            sink,
            pinned: &[],
            blend: &[],
            inlet: 0.0,
            wall: None,
            dt: None,
            inverse: false,
            steep: &[],
            relax: 1.0,
        }
    }
}

/// What a solve did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolveInfo {
    /// Iterations of the linear solver.
    pub iterations: usize,
    /// Relative residual of the φ given: how far the equations were from being met.
    pub initial_residual: f64,
    /// Relative residual of the φ found.
    pub residual: f64,
}

/// A cell in which |S| is a part of what differences say, if the layer there is logarithmic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogSlope {
    /// The cell.
    pub cell: usize,
    /// Its distance from the nearest wall \[m\].
    pub distance: f64,
    /// The part, at most 1.
    pub part: f64,
}

/// A flow on cells, as a closure sees it. All slices have one entry per cell.
pub trait Transport {
    /// Number of cells.
    fn n_cells(&self) -> usize;
    /// Volume of cell `c` \[m³\] (area in a plane flow).
    ///
    /// # Panics
    /// If there is no such cell.
    fn cell_volume(&self, c: usize) -> f64;
    /// Runs of cells in which something happens, in ascending order: what is computed in others, deep in solids, nobody looks at. `None`: all.
    fn runs(&self) -> Option<&[Range<usize>]> {
        None
    }
    /// Distance of every cell's centre from the nearest wall \[m\]; infinite without walls.
    fn wall_distance(&self) -> &[f64];
    /// |S| = √(2 S:S) \[1/s\], S = ½(∇u + ∇uᵀ), at the cells' centres.
    ///
    /// # Errors
    /// [`SolveError::Length`].
    fn strain_rate(&mut self, out: &mut [f64]) -> Result<(), SolveError>;
    /// Cells near walls in which differences between cells find a logarithmic layer too steep.
    fn log_slopes(&mut self) -> &[LogSlope] {
        &[]
    }
    /// ∂u_a/∂x_b \[1/s\] at the cells' centres in `out[cell][a][b]`; zero along axes that the flow does not have.
    ///
    /// # Errors
    /// [`SolveError::Length`].
    fn velocity_gradient(&mut self, out: &mut [[[f64; 3]; 3]]) -> Result<(), SolveError>;
    /// ∇a·∇b at the cells' centres, one-sided beside the sides of the flow.
    ///
    /// # Errors
    /// [`SolveError::Length`].
    fn dot_gradients(&mut self, a: &[f64], b: &[f64], out: &mut [f64]) -> Result<(), SolveError>;
    /// Solves `equation` for `phi`, which comes in as the last iterate (and the value one step ago).
    ///
    /// # Errors
    /// [`SolveError`]; `phi` is then unspecified but for [`SolveError::NotConverged`], which leaves the last iterate.
    fn solve(&mut self, equation: &Equation<'_>, phi: &mut [f64]) -> Result<SolveInfo, SolveError>;
}

/// A model for what the flow does not resolve. `()` is none.
pub trait Closure: Send {
    /// ν_t of every cell \[m²/s\]; `None` if there is none.
    fn eddy_viscosity(&self) -> Option<&[f64]>;
    /// Turbulence kinetic energy of every cell \[m²/s²\], for the rows of the walls; `None` if there is none.
    fn kinetic_energy(&self) -> Option<&[f64]> {
        None
    }
    /// ν_t on the wall of every row that was last given \[m²/s\], so that the wall's friction is τ_w/ρ = (ν + ν_t) u_t/y. With none
    /// the fluid sticks to walls as it does without a closure.
    fn wall_viscosity(&self) -> &[f64] {
        &[]
    }
    /// Does it want to be told of walls inside the flow? If not, [`immerse`](Self::immerse) and [`see_walls`](Self::see_walls) need not be called.
    fn wants_walls(&self) -> bool {
        false
    }
    /// Walls inside the flow are somewhere else: cells `solid` have their centre in one now, those of `fresh` have come out of one, and
    /// take their state from the cells given with each.
    fn immerse(&mut self, solid: &[usize], fresh: &[(usize, Vec<usize>)]) {
        let _ = (solid, fresh);
    }
    /// Brings [`wall_viscosity`](Self::wall_viscosity) up to date with these rows and their k, all else being as it is.
    ///
    /// # Errors
    /// [`SolveError::Value`] for rows that make no sense.
    fn see_walls(&mut self, walls: &[WallRow], nu: f64) -> Result<(), SolveError> {
        let _ = (walls, nu);
        Ok(())
    }
    /// What it remembers of every cell, one list after the other, for the same model on another grid to start from; nothing unless told
    /// otherwise.
    fn cell_state(&self) -> Vec<&[f64]> {
        Vec::new()
    }
    /// Starts from these lists, in the order of [`cell_state`](Self::cell_state).
    ///
    /// # Errors
    /// [`SolveError`] for lists of another length, or with values that make no sense.
    fn set_cell_state(&mut self, state: &[Vec<f64>]) -> Result<(), SolveError> {
        let _ = state;
        Ok(())
    }
    /// How far the model's own equations were from being met by what the last call found: their largest relative residual.
    fn residual(&self) -> f64 {
        0.0
    }
    /// Brings the model up to date with the flow, whose kinematic viscosity is `nu` \[m²/s\] and whose walls are `walls`; `dt` \[s\]
    /// is the step, or `None` for a steady iteration. A cell beside several walls has several rows.
    ///
    /// # Errors
    /// Those of [`Transport`].
    fn correct(
        &mut self,
        flow: &mut dyn Transport,
        walls: &[WallRow],
        nu: f64,
        dt: Option<f64>,
    ) -> Result<(), SolveError>;
}

impl Closure for () {
    #[inline(always)]
    fn eddy_viscosity(&self) -> Option<&[f64]> {
        None
    }
    #[inline(always)]
    fn correct(
        &mut self,
        _: &mut dyn Transport,
        _: &[WallRow],
        _: f64,
        _: Option<f64>,
    ) -> Result<(), SolveError> {
        Ok(())
    }
}

impl<C: Closure + ?Sized> Closure for Box<C> {
    fn eddy_viscosity(&self) -> Option<&[f64]> {
        (**self).eddy_viscosity()
    }
    fn kinetic_energy(&self) -> Option<&[f64]> {
        (**self).kinetic_energy()
    }
    fn wall_viscosity(&self) -> &[f64] {
        (**self).wall_viscosity()
    }
    fn wants_walls(&self) -> bool {
        (**self).wants_walls()
    }
    fn immerse(&mut self, solid: &[usize], fresh: &[(usize, Vec<usize>)]) {
        (**self).immerse(solid, fresh);
    }
    fn see_walls(&mut self, walls: &[WallRow], nu: f64) -> Result<(), SolveError> {
        (**self).see_walls(walls, nu)
    }
    fn cell_state(&self) -> Vec<&[f64]> {
        (**self).cell_state()
    }
    fn set_cell_state(&mut self, state: &[Vec<f64>]) -> Result<(), SolveError> {
        (**self).set_cell_state(state)
    }
    fn residual(&self) -> f64 {
        (**self).residual()
    }
    fn correct(
        &mut self,
        flow: &mut dyn Transport,
        walls: &[WallRow],
        nu: f64,
        dt: Option<f64>,
    ) -> Result<(), SolveError> {
        (**self).correct(flow, walls, nu, dt)
    }
}

/// Why an equation could not be solved.
#[derive(Clone, Debug, PartialEq)]
pub enum SolveError {
    /// A slice of the wrong length.
    Length {
        /// Which one.
        what: &'static str,
        /// Cells of the flow.
        expected: usize,
        /// Its length.
        found: usize,
    },
    /// A number that makes no sense.
    Value {
        /// Which one.
        what: &'static str,
        /// The cell, if it belongs to one.
        cell: Option<usize>,
        /// What it is.
        value: f64,
        /// What it has to be.
        range: &'static str,
    },
    /// The linear solver did not reach its tolerance.
    NotConverged {
        /// Iterations made.
        iterations: usize,
        /// Relative residual reached.
        residual: f64,
        /// Relative residual asked for.
        tolerance: f64,
    },
    /// The linear solver broke down; the message says how.
    Solver(String),
}

impl fmt::Display for SolveError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length { what, expected, found } => {
                write!(f, "{what} has {found} entries for {expected} cells; give one per cell")
            }
            Self::Value { what, cell: Some(cell), value, range } => {
                write!(f, "{what} of cell {cell} is {value}; it must be {range}")
            }
            Self::Value { what, cell: None, value, range } => {
                write!(f, "{what} is {value}; it must be {range}")
            }
            Self::NotConverged { iterations, residual, tolerance } => write!(
                f,
                "the residual is {residual:.3e} after {iterations} iterations, above the tolerance {tolerance:.3e}; \
                 allow more iterations, or relax more"
            ),
            Self::Solver(message) => f.write_str(message),
        }
    }
}
impl std::error::Error for SolveError {}
