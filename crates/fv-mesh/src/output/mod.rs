//! Files of cell fields for ParaView and everything else that reads VTK's XML formats.
mod arrays;
mod cells;
mod rectilinear;
mod series;
#[cfg(test)]
mod tests;
mod unstructured;

pub(crate) use arrays::Arrays;
pub use cells::CellWriter;
pub use interfaces::vtk::Precision;
pub(crate) use rectilinear::write_cells;
pub use series::TimeSeries;

use std::io;

/// Why a file could not be written.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// Values are missing or too many.
    #[error("the array \"{name}\" of {found} values (or more) for {expected} cells; give one value per cell")]
    Count {
        /// The array.
        name: String,
        /// Number of cells.
        expected: usize,
        /// Number of values per component; counting stops at one too many.
        found: usize,
    },
    /// A name is empty or taken.
    #[error("an array named \"{name}\"; give every array a name of its own")]
    Name {
        /// The name.
        name: String,
    },
    /// A finite value that single precision does not hold.
    #[error(
        "the value {value:e} in the array \"{name}\", beyond single precision; write it in double precision"
    )]
    Range {
        /// The array.
        name: String,
        /// The value.
        value: f64,
    },
    /// A series goes back in time.
    #[error("an entry at t = {time} s after one at {last} s in a series; list finite times in order")]
    Time {
        /// Time of the entry \[s\].
        time: f64,
        /// Time of the last entry \[s\].
        last: f64,
    },
    /// What the writer answered.
    #[error("writing output: {0} (choose a place that you may write to, with room on its disk)")]
    Io(#[from] io::Error),
}

impl From<OutputError> for io::Error {
    fn from(e: OutputError) -> Self {
        match e {
            OutputError::Io(e) => e,
            e => Self::new(io::ErrorKind::InvalidInput, e),
        }
    }
}
