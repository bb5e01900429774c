//! Capsules and cylinders at a pose, and their frame.
use crate::{Capsule, Cylinder, Shape, SmoothConvex};
use interfaces::{Point, Pose, Vector};
use nalgebra::Matrix3;

/// A capsule or cylinder at a pose.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tube {
    /// \[m\].
    pub(super) radius: f64,
    /// Half the length of the straight part, in radii.
    pub(super) half: f64,
    pub(super) round: bool,
    /// \[m³\].
    pub(super) volume: f64,
    pub(super) at: Pose,
}

impl Tube {
    pub(crate) fn capsule(shape: &Capsule, at: &Pose) -> Self {
        let radius = shape.radius();
        Self {
            radius,
            half: 0.5 * shape.length() / radius,
            round: true,
            volume: shape.inertia(1.0).volume,
            at: *at,
        }
    }
    pub(crate) fn cylinder(shape: &Cylinder, at: &Pose) -> Self {
        let radius = shape.radius();
        Self {
            radius,
            half: 0.5 * shape.length() / radius,
            round: false,
            volume: shape.inertia(1.0).volume,
            at: *at,
        }
    }
    pub(super) fn top(&self) -> f64 {
        self.half + if self.round { 1.0 } else { 0.0 }
    }
    pub(super) fn holds(&self, x: &Vector) -> bool {
        let beyond = (x.z.abs() - self.half).max(0.0);
        let flat2 = x.x * x.x + x.y * x.y;
        if self.round { flat2 + beyond * beyond <= 1.0 } else { flat2 <= 1.0 && beyond == 0.0 }
    }
    /// Length of the segment from `p` to `q` within the tube.
    pub(super) fn length_within(&self, p: Vector, q: Vector) -> f64 {
        let way = q - p;
        let (o, u) = (Point::from(p), way);
        let chord = if self.round {
            Capsule::new(1.0, 2.0 * self.half).ok().and_then(|c| c.chord(o, u))
        } else {
            Cylinder::new(1.0, 2.0 * self.half).ok().and_then(|c| c.chord(o, u))
        };
        chord.map_or(0.0, |[from, to]| (to.min(1.0) - from.max(0.0)).max(0.0) * way.norm())
    }
}

/// From the frame of the body to that of the tube, in radii.
pub(super) struct Map {
    /// Middle of the tube in the frame of the body \[m\].
    pub(super) centre: Point,
    /// Axis of the tube there.
    pub(super) axis: Vector,
    pub(super) linear: Matrix3<f64>,
}

impl Map {
    pub(super) fn new(a: &Tube, at_b: &Pose) -> Self {
        let turn = (a.at.orientation.inverse() * at_b.orientation).to_rotation_matrix();
        Self {
            centre: at_b.to_body(a.at.position),
            axis: turn.inverse_transform_vector(&Vector::z()),
            linear: turn.matrix() / a.radius,
        }
    }
    pub(super) fn apply(&self, x: Point) -> Vector {
        self.linear * (x - self.centre)
    }
}
