//! Smooth convex pairs: columns over the contact.
mod frame;
mod lens;
mod meeting;
mod pair;
mod polar;
pub(super) mod rules;

use super::{Overlap, Route, ellipsoids};
use crate::{Form, HalfSpace, Shape, SmoothConvex};
use frame::Frame;
use interfaces::{Pose, Vector};
use meeting::{Meeting, meet};
use pair::{Body, Pair};

/// The finest tolerance worth asking for.
const FINEST: f64 = 1e-10;

/// The overlap of two smooth convex bodies, or of one and a wall, by this `route` or the better one of columns and curve; the
/// outer `None` for other shapes.
pub(super) fn overlap(
    a: &dyn Shape,
    at_a: &Pose,
    b: &dyn Shape,
    at_b: &Pose,
    route: Option<Route>,
    tolerance: f64,
) -> Option<Option<Overlap>> {
    // Also where it is not a number.
    let tolerance = FINEST.max(tolerance);
    let reach = a.bounding_radius() + b.bounding_radius();
    let far = (at_a.position - at_b.position).norm() >= reach;
    let semi_axes = [semi_axes(a.form()), semi_axes(b.form())];
    if let [Some(e_a), Some(e_b)] = semi_axes
        && route != Some(Route::Columns)
    {
        if far {
            return Some(None);
        }
        let origin = at_a.position;
        let posed = [(e_a, at_a), (e_b, at_b)].map(|(e, at)| ellipsoids::Posed::new(e, at, origin));
        if let ellipsoids::Found::Overlap(found) = ellipsoids::overlap(posed[0], posed[1], tolerance) {
            return Some(found);
        }
    } else if route == Some(Route::Curve) {
        return None;
    }
    Some(match (a.form(), b.form()) {
        (Form::HalfSpace(w), _) => wall(Posed::new(b, at_b)?, w, at_a, tolerance).map(|o| o.swapped()),
        (_, Form::HalfSpace(w)) => wall(Posed::new(a, at_a)?, w, at_b, tolerance),
        _ => {
            let (a, b) = (Posed::new(a, at_a)?, Posed::new(b, at_b)?);
            if far { None } else { bodies(a, b, tolerance) }
        }
    })
}

fn semi_axes(form: Form) -> Option<Vector> {
    match form {
        Form::Sphere(s) => Some(Vector::repeat(s.radius())),
        Form::Ellipsoid(e) => Some(e.semi_axes()),
        _ => None,
    }
}

/// A posed smooth convex shape.
#[derive(Clone, Copy)]
struct Posed<'a> {
    shape: &'a dyn Shape,
    smooth: &'a dyn SmoothConvex,
    at: &'a Pose,
}

impl<'a> Posed<'a> {
    fn new(shape: &'a dyn Shape, at: &'a Pose) -> Option<Self> {
        let smooth: &dyn SmoothConvex = match shape.form() {
            Form::Sphere(s) => s,
            Form::Ellipsoid(s) => s,
            Form::Cylinder(s) => s,
            Form::Capsule(s) => s,
            Form::Smooth(s) => s,
            _ => return None,
        };
        Some(Self { shape, smooth, at })
    }
    /// The overlap when all of it lies within the other body.
    fn contained(&self, normal: Vector) -> Overlap {
        Overlap::whole(self.shape.inertia(1.0).volume, self.at.position, normal)
    }
}

/// The overlap of two smooth convex bodies, `None` when they are apart, to a share of `tolerance` of its volume.
///
/// A point of both comes from support points, axes from chords through it; shallow overlaps are integrals over
/// columns, others over rays from the point.
fn bodies(a: Posed, b: Posed, tolerance: f64) -> Option<Overlap> {
    let origin = a.at.position;
    let pair = Pair { a: Body::new(a.smooth, a.at, origin), b: Body::new(b.smooth, b.at, origin) };
    let Meeting::At { point, direction } = meet(&pair) else { return None };
    let frame = Frame::new(&pair, point, direction)?;
    integrate(&pair, &frame, a, Some(b), tolerance)
}

/// The overlap of a smooth convex body and a plane wall.
fn wall(a: Posed, wall: &HalfSpace, at_wall: &Pose, tolerance: f64) -> Option<Overlap> {
    let n = wall.posed(at_wall).normal();
    let origin = a.at.position;
    let pair = Pair { a: Body::new(a.smooth, a.at, origin), b: Body::new(wall, at_wall, origin) };
    // The wall's distance from the common origin, the body's place.
    let distance = wall.posed(at_wall).signed_distance(origin);
    let deepest = pair.a.support(-n);
    let depth = -distance - n.dot(&deepest);
    if depth <= 0.0 {
        return None;
    }
    if distance + n.dot(&pair.a.support(n)) <= 0.0 {
        return Some(a.contained(n));
    }
    // Half as deep, towards the body's inside.
    let share = if distance > 0.0 { 0.5 * depth / (depth + distance) } else { 0.5 };
    let frame = Frame::new(&pair, deepest * (1.0 - share), -n)?;
    integrate(&pair, &frame, a, None, tolerance)
}

/// By columns where they do, else by rays.
fn integrate(pair: &Pair, frame: &Frame, a: Posed, b: Option<Posed>, tolerance: f64) -> Option<Overlap> {
    let views = frame.views(pair);
    if frame.lens {
        let refined = lens::edge(&views).and_then(|edge| frame.refined(pair, &edge));
        let frame = refined.as_ref().filter(|f| f.lens).unwrap_or(frame);
        if let Some(sums) = lens::lens(&frame.views(pair), frame.lengths(), tolerance) {
            return frame.overlap(&sums, a.at.position);
        }
    }
    // Rays are less even than columns: a margin.
    match polar::polar(&views, frame.lengths(), 0.2 * tolerance) {
        polar::Found::Within(0) => Some(a.contained(-frame.axes[2].normalize())),
        polar::Found::Within(_) => b.map(|b| b.contained(-frame.axes[2].normalize())),
        polar::Found::Crossing(sums) => frame.overlap(&sums, a.at.position),
    }
}
