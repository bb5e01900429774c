//! Which route leads to the overlap of a pair.
use super::tree::{AdaptiveTree, Normal, Refinement, SubBox};
use super::{Overlap, closed};
use crate::{DemError, Form, Shape};
use interfaces::Pose;
use std::fmt;

/// A way to compute an overlap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Route {
    /// A formula.
    ClosedForm,
    /// Boxes that are divided where the surfaces are, for all that has a signed distance.
    Tree,
}

impl fmt::Display for Route {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::ClosedForm => "closed form",
            Self::Tree => "adaptive tree",
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
    tree: AdaptiveTree,
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
    /// How far the adaptive tree goes; to a relative error of the volume of about 1e-3 unless told.
    #[must_use]
    pub fn with_refinement(mut self, refinement: Refinement) -> Self {
        self.tree.refinement = refinement;
        self
    }
    /// What the normals of the adaptive tree are taken from.
    #[must_use]
    pub fn with_normal(mut self, normal: Normal) -> Self {
        self.tree.normal = normal;
        self
    }
    /// The boxes that the adaptive tree ended with when it was last used.
    pub fn boxes(&self) -> impl Iterator<Item = SubBox> + '_ {
        self.tree.boxes()
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
        if self.route == Some(Route::Tree) {
            return self.by_tree(a, at_a, b, at_b);
        }
        let out = &mut self.patches;
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
            (Form::HalfSpace(_), Form::Disc(_) | Form::Sphere(_)) => {
                self.solve(b, at_b, a, at_a)?;
                self.patches.iter_mut().for_each(|o| *o = o.swapped());
            }
            _ => return self.by_tree(a, at_a, b, at_b),
        }
        Ok(&self.patches)
    }

    fn by_tree(
        &mut self,
        a: &dyn Shape,
        at_a: &Pose,
        b: &dyn Shape,
        at_b: &Pose,
    ) -> Result<&[Overlap], DemError> {
        self.tree.refinement.check()?;
        if !AdaptiveTree::supports(a, b) {
            return Err(DemError::Unsupported { a: a.name(), b: b.name() });
        }
        self.tree.overlap(a, at_a, b, at_b, &mut self.patches);
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
