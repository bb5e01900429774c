//! Which route leads to the overlap of a pair.
use super::ball_faces::{BallFaces, Round};
use super::clip::Clipper;
use super::facets::{FacetOverlap, Impossible};
use super::half_space::HalfSpaceOverlap;
use super::{Overlap, closed};
use crate::{DemError, Form, Shape};
use interfaces::Pose;
use std::fmt;

/// A way to compute an overlap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Route {
    /// A formula.
    ClosedForm,
    /// Cutting one body off at the planes of the other.
    Clip,
    /// Sums over the crossings of triangles.
    Facets,
}

impl fmt::Display for Route {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::ClosedForm => "closed form",
            Self::Clip => "clipping",
            Self::Facets => "crossings of triangles",
        })
    }
}

/// Computes overlaps and keeps the memory that this takes: a warmed-up solver allocates nothing.
///
/// ```
/// use dem::{OverlapSolver, Sphere};
/// use interfaces::Pose;
///
/// let ball = Sphere::new(1.0)?;
/// let mut solver = OverlapSolver::new();
/// let patches = solver.solve(&ball, &Pose::at([0.0; 3]), &ball, &Pose::at([1.5, 0.0, 0.0]))?;
/// let cap = std::f64::consts::PI * 0.25_f64.powi(2) * (3.0 - 0.25) / 3.0;
/// assert!((patches[0].volume - 2.0 * cap).abs() < 1e-14);
/// # Ok::<(), dem::DemError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct OverlapSolver {
    route: Option<Route>,
    patches: Vec<Overlap>,
    ball_faces: BallFaces,
    clipper: Clipper,
    facets: FacetOverlap,
    half_space: HalfSpaceOverlap,
}

/// Polyhedra are clipped while one of them has no more vertices than this; beyond, crossings are found faster.
const CLIPPED: usize = 30;

/// Of hulls with so many faces all are looked at; of larger ones those that a tree finds near.
const FEW_FACES: usize = 20;

impl OverlapSolver {
    /// One that takes the best route for every pair.
    pub fn new() -> Self {
        Self::default()
    }
    /// Takes this `route` for all pairs, or the best one again.
    #[must_use]
    pub fn with_route(self, route: Option<Route>) -> Self {
        Self { route, ..self }
    }

    /// What two bodies share: one patch per connected region, none when they are apart.
    ///
    /// # Errors
    /// [`DemError::Unsupported`] for pairs without a route, [`DemError::Route`] when the route asked for does not lead there,
    /// [`DemError::Pose`] when a pose is not finite.
    pub fn solve(
        &mut self,
        a: &dyn Shape,
        at_a: &Pose,
        b: &dyn Shape,
        at_b: &Pose,
    ) -> Result<&[Overlap], DemError> {
        self.patches.clear();
        for (shape, at) in [(a, at_a), (b, at_b)] {
            if !is_finite(at) {
                return Err(DemError::Pose { name: shape.name(), position: at.position.into() });
            }
        }
        // The most frequent pair of all, before all else.
        if let (Form::Sphere(p), Form::Sphere(q)) = (a.form(), b.form()) {
            self.patches.extend(closed::spheres(p.radius(), at_a.position, q.radius(), at_b.position));
        } else {
            self.pair(a, at_a, b, at_b)?;
        }
        Ok(&self.patches)
    }

    /// Adds the patches of a pair.
    fn pair(&mut self, a: &dyn Shape, at_a: &Pose, b: &dyn Shape, at_b: &Pose) -> Result<(), DemError> {
        let out = &mut self.patches;
        match (a.form(), b.form()) {
            (Form::Union(parts), _) => {
                for part in parts {
                    let at_part = at_a.of(&part.pose);
                    if near(&*part.shape, &at_part, b, at_b) {
                        self.pair(&*part.shape, &at_part, b, at_b)?;
                    }
                }
            }
            (Form::Disc(p), Form::Disc(q)) => {
                out.extend(closed::discs(p.radius(), at_a.position, q.radius(), at_b.position));
            }
            (Form::Sphere(p), Form::Sphere(q)) => {
                out.extend(closed::spheres(p.radius(), at_a.position, q.radius(), at_b.position));
            }
            (Form::Disc(p), Form::HalfSpace(w)) => {
                let w = w.posed(at_b);
                let distance = w.signed_distance(at_a.position);
                out.extend(closed::disc_wall(p.radius(), at_a.position, distance, w.normal()));
            }
            (Form::Sphere(p), Form::HalfSpace(w)) => {
                let w = w.posed(at_b);
                let distance = w.signed_distance(at_a.position);
                out.extend(closed::sphere_wall(p.radius(), at_a.position, distance, w.normal()));
            }
            (Form::Sphere(p), Form::Hull(q)) => {
                let ball = Round::ball(p.radius(), at_a.position);
                match q.n_faces() {
                    ..=FEW_FACES => self.ball_faces.overlap(&ball, q, at_b, out),
                    _ => self.ball_faces.overlap(&ball, q.facets(), at_b, out),
                }
            }
            (Form::Sphere(p), Form::Facets(q)) => {
                let ball = Round::ball(p.radius(), at_a.position);
                self.ball_faces.overlap(&ball, q, at_b, out);
            }
            (Form::Hull(p), Form::Hull(q)) if p.vertices().len().min(q.vertices().len()) <= CLIPPED => {
                self.clipper.overlap(p, at_a, q, at_b, out);
            }
            (Form::Hull(_) | Form::Facets(_), Form::Hull(_) | Form::Facets(_)) => {
                let (Some(p), Some(q)) = (a.form().facets(), b.form().facets()) else { return Ok(()) };
                self.facets.overlap(p, at_a, q, at_b, out).map_err(|Impossible { volume, most }| {
                    DemError::Impossible { a: a.name(), b: b.name(), volume, most }
                })?;
            }
            (Form::Hull(p), Form::HalfSpace(w)) => {
                self.half_space.overlap(p.facets(), at_a, &w.posed(at_b), out)
            }
            (Form::Facets(p), Form::HalfSpace(w)) => self.half_space.overlap(p, at_a, &w.posed(at_b), out),
            (_, Form::Union(_))
            | (Form::Hull(_) | Form::Facets(_), Form::Sphere(_))
            | (Form::HalfSpace(_), Form::Disc(_) | Form::Sphere(_) | Form::Hull(_) | Form::Facets(_)) => {
                let first = out.len();
                self.pair(b, at_b, a, at_a)?;
                self.patches[first..].iter_mut().for_each(|o| *o = o.swapped());
            }
            _ => return Err(DemError::Unsupported { a: a.name(), b: b.name() }),
        }
        Ok(())
    }
}

/// Are all numbers of a pose finite? Short sums: they are not waited for.
#[inline]
fn is_finite(at: &Pose) -> bool {
    let (x, q) = (&at.position, &at.orientation.coords);
    (((x.x + x.y) + (q.x + q.y)) + ((x.z + q.z) + q.w)).is_finite()
}

/// Do the spheres around two shapes meet?
fn near(a: &dyn Shape, at_a: &Pose, b: &dyn Shape, at_b: &Pose) -> bool {
    let within = a.bounding_radius() + b.bounding_radius();
    (at_a.position - at_b.position).norm_squared() <= within * within
}

/// [`OverlapSolver::solve`] once, with memory of its own.
///
/// # Errors
/// Those of [`OverlapSolver::solve`].
pub fn overlap(a: &dyn Shape, at_a: &Pose, b: &dyn Shape, at_b: &Pose) -> Result<Vec<Overlap>, DemError> {
    let mut solver = OverlapSolver::new();
    solver.solve(a, at_a, b, at_b)?;
    Ok(solver.patches)
}
