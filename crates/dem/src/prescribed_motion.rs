//! Motion of bodies given as functions of time.
use interfaces::{Point, Pose, Rotation, Twist, Vector};
use nalgebra::Unit;
use std::fmt;
use std::sync::Arc;

/// Rigid motion that functions of time t \[s\] give: a shift s and a turn by θ about an axis
/// through a pivot p, which the shift moves, too. With the centre of mass at x₀ when t = 0 it is at
///
/// x(t) = x₀ + s(t) − s(0) + (R(θ(t) − θ(0)) − 1)(x₀ − p).
///
/// ```
/// use dem::{Cuboid, Material, PrescribedMotion, RigidBodies};
/// use dem::{Dynamics, Freedom, Kinematics, Periods, Pose, Twist, Vector};
///
/// // A flap of 20 cm that swings about a hinge at its lower end.
/// let (hinge, pose) = ([0.0; 3].into(), Pose::at([0.0, 0.1, 0.0]));
/// let swing = |t: f64| 0.5 * t.sin();
/// let motion = PrescribedMotion::default()
///     .with_turn(Vector::z_axis(), swing)
///     .with_pivot(hinge, pose.position);
/// let mut bodies = RigidBodies::new(Periods::default());
/// let flap = Cuboid::new([0.02, 0.2, 0.1])?;
/// let flap = bodies.add(flap, Material::default(), pose, Twist::default(), Freedom::NONE)?;
/// let dt = 0.01;
/// for step in 0..100 {
///     bodies.set_twist(flap, motion.mean(f64::from(step) * dt, dt));
///     bodies.advance(dt)?;
/// }
/// let (angle, x) = (swing(1.0), bodies.pose(flap).position);
/// assert!((x.x + 0.1 * angle.sin()).abs() < 1e-12 && (x.y - 0.1 * angle.cos()).abs() < 1e-12);
/// let expected = motion.pose(&pose, 1.0);
/// assert!((expected.position - x).norm() < 1e-12);
/// assert!(expected.orientation.angle_to(&bodies.pose(flap).orientation) < 1e-12);
/// # Ok::<(), dem::DemError>(())
/// ```
#[derive(Clone, Default)]
pub struct PrescribedMotion {
    shift: Option<Function<Vector>>,
    turn: Option<(Function<f64>, Unit<Vector>)>,
    /// Velocity of the pivot besides s′ \[m/s\], and angular velocity besides θ′ \[rad/s\].
    velocity: Option<Function<Vector>>,
    spin: Option<Function<Vector>>,
    /// From the pivot to the centre of mass at t = 0 \[m\].
    arm: Vector,
}

type Function<T> = Arc<dyn Fn(f64) -> T + Send + Sync>;

/// Velocities are differences over this share of a step.
const SHARE: f64 = 1e-2;

/// Gauss–Legendre points on \[0, 1\] and their weights: exact for polynomials of degree 5.
const GAUSS: [[f64; 2]; 3] =
    [[0.112_701_665_379_258_3, 5.0 / 18.0], [0.5, 8.0 / 18.0], [0.887_298_334_620_741_7, 5.0 / 18.0]];
/// Intervals by which a pose is integrated from t = 0.
const INTERVALS: u32 = 64;

/// Mean of a function from `t` to `t + dt` \[s\].
fn average(f: Option<&Function<Vector>>, t: f64, dt: f64) -> Vector {
    let Some(f) = f else { return Vector::zeros() };
    GAUSS.iter().map(|[share, weight]| *weight * f(t + share * dt)).sum()
}

impl PrescribedMotion {
    /// The same with this shift \[m\] as a function of time.
    #[must_use]
    pub fn with_shift(mut self, shift: impl Fn(f64) -> Vector + Send + Sync + 'static) -> Self {
        self.shift = Some(Arc::new(shift));
        self
    }
    /// The same with a turn about `axis` by this angle \[rad\] as a function of time.
    #[must_use]
    pub fn with_turn(
        mut self,
        axis: Unit<Vector>,
        angle: impl Fn(f64) -> f64 + Send + Sync + 'static,
    ) -> Self {
        self.turn = Some((Arc::new(angle), axis));
        self
    }
    /// The same with a turn about the point that is at `pivot` when the centre of mass is at
    /// `centre` \[m\], both at t = 0. Without it bodies turn about their centre of mass.
    #[must_use]
    pub fn with_pivot(mut self, pivot: Point, centre: Point) -> Self {
        self.arm = centre - pivot;
        self
    }

    /// The same with this velocity \[m/s\] as a function of time, added to that of the shift and
    /// integrated by three Gauss points per step. A pivot has this velocity, too.
    #[must_use]
    pub fn with_velocity(mut self, velocity: impl Fn(f64) -> Vector + Send + Sync + 'static) -> Self {
        self.velocity = Some(Arc::new(velocity));
        self
    }
    /// The same with this angular velocity \[rad/s\] about the centre of mass as a function of
    /// time, added to that of the turn and integrated like the velocity.
    #[must_use]
    pub fn with_spin(mut self, spin: impl Fn(f64) -> Vector + Send + Sync + 'static) -> Self {
        self.spin = Some(Arc::new(spin));
        self
    }

    fn angle(&self, t: f64) -> Vector {
        self.turn.as_ref().map_or_else(Vector::zeros, |(angle, axis)| angle(t) * **axis)
    }
    /// Displacement of the centre of mass since t = 0, plus s(0) \[m\].
    fn displacement(&self, t: f64) -> Vector {
        let shift = self.shift.as_ref().map_or_else(Vector::zeros, |shift| shift(t));
        if self.arm == Vector::zeros() {
            return shift;
        }
        let turn = Rotation::from_scaled_axis(self.angle(t) - self.angle(0.0));
        shift + (turn * self.arm - self.arm)
    }

    /// Pose at `t` \[s\] of a body that is at `start` when t = 0.
    pub fn pose(&self, start: &Pose, t: f64) -> Pose {
        let turn = Rotation::from_scaled_axis(self.angle(t) - self.angle(0.0));
        let mut pose = Pose {
            position: start.position + self.displacement(t) - self.displacement(0.0),
            orientation: turn * start.orientation,
        };
        if self.velocity.is_some() || self.spin.is_some() {
            let dt = t / f64::from(INTERVALS);
            for from in (0..INTERVALS).map(|i| f64::from(i) * dt) {
                pose.position += dt * average(self.velocity.as_ref(), from, dt);
                let turn = Rotation::from_scaled_axis(dt * average(self.spin.as_ref(), from, dt));
                pose.orientation = turn * pose.orientation;
            }
        }
        pose
    }

    /// Mean velocity from `t` to `t + dt` \[s\]: with it a body is at the end where shift and turn
    /// say, up to round-off.
    pub fn mean(&self, t: f64, dt: f64) -> Twist {
        let Twist { linear, angular } = self.differences(t, dt);
        Twist {
            linear: linear + average(self.velocity.as_ref(), t, dt),
            angular: angular + average(self.spin.as_ref(), t, dt),
        }
    }
    /// The part of the mean velocity that shift and turn have.
    fn differences(&self, t: f64, dt: f64) -> Twist {
        let rate = |f: fn(&Self, f64) -> Vector| (f(self, t + dt) - f(self, t)) / dt;
        Twist { linear: rate(Self::displacement), angular: rate(Self::angle) }
    }
    /// Velocity at `t` \[s\], by differences over a hundredth of `dt` \[s\] to both sides, or to
    /// the one where the functions are finite.
    pub fn velocity(&self, t: f64, dt: f64) -> Twist {
        let h = SHARE * dt;
        let finite = |twist: &Twist| (twist.linear + twist.angular).iter().all(|v| v.is_finite());
        let both = self.differences(t - h, 2.0 * h);
        let before = || Some(self.differences(t - h, h)).filter(finite);
        let rates = if finite(&both) { both } else { before().unwrap_or_else(|| self.differences(t, h)) };
        let at = |f: Option<&Function<Vector>>| f.map_or_else(Vector::zeros, |f| f(t));
        Twist {
            linear: rates.linear + at(self.velocity.as_ref()),
            angular: rates.angular + at(self.spin.as_ref()),
        }
    }
}

impl fmt::Debug for PrescribedMotion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { shift, turn, velocity, spin, arm } = self;
        let axis = turn.as_ref().map(|(_, axis)| axis);
        f.debug_struct("PrescribedMotion")
            .field("shifts", &shift.is_some())
            .field("axis", &axis)
            .field("has_velocity", &velocity.is_some())
            .field("spins", &spin.is_some())
            .field("arm", arm)
            .finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A velocity and a spin about an axis of constant direction are integrated to the path that they
    /// are derivatives of, with an error of sixth order in the step.
    #[test]
    fn velocities_are_integrated() {
        let axis = Unit::new_normalize(Vector::new(1.0, -0.5, 2.0));
        let motion = PrescribedMotion::default()
            .with_velocity(|t| Vector::new(t.cos(), 5.0 * t.powi(4), 0.0))
            .with_spin(move |t| 0.3 * t.cos() * *axis);
        let start = Pose::at([1.0, 2.0, 3.0]);
        let error = |dt: f64| {
            let (mut x, mut turned) = (start.position, 0.0);
            for step in 0..(1.0 / dt).round() as u32 {
                let Twist { linear, angular } = motion.mean(f64::from(step) * dt, dt);
                x += dt * linear;
                turned += dt * angular.dot(&axis);
            }
            let exact = start.position + Vector::new(1.0_f64.sin(), 1.0, 0.0);
            (x - exact).norm() + (turned - 0.3 * 1.0_f64.sin()).abs()
        };
        assert!(error(0.1) < 1e-9 && error(0.5) / error(0.25) > 50.0, "{} {}", error(0.5), error(0.25));
        let pose = motion.pose(&start, 1.0);
        assert!((pose.position - start.position - Vector::new(1.0_f64.sin(), 1.0, 0.0)).norm() < 1e-12);
        assert!((pose.orientation.angle() - 0.3 * 1.0_f64.sin()).abs() < 1e-12);
        let Twist { linear, angular } = motion.velocity(0.5, 0.1);
        assert_eq!(linear, Vector::new(0.5_f64.cos(), 5.0 * 0.5_f64.powi(4), 0.0));
        assert_eq!(angular, 0.3 * 0.5_f64.cos() * *axis);
    }

    /// A body that turns about a pivot that itself is shifted: the velocity of the centre of mass
    /// is s′ + ω × r, and mean velocities add up to the path.
    #[test]
    fn velocity_is_that_of_a_turn_about_the_pivot() {
        let axis = Unit::new_normalize(Vector::new(1.0, 2.0, -0.5));
        let (pivot, centre) = (Point::new(0.3, -0.2, 1.0), Point::new(1.0, 0.5, 0.7));
        let motion = PrescribedMotion::default()
            .with_shift(|t| Vector::new(1.0 + t * t, 0.0, 0.5 * t))
            .with_turn(axis, |t| 0.4 + 0.7 * t)
            .with_pivot(pivot, centre);
        let (dt, mut x) = (0.1, centre);
        for step in 0..20 {
            let t = f64::from(step) * dt;
            let arm = Rotation::from_axis_angle(&axis, 0.7 * t) * (centre - pivot);
            let expected = pivot + Vector::new(t * t, 0.0, 0.5 * t) + arm;
            assert!((x - expected).norm() < 1e-14, "{t}: {x} {expected}");
            let Twist { linear, angular } = motion.velocity(t, dt);
            let omega = 0.7 * *axis;
            assert!((angular - omega).norm() < 1e-11);
            assert!((linear - Vector::new(2.0 * t, 0.0, 0.5) - omega.cross(&arm)).norm() < 1e-6, "{t}");
            x += dt * motion.mean(t, dt).linear;
        }
    }
}
