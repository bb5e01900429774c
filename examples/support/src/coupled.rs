//! Bodies that move in a flow, from flags to files: what the examples `settling_sphere` and `drafting_kissing_tumbling` share.
mod album;
mod motion;
mod options;
mod run;
mod save;

pub use album::{Album, Slice, View};
pub use motion::{Diary, Motion, State};
pub use options::RunOptions;
pub use run::{Fall, Plan, Record, run};
