//! Capsules and cylinders in units of their radius, and their frame.
use crate::overlap::tube::{Ends, Tube};
use crate::{Form, SmoothConvex};
use interfaces::{Point, Pose, Vector};
use nalgebra::Matrix3;

/// A capsule or cylinder at a pose; lengths are in radii unless they say otherwise.
#[derive(Clone, Copy)]
pub(crate) struct UnitTube<'a> {
    shape: &'a dyn SmoothConvex,
    /// \[m\].
    pub(super) radius: f64,
    /// Half the length of the straight part.
    pub(super) half: f64,
    pub(super) round: bool,
    /// \[m³\].
    pub(super) volume: f64,
    pub(super) at: Pose,
}

impl<'a> UnitTube<'a> {
    /// The tube that a capsule or cylinder is.
    pub(crate) fn of(form: &Form<'a>, at: &Pose) -> Option<Self> {
        let shape: &'a dyn SmoothConvex = match form {
            Form::Capsule(capsule) => *capsule,
            Form::Cylinder(cylinder) => *cylinder,
            _ => return None,
        };
        let tube = Tube::of(form, at)?;
        Some(Self {
            shape,
            radius: tube.radius,
            half: tube.half / tube.radius,
            round: tube.ends == Ends::Round,
            volume: tube.volume(),
            at: *at,
        })
    }
    /// Half the extent along the axis.
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
        let (from, way) = (Point::from(p * self.radius), q - p);
        let chord = self.shape.chord(from, way * self.radius);
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
    pub(super) fn new(a: &UnitTube<'_>, at_b: &Pose) -> Self {
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
