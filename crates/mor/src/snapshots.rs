//! Snapshots from files, whether or not they fit into memory.
//!
//! A [`SnapshotSource`] is a matrix with one column per snapshot of which any part can be read: NumPy's [`NpyArray`] (alone or from an [`NpzFile`]), the files of a
//! run that a `.pvd` lists ([`VtkSeries`]), or a matrix in memory. [`to_mat`](SnapshotSource::to_mat) reads it whole;
//! [`Pod::of`](crate::pod::Pod::of) makes modes of it in two passes, [`StreamingPod`](crate::pod::StreamingPod) in one. [`NpyWriter`] writes such files while a run goes on.
//!
//! ```no_run
//! use mor::pod::{Pod, PodParams};
//! use mor::snapshots::{NpyArray, SnapshotAxis, VtkSeries};
//! let file = NpyArray::open("velocity.npy", SnapshotAxis::Last)?;
//! let pod = Pod::of(&file, &PodParams::of_rank(20))?;
//! let run = VtkSeries::open("out/falling_discs/fields.pvd", "lambda")?;
//! println!("{} snapshots up to {:?} s", run.times().len(), run.times().last());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
mod base64;
mod cell_order;
mod error;
mod npy;
mod npy_writer;
mod npz;
mod series;
mod source;
#[cfg(test)]
mod tests;
mod vtk;
mod xml;

pub use error::SnapshotError;
pub use npy::{NpyArray, SnapshotAxis};
pub use npy_writer::NpyWriter;
pub use npz::NpzFile;
pub use series::VtkSeries;
pub use source::SnapshotSource;
pub use vtk::{VtkArray, VtkFile};
