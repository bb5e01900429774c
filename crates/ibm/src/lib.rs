//! Solids in a flow that is computed on a grid which does not know them: the solid fraction λ
//! ([`SolidFraction`]), and the forcing f_ib that makes the fluid move with the solid inside and
//! at its surface (Isoz et al. 2023, equations 1–2), in two forms behind one trait [`Forcing`]:
//!
//! * [`Hfdib`]: the paper's hybrid fictitious domain–immersed boundary method: cells with λ > 0
//!   are forced, those at the surface to a quadratic reconstruction along the surface normal
//!   (figure 3);
//! * [`SmoothForcing`]: forces on surface markers spread by a smooth kernel: for bodies that move.
//!
//! Bodies at rest may be walls of the flow itself instead: [`cut_walls`] tells where they cut links and faces of the grid, and
//! a flow that takes [`CutWalls`] is of second order up to them.
//!
//! [`SurfaceStress`] tells pressure and friction on surfaces from the fields beside them. [`ImmersedScalar`] holds scalars to values or
//! gradients given on bodies ([`Reconstruction`] is what both it and `Hfdib` use), [`Pockets`] finds fluid that bodies
//! have closed in.
//!
//! [`SmoothFilm`] tells what the flow leaves of thin films between bodies to a model of lubrication.
//!
//! Turbulence models get the distance from bodies and walls from [`WallDistance`], and what wall functions need beside bodies
//! from [`WallRows`]; beside bodies that a smooth forcing moves, all of it from [`NearWalls`].
//!
//! The crate works on any [`VelocityField`] and any [`Bodies`].
//!
//! ```
//! use ibm::{Aabb, Lattice, Nodes, Point, Pose, Solid, SolidFraction, StaticBodies, Vector};
//! struct Disc(f64);
//! impl Solid for Disc {
//!     fn signed_distance(&self, x: Point, _: f64) -> f64 {
//!         x.x.hypot(x.y) - self.0
//!     }
//!     fn aabb(&self) -> Aabb {
//!         Aabb::around(Point::origin(), Vector::new(self.0, self.0, 0.0))
//!     }
//! }
//! // The centres of 40 × 40 cells of a unit square, walls around.
//! let centres = || Nodes::uniform(0.0125, 0.025, 40, false);
//! let lattice = Lattice::new([centres(), centres()], 0, [1, 40]);
//! let bodies = StaticBodies::new().with(Disc(0.3), Pose::at([0.5, 0.5, 0.0]));
//! let (mut fraction, mut lambda) = (SolidFraction::new(), vec![0.0; 1600]);
//! fraction.update(&lattice, &bodies)?;
//! fraction.add_to_dense(&lattice, &mut lambda);
//! let area = lambda.iter().sum::<f64>() / 1600.0;
//! assert!((area / (std::f64::consts::PI * 0.09) - 1.0).abs() < 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![doc(html_root_url = "https://docs.rs/siltflow-ibm/latest")]
#![deny(missing_docs)]

mod clip;
mod control_volume;
mod crowd;
mod cut_cells;
mod cut_link;
mod error;
mod film;
mod fluid_sampler;
mod forcing;
mod fraction;
mod hfdib;
mod immersed_scalar;
mod kernel;
mod near_walls;
mod neighbour;
mod pockets;
mod polynomial;
mod profile;
mod projection;
mod reconstruction;
mod smooth;
mod solid_fraction;
mod static_bodies;
mod subcells;
mod surface;
mod surface_flux;
mod surface_stress;
#[cfg(test)]
mod testing;
mod vicinity;
mod wall_distance;
mod wall_rows;

pub use control_volume::ControlVolume;
pub use cut_cells::cut_cells;
pub use cut_link::cut_walls;
pub use error::IbmError;
pub use film::SmoothFilm;
pub use fluid_sampler::FluidSampler;
pub use forcing::{Forcing, Layer, ViscousStep};
pub use fraction::{cell_fraction, plane_fraction};
pub use hfdib::Hfdib;
pub use immersed_scalar::ImmersedScalar;
pub use interfaces::{
    Aabb, Bodies, BodyId, Closure, CutCells, CutComponent, CutFace, CutNode, CutWalls, Equation, Freedom,
    Inertia, Kinematics, LENGTH_PRECISION, Lattice, Link, LogSlope, Nodes, OpenFace, Periods, Point,
    Polyhedron, Pose, Renumbering, Rotation, Solid, SolidPoint, SolveError, SolveInfo, SurfaceElement,
    ThinPart, Transport, Twist, UnresolvedFilm, Vector, VelocityField, WallPiece, WallPoint, WallRow, Wrench,
};
pub use kernel::{Kernel, WIDEST};
pub use nalgebra;
pub use near_walls::NearWalls;
pub use pockets::{Pocket, Pockets};
pub use profile::{Given, Profile, Weights};
pub use reconstruction::{FluidPoint, Reconstruction, SurfaceCell};
pub use smooth::SmoothForcing;
pub use solid_fraction::{FractionRule, SolidFraction, SolidNode};
pub use static_bodies::StaticBodies;
pub use surface::surface_elements;
pub use surface_flux::SurfaceFlux;
pub use surface_stress::{SurfaceLoads, SurfacePoint, SurfaceStress};
pub use wall_distance::WallDistance;
pub use wall_rows::{WallCell, WallRows};

/// The program of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
