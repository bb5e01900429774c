//! Tests across crates, in one binary.
mod bad_input;
mod bluff_body;
mod command;
mod edges;
mod files;
mod flow_alone;
mod frame;
mod free_bodies;
mod gap_sweep;
mod hooked;
mod immersed_scalar;
mod immersed_stress;
mod meshes;
mod moving;
mod moving_walls;
mod narrow_gaps;
mod passing_outlets;
mod physics;
mod plane_shapes;
mod population;
mod preset;
mod removal;
mod repeats;
mod report;
mod restart;
mod scenes;
mod skipping;
mod snapshots;
mod state;
mod steady_scalars;
mod steady_walls;
mod strategies;
mod stretched;
mod turbulence;
mod wall_rows;
mod walls;
mod window;

/// Runs `f` inside a pool of so many threads.
fn with_threads<R: Send>(threads: usize, f: impl FnOnce() -> R + Send) -> R {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool").install(f)
}
