//! Depth of overlaps, and the stiffness that makes them shallow.
use super::RigidBodies;
use super::body::{Constants, Kind};
use super::meeting::shift;
use super::{Contact, Partner};
use crate::contact::{ContactLaw, Push, Touch};
use crate::overlap::{Overlap, closed};
use crate::{Form, Material, PairProperties, Shape};
use interfaces::{BodyId, Freedom, Point, Vector};
use std::sync::Arc;

/// Depth over radius from which an overlap is no small change of the bodies' shapes: a tenth. Laws take forces from the overlap as
/// if it were small.
pub const DEEP: f64 = 0.1;

/// An overlap, by its depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Depth {
    /// The body, and what it overlaps.
    pub body: BodyId,
    /// The body or wall that it overlaps.
    pub partner: Partner,
    /// Place \[m\].
    pub point: Point,
    /// δ: exact of balls and discs; of other bodies from volume and area, V/A of flat faces and 2V/A else \[m\].
    pub depth: f64,
    /// Radius of a sphere (in a plane scene a disc) as large as the smaller one of both \[m\].
    pub radius: f64,
    /// Young's modulus of the body with which the same force would make half of [`DEEP`], the partner's being raised by the same
    /// factor \[Pa\].
    pub youngs_modulus: f64,
}

/// Depth of a body that rests on a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestingDepth {
    /// δ, at most the radius \[m\].
    pub depth: f64,
    /// Radius of a sphere (in a plane scene a disc) as large as the body \[m\].
    pub radius: f64,
    /// Young's modulus that would make it half of [`DEEP`], the wall's being raised by the same factor \[Pa\].
    pub youngs_modulus: f64,
}

/// Depth at which a body of this `shape` and `material` rests on a wall that bears a `load` \[N\] through it by `law`: by a flat face if it has
/// one, else as a sphere as large as the body. `None` without a force.
pub fn resting_depth<L: ContactLaw>(
    law: &L,
    shape: Arc<dyn Shape>,
    material: &Material,
    wall: &Material,
    load: f64,
) -> Option<RestingDepth> {
    let constants = Constants::new(shape, material.density, Freedom::FREE);
    let plane = constants.shape.form().is_plane();
    let properties = law.properties(material, wall);
    let flat = matches!(
        constants.shape.form(),
        Form::Hull(_) | Form::Facets(_) | Form::Polygon(_) | Form::Cylinder(_)
    );
    let face = if flat { constants.flat } else { 0.0 };
    let force =
        |depth: f64| Geometry::of_depth(&constants, depth, face, [plane, true]).force(law, &properties);
    let radius = constants.size;
    if !(L::TOUCHES && load > 0.0 && force(radius) > 0.0) {
        return None;
    }
    // Halve.
    let (mut low, mut high) = (0.0, radius);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if force(middle) < load { low = middle } else { high = middle }
    }
    let youngs_modulus = material.youngs_modulus * load / force(0.5 * DEEP * radius);
    Some(RestingDepth { depth: high, radius, youngs_modulus })
}

/// A static contact of a body with a wall or with its like, of some depth.
pub(super) struct Geometry {
    area: f64,
    volume: f64,
    arm: f64,
    face: f64,
    mass: f64,
    size: f64,
    plane: bool,
    wall: bool,
}

impl Geometry {
    /// A patch of this `area` and `volume`, `arm` from the centre; flat if `face` is above 0.
    pub(super) fn new(c: &Constants, [area, volume, arm, face]: [f64; 4], [plane, wall]: [bool; 2]) -> Self {
        Self { area, volume, arm, face, mass: c.inertia.mass, size: c.size, plane, wall }
    }

    /// Overlap of a sphere (in a plane scene a disc) as large as the body `depth` deep in a wall or in its like; or of a flat `face`, if that
    /// is above 0.
    fn of_depth(c: &Constants, depth: f64, face: f64, [plane, wall]: [bool; 2]) -> Self {
        if face > 0.0 {
            let arm = (c.inner - 0.5 * depth).max(0.5 * c.inner);
            return Self::new(c, [face, face * depth, arm, face], [plane, wall]);
        }
        // Depth of one of both, where two alike meet.
        let r = c.size;
        let own = (if wall { depth } else { 0.5 * depth }).min(r);
        let (at, n) = (Point::origin(), Vector::x());
        let part = if plane {
            closed::disc_wall(r, at, r - own, n).map(|o| [o.area(), o.volume, o.centroid.coords.norm()])
        } else {
            let lens = closed::cap_at_wall(r, at, r - own, n);
            Some([lens.area, lens.overlap.volume, lens.arms[0]])
        };
        let [area, volume, arm] = part.unwrap_or([0.0, 0.0, r]);
        let whole = if wall { [area, volume, arm, 0.0] } else { [area, 2.0 * volume, r - own, 0.0] };
        Self::new(c, whole, [plane, wall])
    }

    /// Force by the law, at rest.
    pub(super) fn push<L: ContactLaw>(&self, law: &L, properties: &PairProperties) -> (Push, [f64; 2]) {
        let Self { area, volume, arm, face, mass, size, plane, wall } = *self;
        let overlap = Overlap {
            volume,
            centroid: Point::origin(),
            normal: Vector::x(),
            gradient: -area * Vector::x(),
            moment: Vector::zeros(),
            pivot: nalgebra::Matrix3::zeros(),
        };
        let other = |own: f64| if wall { f64::INFINITY } else { own };
        let inverse_masses = [1.0 / mass, if wall { 0.0 } else { 1.0 / mass }];
        let touch = Touch {
            overlap: &overlap,
            area,
            volume,
            rate: 0.0,
            velocity: Vector::zeros(),
            spin: Vector::zeros(),
            inverse_masses,
            arms: [arm, other(arm)],
            sizes: [size, other(size)],
            mobility: area * area * (inverse_masses[0] + inverse_masses[1]),
            pivot: None,
            face,
            plane,
            dt: f64::MIN_POSITIVE,
            since: 0.0,
        };
        (law.push(properties, &touch, &mut L::Memory::default()), inverse_masses)
    }

    fn force<L: ContactLaw>(&self, law: &L, properties: &PairProperties) -> f64 {
        self.push(law, properties).0.force.norm()
    }
}

impl<L: ContactLaw> RigidBodies<L> {
    /// The overlap that was deepest in the last sub-step, over the radius of the smaller one of both; `None` without any.
    pub fn deepest(&self) -> Option<Depth> {
        let shallow = |c: Contact| (self.extent(&c), c);
        let deeper =
            |a: (Extent, Contact), b: (Extent, Contact)| if b.0.ratio() > a.0.ratio() { b } else { a };
        let (Extent { depth, radius, face }, contact) = self.contacts().map(shallow).reduce(deeper)?;
        let Contact { body, partner, point, .. } = contact;
        let (a, constants) = (&self.bodies[body.0], &self.constants[body.0]);
        let (material, wall) = match partner {
            Partner::Body(b, _) => (self.bodies[b.0].material, false),
            Partner::Wall(wall) => (self.walls[wall].material, true),
        };
        let properties = self.pair_properties(a.material, material);
        let force = |depth: f64| {
            Geometry::of_depth(constants, depth, face, [a.is_plane(), wall]).force(&self.law, properties)
        };
        let factor = force(depth) / force(0.5 * DEEP * radius);
        let youngs_modulus = self.materials[a.material as usize].youngs_modulus * factor;
        Some(Depth { body, partner, point, depth, radius, youngs_modulus })
    }

    fn extent(&self, contact: &Contact) -> Extent {
        let (a, c) = (&self.bodies[contact.body.0], &self.constants[contact.body.0]);
        let (mut radius, mut flat) = (c.size, c.flat);
        let (gap, round) = match contact.partner {
            Partner::Body(b, image) => {
                let (other, d) = (&self.bodies[b.0], &self.constants[b.0]);
                radius = radius.min(d.size);
                flat = flat.min(d.flat);
                let apart = other.pose.position + shift(&self.periods, image) - a.pose.position;
                (apart.norm() - a.radius - other.radius, other.kind != Kind::Other)
            }
            Partner::Wall(wall) => (self.walls[wall].plane.signed_distance(a.pose.position) - a.radius, true),
        };
        // Half a face and more counts as flat.
        let face = if contact.area > 0.5 * flat { flat } else { 0.0 };
        let depth = match round && a.kind != Kind::Other {
            true => -gap,
            false if contact.area <= 0.0 => f64::INFINITY,
            false if face > 0.0 => contact.volume / contact.area,
            false => 2.0 * contact.volume / contact.area,
        };
        // Whatever is inside is as deep as it is large.
        Extent { depth: depth.min(2.0 * radius), radius, face }
    }
}

/// Depth of an overlap, radius of the smaller one of both, and area of the flat face that it is of, if it is.
struct Extent {
    depth: f64,
    radius: f64,
    face: f64,
}

impl Extent {
    fn ratio(&self) -> f64 {
        self.depth / self.radius
    }
}
