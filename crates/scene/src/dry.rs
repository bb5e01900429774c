//! Bodies without a fluid as those see them who look on.
use crate::any_simulation::Viewed;
use crate::cast::Cast;
use crate::setup::Setup;
use crate::view::View;
use crate::watch::Solids;
use coupling::{Evolving, Grains, StepInfo, Timings};
use dem::{BodyFrames, ContactLaw, Depth, Population, RigidDynamics};
use fv_mesh::Axis;
use interfaces::{Bodies, BodyId, Checkpoint, Dynamics, Kinematics, Lattice, Wrench};
use std::io;

impl<L: ContactLaw> Viewed for Grains<Cast<L>>
where
    Population<L>: Checkpoint,
{
    fn view<'a>(&'a mut self, setup: &'a Setup) -> Box<dyn View + 'a> {
        Box::new(Dry { setup, grains: self })
    }
}

/// Bodies, and the box that they are in.
struct Dry<'a, L: ContactLaw> {
    setup: &'a Setup,
    grains: &'a Grains<Cast<L>>,
}

impl<L: ContactLaw> View for Dry<'_, L>
where
    Population<L>: Checkpoint,
{
    fn axis(&self, a: usize) -> &Axis {
        &self.setup.axes[a]
    }
    fn dim(&self) -> usize {
        self.setup.dim()
    }
    fn periodic(&self, a: usize) -> bool {
        self.setup.periodic(a)
    }
    fn time(&self) -> f64 {
        self.grains.time()
    }
    fn steps(&self) -> u64 {
        self.grains.steps()
    }
    fn kinetic_energy(&mut self) -> f64 {
        self.grains.bodies.rigid_bodies().kinetic_energy()
    }
    fn status(&mut self, info: &StepInfo) -> String {
        let (n, contacts) = (self.grains.bodies.n_bodies(), self.contacts());
        format!("dt {:.1e} s  {n} bodies  {contacts} contacts  E {:.2e} J", info.dt, self.kinetic_energy())
    }
    fn timings(&self) -> &Timings {
        self.grains.timings()
    }
    fn lattice(&self) -> Lattice {
        self.setup.lattice()
    }
    fn shown(&self, solids: &Solids, out: &mut [Vec<f64>]) {
        for out in out.iter_mut() {
            out.clear();
            out.resize(solids.lambda.len(), 0.0);
        }
        let bodies = &self.grains.bodies;
        for b in bodies.ids() {
            let twist = bodies.twist(b);
            for node in solids.fraction.nodes(b) {
                let velocity = twist.at(node.arm);
                out.iter_mut().zip(velocity.iter()).for_each(|(out, u)| out[node.index] = *u);
            }
        }
    }
    fn bodies(&self) -> &dyn Bodies {
        &self.grains.bodies
    }
    fn serial(&self, b: BodyId) -> u64 {
        self.grains.serial(b).unwrap_or(b.0 as u64)
    }
    fn loads(&self, b: BodyId, dt: f64) -> [Wrench; 2] {
        [Wrench::default(), self.grains.bodies.contact_impulse(b) * (1.0 / dt)]
    }
    fn contacts(&self) -> usize {
        self.grains.bodies.rigid_bodies().n_contacts()
    }
    fn deepest(&self) -> Option<Depth> {
        self.grains.bodies.rigid_bodies().deepest()
    }
    fn turnover(&self) -> [u64; 2] {
        self.grains.bodies.turnover()
    }
    fn write_bodies(&self, frames: &mut BodyFrames, index: usize) -> io::Result<Option<String>> {
        let bodies = self.grains.bodies.rigid_bodies();
        frames.write(bodies, self.setup.corner(), bodies.ids(), index).map(Some)
    }
}
