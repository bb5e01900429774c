//! Which route leads to the overlap of a pair.
use super::{Overlap, closed, columns, walls};
use crate::{DemError, Form, Shape};
use interfaces::Pose;
use std::fmt;

/// A way to compute an overlap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Route {
    /// A formula.
    ClosedForm,
    /// Columns over the contact of smooth convex bodies; rays where the overlap is deep.
    Columns,
    /// Integrals along the curve where the surfaces of two ellipsoids or spheres cross.
    Curve,
}

impl fmt::Display for Route {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::ClosedForm => "closed form",
            Self::Columns => "columns",
            Self::Curve => "curve",
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
    tolerance: Option<f64>,
    patches: Vec<Overlap>,
}

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
    /// Aims at this `tolerance`, the largest relative error of a volume, where a route is not exact; 1e-5 unless given, down to
    /// 1e-10.
    #[must_use]
    pub fn with_tolerance(self, tolerance: f64) -> Self {
        Self { tolerance: Some(tolerance), ..self }
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
        for (shape, at) in [(a, at_a), (b, at_b)] {
            if !(at.position.coords.sum() + at.orientation.coords.sum()).is_finite() {
                return Err(DemError::Pose { name: shape.name(), position: at.position.into() });
            }
        }
        self.patches.clear();
        let out = &mut self.patches;
        if let Some(route @ (Route::Columns | Route::Curve)) = self.route {
            let found = columns::overlap(a, at_a, b, at_b, Some(route), self.tolerance);
            out.extend(found.ok_or(DemError::Route { a: a.name(), b: b.name(), route })?);
            return Ok(&self.patches);
        }
        match (a.form(), b.form()) {
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
            (Form::Ellipsoid(p), Form::HalfSpace(w)) => out.extend(walls::ellipsoid(p, at_a, &w.posed(at_b))),
            (Form::Cylinder(p), Form::HalfSpace(w)) => out.extend(walls::cylinder(p, at_a, &w.posed(at_b))),
            (
                Form::HalfSpace(_),
                Form::Disc(_) | Form::Sphere(_) | Form::Ellipsoid(_) | Form::Cylinder(_),
            ) => {
                self.solve(b, at_b, a, at_a)?;
                self.patches.iter_mut().for_each(|o| *o = o.swapped());
            }
            _ if self.route == Some(Route::ClosedForm) => {
                return Err(DemError::Route { a: a.name(), b: b.name(), route: Route::ClosedForm });
            }
            _ => match columns::overlap(a, at_a, b, at_b, None, self.tolerance) {
                Some(found) => out.extend(found),
                None => return Err(DemError::Unsupported { a: a.name(), b: b.name() }),
            },
        }
        Ok(&self.patches)
    }
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
