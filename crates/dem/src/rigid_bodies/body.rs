//! One body.
use super::turning::{Turning, turn};
use crate::{Form, Shape};
use interfaces::{Freedom, Inertia, Load, Point, Pose, Renumbering, Rotation, Twist, Vector, Wrench};
use std::any::Any;
use std::f64::consts::PI;
use std::sync::Arc;

/// What contacts read of a body: two cache lines.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Body {
    pub(super) pose: Pose,
    pub(super) twist: Twist,
    /// Of the sphere around it.
    pub(super) radius: f64,
    /// 0 if it cannot be moved.
    pub(super) inverse_mass: f64,
    pub(super) material: u32,
    pub(super) kind: Kind,
    /// Are its quantities per metre of depth?
    pub(super) plane: bool,
}

/// Bodies whose overlaps need neither an orientation nor a solver, and others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Ball,
    Disc,
    Other,
}

/// What does not change; what balls need in every step is in the first cache line.
#[derive(Clone)]
#[repr(C, align(64))]
pub(super) struct Constants {
    pub(super) mass: f64,
    pub(super) freedom: Freedom,
    pub(super) turning: Turning,
    pub(super) shape: Arc<dyn Shape>,
    pub(super) inertia: Inertia,
    /// Radius of a sphere (in a plane scene a disc) as large as the body.
    pub(super) size: f64,
    /// Radius of a sphere around the centre of mass that is within the body; `size` if the centre is not.
    pub(super) inner: f64,
    /// Area of its largest flat face, as far as is known.
    pub(super) flat: f64,
    /// The same; where nothing is known, what may be: as large as a cut through the inner sphere.
    pub(super) face: f64,
}

/// Area of the largest flat face \[m²\]; `None` where the form does not tell.
fn flat(form: &Form<'_>) -> Option<f64> {
    match form {
        Form::Hull(hull) => Some(hull.face_areas().fold(0.0, f64::max)),
        Form::Facets(facets) => Some(facets.largest_flat()),
        Form::Polygon(p) => Some(p.longest_edge()),
        Form::Cylinder(c) => Some(PI * c.radius() * c.radius()),
        Form::Union(parts) => {
            parts.iter().try_fold(0.0, |largest, part| flat(&part.shape.form()).map(|f| f64::max(largest, f)))
        }
        Form::Smooth(_) | Form::Distance => None,
        Form::Disc(_) | Form::Sphere(_) | Form::HalfSpace(_) | Form::Ellipsoid(_) | Form::Capsule(_) => {
            Some(0.0)
        }
    }
}

/// `shape` in an `Arc`: its own, if it is an `Arc<dyn Shape>`.
pub(super) fn shared(shape: impl Shape + 'static) -> Arc<dyn Shape> {
    let own = (&shape as &dyn Any).downcast_ref::<Arc<dyn Shape>>().cloned();
    own.unwrap_or_else(|| Arc::new(shape))
}

impl std::fmt::Debug for Constants {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Constants")
            .field("shape", &self.shape.name())
            .field("inertia", &self.inertia)
            .finish()
    }
}

impl Constants {
    pub(super) fn new(shape: Arc<dyn Shape>, density: f64, freedom: Freedom) -> Self {
        let inertia = shape.inertia(density);
        let plane = shape.form().is_plane();
        let size = if plane { (inertia.volume / PI).sqrt() } else { (0.75 * inertia.volume / PI).cbrt() };
        let depth = -shape.signed_distance(Point::origin(), shape.bounding_radius());
        let inner = if depth > 0.0 { depth } else { size };
        let flat = flat(&shape.form());
        let face = flat.unwrap_or(PI * inner * inner);
        let flat = flat.unwrap_or(0.0);
        let turning = Turning::new(&inertia.tensor, freedom.angular);
        Self { mass: inertia.mass, inertia, freedom, turning, size, inner, flat, face, shape }
    }
    pub(super) fn kind(&self) -> Kind {
        match self.shape.form() {
            Form::Sphere(_) => Kind::Ball,
            Form::Disc(_) => Kind::Disc,
            _ => Kind::Other,
        }
    }
    pub(super) fn is_round(&self) -> bool {
        self.kind() != Kind::Other
    }
    /// May its centre not be moved? Contacts then feel an infinite mass.
    #[inline]
    pub(super) fn pinned(&self) -> bool {
        self.freedom.linear == [false; 3]
    }
    /// Can forces change anything about it?
    #[inline]
    pub(super) fn movable(&self) -> bool {
        self.freedom != Freedom::NONE
    }
}

/// What the surroundings do to the bodies.
#[derive(Clone, Debug, Default)]
pub(super) struct Loads {
    loads: Vec<Load>,
    /// Has any ever been given? If not, none is read.
    given: bool,
}

impl Loads {
    pub(super) fn add(&mut self) {
        self.loads.push(Load::default());
    }
    #[inline]
    pub(super) fn of(&self, b: usize) -> &Load {
        const NONE: &Load = &Load {
            wrench: Wrench { force: Vector::new(0.0, 0.0, 0.0), torque: Vector::new(0.0, 0.0, 0.0) },
            added_mass: 0.0,
            added_moment: 0.0,
        };
        if self.given { &self.loads[b] } else { NONE }
    }
    pub(super) fn renumber(&mut self, numbers: &Renumbering) {
        numbers.apply(&mut self.loads);
    }
    pub(super) fn set(&mut self, b: usize, load: Load) {
        self.given |= load != Load::default();
        self.loads[b] = load;
    }
}

impl Body {
    #[inline]
    pub(super) fn is_plane(&self) -> bool {
        self.plane
    }

    /// Moves along with the twist for half a step before forces are known. Round bodies turn afterwards, at once.
    #[inline]
    pub(super) fn before(&mut self, constants: &Constants, load: &Load, half: f64) {
        self.pose.position += self.twist.linear * half;
        if self.kind == Kind::Other {
            let Self { pose, twist, .. } = self;
            constants.turning.drift(&mut pose.orientation, &mut twist.angular, load.added_moment, half);
        }
    }

    /// Changes the twist by `total` over the step, and moves along for the other half.
    #[inline]
    pub(super) fn after(&mut self, constants: &Constants, load: &Load, total: &Wrench, half: f64) {
        let Self { pose, twist, .. } = self;
        let spin = twist.angular;
        if constants.movable() {
            let kick = total.force * (2.0 * half / (constants.mass + load.added_mass));
            let free = constants.freedom.linear;
            twist.linear += Vector::from_fn(|i, _| if free[i] { kick[i] } else { 0.0 });
            let q = &pose.orientation;
            constants.turning.kick(q, &mut twist.angular, &total.torque, load.added_moment, 2.0 * half);
        }
        pose.position += twist.linear * half;
        if self.kind == Kind::Other {
            constants.turning.drift(&mut pose.orientation, &mut twist.angular, load.added_moment, half);
        } else {
            turned(&mut pose.orientation, (spin + twist.angular) * half);
        }
    }
}

#[inline]
pub(super) fn is_finite(twist: &Twist) -> bool {
    twist.linear.iter().chain(&twist.angular).all(|x| x.is_finite())
}

/// Turns `q` by the small rotation vector `by`.
#[inline]
fn turned(q: &mut Rotation, by: Vector) {
    if by != Vector::zeros() {
        *q = turn(by) * *q;
        q.renormalize_fast();
    }
}
