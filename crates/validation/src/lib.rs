//! Cases whose solution is exact, measured or published: set-up as data, reference with its source,
//! for tests (coarse, with tolerances) and benches (fine, with tables).

pub mod axes;
pub mod bent_duct;
pub mod channel_cylinder;
pub mod developed_duct;
pub mod duct_cylinder;
pub mod eccentric_cylinders;
pub mod falling_discs;
pub mod film;
pub mod forced_duct;
pub mod free_body;
pub mod free_stream;
pub mod motion;
pub mod moved_body;
pub mod periodic_cube;
pub mod plane_duct;
pub mod prescribed_bodies;
pub mod reference_curve;
pub mod rock;
pub mod settling_sphere;
pub mod sheared_body;
pub mod sinking_discs;
pub mod sliding_plate;
pub mod sphere_stream;
pub mod turbulent_flows;
pub mod turned_ducts;
pub mod unfolded;
pub mod wake;
pub mod walled_flows;

/// Result of a case.
pub type Outcome<T> = Result<T, Box<dyn std::error::Error + Send + Sync>>;

/// Name and function of a bench's case.
pub type Case<'a> = (&'a str, fn() -> Outcome<()>);

/// Runs the cases of a bench, on one thread: those named on the command line, or all.
///
/// # Errors
/// The first error of a case.
pub fn run_cases(cases: &[Case<'_>]) -> Outcome<()> {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    rayon::ThreadPoolBuilder::new().num_threads(1).build()?.install(|| {
        let mut chosen =
            cases.iter().filter(|(name, _)| wanted.is_empty() || wanted.iter().any(|w| w == name));
        chosen.try_for_each(|(_, case)| case())
    })
}
