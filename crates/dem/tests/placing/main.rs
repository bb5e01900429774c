//! Sizes, lattices, random addition and tables of bodies, as a user of the crate sees them.
mod lattices;
mod random_addition;
mod sizes;
mod table;
mod tight;
