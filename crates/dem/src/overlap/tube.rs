//! Spheres, capsules and cylinders at a pose.
use crate::Form;
use interfaces::{Pose, Vector};
use std::f64::consts::PI;

/// Ends of the straight part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Ends {
    Round,
    Flat,
}

/// All within a radius of a straight line or point (round ends), or of a line between the planes across its ends
/// (flat ends): in slices along the line, at the height h above it, all within √(r² − h²) of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tube {
    /// \[m\].
    pub(super) radius: f64,
    /// Half the length of the line; zero for spheres \[m\].
    pub(super) half: f64,
    pub(super) ends: Ends,
    /// Direction of the line, in the world.
    pub(super) axis: Vector,
    pub(super) at: Pose,
}

impl Tube {
    /// The tube that a sphere, capsule or cylinder is.
    pub(super) fn of(form: &Form<'_>, at: &Pose) -> Option<Self> {
        let axis = at.orientation * Vector::z();
        let (radius, half, ends) = match form {
            Form::Sphere(s) => (s.radius(), 0.0, Ends::Round),
            Form::Capsule(c) => (c.radius(), 0.5 * c.length(), Ends::Round),
            Form::Cylinder(c) => (c.radius(), 0.5 * c.length(), Ends::Flat),
            _ => return None,
        };
        Some(Self { radius, half, ends, axis, at: *at })
    }
    /// Half the extent along the axis \[m\].
    pub(super) fn top(&self) -> f64 {
        match self.ends {
            Ends::Round => self.half + self.radius,
            Ends::Flat => self.half,
        }
    }
    /// Radius of the sphere around all \[m\].
    pub(super) fn bound(&self) -> f64 {
        match self.ends {
            Ends::Round => self.half + self.radius,
            Ends::Flat => self.half.hypot(self.radius),
        }
    }
    /// \[m³\].
    pub(super) fn volume(&self) -> f64 {
        let tube = PI * self.radius * self.radius * (2.0 * self.half);
        match self.ends {
            Ends::Round => tube + 4.0 / 3.0 * PI * self.radius.powi(3),
            Ends::Flat => tube,
        }
    }
}
