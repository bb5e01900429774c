//! Contact laws: the force that follows from an overlap.
mod chen;
mod friction;
mod law;
mod potential;
mod properties;
mod rolling;

pub use chen::Chen;
pub use law::{ContactLaw, Memory, Push, Touch};
pub use potential::Potential;
pub use properties::{Means, PairProperties};
pub use rolling::Rolling;
