//! What bodies tell the books.
use crate::particles::{Stake, wrench};
use crate::{Particles, Strategy};
use ibm::Forcing;
use interfaces::{BodyId, Dynamics, Twist, Vector, VelocityField, Wrench};

/// What the books have to know of what is immersed, body by body. Nothing is the answer of what has no part in them.
pub trait Accounts {
    /// How many bodies.
    fn n_accounts(&self) -> usize {
        0
    }
    /// That of body number `b`.
    fn account(&self, _b: BodyId) -> Account {
        Account::default()
    }
    /// See [`Forcing::hidden_dissipation`].
    fn hidden_dissipation(&self) -> f64 {
        0.0
    }
    /// See [`Forcing::inelastic_loss`]; the velocity was `before`.
    fn inelastic_loss(&mut self, _before: &[&[f64]], _velocity: &dyn VelocityField) -> f64 {
        0.0
    }
    /// See [`Forcing::surface_work`].
    fn surface_work(&self) -> f64 {
        0.0
    }
}

impl Accounts for () {}

/// A body in the books: what it has now, and the impulses on it in the last step.
#[derive(Clone, Copy, Debug, Default)]
pub struct Account {
    /// None for one that was put in since.
    pub(crate) serial: Option<u64>,
    pub(crate) stake: Stake,
    /// What it brought, if it was put in at the start of the last step.
    pub(crate) brought: Stake,
    /// Weight less buoyancy \[N\].
    pub(crate) weight: Vector,
    pub(crate) in_transit: f64,
    pub(crate) contact: Wrench,
    /// Of what holds or drives it.
    pub(crate) held: Wrench,
    /// On the fluid inside it, and what is on its way.
    pub(crate) inner: Wrench,
    /// Kinetic energy that the fluid inside would have gained, had it moved with the body \[J\].
    pub(crate) carried: f64,
    /// Before and after the step.
    pub(crate) twists: [Twist; 2],
}

impl Account {
    /// What an impulse does to the kinetic energy: its product with the mean velocity.
    pub(crate) fn work(&self, impulse: Wrench) -> f64 {
        let [before, after] = self.twists;
        0.5 * (impulse.force.dot(&(before.linear + after.linear))
            + impulse.torque.dot(&(before.angular + after.angular)))
    }
}

impl<F: Forcing, B: Dynamics, S: Strategy> Accounts for Particles<F, B, S> {
    fn n_accounts(&self) -> usize {
        self.bodies.n_bodies()
    }
    fn account(&self, b: BodyId) -> Account {
        Account {
            serial: self.serial(b),
            stake: self.stake(b),
            brought: self.stake_brought(b),
            weight: self.weight(b),
            in_transit: self.momentum_in_transit(b).force.norm(),
            contact: self.bodies.contact_impulse(b),
            held: self.constraint_impulse(b),
            inner: self.inner_impulse(b),
            carried: self.carried(b),
            twists: [self.twist_before(b), self.bodies.twist(b)],
        }
    }
    fn hidden_dissipation(&self) -> f64 {
        self.forcing.hidden_dissipation()
    }
    fn inelastic_loss(&mut self, before: &[&[f64]], velocity: &dyn VelocityField) -> f64 {
        let Self { forcing, bodies, states, .. } = self;
        let mean = |b: BodyId| {
            let (before, after) = (wrench(states[b.0].before), bodies.twist(b));
            Twist {
                linear: 0.5 * (before.force + after.linear),
                angular: 0.5 * (before.torque + after.angular),
            }
        };
        forcing.inelastic_loss(before, velocity, &*bodies, &mean)
    }
    fn surface_work(&self) -> f64 {
        self.forcing.surface_work(&self.bodies)
    }
}

/// All of them.
pub(crate) fn accounts(immersed: &impl Accounts) -> impl Iterator<Item = (BodyId, Account)> {
    (0..immersed.n_accounts()).map(|b| (BodyId(b), immersed.account(BodyId(b))))
}
