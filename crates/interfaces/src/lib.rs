//! The words that the siltflow crates share, and nothing else: where things are ([`Pose`],
//! [`Aabb`], [`Periods`]), how they move ([`Twist`]) and are pushed ([`Wrench`]), what a body
//! owes its neighbours ([`Solid`], [`Kinematics`], [`Bodies`], [`Dynamics`]), how a flow shows
//! its velocity ([`Lattice`], [`Nodes`], [`VelocityField`]) and its cells ([`MeshGeometry`]), what a restart needs ([`Checkpoint`]), who takes snapshots ([`SnapshotSink`]), what a turbulence model asks of a flow
//! ([`Transport`], [`Closure`]) and is told of walls ([`WallRow`]), and the container of the files that ParaView reads ([`vtk`]).
//!
//! The numerical crates depend on this one and on none of each other, so each can be taken
//! alone; they meet because a type of one implements a trait of this crate that another asks for.
//! Units are SI throughout. A plane scene lies in z = 0 and its quantities are per metre of depth.
//!
//! ```
//! use interfaces::{Periods, Pose, Vector};
//! let box_ = Periods::new([Some(1.0), None, None]);
//! assert!((box_.nearest(Vector::new(0.9, 0.9, 0.0)).x + 0.1).abs() < 1e-15);
//! let pose = Pose::at([0.0, 1.0, 0.0]);
//! assert_eq!(pose.to_body([0.0, 3.0, 0.0].into()).y, 2.0);
//! ```
#![doc(html_root_url = "https://docs.rs/siltflow-interfaces/latest")]
#![deny(missing_docs)]

mod bodies;
mod cut_cells;
mod cut_walls;
mod film;
mod geometry;
mod lattice;
mod law_of_the_wall;
mod mesh;
mod nodes;
mod renumbering;
mod restart;
mod snapshots;
mod solid;
mod thin_part;
mod transport;
pub mod vtk;
mod wall_row;

pub use bodies::{Bodies, BodyId, Dynamics, Freedom, Inertia, Kinematics, Load};
pub use cut_cells::{CutCells, OpenFace, WallPiece};
pub use cut_walls::{CutComponent, CutFace, CutNode, CutWalls, Link, SolidPoint};
pub use film::UnresolvedFilm;
pub use geometry::{
    Aabb, LENGTH_PRECISION, Periods, Point, Pose, Rotation, Twist, Vector, Wrench, is_longer,
};
pub use lattice::{Lattice, VelocityField};
pub use law_of_the_wall::LawOfTheWall;
pub use mesh::{Cell, MeshGeometry};
pub use nalgebra;
pub use nodes::Nodes;
pub use renumbering::Renumbering;
pub use restart::{Checkpoint, RestartError};
pub use snapshots::SnapshotSink;
pub use solid::{Polyhedron, Solid, SurfaceElement};
pub use thin_part::ThinPart;
pub use transport::{Closure, Equation, LogSlope, SolveError, SolveInfo, Transport};
pub use wall_row::{WallPoint, WallRow};

/// The program of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
