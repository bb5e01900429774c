//! Discs that know of no contacts.
use example_support::scene::Scene;
use siltflow::dem::{Disc, RigidBodies, Shape};
use siltflow::interfaces::{
    Bodies, BodyId, Checkpoint, Dynamics, Freedom, Inertia, Kinematics, Load, Pose, RestartError, Rotation,
    Solid, Twist, Vector, Wrench,
};
use std::convert::Infallible;

/// The discs of the scene as `dem` has them, with the contact law `()`.
pub(crate) fn passing(scene: &Scene) -> Result<RigidBodies<()>, Box<dyn std::error::Error>> {
    let discs = scene.discs()?;
    let mut bodies = RigidBodies::with_law(discs.periods(), ());
    for b in discs.ids() {
        let density = discs.inertia(b).mass / discs.inertia(b).volume;
        let material = siltflow::dem::Material { density, ..Default::default() };
        let disc = Disc::new(0.5 * scene.diameter)?;
        bodies.add(disc, material, discs.pose(b), discs.twist(b), discs.freedom(b))?;
    }
    Ok(bodies)
}

/// A disc that its load moves.
struct Drifter {
    shape: Disc,
    inertia: Inertia,
    pose: Pose,
    twist: Twist,
    load: Load,
}

/// Free discs, moved by drift, kick, drift as in `dem`, and nothing else.
pub(crate) struct Drifting(Vec<Drifter>);

impl Drifting {
    /// The discs of the scene.
    pub(crate) fn new(scene: &Scene) -> Result<Self, Box<dyn std::error::Error>> {
        let discs = scene.discs()?;
        let one = |b| {
            let shape = Disc::new(0.5 * scene.diameter)?;
            let density = discs.inertia(b).mass / discs.inertia(b).volume;
            let inertia = shape.inertia(density);
            Ok(Drifter { shape, inertia, pose: discs.pose(b), twist: discs.twist(b), load: Load::default() })
        };
        discs.ids().map(one).collect::<Result<Vec<_>, _>>().map(Self)
    }
}

impl Kinematics for Drifting {
    fn n_bodies(&self) -> usize {
        self.0.len()
    }
    fn pose(&self, b: BodyId) -> Pose {
        self.0[b.0].pose
    }
    fn twist(&self, b: BodyId) -> Twist {
        self.0[b.0].twist
    }
}

impl Bodies for Drifting {
    fn solid(&self, b: BodyId) -> &dyn Solid {
        &self.0[b.0].shape
    }
    fn inertia(&self, b: BodyId) -> Inertia {
        self.0[b.0].inertia
    }
    fn freedom(&self, _: BodyId) -> Freedom {
        Freedom::PLANAR
    }
}

/// Runs of this program are too short to be stopped.
impl Checkpoint for Drifting {
    fn save(&self, _: &mut dyn FnMut(&str, &[f64])) {}
    fn restore<'a>(&mut self, _: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        Ok(())
    }
}

impl Dynamics for Drifting {
    type Error = Infallible;
    fn apply(&mut self, b: BodyId, load: Load) {
        self.0[b.0].load = load;
    }
    fn advance(&mut self, dt: f64) -> Result<(), Infallible> {
        for Drifter { inertia, pose, twist, load, .. } in &mut self.0 {
            pose.position += 0.5 * dt * twist.linear;
            let spin = twist.angular.z;
            let Wrench { force, torque } = load.wrench;
            twist.linear += force * (dt / (inertia.mass + load.added_mass));
            twist.angular.z += torque.z * (dt / (inertia.tensor[(2, 2)] + load.added_moment));
            pose.position += 0.5 * dt * twist.linear;
            let turn = Vector::z() * (0.5 * dt * (spin + twist.angular.z));
            pose.orientation = Rotation::from_scaled_axis(turn) * pose.orientation;
        }
        Ok(())
    }
    fn contact_impulse(&self, _: BodyId) -> Wrench {
        Wrench::default()
    }
    fn set_twist(&mut self, b: BodyId, twist: Twist) {
        self.0[b.0].twist = twist;
    }
    fn stable_dt(&self) -> f64 {
        f64::INFINITY
    }
}
