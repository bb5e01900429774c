//! Where bodies start: how large they are ([`SizeDistribution`]), where they stand in order ([`CrystalLattice`]) or at random without
//! overlap ([`RandomAddition`]), how they are turned ([`Orientations`]), and tables of them ([`read_bodies`], [`write_bodies`]).
//!
//! All of it makes sizes, shapes' [`Pose`](interfaces::Pose)s and twists; adding the bodies to [`RigidBodies`](crate::RigidBodies) is left to
//! the caller. What is drawn depends on the seed only, bit for bit on any machine: numbers come from PCG64 and are shaped by functions of
//! `libm`, not by those of the operating system.
//!
//! ```
//! use dem::placing::{RandomAddition, Region, SizeDistribution};
//! use dem::{Shape, Sphere};
//! use dem::{Aabb, Vector};
//! use std::f64::consts::PI;
//!
//! // Grains of 1 to 4 mm fill a tenth of a periodic box of 40 mm.
//! let grains = SizeDistribution::log_normal(2e-3, 1.4, [1e-3, 4e-3])?;
//! let sizes = grains.until(0.1 * 0.04_f64.powi(3), |d| PI / 6.0 * d * d * d, 7)?;
//! let spheres = sizes.iter().map(|d| Sphere::new(0.5 * d)).collect::<Result<Vec<_>, _>>()?;
//! let shapes: Vec<&dyn Shape> = spheres.iter().map(|s| s as _).collect();
//! let region = Region::cuboid(Aabb { min: [0.0; 3].into(), max: [0.04; 3].into() }, [true; 3])?;
//! let poses = RandomAddition::new(region).with_gap(1e-4)?.place(&shapes, 7)?;
//! assert_eq!(poses.len(), spheres.len());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
mod apart;
mod body_table;
mod crystal_lattice;
mod error;
mod grid;
mod orientations;
mod random_addition;
mod region;
mod size_distribution;
mod source;

/// Points and bodies that are made at once, at most: several gigabytes as bodies.
const MOST: usize = 10_000_000;

pub use body_table::{BodyRow, BodyTableError, read_bodies, write_bodies};
pub use crystal_lattice::{CrystalLattice, LatticeKind};
pub(crate) use error::not_negative;
pub use error::{Jammed, PlacingError};
pub use orientations::Orientations;
pub use random_addition::RandomAddition;
pub use region::Region;
pub use size_distribution::{Basis, SizeDistribution};
