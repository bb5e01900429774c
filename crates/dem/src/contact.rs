//! Contact laws: the force that follows from an overlap.
mod chen;
mod friction;
mod gap;
mod law;
mod lubricated;
mod potential;
mod properties;
mod repulsive;
mod rolling;

pub use chen::Chen;
pub use friction::Springs;
pub use gap::{FilmForce, Gap};
pub use law::{ContactLaw, Memory, Pivot, Push, Touch};
pub(crate) use law::{LEAST_STEPS, stiffness_of_decay};
pub use lubricated::{Lubricated, WholeFilm};
pub use potential::Potential;
pub use properties::{Means, PairProperties};
pub use repulsive::Repulsive;
pub use rolling::Rolling;
