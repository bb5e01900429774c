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
pub use gap::{FilmForce, Gap};
pub use law::{ContactLaw, Memory, Push, Touch};
pub use lubricated::{Lubricated, WholeFilm};
pub use potential::Potential;
pub use properties::{Means, PairProperties};
pub use repulsive::Repulsive;
pub use rolling::Rolling;
