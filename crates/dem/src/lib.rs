//! Rigid bodies: shapes, the volume in which two of them overlap, the contact force that follows from it
//! (Chen 2012; Isoz et al. 2023, equation 4), and their motion. Stands alone: no mesh, no flow.
//!
//! A plane scene (discs) lies in z = 0; its masses, forces and overlap "volumes" are per metre of depth.
//!
//! ```
//! use dem::{Disc, Material, RigidBodies};
//! use dem::{BodyId, Dynamics, Freedom, Kinematics, Periods, Pose, Twist, Vector};
//!
//! let mut bodies = RigidBodies::new(Periods::default());
//! let (disc, steel) = (Disc::new(0.01)?, Material { density: 7800.0, ..Material::default() });
//! let right = Twist { linear: Vector::new(1.0, 0.0, 0.0), ..Twist::default() };
//! bodies.add(disc, steel, Pose::at([0.0, 0.0, 0.0]), right, Freedom::PLANAR)?;
//! bodies.add(disc, steel, Pose::at([0.03, 0.0, 0.0]), Twist::default(), Freedom::PLANAR)?;
//! for _ in 0..40 {
//!     bodies.advance(1e-3)?;
//! }
//! // Equal bodies exchange their velocities, but for what the damping took.
//! assert!(bodies.twist(BodyId(1)).linear.x > 0.5);
//! # Ok::<(), dem::DemError>(())
//! ```
#![doc(html_root_url = "https://docs.rs/siltflow-dem/latest")]
#![deny(missing_docs)]

mod broad_phase;
mod contact;
#[cfg(test)]
mod draw;
mod error;
mod material;
mod overlap;
#[cfg(feature = "placing")]
pub mod placing;
#[cfg(feature = "placing")]
mod population;
mod prescribed_motion;
mod rigid_bodies;
mod rigid_dynamics;
mod shapes;
mod vtp;

pub use broad_phase::{
    Automatic, BroadPhase, HierarchicalGrid, LinkedCells, NearPair, PairList, PairListError, RTree, Sweep,
};
pub use contact::{
    Chen, ContactLaw, FilmForce, Gap, Lubricated, Means, Memory, PairProperties, Pivot, Potential, Push,
    Repulsive, Rolling, Springs, Touch, WholeFilm,
};
pub use error::{DemError, SubStepLimit};
pub use interfaces::{
    Aabb, Bodies, BodyId, Cell, Checkpoint, Dynamics, Freedom, Inertia, Kinematics, LENGTH_PRECISION, Load,
    MeshGeometry, Periods, Point, Polyhedron, Pose, Renumbering, RestartError, Rotation, Solid,
    SurfaceElement, Twist, UnresolvedFilm, Vector, Wrench,
};
pub use material::Material;
pub use nalgebra;
#[cfg(feature = "mesh")]
pub use overlap::FacetIndex;
pub use overlap::{BoxKind, CellOverlap, Normal, Overlap, OverlapSolver, Refinement, Route, SubBox, overlap};
#[cfg(feature = "placing")]
pub use population::{Entrant, Inflow, Origin, Population};
pub use prescribed_motion::PrescribedMotion;
pub use rigid_bodies::{
    Contact, DEEP, Depth, Partner, RestingDepth, RigidBodies, Sleep, Tether, resting_depth,
};
pub use rigid_dynamics::RigidDynamics;
#[cfg(feature = "mesh")]
pub use shapes::{
    AdmissionReport, Changes, MeshError, RepairReport, Shell, Thinnest, TriangleMesh, TriangleSoup,
};
pub use shapes::{
    Capsule, ConvexPolyhedron, Cuboid, Cylinder, Disc, Ellipsoid, Facets, Form, HalfSpace, Implicit, Part,
    Polygon, Shape, SmoothConvex, Sphere, Union,
};
pub use vtp::BodyFrames;

/// The program of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
