//! Slices against closed forms, integrals over other slices, polyhedra, and properties that every overlap has.
mod exact;
mod independent;
mod lanes;
mod properties;

use crate::{
    Capsule, ConvexPolyhedron, Cuboid, Cylinder, Form, Overlap, OverlapSolver, Route, Shape, Sphere,
};
use interfaces::{Pose, Rotation};

/// By slices, or in closed form where one body has flat faces.
fn slices(tolerance: f64, a: &dyn Shape, at_a: Pose, b: &dyn Shape, at_b: Pose) -> Option<Overlap> {
    let flat = |s: &dyn Shape| matches!(s.form(), Form::Hull(_) | Form::HalfSpace(_));
    let route = if flat(a) || flat(b) { Route::ClosedForm } else { Route::Slices };
    let mut solver = OverlapSolver::new().with_route(Some(route)).with_tolerance(tolerance);
    let patches = solver.solve(a, &at_a, b, &at_b).unwrap();
    assert!(patches.len() <= 1);
    patches.first().copied()
}
fn volume(a: &dyn Shape, at_a: Pose, b: &dyn Shape, at_b: Pose) -> f64 {
    slices(1e-11, a, at_a, b, at_b).map_or(0.0, |o| o.volume)
}
fn pose(at: [f64; 3], turn: [f64; 3]) -> Pose {
    Pose { position: at.into(), orientation: Rotation::from_scaled_axis(turn.into()) }
}
fn here() -> Pose {
    Pose::at([0.0; 3])
}
fn cylinder(radius: f64, length: f64) -> Cylinder {
    Cylinder::new(radius, length).unwrap()
}
fn capsule(radius: f64, length: f64) -> Capsule {
    Capsule::new(radius, length).unwrap()
}
fn sphere(radius: f64) -> Sphere {
    Sphere::new(radius).unwrap()
}
fn cuboid(edges: [f64; 3]) -> Cuboid {
    Cuboid::new(edges).unwrap()
}
/// A prism with n sides, as large as the cylinder.
fn prism(n: usize, radius: f64, length: f64) -> ConvexPolyhedron {
    let step = std::f64::consts::TAU / n as f64;
    let reach = radius * (step / step.sin()).sqrt();
    let corner = |i: usize| {
        let (sin, cos) = (step * (i % n) as f64).sin_cos();
        [reach * cos, reach * sin, if i < n { -0.5 } else { 0.5 } * length]
    };
    let corners: Vec<_> = (0..2 * n).map(corner).collect();
    let side = |i: usize| [i, (i + 1) % n, n + (i + 1) % n, n + i].map(|v| v as u32).to_vec();
    let mut faces: Vec<_> = (0..n).map(side).collect();
    faces.push((0..n as u32).rev().collect());
    faces.push((n as u32..2 * n as u32).collect());
    ConvexPolyhedron::new(&corners, &faces).unwrap()
}
