//! The flow solver as its users see it: exact solutions, boundary conditions, stress.
mod boundaries;
mod exact;
mod norms;
mod stress;
