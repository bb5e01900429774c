//! Shifted proper orthogonal decomposition of translations on periodic axes, by least squares in Fourier space.
//!
//! There T^s multiplies the coefficient of wave vector κ by e^(−iκ·s): each wave vector is a problem of its own.
mod als;
mod amplitudes;
mod batch;
mod centring;
mod cholesky;
mod compression;
mod descent;
mod escapes;
mod finish;
mod newton;
mod normal;
mod objective;
mod phases;
mod problem;
mod spectrum;

#[cfg(test)]
mod tests;

pub use als::Als;
pub(super) use als::{LONG, Patience, RIDGE};
pub use centring::centred;
pub(super) use centring::offsets;
pub(super) use cholesky::{factorise, substitute};
pub(super) use spectrum::Spectrum;
