//! What can go wrong.
use std::io;
use std::path::{Path, PathBuf};

/// Why snapshots could not be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SnapshotError {
    /// The file system.
    #[error("{}: {why}", path.display())]
    Io {
        /// Of the file.
        path: PathBuf,
        /// Of the failure.
        kind: io::ErrorKind,
        /// In words.
        why: String,
    },
    /// The file ends before its data do.
    #[error("{}: {what} takes {expected} bytes, of which {found} are there: the file was cut short; write it again", path.display())]
    Truncated {
        /// Of the file.
        path: PathBuf,
        /// Which data.
        what: String,
        /// How many bytes there must be.
        expected: u64,
        /// How many there are.
        found: u64,
    },
    /// Numbers of a type that is not read.
    #[error("{}: {what} holds numbers of type `{found}`; real numbers of 32 or 64 bits are read (float32, float64)", path.display())]
    DataType {
        /// Of the file.
        path: PathBuf,
        /// Which array.
        what: String,
        /// Its type, as the file says.
        found: String,
    },
    /// The file is not what its header should say, or damaged.
    #[error("{}: {why}", path.display())]
    Format {
        /// Of the file.
        path: PathBuf,
        /// In words.
        why: String,
    },
    /// An array has another number of values than it must have.
    #[error("{}: {what} has {found} values where {expected} are needed", path.display())]
    Shape {
        /// Of the file.
        path: PathBuf,
        /// Which array.
        what: String,
        /// How many there must be.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// The axes of an array are not in the order of a grid's cells.
    #[error("{}: cells {cells:?}, x fastest, are needed; {found}: {remedy}", path.display())]
    CellOrder {
        /// Of the file.
        path: PathBuf,
        /// Cells along x, y, z.
        cells: Vec<usize>,
        /// Shape of the array, and lengths of the axes that make the rows from the fastest.
        found: String,
        /// Remedy.
        remedy: String,
    },
    /// There is no array of that name.
    #[error("{}: there is no array `{name}`; there are {there:?}", path.display())]
    NoArray {
        /// Of the file.
        path: PathBuf,
        /// Asked for.
        name: String,
        /// Names of those that are there.
        there: Vec<String>,
    },
    /// A part of a matrix that it does not have.
    #[error(
        "rows {rows:?} of snapshots {snapshots:?} were asked for; there are {there:?} rows and snapshots"
    )]
    Outside {
        /// First and one past the last.
        rows: [usize; 2],
        /// First and one past the last.
        snapshots: [usize; 2],
        /// Rows and snapshots of the matrix.
        there: [usize; 2],
    },
}

impl SnapshotError {
    pub(super) fn io(path: &Path, source: &io::Error) -> Self {
        Self::Io { path: path.into(), kind: source.kind(), why: source.to_string() }
    }
    pub(super) fn format(path: &Path, why: impl Into<String>) -> Self {
        Self::Format { path: path.into(), why: why.into() }
    }
}
