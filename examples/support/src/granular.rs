//! Granular motion without flow: what the examples `settling`, `pouring`, `hopper` and `drum` share.
mod album;
mod grains;
mod law;
mod measures;
mod options;
mod place;
mod plates;
mod record;
pub mod report;
mod run;
mod scene;
mod squeeze;

pub use grains::{Grain, Kind};
pub use law::{Granulate, Law, Ways};
pub use measures::{GRAVITY, Totals, cone_slope, line, solid_fraction, totals};
pub use options::{GrainOptions, RunOptions};
pub use place::{Start, starts};
pub use plates::{Stave, ring_of_staves};
pub use record::History;
pub(crate) use run::fingerprint;
pub use run::{Ending, main_of, run};
pub use scene::Scene;
pub use squeeze::squeezed;
