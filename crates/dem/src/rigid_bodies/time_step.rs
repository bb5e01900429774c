//! How long a sub-step may be.
use super::RigidBodies;
use super::body::{Constants, Kind};
use super::depth::Geometry;
use crate::contact::{ContactLaw, LEAST_STEPS};
use crate::{DemError, PairProperties, SubStepLimit};
use interfaces::BodyId;
use std::f64::consts::PI;

/// Sub-steps per half period of the stiffest contact foreseen.
const STEPS_PER_CONTACT: f64 = 33.0;
/// Share of [`LEAST_STEPS`] that is still accepted.
const FEWEST_STEPS: f64 = 22.0;
/// Overlap, in radii of the smaller body, up to which that stiffness is foreseen.
const FORESEEN_DEPTH: f64 = 0.05;
/// Share of both bodies' inner radii by which they may come nearer in a sub-step.
const TRAVEL: f64 = 0.05;
/// What of it is still accepted, when pairs are listed amid a sub-step.
const MOST_TRAVEL: f64 = 0.1;
/// More sub-steps than this within one advance are an error.
const MOST: f64 = 1e8;

impl<L: ContactLaw> RigidBodies<L> {
    /// The longest stable step, over all bodies; none is less than `bound`, at which the search
    /// ends.
    pub(super) fn least_stable_dt(&self, bound: f64) -> f64 {
        let mut least = f64::INFINITY;
        for b in 0..self.bodies.len() {
            least = least.min(self.stable_dt_of(b)).min(self.stable_dt_of_tether(b));
            if least <= bound {
                break;
            }
        }
        least
    }

    /// The longest stable step for `b` against its own kind and against the walls.
    pub(super) fn stable_dt_of(&self, b: usize) -> f64 {
        let (body, constants) = (&self.bodies[b], &self.constants[b]);
        if !constants.movable() {
            return f64::INFINITY;
        }
        let with = |material: u32, wall: bool| {
            self.half_period(constants, body.is_plane(), self.pair_properties(body.material, material), wall)
        };
        let own = with(body.material, false);
        self.walls.iter().map(|w| with(w.material, true)).fold(own, f64::min) / STEPS_PER_CONTACT
    }

    /// π√(m/k) of a contact at the foreseen depth, with a wall or the body's like; k as the law answers for a cap, or for the largest flat
    /// face.
    fn half_period(&self, c: &Constants, plane: bool, properties: &PairProperties, wall: bool) -> f64 {
        let r = c.size;
        let depth = FORESEEN_DEPTH * r * if wall { 1.0 } else { 0.5 };
        let chord = (depth * (2.0 * r - depth)).sqrt();
        let (area, volume) = if plane {
            (2.0 * chord, 4.0 / 3.0 * chord * depth)
        } else {
            (PI * chord * chord, PI * depth * depth * r)
        };
        let of = |patch: [f64; 4]| {
            let (push, masses) = Geometry::new(c, patch, [plane, wall]).push(&self.law, properties);
            PI / (push.stiffness * (masses[0] + masses[1])).sqrt()
        };
        let cap = of([area, volume, r, 0.0]);
        if c.flat > area { cap.min(of([c.flat, c.flat * depth, c.inner, c.flat])) } else { cap }
    }

    /// The longest sub-step as things stand: what was foreseen, what the stiffest contact asks for, and what keeps bodies from
    /// passing through one another.
    pub(super) fn longest_step(&self) -> f64 {
        let contact = PI / (LEAST_STEPS * self.stiffest.sqrt());
        let travel = TRAVEL / self.fastest;
        self.stable_dt.min(contact).min(travel)
    }

    /// Was a sub-step longer than the contacts that it met allow, or bodies that turned out to be near?
    pub(super) fn is_too_long(&self, dt: f64) -> bool {
        dt * self.stiffest.sqrt() * FEWEST_STEPS > PI || dt * self.fastest > MOST_TRAVEL
    }

    /// Into how many sub-steps `dt` is divided.
    pub(super) fn n_steps(&self, dt: f64) -> Result<f64, DemError> {
        let longest = self.longest_step();
        let steps = (dt / longest).ceil().max(1.0);
        // Not a number fails, too.
        if steps <= MOST { Ok(steps) } else { Err(DemError::SubSteps { limit: self.limit(), dt, longest }) }
    }

    /// Cause of the longest sub-step.
    fn limit(&self) -> SubStepLimit {
        let contact = PI / (LEAST_STEPS * self.stiffest.sqrt());
        if TRAVEL / self.fastest < self.stable_dt.min(contact) {
            return SubStepLimit::Speed;
        } else if contact < self.stable_dt {
            return SubStepLimit::Contact;
        }
        let least = |of: &dyn Fn(usize) -> f64| {
            let bodies = (0..self.bodies.len()).map(|b| (b, of(b)));
            bodies.min_by(|x, y| x.1.total_cmp(&y.1)).unwrap_or((0, f64::INFINITY))
        };
        let (tether, material) = (least(&|b| self.stable_dt_of_tether(b)), least(&|b| self.stable_dt_of(b)));
        if tether.1 < material.1 {
            SubStepLimit::Tether(BodyId(tether.0))
        } else {
            SubStepLimit::Material(BodyId(material.0))
        }
    }

    /// The largest rate at which near bodies may come nearer to one another, by their inner radii \[1/s\].
    pub(super) fn fastest_approach(&self) -> f64 {
        let motion = |b: usize| {
            let body = &self.bodies[b];
            let tip = if body.kind == Kind::Other { body.twist.angular.norm() * body.radius } else { 0.0 };
            (body.twist.linear, tip, self.constants[b].inner)
        };
        let rate = |pair: &crate::broad_phase::NearPair| {
            let (u, tip, inner) = motion(pair.a as usize);
            if (pair.b as usize) < self.bodies.len() {
                let (v, other, within) = motion(pair.b as usize);
                ((u - v).norm() + tip + other) / (inner + within)
            } else {
                (u.norm() + tip) / inner
            }
        };
        self.near.iter().map(rate).fold(0.0, f64::max)
    }
}
