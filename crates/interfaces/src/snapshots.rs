//! Who takes snapshots of a running simulation.
use std::error::Error;

/// Takes the snapshots of one quantity as they come: keeps them, or makes modes of them at once.
pub trait SnapshotSink {
    /// The `field` at `time` \[s\]; all have the same length.
    ///
    /// # Errors
    /// Why it cannot be taken; the run then ends with that error.
    fn push(&mut self, time: f64, field: &[f64]) -> Result<(), Box<dyn Error + Send + Sync>>;
}
