//! Bodies without a fluid as those see them who look on.
use crate::any_simulation::Viewed;
use crate::cast::Cast;
use crate::setup::Setup;
use crate::view::View;
use crate::watch::Solids;
use coupling::{Evolving, Grains, StepInfo, Timings};
use dem::{BodyFrames, Depth};
use fv_mesh::Axis;
use interfaces::{Bodies, BodyId, Dynamics, Kinematics, Lattice, Wrench};
use std::io;

impl Viewed for Grains<Cast> {
    fn view<'a>(&'a mut self, setup: &'a Setup) -> Box<dyn View + 'a> {
        Box::new(Dry { setup, grains: self })
    }
}

/// Bodies, and the box that they are in.
struct Dry<'a> {
    setup: &'a Setup,
    grains: &'a Grains<Cast>,
}

impl View for Dry<'_> {
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
        self.grains.bodies.bodies.kinetic_energy()
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
        self.grains.bodies.bodies.contacts()
    }
    fn deepest(&self) -> Option<Depth> {
        self.grains.bodies.bodies.deepest()
    }
    fn turnover(&self) -> [u64; 2] {
        self.grains.bodies.turnover()
    }
    fn write_bodies(&self, frames: &mut BodyFrames, index: usize) -> io::Result<Option<String>> {
        self.grains.bodies.bodies.write(frames, self.setup.corner(), index).map(Some)
    }
}
