//! Bodies in a flow.
use crate::error::Escape;
use crate::serials::Serials;
use crate::strategy::{Exchange, OneSolve, Strategy};
use crate::{CouplingError, FlowSolver, Immersed, Module, Timings};
use fv_mesh::CartesianGrid;
use ibm::{Forcing, Layer};
use interfaces::{
    Bodies, BodyId, Checkpoint, Dynamics, Renumbering, RestartError, Twist, Vector, VelocityField, Wrench,
    is_longer,
};
use nalgebra::{Matrix6, Vector6};

/// Bodies `B` immersed by the forcing `F`, moved by the flow, gravity and one another; `S` is the [`Strategy`] by which flow and
/// bodies learn of each other, [`OneSolve`] unless told.
///
/// With generalised velocities v = (U, Ω) and M_s the bodies' masses, every strategy solves
///
/// ```text
/// M_s vⁿ⁺¹ = M_s vⁿ + J + dt (ρ_s − ρ) V g + J_contact,    J = −ρ∫f_ib dV dt + Iⁿ⁺¹ − Iⁿ,
/// ```
///
/// I being the momentum of the fluid inside a body: the load includes its inertia. (Flows that look back further, [`FlowSolver::weights`], have
/// w₀Iⁿ⁺¹ + w₁Iⁿ + w₂Iⁿ⁻¹ for the difference and w₀ times the forcing's momentum.) What a strategy hands the bodies of J too late
/// or too early is kept (`δ`) and handed on in the next step, so every impulse that the fluid loses reaches a body.
///
/// A body may be partly outside an open side. Forces act on it where there is fluid; fluid inside that passes the side along with the body does not act on it: in its load Iⁿ is that of the part
/// that is in the box at the end of the step, Iⁿ + R(xⁿ⁺¹, vⁿ) − R(xⁿ, vⁿ) with R the momentum of rigid motion there. The ledger has the difference among what
/// [holds](Self::constraint_impulse) bodies.
pub struct Particles<F, B, S = OneSolve> {
    /// The bodies.
    pub bodies: B,
    /// How the fluid is made to follow them.
    pub forcing: F,
    /// How flow and bodies learn of each other.
    pub strategy: S,
    gravity: Vector,
    density: f64,
    pub(crate) states: Vec<State>,
    last_dt: f64,
    /// Of those that were put into the flow.
    serials: Serials,
}

/// What is kept of one body from step to step, as (linear, angular).
#[derive(Clone, Copy, Debug, Default)]
pub struct State {
    /// Iⁿ and Iⁿ⁻¹.
    pub internal: [Vector6<f64>; 2],
    /// δⁿ: impulse of the fluid that the body has not been given yet.
    pub deferred: Vector6<f64>,
    /// Momentum that the virtual mass holds back.
    pub held: Vector6<f64>,
    /// ā.
    pub acceleration: Vector6<f64>,
    /// Force and torque over the last step, contacts left out.
    pub load: Vector6<f64>,
    /// Mass and moment of inertia that the fluid adds.
    pub added: [f64; 2],
    /// Impulse of the fluid over the last step, divided by its length.
    pub hydrodynamic: Vector6<f64>,
    /// Impulse of what holds the components that are not free, over the last step.
    pub constraint: Vector6<f64>,
    /// Rⁿ: momentum of the fluid inside if it moved with the body, where the body is at an open side.
    pub rigid: Option<Vector6<f64>>,
    /// Rⁿ − R of the body where it is now, both with vⁿ: momentum of the fluid inside that left the box with the body in the last step.
    pub crossing: Vector6<f64>,
    /// Momentum M_s vⁿ and velocity vⁿ before the step under way.
    pub momentum: Vector6<f64>,
    pub before: Vector6<f64>,
    /// Impulse of the fluid that the strategy foresaw in the step under way.
    pub foreseen: Vector6<f64>,
    /// What the equation of motion left in the last two rounds of the step under way, and how far the velocity was changed for it.
    pub residuals: [Vector6<f64>; 2],
    pub relaxation: [f64; 2],
}

impl State {
    /// w₀I + w₁Iⁿ + w₂Iⁿ⁻¹: dt times the inertia of the fluid inside, when its momentum becomes I.
    pub fn inside(&self, [w0, w1, w2]: [f64; 3], internal: Vector6<f64>) -> Vector6<f64> {
        w0 * internal + w1 * self.internal[0] + w2 * self.internal[1]
    }
    /// Ends the step with the momentum I inside.
    pub fn keep(&mut self, internal: Vector6<f64>) {
        self.internal = [internal, self.internal[0]];
    }
}

/// A body's part in momentum \[N s\] and kinetic energy \[J\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Stake {
    pub(crate) momentum: Vector,
    pub(crate) energy: f64,
}

/// What the flow does to a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyReport {
    /// Load of the fluid without buoyancy: −ρ∫f_ib dV + ρ d/dt ∫_Ωs u dV.
    pub hydrodynamic: Wrench,
    /// Mean contact load over the last step.
    pub contact: Wrench,
}

/// A body whose centre is beyond the lower (`end` 0) or upper side of `axis`, at `centre`; the box reaches from and to `box_` \[m\].
#[derive(Clone, Copy)]
struct Outside {
    body: BodyId,
    axis: usize,
    end: usize,
    centre: f64,
    box_: [f64; 2],
}

impl Outside {
    fn outwards(&self) -> Vector {
        let sign = if self.end == 0 { -1.0 } else { 1.0 };
        Vector::from_fn(|a, _| if a == self.axis { sign } else { 0.0 })
    }
    fn error(self) -> CouplingError {
        let Self { body, axis, centre, box_, .. } = self;
        CouplingError::Outside { body, axis, centre, box_ }
    }
}

pub(crate) fn six(w: Wrench) -> Vector6<f64> {
    Vector6::new(w.force.x, w.force.y, w.force.z, w.torque.x, w.torque.y, w.torque.z)
}
pub(crate) fn wrench(v: Vector6<f64>) -> Wrench {
    Wrench { force: v.fixed_rows::<3>(0).into(), torque: v.fixed_rows::<3>(3).into() }
}

impl<F: Forcing, B: Dynamics> Particles<F, B> {
    /// Bodies and their forcing in a fluid of `density` \[kg/m³\] under `gravity` \[m/s²\].
    pub fn new(bodies: B, forcing: F, density: f64, gravity: Vector) -> Self {
        let states = vec![State::default(); bodies.n_bodies()];
        let strategy = OneSolve::default();
        Self {
            bodies,
            forcing,
            strategy,
            gravity,
            density,
            states,
            last_dt: 0.0,
            serials: Serials::default(),
        }
    }
    /// The same with a [virtual mass](OneSolve::virtual_mass).
    #[must_use]
    pub fn with_virtual_mass(mut self, factor: f64) -> Self {
        self.strategy.virtual_mass = Some(factor);
        self
    }
}

impl<F: Forcing, B: Dynamics, S: Strategy> Particles<F, B, S> {
    /// The same by another strategy.
    #[must_use]
    pub fn with_strategy<T: Strategy>(self, strategy: T) -> Particles<F, B, T> {
        let Self { bodies, forcing, gravity, density, states, last_dt, serials, .. } = self;
        Particles { bodies, forcing, strategy, gravity, density, states, last_dt, serials }
    }

    /// Mass and inertia as they resist (U, Ω) in the world.
    pub(crate) fn mass_matrix(&self, b: BodyId) -> Matrix6<f64> {
        let inertia = self.bodies.inertia(b);
        let r = self.bodies.pose(b).orientation.to_rotation_matrix();
        let mut m = Matrix6::from_diagonal_element(inertia.mass);
        m.fixed_view_mut::<3, 3>(3, 3).copy_from(&(r.matrix() * inertia.tensor * r.matrix().transpose()));
        m
    }
    /// (U, Ω) of body `b`.
    pub(crate) fn velocity(&self, b: BodyId) -> Vector6<f64> {
        let t = self.bodies.twist(b);
        six(Wrench { force: t.linear, torque: t.angular })
    }
    /// Gives body `b` another velocity.
    pub(crate) fn set_velocity(&mut self, b: BodyId, v: Vector6<f64>) {
        let Wrench { force: linear, torque: angular } = wrench(v);
        self.bodies.set_twist(b, Twist { linear, angular });
    }
    /// Which components of (U, Ω) are free.
    pub(crate) fn freedom(&self, b: BodyId) -> [bool; 6] {
        let f = self.bodies.freedom(b);
        std::array::from_fn(|i| if i < 3 { f.linear[i] } else { f.angular[i - 3] })
    }
    /// Mass of the fluid that body `b` displaces.
    pub(crate) fn displaced(&self, b: BodyId) -> f64 {
        self.density * self.bodies.inertia(b).volume
    }
    /// The body's weight less its buoyancy, as (force, torque).
    pub(crate) fn pull(&self, b: BodyId) -> Vector6<f64> {
        six(Wrench { force: self.weight(b), torque: Vector::zeros() })
    }
    /// ρ∫(u, r × u) dV over body `b`.
    pub(crate) fn inside(&mut self, velocity: &dyn VelocityField, b: BodyId) -> Vector6<f64> {
        six(self.forcing.internal_momentum(velocity, &self.bodies, b))
    }
    /// How the fluid outside that the forcing drags along resists body `b`.
    pub(crate) fn layer(&mut self, velocity: &dyn VelocityField, b: BodyId) -> Layer {
        self.forcing.layer(velocity, &self.bodies, b)
    }

    /// Moves the bodies to where they are at the end of the step, under the loads that the strategy holds.
    fn advance(&mut self, dt: f64, time: f64) -> Result<(), CouplingError> {
        // Differences over a much shorter step say nothing about this one.
        let known = dt <= LONGEST_GROWTH * self.last_dt;
        self.last_dt = dt;
        for b in (0..self.states.len()).map(BodyId) {
            let before = self.velocity(b);
            let momentum = self.mass_matrix(b) * before;
            let weight = self.pull(b);
            let s = &mut self.states[b.0];
            (s.momentum, s.before) = (momentum, before);
            self.bodies.apply(b, S::held(s, weight, dt, known));
        }
        self.bodies.advance(dt).map_err(|e| CouplingError::Dynamics { time, source: Box::new(e) })
    }

    /// How often forcing and pressure take turns in a step.
    pub(crate) fn rounds<const D: usize, A: FlowSolver<D>>(&self, flow: &A) -> usize {
        self.forcing.rounds().max(flow.rounds())
    }

    /// Bodies were taken out of [`bodies`](Self::bodies): what is kept of each goes by its new number from now on. (Those that are added are noticed.) The fluid where they were
    /// goes on as it moved; momentum on its way between fluid and them is lost.
    pub fn renumber(&mut self, numbers: &Renumbering) {
        self.serials.renumber(numbers);
        numbers.apply(&mut self.states);
        self.forcing.renumber(numbers);
    }
    /// What body `b` keeps when numbers close up: bodies are counted as they are put into the flow, from 0. `None` for one that has been added since the last step.
    pub fn serial(&self, b: BodyId) -> Option<u64> {
        self.serials.of(b)
    }

    /// The number under which files and users know body `b`: its serial number.
    pub(crate) fn known_as(&self, b: BodyId) -> BodyId {
        self.serial(b).map_or(b, |serial| BodyId(serial as usize))
    }

    /// Makes the fluid follow the bodies and free of divergence, as often as forcing and flow ask for.
    pub(crate) fn force<const D: usize, A: FlowSolver<D>>(
        &mut self,
        flow: &mut A,
        dt: f64,
        timings: &mut Timings,
    ) -> Result<(), CouplingError> {
        for _ in 0..self.rounds(flow) {
            timings.measure(Module::Forcing, || self.forcing.force(flow.velocity_mut(), &self.bodies));
            timings.measure(Module::Pressure, || flow.project(dt))?;
        }
        Ok(())
    }

    /// The impulse J that the fluid has put on body `b` so far in this step, and its momentum inside the body.
    pub(crate) fn impulse<const D: usize, A: FlowSolver<D>>(
        &mut self,
        flow: &A,
        b: BodyId,
    ) -> [Vector6<f64>; 2] {
        let (internal, weights) = (self.inside(flow.velocity(), b), flow.weights());
        let impulse = weights[0] * six(self.forcing.reaction(b)) + self.states[b.0].inside(weights, internal);
        [impulse, internal]
    }

    /// Whether body `b` reaches beyond an open side, or to less than so many cells from it.
    fn at_opening<const D: usize, A: FlowSolver<D>>(&self, flow: &A, b: BodyId, cells: f64) -> bool {
        let (grid, bounds) = (flow.grid(), self.bodies.aabb(b));
        (0..D).filter(|&a| !flow.sides().periodic(a)).any(|axis| {
            let along = grid.axis(axis);
            let near = [
                bounds.min[axis] < along.lower() + cells * along.width(0),
                bounds.max[axis] > along.upper() - cells * along.width(along.cells() - 1),
            ];
            near.into_iter().enumerate().any(|(end, near)| {
                near && self
                    .beyond_opening(flow, &Outside { body: b, axis, end, centre: 0.0, box_: [0.0; 2] })
            })
        })
    }

    /// Notes R of the bodies from number `first` on that are at open sides.
    fn note_rigid<const D: usize, A: FlowSolver<D>>(&mut self, flow: &A, first: usize) {
        if flow.sides().closed() {
            return;
        }
        for b in (first..self.states.len()).map(BodyId) {
            // A body moves less than a cell in a step.
            let at_opening = self.at_opening(flow, b, 1.0);
            let twist = self.bodies.twist(b);
            self.states[b.0].rigid =
                at_opening.then(|| six(self.forcing.rigid_momentum(flow.velocity(), &self.bodies, b, twist)));
        }
    }

    /// Takes the fluid inside that has left the box with a body out of its Iⁿ, and adds what has come in.
    fn cross<const D: usize, A: FlowSolver<D>>(&mut self, flow: &A) {
        if flow.sides().closed() {
            return;
        }
        for b in (0..self.states.len()).map(BodyId) {
            let Wrench { force: linear, torque: angular } = wrench(self.states[b.0].before);
            self.states[b.0].crossing = Vector6::zeros();
            if let Some(before) = self.states[b.0].rigid
                && self.at_opening(flow, b, 0.0)
            {
                let twist = Twist { linear, angular };
                let now = six(self.forcing.rigid_momentum(flow.velocity(), &self.bodies, b, twist));
                let s = &mut self.states[b.0];
                s.crossing = before - now;
                s.internal = s.internal.map(|internal| internal - s.crossing);
            }
        }
    }

    /// Bodies whose centres are beyond a bounded side.
    fn outside<const D: usize, A: FlowSolver<D>>(&self, flow: &A) -> impl Iterator<Item = Outside> {
        outside(flow.grid(), |a| flow.sides().periodic(a), &self.bodies)
    }

    /// Whether fluid may pass the side where the body is beyond it. Sides go on beyond their edges.
    fn beyond_opening<const D: usize, A: FlowSolver<D>>(&self, flow: &A, one: &Outside) -> bool {
        let (grid, centre) = (flow.grid(), self.bodies.pose(one.body).position);
        let x = std::array::from_fn(|a| {
            let lower = grid.origin().get(a).copied().unwrap_or(0.0);
            let upper = lower + grid.lengths().get(a).copied().unwrap_or(0.0);
            centre[a].clamp(lower, upper)
        });
        flow.sides().is_open_at(one.axis, one.end, x)
    }

    /// The first body that has left the box where it cannot: through a wall, or through an open side with no exit ahead. As long as it is partly inside, or on
    /// its way in, the latter may still change.
    fn escaped<const D: usize, A: FlowSolver<D>>(&self, flow: &A) -> Option<(Outside, Escape)> {
        self.outside(flow).find_map(|one| {
            let outwards = one.outwards();
            let exit = self.bodies.exit_distance(one.body, outwards);
            if exit <= 0.0 {
                return None;
            }
            if !self.beyond_opening(flow, &one) {
                return Some((one, Escape::Wall));
            }
            let bounds = self.bodies.aabb(one.body);
            let apart = if one.end == 0 {
                bounds.max[one.axis] < one.box_[0]
            } else {
                bounds.min[one.axis] > one.box_[1]
            };
            let leaving = self.bodies.twist(one.body).linear.dot(&outwards) >= 0.0;
            (exit == f64::INFINITY && apart && leaving).then_some((one, Escape::NoExit))
        })
    }

    /// Fluid and contact loads of the last step on body `b`.
    pub fn report(&self, b: BodyId, dt: f64) -> BodyReport {
        BodyReport {
            hydrodynamic: wrench(self.states[b.0].hydrodynamic),
            contact: self.bodies.contact_impulse(b) * (1.0 / dt),
        }
    }
    /// Momentum of the fluid inside body `b` after the last step.
    pub fn internal_momentum(&self, b: BodyId) -> Wrench {
        wrench(self.states[b.0].internal[0])
    }
    /// Momentum on its way between fluid and body `b`: δ and what the virtual mass holds.
    pub fn momentum_in_transit(&self, b: BodyId) -> Wrench {
        let s = &self.states[b.0];
        wrench(s.deferred + s.held)
    }
    /// Impulse over the last step of what holds body `b` where it is not free, and momentum of the fluid inside that left the box with it \[N s, N m s\].
    pub fn constraint_impulse(&self, b: BodyId) -> Wrench {
        wrench(self.states[b.0].constraint + self.states[b.0].crossing)
    }
    /// (ρ_s − ρ) V g of body `b` \[N\].
    pub fn weight(&self, b: BodyId) -> Vector {
        let i = self.bodies.inertia(b);
        self.gravity * (i.mass - self.density * i.volume)
    }
    /// What body `b` holds of the momentum \[N s\] and kinetic energy \[J\] of the books ([`Ledger`](crate::Ledger)): mU + δ − I and
    /// ½(1 − ρ/ρ_s)(mU² + ΩIΩ).
    pub(crate) fn stake(&self, b: BodyId) -> Stake {
        let (inertia, twist) = (self.bodies.inertia(b), self.bodies.twist(b));
        let turned = self.bodies.pose(b).orientation.inverse_transform_vector(&twist.angular);
        let moving = inertia.mass * twist.linear.norm_squared() + turned.dot(&(inertia.tensor * turned));
        let transit = self.momentum_in_transit(b).force;
        Stake {
            momentum: inertia.mass * twist.linear + transit - self.internal_momentum(b).force,
            energy: 0.5 * (1.0 - self.displaced(b) / inertia.mass) * moving,
        }
    }
    /// The same at the start of the last step, of a body that was put into the flow then; and its velocity.
    pub(crate) fn stake_brought(&self, b: BodyId) -> Stake {
        let (s, inertia) = (&self.states[b.0], self.bodies.inertia(b));
        Stake {
            momentum: (s.momentum - s.internal[1] - s.crossing).fixed_rows::<3>(0).into(),
            energy: 0.5 * (1.0 - self.displaced(b) / inertia.mass) * s.momentum.dot(&s.before),
        }
    }
    /// What the momentum of the fluid inside body `b` gained in the last step, less what came to be [on its way](Self::momentum_in_transit): what neither the fluid outside nor
    /// the body has of the impulses.
    pub(crate) fn inner_impulse(&self, b: BodyId) -> Wrench {
        let s = &self.states[b.0];
        let given =
            self.last_dt * self.pull(b) + six(self.bodies.contact_impulse(b)) + s.constraint + s.crossing;
        let gained = self.mass_matrix(b) * self.velocity(b) - s.momentum;
        wrench(gained - given - six(self.forcing.reaction(b)))
    }
    /// Kinetic energy that the fluid inside would have gained, had it moved with the body \[J\]: Δ½(ρ/ρ_s)(mU² + ΩIΩ).
    pub(crate) fn carried(&self, b: BodyId) -> f64 {
        let (s, now) = (&self.states[b.0], self.velocity(b));
        let gained = now.dot(&(self.mass_matrix(b) * now)) - s.momentum.dot(&s.before);
        0.5 * self.displaced(b) / self.bodies.inertia(b).mass * gained
    }
    /// Velocity of body `b` before the last step.
    pub(crate) fn twist_before(&self, b: BodyId) -> Twist {
        let Wrench { force: linear, torque: angular } = wrench(self.states[b.0].before);
        Twist { linear, angular }
    }
    /// Gravity \[m/s²\].
    pub fn gravity(&self) -> Vector {
        self.gravity
    }
}

impl<const D: usize, F, B, S, A> Immersed<D, A> for Particles<F, B, S>
where
    F: Forcing,
    B: Dynamics,
    S: Exchange<D, A>,
    A: FlowSolver<D>,
{
    fn couple(&mut self, flow: &mut A, dt: f64, timings: &mut Timings) -> Result<(), CouplingError> {
        let time = flow.time();
        timings.measure(Module::Contact, || self.advance(dt, time))?;
        if let Some((Outside { body, axis, centre, box_, .. }, by)) = self.escaped(flow) {
            let speed = self.bodies.twist(body).linear.norm();
            let body = self.known_as(body);
            return Err(CouplingError::Escaped { body, axis, centre, box_, speed, time: time + dt, by });
        }
        self.forcing.begin(flow.viscous_step(dt));
        timings.measure(Module::SolidFraction, || self.forcing.place(flow.velocity(), &self.bodies))?;
        timings.measure(Module::Forcing, || self.cross(flow));
        S::exchange(self, flow, dt, timings)?;
        timings.measure(Module::Forcing, || self.note_rigid(flow, 0));
        Ok(timings.measure(Module::SolidFraction, || flow.follow_walls(&self.bodies))?)
    }

    fn begin(&mut self, flow: &mut A) -> Result<(), CouplingError> {
        let (n, started) = (self.bodies.n_bodies(), self.serials.len());
        if started > n {
            return Err(CouplingError::Renumbered { before: started, now: n });
        }
        let time = flow.time();
        let renewed = self.bodies.renew(time);
        if let Some(numbers) = renewed.map_err(|e| CouplingError::Dynamics { time, source: Box::new(e) })? {
            self.renumber(&numbers);
        }
        let (n, started) = (self.bodies.n_bodies(), self.serials.len());
        if started < n {
            fit(flow.grid(), |a| flow.sides().periodic(a), &self.bodies)?;
            if let Some((one, _)) = self.escaped(flow) {
                return Err(one.error());
            }
            self.states.resize(n, State::default());
            self.forcing.place(flow.velocity(), &self.bodies)?;
            for (b, s) in self.states.iter_mut().enumerate().skip(started) {
                let internal = self.forcing.internal_momentum(flow.velocity(), &self.bodies, BodyId(b));
                s.internal = [six(internal); 2];
            }
            self.note_rigid(flow, started);
            self.serials.count(n);
        }
        Ok(flow.follow_walls(&self.bodies)?)
    }

    fn check(&self, flow: &A) -> Result<(), CouplingError> {
        let density = flow.fluid().density;
        for told in [self.density, self.forcing.density()] {
            if density != told {
                return Err(CouplingError::Density { flow: density, particles: told });
            }
        }
        check_places(flow.grid(), |a| flow.sides().periodic(a), &self.bodies)
    }

    fn net_weight(&self) -> Vector {
        let falling = |b| {
            let may = self.bodies.freedom(b).linear;
            let weight = self.weight(b);
            Vector::from_fn(|i, _| if may[i] { weight[i] } else { 0.0 })
        };
        (0..self.bodies.n_bodies()).map(|b| falling(BodyId(b))).sum()
    }
}

impl<F: Forcing, B: Dynamics, S: Strategy> Checkpoint for Particles<F, B, S> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        self.bodies.save(&mut |name, values| sink(&format!("bodies.{name}"), values));
        let mut values = Vec::with_capacity(self.states.len() * STATE);
        for s in &self.states {
            let [now, before] = s.internal;
            let rest = [s.deferred, s.held, s.acceleration, s.load, s.hydrodynamic, s.constraint];
            for v in [now, before].iter().chain(&rest) {
                values.extend_from_slice(v.as_slice());
            }
            values.extend_from_slice(&s.added);
            values.push(f64::from(u8::from(s.rigid.is_some())));
            values.extend_from_slice(s.rigid.unwrap_or_default().as_slice());
        }
        sink("coupling", &values);
        sink("last_dt", &[self.last_dt]);
        self.serials.save(sink);
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.bodies.restore(&|name| source(&format!("bodies.{name}")))?;
        self.last_dt = RestartError::take(source, "last_dt", 1)?[0];
        let values = RestartError::take(source, "coupling", self.bodies.n_bodies() * STATE)?;
        self.serials.restore(source, self.bodies.n_bodies())?;
        self.states.clear();
        for v in values.chunks_exact(STATE) {
            let six = |i: usize| Vector6::from_column_slice(&v[6 * i..6 * i + 6]);
            self.states.push(State {
                internal: [six(0), six(1)],
                deferred: six(2),
                held: six(3),
                acceleration: six(4),
                load: six(5),
                hydrodynamic: six(6),
                constraint: six(7),
                added: [v[48], v[49]],
                rigid: (v[50] != 0.0).then(|| Vector6::from_column_slice(&v[51..57])),
                ..State::default()
            });
        }
        Ok(())
    }
}

/// Requires that bodies which a forcing puts into a flow fit into its box and have their centres
/// inside; `periodic` axes have no outside.
///
/// # Errors
/// [`CouplingError::TooLarge`] and [`CouplingError::Outside`].
pub fn check_places<const D: usize, B: Bodies>(
    grid: &CartesianGrid<D>,
    periodic: impl Fn(usize) -> bool,
    bodies: &B,
) -> Result<(), CouplingError> {
    fit(grid, &periodic, bodies)?;
    outside(grid, periodic, bodies).next().map_or(Ok(()), |one| Err(one.error()))
}

/// Requires that all bodies fit into the box; along a periodic axis they may overlap with their own
/// image by a cell.
fn fit<const D: usize, B: Bodies>(
    grid: &CartesianGrid<D>,
    periodic: impl Fn(usize) -> bool,
    bodies: &B,
) -> Result<(), CouplingError> {
    for body in bodies.ids() {
        let bounds = bodies.aabb(body);
        for axis in 0..D {
            let (size, length) = (bounds.extent()[axis], grid.lengths()[axis]);
            // As long as a period, a body closes on itself.
            let most = if periodic(axis) { length + grid.spacing()[axis] } else { length };
            if is_longer(size, most) {
                return Err(CouplingError::TooLarge { body, axis, size, length });
            }
        }
    }
    Ok(())
}

/// Bodies whose centres are beyond a bounded side.
fn outside<const D: usize, B: Bodies>(
    grid: &CartesianGrid<D>,
    periodic: impl Fn(usize) -> bool,
    bodies: &B,
) -> impl Iterator<Item = Outside> {
    (0..D).filter(move |&a| !periodic(a)).flat_map(move |axis| {
        let box_ = [grid.origin()[axis], grid.origin()[axis] + grid.lengths()[axis]];
        bodies.ids().filter_map(move |body| {
            let centre = bodies.pose(body).position[axis];
            let end = usize::from(centre > box_[1]);
            (!(box_[0]..=box_[1]).contains(&centre)).then_some(Outside { body, axis, end, centre, box_ })
        })
    })
}

/// Loads are held over a step at most so many times longer than the last.
const LONGEST_GROWTH: f64 = 10.0;

/// Saved numbers per body.
const STATE: usize = 8 * 6 + 2 + 7;
