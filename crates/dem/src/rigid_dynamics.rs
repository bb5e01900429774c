//! Whoever holds rigid bodies.
use crate::contact::ContactLaw;
use crate::rigid_bodies::RigidBodies;
use interfaces::Dynamics;

/// [`RigidBodies`], or what moves them in a way of its own ([`Population`](crate::Population)): what files, pictures and counts of contacts ask for.
pub trait RigidDynamics: Dynamics {
    /// The law of contact.
    type Law: ContactLaw;
    /// The bodies.
    fn rigid_bodies(&self) -> &RigidBodies<Self::Law>;
}

impl<L: ContactLaw> RigidDynamics for RigidBodies<L> {
    type Law = L;
    fn rigid_bodies(&self) -> &RigidBodies<L> {
        self
    }
}
