//! Bodies in a flow: one pressure solution per step.
use crate::{CouplingError, Immersed, Module, Timings};
use fv_mesh::Projection;
use ibm::Forcing;
use interfaces::{BodyId, Checkpoint, Dynamics, Load, RestartError, Twist, Vector, VelocityField, Wrench};
use nalgebra::{Matrix6, Vector6};

/// Bodies `B` immersed by the forcing `F`, moved by the flow, gravity and one another.
///
/// The bodies' new velocity v = (U, Ω) follows from one linear system per body before the forcing,
/// with the fluid's reaction predicted implicitly ([`ibm::Layer`]: M_l, b_l from the velocity u*):
///
/// ```text
/// (M_s + C + M_l) vⁿ⁺¹ = M_s vⁿ + C vⁿ + b_l + I(u*) − Iⁿ + δⁿ + dt [(ρ_s − ρ) V g + C ā] + J_contact
/// ```
///
/// I is the momentum of the fluid inside, C a virtual mass that is given back through the
/// last acceleration ā, and δⁿ the impulse by which the last prediction missed the true one,
/// J = −ρ∫f_ib dV dt + Iⁿ⁺¹ − Iⁿ. So every impulse the fluid loses reaches a body, at the latest a
/// step later, and the load includes the inertia of the fluid inside.
pub struct Particles<F, B> {
    /// The bodies.
    pub bodies: B,
    /// How the fluid is made to follow them.
    pub forcing: F,
    gravity: Vector,
    density: f64,
    virtual_mass: Option<f64>,
    states: Vec<State>,
    last_dt: f64,
    /// So many bodies have been put into the flow.
    started: usize,
    /// Momentum (later: foreseen impulse) and velocity of every body before the step.
    scratch: Vec<(Vector6<f64>, Vector6<f64>)>,
}

/// What is kept of one body from step to step, as (linear, angular).
#[derive(Clone, Copy, Debug, Default)]
struct State {
    /// Iⁿ.
    internal: Vector6<f64>,
    /// δⁿ.
    deferred: Vector6<f64>,
    /// Momentum that the virtual mass holds back.
    held: Vector6<f64>,
    /// ā.
    acceleration: Vector6<f64>,
    /// Force and torque over the last step, contacts left out.
    load: Vector6<f64>,
    /// Mass and moment of inertia that the fluid adds.
    added: [f64; 2],
    /// Impulse of the fluid over the last step, divided by its length.
    hydrodynamic: Vector6<f64>,
    /// Impulse of what holds the components that are not free, over the last step.
    constraint: Vector6<f64>,
}

/// What the flow does to a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyReport {
    /// Load of the fluid without buoyancy: −ρ∫f_ib dV + ρ d/dt ∫_Ωs u dV.
    pub hydrodynamic: Wrench,
    /// Mean contact load over the last step.
    pub contact: Wrench,
}

fn six(w: Wrench) -> Vector6<f64> {
    Vector6::new(w.force.x, w.force.y, w.force.z, w.torque.x, w.torque.y, w.torque.z)
}
fn wrench(v: Vector6<f64>) -> Wrench {
    Wrench { force: v.fixed_rows::<3>(0).into(), torque: v.fixed_rows::<3>(3).into() }
}

impl<F: Forcing, B: Dynamics> Particles<F, B> {
    /// Bodies and their forcing in a fluid of `density` \[kg/m³\] under `gravity` \[m/s²\].
    pub fn new(bodies: B, forcing: F, density: f64, gravity: Vector) -> Self {
        let states = vec![State::default(); bodies.n_bodies()];
        Self {
            bodies,
            forcing,
            gravity,
            density,
            virtual_mass: None,
            started: 0,
            states,
            last_dt: 0.0,
            scratch: Vec::new(),
        }
    }
    /// The virtual mass C as a multiple of the displaced fluid's. Unless told, 0.3 for bodies lighter
    /// than 0.7 of the fluid, which are unstable without, and none for others.
    #[must_use]
    pub fn with_virtual_mass(mut self, factor: f64) -> Self {
        self.virtual_mass = Some(factor);
        self
    }

    /// Mass and inertia as they resist (U, Ω) in the world.
    fn mass_matrix(&self, b: BodyId) -> Matrix6<f64> {
        let inertia = self.bodies.inertia(b);
        let r = self.bodies.pose(b).orientation.to_rotation_matrix();
        let mut m = Matrix6::from_diagonal_element(inertia.mass);
        m.fixed_view_mut::<3, 3>(3, 3).copy_from(&(r.matrix() * inertia.tensor * r.matrix().transpose()));
        m
    }

    fn velocity(&self, b: BodyId) -> Vector6<f64> {
        let t = self.bodies.twist(b);
        Vector6::new(t.linear.x, t.linear.y, t.linear.z, t.angular.x, t.angular.y, t.angular.z)
    }

    /// Moves the bodies to where they are at the end of the step.
    fn advance(&mut self, dt: f64, time: f64) -> Result<(), CouplingError> {
        // Differences over a much shorter step say nothing about this one: no load is held then.
        let known = dt <= LONGEST_GROWTH * self.last_dt;
        self.last_dt = dt;
        for (b, s) in
            self.states.iter().enumerate().map(|(b, s)| (b, if known { *s } else { State::default() }))
        {
            let load = Load { wrench: wrench(s.load), added_mass: s.added[0], added_moment: s.added[1] };
            self.bodies.apply(BodyId(b), load);
        }
        self.bodies.advance(dt).map_err(|e| CouplingError::Dynamics { time, source: Box::new(e) })
    }

    /// No body's centre may leave through a bounded side.
    fn check_inside<const D: usize>(&self, flow: &Projection<D>) -> Result<(), CouplingError> {
        let grid = flow.grid();
        for axis in (0..D).filter(|&a| !flow.sides().periodic(a)) {
            let box_ = [grid.origin()[axis], grid.origin()[axis] + grid.lengths()[axis]];
            for body in (0..self.bodies.n_bodies()).map(BodyId) {
                let centre = self.bodies.pose(body).position[axis];
                if !(box_[0]..=box_[1]).contains(&centre) {
                    return Err(CouplingError::Outside { body, axis, centre, box_ });
                }
            }
        }
        Ok(())
    }

    /// Gives body `b` its velocity at the end of the step; answers the impulse J_pred it foresees.
    fn solve(
        &mut self,
        b: BodyId,
        momentum: Vector6<f64>,
        before: Vector6<f64>,
        velocity: &dyn VelocityField,
        dt: f64,
    ) -> Option<Vector6<f64>> {
        let inertia = self.bodies.inertia(b);
        let displaced = self.density * inertia.volume;
        let layer = self.forcing.layer(velocity, &self.bodies, b);
        let internal = six(self.forcing.internal_momentum(velocity, &self.bodies, b));
        let mass = self.mass_matrix(b);
        let light = inertia.mass < 0.7 * displaced;
        let factor = self.virtual_mass.unwrap_or(if light { 0.3 } else { 0.0 });
        let virtual_mass = mass * (factor * displaced / inertia.mass);
        let weight =
            six(Wrench { force: self.gravity * (inertia.mass - displaced), torque: Vector::zeros() });
        let contact = six(self.bodies.contact_impulse(b));

        let s = &mut self.states[b.0];
        let mut matrix = mass + virtual_mass + layer.mass;
        let mut free = momentum
            + virtual_mass * (before + dt * s.acceleration)
            + layer.momentum
            + (internal - s.internal)
            + s.deferred
            + dt * weight;
        let mut kick = contact;
        let freedom = self.bodies.freedom(b);
        for (i, may) in freedom.linear.into_iter().chain(freedom.angular).enumerate() {
            if !may {
                matrix.row_mut(i).fill(0.0);
                matrix[(i, i)] = 1.0;
                (free[i], kick[i]) = (before[i], 0.0);
            }
        }
        let lu = matrix.lu();
        let (free, kick) = (lu.solve(&free)?, lu.solve(&kick)?);
        let after = free + kick;
        if !after.iter().all(|v| v.is_finite()) {
            return None;
        }
        // Contacts act again in the next step; what is left of the load is held on to.
        let change = free - before;
        s.added = [
            (virtual_mass[(0, 0)] + (layer.mass[(0, 0)] + layer.mass[(1, 1)]) / 2.0),
            virtual_mass[(5, 5)] + layer.mass[(5, 5)],
        ];
        let added = Vector6::from_fn(|i, _| s.added[i / 3]);
        s.load = (mass * free - momentum + added.component_mul(&change)) / dt;
        let given_back = virtual_mass * (dt * s.acceleration - (after - before));
        s.held -= given_back;
        let foreseen = layer.momentum - layer.mass * after + (internal - s.internal);
        s.constraint = mass * after - momentum - foreseen - s.deferred - dt * weight - contact - given_back;
        s.acceleration = (after - before) / dt;
        self.bodies.set_twist(
            b,
            Twist { linear: after.fixed_rows::<3>(0).into(), angular: after.fixed_rows::<3>(3).into() },
        );
        Some(foreseen)
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
        wrench(self.states[b.0].internal)
    }
    /// Momentum on its way between fluid and body `b`: δ and what the virtual mass holds.
    pub fn momentum_in_transit(&self, b: BodyId) -> Wrench {
        let s = &self.states[b.0];
        wrench(s.deferred + s.held)
    }
    /// Impulse over the last step of what holds body `b` where it is not free \[N s, N m s\].
    pub fn constraint_impulse(&self, b: BodyId) -> Wrench {
        wrench(self.states[b.0].constraint)
    }
    /// (ρ_s − ρ) V g of body `b` \[N\].
    pub fn weight(&self, b: BodyId) -> Vector {
        let i = self.bodies.inertia(b);
        self.gravity * (i.mass - self.density * i.volume)
    }
    /// Gravity \[m/s²\].
    pub fn gravity(&self) -> Vector {
        self.gravity
    }
}

impl<const D: usize, F: Forcing, B: Dynamics> Immersed<D> for Particles<F, B> {
    fn couple(
        &mut self,
        flow: &mut Projection<D>,
        dt: f64,
        timings: &mut Timings,
    ) -> Result<(), CouplingError> {
        let time = flow.time();
        let n = self.states.len();
        let mut scratch = std::mem::take(&mut self.scratch);
        scratch.clear();
        scratch.extend((0..n).map(|b| {
            let before = self.velocity(BodyId(b));
            (self.mass_matrix(BodyId(b)) * before, before)
        }));

        timings.measure(Module::Contact, || self.advance(dt, time))?;
        self.check_inside(flow)?;
        timings.measure(Module::SolidFraction, || self.forcing.place(flow.velocity(), &self.bodies))?;
        timings.measure(Module::Forcing, || {
            for (b, (momentum, before)) in scratch.iter_mut().enumerate() {
                let body = BodyId(b);
                // From here on `momentum` is the impulse that was foreseen.
                *momentum = self
                    .solve(body, *momentum, *before, flow.velocity(), dt)
                    .ok_or(CouplingError::Motion { body, time })?;
            }
            Ok::<(), CouplingError>(())
        })?;
        for _ in 0..self.forcing.rounds() {
            timings.measure(Module::Forcing, || self.forcing.force(flow.velocity_mut(), &self.bodies));
            timings.measure(Module::Pressure, || flow.project(dt))?;
        }
        timings.measure(Module::Forcing, || {
            for (b, (foreseen, _)) in scratch.iter().enumerate() {
                let internal = six(self.forcing.internal_momentum(flow.velocity(), &self.bodies, BodyId(b)));
                let s = &mut self.states[b];
                let impulse = six(self.forcing.reaction(BodyId(b))) + internal - s.internal;
                s.deferred = impulse - foreseen;
                s.internal = internal;
                s.hydrodynamic = impulse / dt;
            }
        });
        self.scratch = scratch;
        Ok(())
    }

    fn begin(&mut self, flow: &Projection<D>) -> Result<(), CouplingError> {
        let n = self.bodies.n_bodies();
        if self.started == n {
            return Ok(());
        }
        self.states.resize(n, State::default());
        self.forcing.place(flow.velocity(), &self.bodies)?;
        for (b, s) in self.states.iter_mut().enumerate().skip(self.started) {
            s.internal = six(self.forcing.internal_momentum(flow.velocity(), &self.bodies, BodyId(b)));
        }
        self.started = n;
        Ok(())
    }

    fn check(&self, flow: &Projection<D>) -> Result<(), CouplingError> {
        let (density, grid) = (flow.fluid().density, flow.grid());
        for told in [self.density, self.forcing.density()] {
            if density != told {
                return Err(CouplingError::Density { flow: density, particles: told });
            }
        }
        for body in (0..self.bodies.n_bodies()).map(BodyId) {
            let bounds = self.bodies.aabb(body);
            for axis in 0..D {
                let (size, length) = (bounds.extent()[axis], grid.lengths()[axis]);
                if size >= length {
                    return Err(CouplingError::TooLarge { body, axis, size, length });
                }
            }
        }
        self.check_inside(flow)
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

impl<F: Forcing, B: Dynamics> Checkpoint for Particles<F, B> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        self.bodies.save(&mut |name, values| sink(&format!("bodies.{name}"), values));
        let mut values = Vec::with_capacity(self.states.len() * STATE);
        for s in &self.states {
            for v in [s.internal, s.deferred, s.held, s.acceleration, s.load, s.hydrodynamic, s.constraint] {
                values.extend_from_slice(v.as_slice());
            }
            values.extend_from_slice(&s.added);
        }
        sink("coupling", &values);
        sink("last_dt", &[self.last_dt]);
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.bodies.restore(&|name| source(&format!("bodies.{name}")))?;
        self.last_dt = RestartError::take(source, "last_dt", 1)?[0];
        let values = RestartError::take(source, "coupling", self.bodies.n_bodies() * STATE)?;
        self.states.clear();
        self.started = self.bodies.n_bodies();
        for v in values.chunks_exact(STATE) {
            let six = |i: usize| Vector6::from_column_slice(&v[6 * i..6 * i + 6]);
            self.states.push(State {
                internal: six(0),
                deferred: six(1),
                held: six(2),
                acceleration: six(3),
                load: six(4),
                hydrodynamic: six(5),
                constraint: six(6),
                added: [v[42], v[43]],
            });
        }
        Ok(())
    }
}

/// Loads are held over a step at most so many times longer than the last.
const LONGEST_GROWTH: f64 = 10.0;

/// Saved numbers per body.
const STATE: usize = 7 * 6 + 2;
