//! Balls and ellipsoids against bodies of flat faces: closed forms, cut bodies, finite differences.
mod bodies;
mod exact;
mod properties;

use super::{BallFaces, Faces, Round};
use crate::Overlap;
use interfaces::{Point, Pose, Rotation, Vector};

/// All regions, and that every number in them is finite.
fn regions(a: &Round, b: &impl Faces, at_b: &Pose) -> Vec<Overlap> {
    let mut out = Vec::new();
    BallFaces::default().overlap(a, b, at_b, &mut out);
    for o in &out {
        let all = [o.centroid.coords, o.normal, o.gradient, o.moment];
        assert!(o.volume > 0.0 && all.iter().all(|v| v.iter().all(|x| x.is_finite())), "{o:?}");
        assert!((o.normal.norm() - 1.0).abs() < 1e-12);
    }
    out
}
/// The one region that they must share.
fn one(a: &Round, b: &impl Faces, at_b: &Pose) -> Overlap {
    let all = regions(a, b, at_b);
    assert_eq!(all.len(), 1, "{all:?}");
    all[0]
}
/// The volume that they share.
fn volume(a: &Round, b: &impl Faces, at_b: &Pose) -> f64 {
    regions(a, b, at_b).iter().map(|o| o.volume).sum()
}
fn ball(radius: f64, centre: [f64; 3]) -> Round {
    Round::ball(radius, Point::from(centre))
}
fn origin() -> Pose {
    Pose::at([0.0; 3])
}
/// Turned about a crooked axis and moved.
fn somewhere() -> Pose {
    Pose {
        position: Point::new(0.3, -0.7, 1.1),
        orientation: Rotation::from_scaled_axis(Vector::new(0.4, -1.1, 0.8)),
    }
}
