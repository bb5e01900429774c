//! Direct solvers of the discrete Poisson equation on boxes.
//!
//! [`DirectPoisson`] serves uniform boxes and [`SeparablePoisson`] those with cells stretched along any
//! axis; [`Poisson`] takes the faster one that serves. With cell-centred unknowns φ on `cells` cells of
//! size h_a along axis a, [`DirectPoisson`] solves
//!
//! ```text
//! Σ_a (φ_{i−1} − 2 φ_i + φ_{i+1}) / h_a² − s φ = f
//! ```
//!
//! in every cell, to round-off, where s is zero (Poisson) or a positive constant (Helmholtz). What
//! stands for φ outside the box follows [`AxisBounds`]. The unit of φ is that of f times m². Data are
//! dense with x fastest.
//!
//! All axes but the last are diagonalised by Fourier or cosine transforms; along the last one a
//! tridiagonal system is swept per mode. The cost is a few nanoseconds per cell.
//!
//! ```
//! use fv_mesh::poisson::{AxisBounds, DirectPoisson, PoissonSolver};
//! // Periodic along x, walls below and above: f(y) alone, so φ'' = f.
//! let mut poisson = DirectPoisson::new([8, 4], [0.1, 0.5], [AxisBounds::Periodic, AxisBounds::Neumann])?;
//! let mut phi: Vec<f64> = (0..32).map(|c| if c < 16 { 1.0 } else { -1.0 }).collect();
//! let info = poisson.solve(&mut phi)?;
//! assert!(info.removed_mean.abs() < 1e-15);
//! // The lowest row has one neighbour only: (φ₁ − φ₀) / h² = 1.
//! assert!(((phi[8] - phi[0]) / 0.25 - 1.0).abs() < 1e-13);
//! # Ok::<(), fv_mesh::poisson::PoissonError>(())
//! ```

mod aligned;
mod auto;
mod column;
mod direct;
mod layers;
mod modes;
pub mod multigrid;
mod poisson_axis;
mod separable;
#[cfg(test)]
mod tests;
mod transform;
mod tridiagonal;

pub use auto::{AxisMethod, Poisson, PoissonChoice, PoissonKind};
pub use direct::DirectPoisson;
pub use poisson_axis::PoissonAxis;
pub use separable::SeparablePoisson;

/// Makes rows of a right-hand side: `fill(r, row)`. Not a type parameter, so that the solvers are compiled once.
pub(crate) type Rows<'a> = &'a (dyn Fn(usize, &mut [f64]) + Sync);

/// Rows of a dense field with `n` cells along x.
fn rows_of(field: &[f64], n: usize) -> impl Fn(usize, &mut [f64]) + Sync {
    move |r, row| row.copy_from_slice(&field[r * n..][..n])
}

/// What holds at the two ends of an axis. "Low" and "high" order the ends along the axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisBounds {
    /// The box repeats itself.
    Periodic,
    /// Zero normal gradient at both end faces: the ghost value equals the inner one.
    Neumann,
    /// Zero value at both end faces: the ghost value is minus the inner one.
    Dirichlet,
    /// Zero gradient at the low face, zero value at the high face; in [`DirectPoisson`] on the last axis only.
    NeumannDirichlet,
    /// Zero value at the low face, zero gradient at the high face; in [`DirectPoisson`] on the last axis only.
    DirichletNeumann,
}

/// What a solve has to tell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PoissonInfo {
    /// Mean of f that was taken out before solving because no φ exists otherwise (all axes periodic
    /// or Neumann and no shift); zero when the equation has a solution for every f. Unit of f.
    pub removed_mean: f64,
    /// Iterations made; zero from a direct solver.
    pub iterations: usize,
    /// 2-norm of the residual over that of f, as an iterative solver measured it; zero from a direct solver.
    pub residual: f64,
}

/// Why a solver cannot be made or a solve was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PoissonError {
    /// An axis without cells.
    #[error("the box has no cells along axis {axis}; give every axis at least one cell")]
    NoCells {
        /// Axis, 0 for x.
        axis: usize,
    },
    /// A cell size that is not a length.
    #[error(
        "the cell size along axis {axis} is {spacing} m; it must be positive and finite, and so must its square"
    )]
    Spacing {
        /// Axis, 0 for x.
        axis: usize,
        /// Cell size \[m\].
        spacing: f64,
    },
    /// Differing ends on an axis that is solved by transforms.
    #[error(
        "axis {axis} has {bounds:?} ends; only the last axis may have ends that differ: \
         order the axes so that this one comes last"
    )]
    MixedEnds {
        /// Axis, 0 for x.
        axis: usize,
        /// Its bounds.
        bounds: AxisBounds,
    },
    /// A shift that makes the operator indefinite or is no number.
    #[error("the Helmholtz shift is {shift} 1/m²; it must be finite and not negative")]
    Shift {
        /// Shift \[1/m²\].
        shift: f64,
    },
    /// A slice of the wrong size.
    #[error(
        "the field has {length} values but the box has {cells} cells; give one value per cell, x fastest"
    )]
    Length {
        /// Values in the slice.
        length: usize,
        /// Cells in the box.
        cells: usize,
    },
    /// The eigenvalues of an axis could not be computed.
    #[error(
        "the eigenvalues of axis {axis} with {cells} cells could not be computed; \
         give its cells widths that differ less from each other"
    )]
    Eigen {
        /// Axis, 0 for x.
        axis: usize,
        /// Its cells.
        cells: usize,
    },
    /// Infinities or NaN in the right-hand side. The solution was not written.
    #[error(
        "the right-hand side sums to {sum} in layer {} (of the last axis): it holds a \
         value that is not finite, or too large to add up; look for the step where the fields it is made of diverged",
        if low == high { low.to_string() } else { format!("{low} or {high}") }
    )]
    NonFinite {
        /// One of the two layers that are transformed together.
        low: usize,
        /// The other one; the same if there is only one.
        high: usize,
        /// The sum found, of values or of absolute values.
        sum: f64,
    },
    /// A parameter of a solver that is too small or no number.
    #[error("the parameter {name} is {value}; it must be finite and at least {least}")]
    Parameter {
        /// Its name.
        name: &'static str,
        /// What was given; 1 for yes and 0 for no.
        value: f64,
        /// Least value allowed.
        least: f64,
    },
    /// A coefficient that makes the operator indefinite or is no number.
    #[error("the coefficient at face {face} of axis {axis} is {value}; it must be from 0 to 1e30")]
    Coefficient {
        /// Axis, 0 for x.
        axis: usize,
        /// Number of the face among those normal to the axis, x fastest.
        face: usize,
        /// Its coefficient.
        value: f64,
    },
    /// A wrong number of faces.
    #[error(
        "{length} values were given for the faces of axis {axis} but there are {faces}; give one per face, x fastest"
    )]
    Faces {
        /// Axis, 0 for x.
        axis: usize,
        /// Values given.
        length: usize,
        /// Faces that need one.
        faces: usize,
    },
    /// A direct solver for a side on a part of which the pressure is given.
    #[error(
        "the pressure is given on a part of a side of axis {axis}; the direct solver needs one condition per side: \
         take multigrid, or Auto"
    )]
    PartialOutlet {
        /// Axis, 0 for x.
        axis: usize,
    },
    /// An iterative solver ran out of iterations. The best φ found was written.
    #[error(
        "the residual is {residual:.3e} of the right-hand side after {iterations} iterations, above the \
         tolerance {tolerance:.3e}; allow more iterations or a larger tolerance"
    )]
    NotConverged {
        /// Iterations made.
        iterations: usize,
        /// 2-norm of the residual over that of f.
        residual: f64,
        /// What was asked for.
        tolerance: f64,
    },
    /// The equation at cells that immersed walls cut was not solved.
    #[error(
        "the pressure equation of the {cells} cells that immersed walls cut keeps a residual of \
         {residual:.3e} of its terms, above the tolerance {tolerance:.3e}; take cells there whose widths \
         differ less between axes, or finer ones"
    )]
    Walls {
        /// Cells with faces that are not wholly open.
        cells: usize,
        /// 2-norm of the residual over that of its terms.
        residual: f64,
        /// Largest residual allowed.
        tolerance: f64,
    },
}

/// A solver of the discrete Poisson equation, in place.
pub trait PoissonSolver<const D: usize>: Send {
    /// Replaces the right-hand side f by the solution φ; both are dense with x fastest.
    ///
    /// If the operator is singular, the mean of f is removed and reported, and φ has zero mean,
    /// both weighted with the volumes of the cells.
    ///
    /// # Errors
    ///
    /// [`PoissonError::Length`] and [`PoissonError::NonFinite`]; f is then left as it was.
    fn solve(&mut self, rhs_in_phi_out: &mut [f64]) -> Result<PoissonInfo, PoissonError>;
}
