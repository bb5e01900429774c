//! Every kind of shape with every other, slender and flat ones too, from a graze to one within the other: what must hold of any overlap.
use super::{Overlap, OverlapSolver};
use crate::draw::Draw;
use crate::shapes::icosphere;
use crate::{
    Capsule, ConvexPolyhedron, Cuboid, Cylinder, DemError, Ellipsoid, Form, HalfSpace, Implicit, Part, Shape,
    Sphere, TriangleMesh, Union,
};
use interfaces::{Aabb, Point, Pose, Solid, Vector};
use std::sync::Arc;

/// A ring.
#[derive(Clone, Copy, Debug)]
struct Ring(f64);

impl Solid for Ring {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        (x.x.hypot(x.y) - 0.7).hypot(x.z) - self.0
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), Vector::new(0.7 + self.0, 0.7 + self.0, self.0))
    }
}

const KINDS: usize = 11;

/// A shape of the kind, of about unit size.
fn shape(kind: usize, draw: &mut Draw) -> Box<dyn Shape> {
    let mut length = || draw.between(0.1, 2.0);
    let made: Result<Box<dyn Shape>, DemError> = match kind {
        0 => Sphere::new(length()).map(|s| Box::new(s) as _),
        1 => Ellipsoid::new([length(), length(), length()]).map(|s| Box::new(s) as _),
        2 => Capsule::new(0.5 * length(), length()).map(|s| Box::new(s) as _),
        3 => Cylinder::new(0.5 * length(), length()).map(|s| Box::new(s) as _),
        4 => Cuboid::new([length(), length(), length()]).map(|s| Box::new(s) as _),
        5 => {
            let points: Vec<[f64; 3]> =
                (0..12).map(|_| (draw.direction() * draw.between(0.5, 1.0)).into()).collect();
            ConvexPolyhedron::from_points(&points).map(|s| Box::new(s) as _)
        }
        6 => {
            let (mut vertices, faces) = icosphere(1.0, 2);
            // Bulges and hollows, star-shaped: the surface never crosses itself.
            vertices.iter_mut().for_each(|v| {
                *v = v.map({
                    let s = draw.between(0.5, 1.2);
                    move |x| s * x
                })
            });
            Ok(Box::new(TriangleMesh::new(&vertices, &faces).unwrap()) as _)
        }
        7 => {
            let part = |shape: Arc<dyn Shape>, at: [f64; 3]| Part { shape, pose: Pose::at(at) };
            let (edge, radius) = (length(), length());
            let parts = vec![
                part(Arc::new(Cuboid::new([edge; 3]).unwrap()), [0.0; 3]),
                part(Arc::new(Sphere::new(radius).unwrap()), [0.5 * edge + radius, 0.0, 0.0]),
            ];
            Union::new(parts).map(|s| Box::new(s) as _)
        }
        8 => Implicit::new("ring", Ring(0.5 * length().min(1.0)), 1e-3).map(|s| Box::new(s) as _),
        9 => HalfSpace::new(Point::origin(), draw.direction()).map(|s| Box::new(s) as _),
        _ => {
            let mesh = TriangleMesh::sphere(length(), 1).unwrap();
            Ok(Box::new(mesh) as _)
        }
    };
    made.unwrap()
}

/// What errors of volumes are allowed, relative to the smaller body.
fn tolerance(a: &dyn Shape, b: &dyn Shape) -> f64 {
    let kinds = [a.form(), b.form()];
    let any = |is: fn(&Form<'_>) -> bool| kinds.iter().any(is);
    let tube = any(|f| matches!(f, Form::Capsule(_) | Form::Cylinder(_)));
    let round = any(|f| matches!(f, Form::Ellipsoid(_)))
        && kinds.iter().all(|f| matches!(f, Form::Sphere(_) | Form::Ellipsoid(_) | Form::Union(_)));
    if any(|f| matches!(f, Form::Distance)) || (tube && any(|f| matches!(f, Form::Facets(_)))) {
        // By the tree.
        5e-3
    } else if tube || round {
        // By slices, curves or columns.
        1e-5
    } else {
        1e-10
    }
}

fn total(patches: &[Overlap]) -> (f64, Vector) {
    (patches.iter().map(|p| p.volume).sum(), patches.iter().map(|p| p.gradient).sum())
}

/// What is wrong with the overlap of a pair.
fn faults(
    solver: &mut OverlapSolver,
    a: &dyn Shape,
    b: &dyn Shape,
    poses: [Pose; 4],
) -> Result<Vec<String>, DemError> {
    let mut faults = Vec::new();
    let [at_a, at_b, moved_a, moved_b] = poses;
    let patches = solver.solve(a, &at_a, b, &at_b)?.to_vec();
    let volume = |s: &dyn Shape| if reach(s) > 0.0 { s.inertia(1.0).volume } else { f64::INFINITY };
    let least = volume(a).min(volume(b));
    let (share, area) = (tolerance(a, b), least.powf(2.0 / 3.0));
    for p in &patches {
        let numbers = p.centroid.coords.sum() + p.gradient.sum() + p.moment.sum();
        let sound = numbers.is_finite() && p.volume > 0.0 && p.volume <= least * (1.0 + share);
        if !sound || (p.normal.norm() - 1.0).abs() > 1e-12 {
            faults.push(format!("{p:?} of {least}"));
        }
    }
    let (v, s) = total(&patches);
    let mut compare = |other: (f64, Vector), to: &str| {
        if (other.0 - v).abs() > share * least || (other.1 - s).norm() > 20.0 * share * area {
            faults.push(format!("V {v}, S {s:?}, but {other:?} {to}; smaller body {least}"));
        }
    };
    let swapped = total(solver.solve(b, &at_b, a, &at_a)?);
    compare((swapped.0, -swapped.1), "swapped");
    let back = at_a.orientation * moved_a.orientation.inverse();
    let elsewhere = total(solver.solve(a, &moved_a, b, &moved_b)?);
    compare((elsewhere.0, back * elsewhere.1), "elsewhere");
    Ok(faults)
}

/// Half-spaces have no size.
fn reach(s: &dyn Shape) -> f64 {
    if s.bounding_radius() < 1e3 { s.bounding_radius() } else { 0.0 }
}

#[test]
fn what_holds_of_any_overlap() {
    let mut draw = Draw(11);
    let mut solver = OverlapSolver::new();
    let (mut met, mut found) = (0, Vec::new());
    for (i, j) in (0..KINDS).flat_map(|i| (i..KINDS).map(move |j| (i, j))) {
        for round in 0..5 {
            let (a, b) = (shape(i, &mut draw), shape(j, &mut draw));
            let (a, b) = (&*a, &*b);
            if a.name() == "half-space" && b.name() == "half-space" {
                continue;
            }
            let distance = (reach(a) + reach(b)) * f64::from(round) / 5.5;
            let at_a = Pose { position: Point::from(draw.direction()), orientation: draw.turn() };
            let at_b =
                Pose { position: at_a.position + draw.direction() * distance, orientation: draw.turn() };
            let (turn, shift) = (draw.turn(), draw.direction() * 30.0);
            let moved =
                |at: Pose| Pose { position: turn * at.position + shift, orientation: turn * at.orientation };
            let faults = faults(&mut solver, a, b, [at_a, at_b, moved(at_a), moved(at_b)]);
            met += usize::from(solver.solve(a, &at_a, b, &at_b).is_ok_and(|p| !p.is_empty()));
            let pair = format!("{} and {}, round {round}", a.name(), b.name());
            match faults {
                Ok(faults) => found.extend(faults.into_iter().map(|f| format!("{pair}: {f}"))),
                Err(error) => found.push(format!("{pair}: {error}")),
            }
        }
    }
    assert!(found.is_empty(), "{} faults:\n{}", found.len(), found.join("\n"));
    assert!(met > 200, "only {met} pairs met");
}
