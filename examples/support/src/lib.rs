//! What the examples, benches and tests share and what is no part of the library: the scene of the falling discs, bodies that
//! stand still and flows beside them; pictures, progress, tables, time and memory of the process; the start-up theory the runs are held against.

pub mod axes;
pub mod channel_cylinder;
pub mod cpu;
pub mod free_stream;
pub mod moved_body;
pub mod picture;
pub mod progress;
pub mod scene;
pub mod startup_theory;
pub mod still_bodies;
pub mod table;
pub mod walled_flows;

/// What may go wrong in an example or a bench.
pub type Outcome<T> = Result<T, Box<dyn std::error::Error + Send + Sync>>;
