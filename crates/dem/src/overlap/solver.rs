//! Which route leads to the overlap of a pair.
use super::ball_faces::{BallFaces, Round};
use super::clip::Clipper;
use super::facets::{FacetOverlap, Impossible};
use super::half_space::HalfSpaceOverlap;
use super::plane::PlaneOverlap;
use super::slices::Slices;
use super::tree::{AdaptiveTree, Exhausted, Normal, Refinement, SubBox};
use super::tube_faces::{TubeFaces, UnitTube, WallBox};
use super::{Overlap, closed, columns, outline, walls};
use crate::{DemError, Form, Shape};
use interfaces::Pose;
use nalgebra::Matrix3;
use std::fmt;

/// A way to compute an overlap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Route {
    /// A formula.
    ClosedForm,
    /// Cutting one body off at the planes of the other.
    Clip,
    /// Sums over the crossings of triangles.
    Crossings,
    /// Columns over the contact of smooth convex bodies; rays where the overlap is deep.
    Columns,
    /// Parallel slices, for capsules and cylinders with one another, with spheres and ellipsoids.
    Slices,
    /// Integrals along the curve where the surfaces of two ellipsoids or spheres cross.
    Curve,
    /// Boxes that are divided where the surfaces are, for all that has a signed distance.
    Tree,
}

impl fmt::Display for Route {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::ClosedForm => "closed form",
            Self::Clip => "clipping",
            Self::Crossings => "crossings of triangles",
            Self::Columns => "columns",
            Self::Slices => "slices",
            Self::Curve => "curve",
            Self::Tree => "adaptive tree",
        })
    }
}

/// Computes overlaps and keeps the memory that this takes: a warmed-up solver allocates nothing.
///
/// ```
/// use dem::{OverlapSolver, Sphere};
/// use dem::Pose;
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
    /// Of two spheres.
    lens: Option<Overlap>,
    ball_faces: BallFaces,
    tube_faces: TubeFaces,
    clipper: Clipper,
    facets: FacetOverlap,
    half_space: HalfSpaceOverlap,
    plane: PlaneOverlap,
    slices: Slices,
    tree: AdaptiveTree,
    pivots: bool,
}

/// Largest relative error of a volume that is aimed at unless told.
const TOLERANCE: f64 = 1e-5;

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
    /// Aims at this `tolerance`, the largest relative error of a volume, where a route is not exact; 1e-5 unless given, down to
    /// 1e-10.
    #[must_use]
    pub fn with_tolerance(self, tolerance: f64) -> Self {
        Self { tolerance: Some(tolerance), ..self }
    }

    /// Whether [`Overlap::pivot`] is computed: exactly where flat faces, ellipsoids or cylinders meet walls, where polyhedra and
    /// where polygons meet; elsewhere as of a disc of the patch's area. No route pays for it unless it is requested.
    #[must_use]
    pub fn with_pivots(mut self, pivots: bool) -> Self {
        self.set_pivots(pivots);
        self
    }
    pub(crate) fn set_pivots(&mut self, pivots: bool) {
        self.pivots = pivots;
        self.clipper.pivots = pivots;
        self.facets.set_pivots(pivots);
        self.half_space.set_pivots(pivots);
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
    /// [`DemError::Pose`] when a pose is not finite, [`DemError::Boxes`] when the adaptive tree does not come to its tolerance.
    #[inline(always)]
    pub fn solve(
        &mut self,
        a: &dyn Shape,
        at_a: &Pose,
        b: &dyn Shape,
        at_b: &Pose,
    ) -> Result<&[Overlap], DemError> {
        // The most frequent pair of all, before all else and where the caller is: there the shapes may be known.
        if matches!(self.route, None | Some(Route::ClosedForm))
            && let Form::Sphere(p) = a.form()
            && let Form::Sphere(q) = b.form()
        {
            let apart = at_a.position - at_b.position;
            let (d, turns) = (apart.norm(), at_a.orientation.coords + at_b.orientation.coords);
            // Where this is too large, it is told below whether a pose is to blame.
            if (d + ((turns.x + turns.z) + (turns.y + turns.w))).is_finite() {
                self.lens =
                    closed::spheres_apart(p.radius(), at_a.position, q.radius(), at_b.position, apart, d);
                return Ok(self.lens.as_slice());
            }
        }
        self.patches.clear();
        self.any_pair(a, at_a, b, at_b)?;
        Ok(&self.patches)
    }

    /// Adds the patches of a pair whose poses may not be finite.
    #[inline(never)]
    fn any_pair(&mut self, a: &dyn Shape, at_a: &Pose, b: &dyn Shape, at_b: &Pose) -> Result<(), DemError> {
        check(a, at_a)?;
        check(b, at_b)?;
        self.pair(a, at_a, b, at_b)
    }

    /// Adds the patches of a pair.
    fn pair(&mut self, a: &dyn Shape, at_a: &Pose, b: &dyn Shape, at_b: &Pose) -> Result<(), DemError> {
        let (form_a, form_b) = (a.form(), b.form());
        if let Form::Union(parts) = form_a {
            // Of many parts most are far away, as spheres around them tell; of long ones, their boxes tell more.
            let turn = at_a.orientation.to_rotation_matrix();
            let reach = b.bounding_radius();
            for part in parts {
                let place = at_a.position + turn * part.pose.position.coords;
                let within = part.shape.bounding_radius() + reach;
                if (place - at_b.position).norm_squared() > within * within {
                    continue;
                }
                let at_part = at_a.of(&part.pose);
                let (at, bounds) = (at_part.to_body(at_b.position), part.shape.aabb());
                let gap = (bounds.min - at).sup(&(at - bounds.max)).map(|g| g.max(0.0));
                if gap.norm_squared() <= reach * reach {
                    self.pair(&*part.shape, &at_part, b, at_b)?;
                }
            }
            return Ok(());
        }
        if rank(&form_a) > rank(&form_b) {
            let first = self.patches.len();
            self.pair(b, at_b, a, at_a)?;
            self.patches[first..].iter_mut().for_each(|o| *o = o.swapped());
            return Ok(());
        }
        let first = self.patches.len();
        let out = &mut self.patches;
        let best = || best(&form_a, &form_b).ok_or(DemError::Unsupported { a: a.name(), b: b.name() });
        let route = self.route.map_or_else(best, Ok)?;
        let tolerance = self.tolerance.unwrap_or(TOLERANCE);
        let found = match route {
            Route::ClosedForm => self.closed_form(&form_a, at_a, &form_b, at_b),
            Route::Clip => match (&form_a, &form_b) {
                (Form::Hull(p), Form::Hull(q)) => {
                    self.clipper.overlap(p, at_a, q, at_b, out);
                    true
                }
                _ => false,
            },
            Route::Crossings => match (form_a.facets(), form_b.facets()) {
                (Some(p), Some(q)) => {
                    let impossible = |Impossible { volume, most }| DemError::Impossible {
                        a: a.name(),
                        b: b.name(),
                        volume,
                        most,
                    };
                    self.facets.overlap(p, at_a, q, at_b, out).map_err(impossible)?;
                    true
                }
                _ => false,
            },
            Route::Slices => self.slices.overlap((&form_a, at_a), (&form_b, at_b), tolerance, out),
            Route::Curve | Route::Columns => {
                let found = columns::overlap(a, at_a, b, at_b, Some(route), tolerance);
                found.map(|patch| out.extend(patch)).is_some()
            }
            Route::Tree => {
                self.tree.refinement.check()?;
                let found = AdaptiveTree::supports(a, b);
                if found {
                    let what = || format!("a {} in a {}", a.name(), b.name());
                    let exhausted =
                        |Exhausted { boxes, error }| DemError::Boxes { what: what(), boxes, error };
                    self.tree.overlap(a, at_a, b, at_b, out).map_err(exhausted)?;
                }
                found
            }
        };
        if self.pivots && !(is_round(&form_a) || is_round(&form_b)) {
            for o in self.patches[first..].iter_mut().filter(|o| o.pivot == Matrix3::zeros()) {
                o.pivot = outline::of_disc(o.area(), o.normal);
            }
        }
        if found { Ok(()) } else { Err(DemError::Route { a: a.name(), b: b.name(), route }) }
    }

    /// Adds what a formula gives; answers whether there is one.
    fn closed_form(&mut self, a: &Form<'_>, at_a: &Pose, b: &Form<'_>, at_b: &Pose) -> bool {
        let out = &mut self.patches;
        let place = at_a.position;
        match (a, b) {
            (Form::Disc(p), Form::Disc(q)) => {
                out.extend(closed::discs(p.radius(), place, q.radius(), at_b.position))
            }
            (Form::Disc(p), Form::Polygon(q)) => self.plane.disc(p.radius(), place, q, at_b, out),
            (Form::Polygon(p), Form::Polygon(q)) => self.plane.polygons(p, at_a, q, at_b, out),
            (Form::Sphere(p), Form::Sphere(q)) => {
                out.extend(closed::spheres(p.radius(), place, q.radius(), at_b.position))
            }
            (Form::Sphere(_) | Form::Ellipsoid(_), Form::Hull(_) | Form::Facets(_)) => {
                let round = match a {
                    Form::Ellipsoid(p) => Round::ellipsoid(p.semi_axes(), at_a),
                    Form::Sphere(p) => Round::ball(p.radius(), place),
                    _ => return false,
                };
                match b {
                    Form::Hull(q) if q.n_faces() <= FEW_FACES => {
                        self.ball_faces.overlap(&round, *q, at_b, out)
                    }
                    Form::Hull(q) => self.ball_faces.overlap(&round, q.facets(), at_b, out),
                    Form::Facets(q) => self.ball_faces.overlap(&round, *q, at_b, out),
                    _ => return false,
                }
            }
            (Form::Capsule(_) | Form::Cylinder(_), Form::Hull(_) | Form::Facets(_)) => {
                let Some(tube) = UnitTube::of(a, at_a) else { return false };
                match b {
                    Form::Hull(q) if q.n_faces() <= FEW_FACES => {
                        self.tube_faces.overlap(&tube, *q, at_b, out)
                    }
                    Form::Hull(q) => self.tube_faces.overlap(&tube, q.facets(), at_b, out),
                    Form::Facets(q) => self.tube_faces.overlap(&tube, *q, at_b, out),
                    _ => return false,
                }
            }
            (_, Form::HalfSpace(w)) => {
                let w = w.posed(at_b);
                match a {
                    Form::Disc(p) => {
                        out.extend(closed::disc_wall(p.radius(), place, w.signed_distance(place), w.normal()))
                    }
                    Form::Polygon(p) => self.plane.at_wall(p, at_a, &w, out),
                    Form::Sphere(p) => out.extend(closed::sphere_wall(
                        p.radius(),
                        place,
                        w.signed_distance(place),
                        w.normal(),
                    )),
                    Form::Ellipsoid(p) => out.extend(walls::ellipsoid(p, at_a, &w)),
                    Form::Cylinder(p) => out.extend(walls::cylinder(p, at_a, &w)),
                    Form::Capsule(_) => {
                        let Some(tube) = UnitTube::of(a, at_a) else { return false };
                        let wall = WallBox::new(&tube, &w);
                        self.tube_faces.overlap(&tube, &wall, &Pose::at([0.0; 3]), out);
                    }
                    Form::Hull(p) => self.half_space.overlap(p.facets(), at_a, &w, out),
                    Form::Facets(p) => self.half_space.overlap(p, at_a, &w, out),
                    _ => return false,
                }
            }
            _ => return false,
        }
        true
    }
}

/// The order in which the two of a pair are taken: unions first, which are taken apart, then round ones; walls last.
fn rank(form: &Form<'_>) -> usize {
    match form {
        Form::Union(_) => 0,
        Form::Disc(_) => 1,
        Form::Polygon(_) => 2,
        Form::Sphere(_) => 3,
        Form::Ellipsoid(_) => 4,
        Form::Capsule(_) | Form::Cylinder(_) | Form::Smooth(_) => 5,
        Form::Hull(_) => 6,
        Form::Facets(_) => 7,
        Form::Distance => 8,
        Form::HalfSpace(_) => 9,
    }
}

/// Whether spin leaves the surface where it is.
fn is_round(form: &Form<'_>) -> bool {
    matches!(form, Form::Disc(_) | Form::Sphere(_))
}

/// Is it convex and known by straight lines?
fn is_smooth(form: &Form<'_>) -> bool {
    matches!(
        form,
        Form::Sphere(_) | Form::Ellipsoid(_) | Form::Capsule(_) | Form::Cylinder(_) | Form::Smooth(_)
    )
}

/// The best route for a pair in the order of [`rank`].
fn best(a: &Form<'_>, b: &Form<'_>) -> Option<Route> {
    Some(match (a, b) {
        (Form::Disc(_), Form::Disc(_)) => Route::ClosedForm,
        (Form::Disc(_) | Form::Polygon(_), Form::Polygon(_) | Form::HalfSpace(_)) => Route::ClosedForm,
        (Form::Disc(_) | Form::Polygon(_), _) => return None,
        (Form::Sphere(_), Form::Sphere(_)) => Route::ClosedForm,
        (Form::Sphere(_) | Form::Ellipsoid(_), Form::Hull(_) | Form::Facets(_) | Form::HalfSpace(_)) => {
            Route::ClosedForm
        }
        (Form::Capsule(_) | Form::Cylinder(_), Form::Hull(_) | Form::Facets(_) | Form::HalfSpace(_)) => {
            Route::ClosedForm
        }
        (Form::Hull(_) | Form::Facets(_), Form::HalfSpace(_)) => Route::ClosedForm,
        (Form::Sphere(_) | Form::Ellipsoid(_), Form::Ellipsoid(_)) => Route::Curve,
        (Form::Hull(p), Form::Hull(q)) if p.vertices().len().min(q.vertices().len()) <= CLIPPED => {
            Route::Clip
        }
        (Form::Hull(_) | Form::Facets(_), Form::Hull(_) | Form::Facets(_)) => Route::Crossings,
        (Form::HalfSpace(_), Form::HalfSpace(_)) => return None,
        (_, Form::HalfSpace(_)) if is_smooth(a) => Route::Columns,
        (Form::Sphere(_) | Form::Ellipsoid(_), Form::Capsule(_) | Form::Cylinder(_)) => Route::Slices,
        (Form::Capsule(_) | Form::Cylinder(_), Form::Capsule(_) | Form::Cylinder(_)) => Route::Slices,
        (_, _) if is_smooth(a) && is_smooth(b) => Route::Columns,
        _ => Route::Tree,
    })
}

/// Refuses poses that are not finite.
#[inline]
pub(super) fn check(shape: &dyn Shape, at: &Pose) -> Result<(), DemError> {
    if at.position.iter().chain(at.orientation.coords.iter()).all(|x| x.is_finite()) {
        Ok(())
    } else {
        Err(DemError::Pose { name: shape.name(), position: at.position.into() })
    }
}

/// [`OverlapSolver::solve`] once, with memory of its own.
///
/// # Errors
/// Those of [`OverlapSolver::solve`].
pub fn overlap(a: &dyn Shape, at_a: &Pose, b: &dyn Shape, at_b: &Pose) -> Result<Vec<Overlap>, DemError> {
    OverlapSolver::new().solve(a, at_a, b, at_b).map(<[_]>::to_vec)
}
