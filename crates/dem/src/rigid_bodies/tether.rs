//! Bodies on springs.
use super::RigidBodies;
use super::body::{Body, Constants, Kind};
use crate::DemError;
use crate::contact::ContactLaw;
use interfaces::{BodyId, Point, Pose, Rotation, Twist, Wrench};
use std::f64::consts::PI;

/// A spring and a dashpot, side by side, between a point of a body and a place that stays: F = −k (x − x₀) − c v at that point. A spring for
/// some directions only needs a body that is free in these only ([`Freedom`](interfaces::Freedom)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tether {
    /// The point, in the body's frame \[m\].
    pub on_body: Point,
    /// The place x₀ in the world \[m\]; it is not looked for over periodic sides.
    pub anchor: Point,
    /// k \[N/m\]; in a plane scene per metre of depth.
    pub stiffness: f64,
    /// c \[N s/m\].
    pub damping: f64,
}

/// Steps per half period of a tethered body.
const STEPS: f64 = 33.0;
/// Largest c dt/m of a step.
const MOST_DAMPING: f64 = 0.2;

impl Tether {
    /// Force and torque on a body, about its centre of mass.
    pub fn wrench(&self, pose: &Pose, twist: &Twist) -> Wrench {
        let arm = pose.orientation * self.on_body.coords;
        let stretch = pose.position + arm - self.anchor;
        let force = -self.stiffness * stretch - self.damping * twist.at(arm);
        Wrench { force, torque: arm.cross(&force) }
    }

    /// ½k|x − x₀|² \[J\].
    pub fn energy(&self, pose: &Pose) -> f64 {
        let stretch = pose.position + pose.orientation * self.on_body.coords - self.anchor;
        0.5 * self.stiffness * stretch.norm_squared()
    }

    /// The longest step in which it is followed.
    fn stable_dt(&self, constants: &Constants) -> f64 {
        let inertia = &constants.inertia;
        let least = [0, 1, 2].map(|i| inertia.tensor[(i, i)]).into_iter().filter(|i| *i > 0.0);
        let turning = self.on_body.coords.norm_squared() / least.fold(f64::INFINITY, f64::min);
        let mass = 1.0 / (1.0 / inertia.mass + turning);
        (PI * (mass / self.stiffness).sqrt() / STEPS).min(MOST_DAMPING * mass / self.damping)
    }

    fn is_sensible(&self) -> bool {
        let places = self.on_body.iter().chain(self.anchor.iter());
        places.chain([&self.stiffness, &self.damping]).all(|x| x.is_finite())
            && self.stiffness >= 0.0
            && self.damping >= 0.0
    }
}

impl<L: ContactLaw> RigidBodies<L> {
    /// Ties body `b`, or unties it. Its impulse is among those that [`contact_impulse`](interfaces::Dynamics::contact_impulse) tells. Tethers are part of the
    /// set-up, not of the saved state.
    ///
    /// # Errors
    /// [`DemError::NoSuchBody`]; [`DemError::Tether`] unless all its numbers are finite, and stiffness and damping not negative.
    pub fn set_tether(&mut self, b: BodyId, tether: Option<Tether>) -> Result<(), DemError> {
        if b.0 >= self.bodies.len() {
            return Err(DemError::NoSuchBody { body: b, bodies: self.bodies.len() });
        }
        if let Some(Tether { stiffness, damping, .. }) = tether.filter(|t| !t.is_sensible()) {
            return Err(DemError::Tether { body: b, stiffness, damping });
        }
        let before = self.tether(b).copied();
        if before == tether {
            return Ok(());
        }
        self.wake_all();
        self.tethers.resize(self.bodies.len(), None);
        let longest = self.stable_dt;
        self.tethers[b.0] = tether;
        self.tied = self.tied + usize::from(tether.is_some()) - usize::from(before.is_some());
        if self.tied == 0 {
            self.tethers.clear();
        }
        self.stable_dt = match before {
            None => longest.min(self.stable_dt_of_tether(b.0)),
            Some(_) => self.least_stable_dt(0.0),
        };
        Ok(())
    }

    /// The tether of body `b`.
    pub fn tether(&self, b: BodyId) -> Option<&Tether> {
        self.tethers.get(b.0)?.as_ref()
    }

    /// The longest step for the tether of `b`, if it has one.
    pub(super) fn stable_dt_of_tether(&self, b: usize) -> f64 {
        self.tether(BodyId(b)).map_or(f64::INFINITY, |t| t.stable_dt(&self.constants[b]))
    }
}

/// Force and torque of the tether of `b` amid a step of `dt`, if it has one. Round bodies have not turned yet then.
#[inline]
pub(super) fn pull_of(tethers: &[Option<Tether>], b: usize, body: &Body, dt: f64) -> Option<Wrench> {
    let tether = tethers.get(b)?.as_ref()?;
    let mut pose = body.pose;
    if body.kind != Kind::Other {
        pose.orientation = Rotation::from_scaled_axis(body.twist.angular * (0.5 * dt)) * pose.orientation;
    }
    Some(tether.wrench(&pose, &body.twist))
}
