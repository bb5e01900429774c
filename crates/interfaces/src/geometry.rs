//! Positions, motions and loads.
use nalgebra::{Point3, UnitQuaternion, Vector3};

/// A place in space \[m\].
pub type Point = Point3<f64>;
/// A direction, displacement, velocity, force … in space.
pub type Vector = Vector3<f64>;
/// An orientation: turns body-frame vectors into world-frame vectors.
pub type Rotation = UnitQuaternion<f64>;

/// Where a body is: the place of its centre of mass and its orientation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Centre of mass \[m\]; in periodic boxes it runs on without wrapping.
    pub position: Point,
    /// Turns body-frame vectors into world-frame vectors.
    pub orientation: Rotation,
}

impl Pose {
    /// At `position`, not turned.
    pub fn at(position: [f64; 3]) -> Self {
        Self { position: position.into(), orientation: Rotation::identity() }
    }
    /// A world point in the body's frame.
    #[inline]
    pub fn to_body(&self, x: Point) -> Point {
        Point::from(self.orientation.inverse_transform_vector(&(x - self.position)))
    }
    /// Where something is in the world that is at `inner` in the body's frame.
    #[must_use]
    pub fn of(&self, inner: &Self) -> Self {
        let position = self.to_world(inner.position);
        Self { position, orientation: self.orientation * inner.orientation }
    }
    /// A point of the body's frame in the world.
    pub fn to_world(&self, x: Point) -> Point {
        self.position + self.orientation * x.coords
    }
}

/// How a body moves: velocity of the centre of mass and angular velocity, in the world frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twist {
    /// Velocity of the centre of mass \[m/s\].
    pub linear: Vector,
    /// Angular velocity \[rad/s\].
    pub angular: Vector,
}

impl Twist {
    /// Velocity of the material point at `arm` from the centre of mass: U + Ω × r \[m/s\].
    #[inline]
    pub fn at(&self, arm: Vector) -> Vector {
        self.linear + self.angular.cross(&arm)
    }
}

/// A force and the torque about the body's centre of mass; also their time integrals.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// Force \[N\] (impulse: N s).
    pub force: Vector,
    /// Torque \[N m\] (impulse: N m s).
    pub torque: Vector,
}

impl Wrench {
    /// A force that acts at `arm` from the centre of mass.
    #[inline]
    pub fn at(force: Vector, arm: Vector) -> Self {
        Self { force, torque: arm.cross(&force) }
    }
}

impl std::ops::Add for Wrench {
    type Output = Self;
    #[inline]
    fn add(self, o: Self) -> Self {
        Self { force: self.force + o.force, torque: self.torque + o.torque }
    }
}
impl std::ops::AddAssign for Wrench {
    #[inline]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}
impl std::ops::Sub for Wrench {
    type Output = Self;
    #[inline]
    fn sub(self, o: Self) -> Self {
        self + o * -1.0
    }
}
impl std::ops::Mul<f64> for Wrench {
    type Output = Self;
    #[inline]
    fn mul(self, s: f64) -> Self {
        Self { force: self.force * s, torque: self.torque * s }
    }
}

/// An axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Lower corner \[m\].
    pub min: Point,
    /// Upper corner \[m\].
    pub max: Point,
}

impl Aabb {
    /// The box of half-widths `half` around `centre`.
    #[inline]
    pub fn around(centre: Point, half: Vector) -> Self {
        Self { min: centre - half, max: centre + half }
    }
    /// Widened by `margin` on every side.
    #[inline]
    pub fn grown(&self, margin: f64) -> Self {
        let m = Vector::repeat(margin);
        Self { min: self.min - m, max: self.max + m }
    }
    /// Edge lengths \[m\].
    pub fn extent(&self) -> Vector {
        self.max - self.min
    }
    /// The box around this body-frame box once the body stands at `pose`.
    pub fn posed(&self, pose: &Pose) -> Self {
        let centre = nalgebra::center(&self.min, &self.max);
        let r = pose.orientation.to_rotation_matrix();
        let half = r.matrix().abs() * (self.extent() * 0.5);
        Self::around(pose.to_world(centre), half)
    }
}

/// Relative precision of the lengths of bodies, 4.8e-7. Coordinates of mesh files are in single
/// precision, each rounded by up to ε/2 of itself (ε = 2⁻²³), so an extent is off by up to ε times
/// the farthest coordinate: 4 ε of the extent for a body that is up to four times as far from the
/// file's origin as it is long.
pub const LENGTH_PRECISION: f64 = 4.0 * f32::EPSILON as f64;

/// Whether a `size` \[m\] is more than `room` \[m\], a period or the length of a box, by more than
/// [`LENGTH_PRECISION`] of that.
///
/// ```
/// use interfaces::is_longer;
/// // Half a metre and its nearest number in single precision that is larger.
/// assert!(!is_longer(f64::from(0.5_f32.next_up()), 0.5));
/// assert!(is_longer(0.5 * (1.0 + 1e-6), 0.5));
/// ```
pub fn is_longer(size: f64, room: f64) -> bool {
    size > room * (1.0 + LENGTH_PRECISION)
}

/// The periods of space: `None` where a direction does not repeat.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Periods {
    lengths: [Option<f64>; 3],
}

impl Periods {
    /// Space that repeats after `lengths` \[m\].
    pub fn new(lengths: [Option<f64>; 3]) -> Self {
        Self { lengths }
    }
    /// The period along axis `a`, if it has one.
    #[inline]
    pub fn along(&self, a: usize) -> Option<f64> {
        self.lengths[a]
    }
    /// The difference vector to the nearest image: each component within ± half a period.
    pub fn nearest(&self, mut d: Vector) -> Vector {
        for a in 0..3 {
            if let Some(l) = self.lengths[a] {
                d[a] -= l * (d[a] / l).round();
            }
        }
        d
    }
    /// The image of `x` within one period from `origin`.
    pub fn wrap(&self, mut x: Point, origin: Point) -> Point {
        for a in 0..3 {
            if let Some(l) = self.lengths[a] {
                x[a] -= l * ((x[a] - origin[a]) / l).floor();
            }
        }
        x
    }
}
