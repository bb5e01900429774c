//! Which pairs are near, for how long.
use super::RigidBodies;
use super::body::{Body, Constants, Kind};
use super::contacts::{CHUNK, Chunk, Patch, wall_number};
use super::meeting::shift;
use crate::DemError;
use crate::broad_phase::{NearPair, PairListError};
use crate::contact::ContactLaw;
use interfaces::{Aabb, BodyId, Load, Point, Pose, Rotation, Vector, Wrench};

/// Sub-steps for which pairs are listed.
const HORIZON: f64 = 40.0;
/// Radii by which bodies may go astray besides, having been pushed.
const SKIN: f64 = 0.02;

/// Where a body was when pairs were listed, and how far its surface may go before they have to be listed anew.
#[derive(Clone, Copy, Debug)]
pub(super) struct Listed {
    pub(super) centre: Point,
    pub(super) orientation: Rotation,
    pub(super) margin: f64,
}

impl Listed {
    /// Nowhere yet.
    pub(super) fn not_yet() -> Self {
        Self { centre: Point::origin(), orientation: Rotation::identity(), margin: -1.0 }
    }

    /// Of a body that is foreseen to move for `dt`, the next `step` of it in any case and the rest if that is no farther than `room`.
    fn new(body: &Body, constants: &Constants, pull: &Pull<'_>, [step, dt]: [f64; 2], room: f64) -> Self {
        let at_rest = !constants.movable() && body.twist == Default::default();
        let skin = if at_rest { 0.0 } else { SKIN * constants.size };
        let way = |dt: f64| path(body, constants, pull, dt);
        let margin = skin + way(dt).min(way(step).max(room));
        Self { centre: body.pose.position, orientation: body.pose.orientation, margin }
    }

    /// How far the surface has gone at most.
    #[inline]
    fn gone(&self, body: &Body) -> f64 {
        let moved = (body.pose.position - self.centre).norm();
        if body.kind == Kind::Other { moved + self.turned(body) } else { moved }
    }

    /// Has the surface gone farther than the margin?
    #[inline]
    pub(super) fn is_left(&self, body: &Body) -> bool {
        let margin = if body.kind == Kind::Other { self.margin - self.turned(body) } else { self.margin };
        margin < 0.0 || (body.pose.position - self.centre).norm_squared() > margin * margin
    }

    /// How far the surface has gone at most by turning.
    #[inline]
    fn turned(&self, body: &Body) -> f64 {
        // |q − p| is at least 0.9 times half the angle between them, up to a right angle; the other sign is the same turn.
        let (p, q) = (&self.orientation.coords, &body.pose.orientation.coords);
        2.3 * (q - p).norm_squared().min((q + p).norm_squared()).sqrt() * body.radius
    }
}

/// What pulls at a body.
struct Pull<'a> {
    load: &'a Load,
    contact: &'a Wrench,
    gravity: &'a Vector,
}

/// How far the surface goes within `dt` if nothing but load and weight changes its velocity; where contacts bear these, not even they.
fn path(body: &Body, constants: &Constants, pull: &Pull<'_>, dt: f64) -> f64 {
    let mut speed = body.twist.linear.norm();
    if !constants.pinned() {
        let mass = constants.mass;
        let pulled = pull.load.wrench.force + pull.gravity * mass;
        let force = pulled.norm().min((pulled + pull.contact.force).norm());
        speed += 0.5 * dt * force / (mass + pull.load.added_mass);
    }
    if body.kind == Kind::Other {
        speed += body.twist.angular.norm() * body.radius;
    }
    dt * speed
}

impl<L: ContactLaw> RigidBodies<L> {
    /// May a body leave what was listed for it within `dt`?
    pub(super) fn may_stray(&self, dt: f64) -> bool {
        if !L::TOUCHES {
            return self.listed.iter().any(|l| l.margin < 0.0);
        }
        self.bodies.iter().zip(&self.listed).enumerate().any(|(b, (body, listed))| {
            if self.sleepers.is_asleep(b) {
                return listed.margin < 0.0;
            }
            listed.gone(body) + path(body, &self.constants[b], &self.pull(b), dt) > listed.margin
        })
    }

    /// For how long pairs are listed when the next step is `dt` long.
    pub(super) fn horizon(&self, dt: f64) -> f64 {
        if self.stable_dt.is_finite() { dt.max(HORIZON * self.stable_dt) } else { dt }
    }

    fn pull(&self, b: usize) -> Pull<'_> {
        Pull { load: self.loads.of(b), contact: &self.contact[b], gravity: &self.gravity }
    }

    /// Has a body gone farther than foreseen?
    pub(super) fn strayed(&self) -> bool {
        self.bodies.iter().zip(&self.listed).any(|(body, listed)| listed.is_left(body))
    }

    /// Where body `b` may be within `dt`.
    fn listing(&self, b: usize, times: [f64; 2], room: f64) -> Listed {
        let body = &self.bodies[b];
        if !L::TOUCHES || self.sleepers.is_asleep(b) {
            // Where nobody touches anybody, no way is too far.
            let margin = if L::TOUCHES { 0.0 } else { f64::INFINITY };
            Listed { centre: body.pose.position, orientation: body.pose.orientation, margin }
        } else {
            Listed::new(body, &self.constants[b], &self.pull(b), times, room)
        }
    }

    /// The box of all places where body `b` is listed to be.
    fn listed_box(&self, b: usize) -> Aabb {
        let (Listed { centre, orientation, margin }, r) = (self.listed[b], self.bodies[b].radius);
        let own = match self.bodies[b].kind {
            Kind::Ball => Aabb::around(centre, Vector::new(r, r, r)),
            Kind::Disc => Aabb::around(centre, Vector::new(r, r, 0.0)),
            Kind::Other => self.constants[b].shape.aabb().posed(&Pose { position: centre, orientation }),
        };
        own.grown(margin + 0.5 * self.law.reach())
    }

    /// Lists the pairs whose boxes may meet within `dt`, or within some sub-steps: of all bodies, so that long passes before it has to be done again.
    /// (Of a few only, by `PairList::refresh`, it would have to be done for others soon after, and costs as much for all pairs.)
    pub(super) fn list(&mut self, dt: f64) -> Result<(), DemError> {
        let times = [dt, self.horizon(dt)];
        self.listed_for = times[1];
        // Farther than a period everybody is met again.
        let room = (0..3).filter_map(|a| self.periods.along(a)).fold(f64::INFINITY, f64::min);
        for b in 0..self.bodies.len() {
            self.listed[b] = self.listing(b, times, room);
        }
        self.list_again()
    }

    /// Lists the pairs by where bodies are listed to be.
    pub(super) fn list_again(&mut self) -> Result<(), DemError> {
        if !L::TOUCHES {
            return Ok(());
        }
        self.boxes.clear();
        self.boxes.reserve(self.bodies.len());
        for b in 0..self.bodies.len() {
            let own = self.listed_box(b);
            self.boxes.push(own);
        }
        self.movable.clear();
        self.movable.extend(self.constants.iter().map(Constants::movable));
        let listed = self.pairs.list(&self.boxes, &self.movable);
        self.gather(listed)
    }

    /// Gathers the pairs that are near from those whose boxes meet, with the walls'.
    fn gather(&mut self, listed: Result<(), PairListError>) -> Result<(), DemError> {
        listed.map_err(|error| match error {
            // Where bodies are to start was checked.
            PairListError::Box { body, .. } => {
                DemError::Diverged { body: BodyId(body), velocity: self.bodies[body].twist.linear.into() }
            }
            // Bodies as such are no longer than a period.
            PairListError::Size { body, axis, size, period } => {
                let speed = self.bodies[body].twist.linear.norm();
                DemError::TooFast { body: BodyId(body), speed, way: 0.5 * size, axis, period }
            }
            other => other.into(),
        })?;
        std::mem::swap(&mut self.near, &mut self.last_near);
        self.near.clear();
        // Boxes that meet at their corners hold balls that are far apart.
        let (bodies, listed, periods) = (&self.bodies, &self.listed, &self.periods);
        let (constants, sleepers, film) = (&self.constants, &self.sleepers, self.law.reach());
        let lies = |b: usize| sleepers.lies(b, &bodies[b], &constants[b]);
        let spheres_meet = |pair: &&NearPair| {
            let (a, b) = (pair.a as usize, pair.b as usize);
            let apart = listed[b].centre + shift(periods, pair.image) - listed[a].centre;
            let within = bodies[a].radius + listed[a].margin + bodies[b].radius + listed[b].margin + film;
            let lie = sleepers.n > 0 && lies(a) && lies(b);
            apart.norm_squared() <= within * within && !lie
        };
        self.near.extend(self.pairs.pairs().iter().filter(spheres_meet));
        let pairs = self.near.len();
        for (w, wall) in self.walls.iter().enumerate() {
            for (b, listed) in self.listed.iter().enumerate() {
                let reach = self.bodies[b].radius + listed.margin + film;
                if self.movable[b]
                    && !self.sleepers.is_asleep(b)
                    && wall.plane.signed_distance(listed.centre) <= reach
                {
                    self.near.push(NearPair { a: b as u32, b: wall_number(w), image: [0; 3] });
                }
            }
        }
        self.near[pairs..].sort_unstable();
        self.carry_over();
        self.felt.clear();
        self.fastest = self.fastest_approach();
        Ok(())
    }

    /// Gives the patches of the last list to the pairs of the new one.
    fn carry_over(&mut self) {
        let n = self.bodies.len();
        let key = |p: &NearPair| (p.b as usize >= n, *p);
        self.carried.clear();
        for chunk in &mut self.chunks {
            let pair = |p: &Patch<L::Memory>| self.last_near[p.near as usize];
            self.carried.extend(chunk.patches.drain(..).map(|p| (pair(&p), p)));
        }
        if !self.sleepers.woken.is_empty() {
            self.carried.append(&mut self.sleepers.woken);
            self.carried.sort_by_key(|(pair, _)| key(pair));
        }
        let wanted = self.near.len().div_ceil(CHUNK);
        while self.chunks.len() < wanted {
            self.chunks.push(Chunk::default());
        }
        let mut at = 0;
        for (pair, patch) in &self.carried {
            while at < self.near.len() && key(&self.near[at]) < key(pair) {
                at += 1;
            }
            if self.near.get(at) == Some(pair) {
                self.chunks[at / CHUNK].patches.push(Patch { near: at as u32, ..*patch });
            }
        }
    }
}
