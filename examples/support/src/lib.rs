//! What the examples, benches and tests share and what is no part of the library: the scene of the falling discs, bodies that are
//! and move as prescribed, flows with them; tables; the start-up theory that runs are compared with.

use std::process::ExitCode;

pub mod axes;
pub mod channel_cylinder;
pub mod coupled;
pub mod developed_duct;
pub mod duct_cylinder;
pub mod eccentric_cylinders;
pub mod files;
pub mod film;
pub mod forced_duct;
pub mod free_body;
pub mod free_stream;
pub mod granular;
pub mod moved_body;
pub mod periodic_cube;
pub mod plane_duct;
pub mod portrait_shape;
pub mod prescribed_bodies;
pub mod reference_curve;
pub mod rock;
pub mod scene;
pub mod settling_sphere;
pub mod sheared_body;
pub mod sinking_discs;
pub mod sliding_plate;
pub mod sphere_stream;
pub mod startup_theory;
pub mod steadily;
pub mod suspension;
pub mod table;
pub mod turbulent_flows;
pub mod turned_ducts;
pub mod unfolded;
pub mod wake;
pub mod walled_flows;

/// What may go wrong in an example or a bench.
pub type Outcome<T> = Result<T, Box<dyn std::error::Error + Send + Sync>>;

/// What an example's `main` answers; errors are told.
pub fn told(outcome: Outcome<()>) -> ExitCode {
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// A case of a bench and its name.
pub type Case<'a> = (&'a str, fn() -> Outcome<()>);

/// Runs the cases of a bench, on one thread: those named on the command line, or all.
///
/// # Errors
/// The first that a case has.
pub fn run_cases(cases: &[Case<'_>]) -> Outcome<()> {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    rayon::ThreadPoolBuilder::new().num_threads(1).build()?.install(|| {
        let mut chosen =
            cases.iter().filter(|(name, _)| wanted.is_empty() || wanted.iter().any(|w| w == name));
        chosen.try_for_each(|(_, case)| case())
    })
}
