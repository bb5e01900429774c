//! The flow solver as its users see it: exact solutions, boundary conditions, stress.
mod boundaries;
mod exact;
mod hooks;
mod moving_walls;
mod norms;
mod outlet_friction;
mod stress;
mod wall_friction;
