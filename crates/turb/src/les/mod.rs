//! Sub-grid models for flows in space whose large eddies the grid resolves. Δ = V^⅓.
mod smagorinsky;
mod wale;

pub use smagorinsky::{Smagorinsky, SmagorinskyConstants};
pub use wale::{Wale, WaleConstants};

use interfaces::{SolveError, Transport};

/// # Errors
/// [`SolveError::Length`] for a model of another number of cells.
fn check(flow: &dyn Transport, found: usize) -> Result<(), SolveError> {
    let expected = flow.n_cells();
    if expected == found {
        return Ok(());
    }
    Err(SolveError::Length { what: "the sub-grid model", expected, found })
}
