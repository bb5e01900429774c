//! Snapshots of a running simulation for whoever makes models of them, with no files between.
use crate::{CouplingError, FlowSolver, Observer, Particles, Simulation, StepInfo, Strategy};
use ibm::{Forcing, SolidFraction};
use interfaces::{Dynamics, Pose, SnapshotSink};
use std::collections::BTreeMap;
use std::io;

/// What a snapshot holds, at the centres of the cells, x fastest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// λ.
    SolidFraction,
    /// All components \[m/s\], one after the other.
    Velocity,
    /// The pressure \[Pa\].
    Pressure,
}

/// Hands one quantity to a sink at every snapshot: at the start and the end of every interval of the [`Schedule`](crate::Schedule).
pub struct SnapshotFeed<K> {
    quantity: Quantity,
    /// Who takes the snapshots.
    pub sink: K,
    field: Vec<f64>,
    fraction: SolidFraction,
}

impl<K: SnapshotSink> SnapshotFeed<K> {
    /// Of `quantity`, to `sink`.
    pub fn new(quantity: Quantity, sink: K) -> Self {
        Self { quantity, sink, field: Vec::new(), fraction: SolidFraction::new() }
    }
}

impl<const D: usize, F, B, S, A, K> Observer<Simulation<D, Particles<F, B, S>, A>> for SnapshotFeed<K>
where
    F: Forcing,
    B: Dynamics,
    S: Strategy,
    A: FlowSolver<D>,
    K: SnapshotSink,
{
    fn snapshot(
        &mut self,
        simulation: &mut Simulation<D, Particles<F, B, S>, A>,
        _: usize,
        info: &StepInfo,
    ) -> Result<(), CouplingError> {
        let (flow, field) = (&simulation.flow, &mut self.field);
        field.clear();
        match self.quantity {
            Quantity::SolidFraction => {
                let lattice = flow.grid().lattice(None, flow.sides());
                self.fraction.update(&lattice, &simulation.particles.bodies)?;
                field.resize(flow.grid().n_cells(), 0.0);
                self.fraction.add_to_dense(&lattice, field);
            }
            Quantity::Velocity => (0..D).for_each(|c| field.extend(flow.centred_velocity(c))),
            Quantity::Pressure => field.extend(flow.pressure().values()),
        }
        let refused = |source| CouplingError::Output {
            what: format!("handing on the snapshot at t = {} s", info.time),
            source: io::Error::other(source),
        };
        self.sink.push(info.time, field).map_err(refused)
    }
}

/// The paths of the bodies: where each is at every snapshot, not wrapped into a periodic box. What frames of reference that move with them are told.
#[derive(Clone, Debug, Default)]
pub struct BodyPaths {
    /// Times of all snapshots \[s\].
    pub times: Vec<f64>,
    /// By [serial number](Particles::serial): the number of the first snapshot at which the body was there, and its poses from then on.
    pub paths: BTreeMap<u64, (usize, Vec<Pose>)>,
}

impl BodyPaths {
    /// The poses of the bodies that were there at all snapshots, in the order of their serial numbers.
    pub fn whole(&self) -> Vec<Vec<Pose>> {
        self.paths
            .values()
            .map(|(_, poses)| poses)
            .filter(|poses| poses.len() == self.times.len())
            .cloned()
            .collect()
    }
}

impl<const D: usize, F, B, S, A> Observer<Simulation<D, Particles<F, B, S>, A>> for BodyPaths
where
    F: Forcing,
    B: Dynamics,
    S: Strategy,
    A: FlowSolver<D>,
{
    fn snapshot(
        &mut self,
        simulation: &mut Simulation<D, Particles<F, B, S>, A>,
        _: usize,
        info: &StepInfo,
    ) -> Result<(), CouplingError> {
        let particles = &simulation.particles;
        for b in particles.bodies.ids() {
            let serial = particles.serial(b).unwrap_or(b.0 as u64);
            let first = self.times.len();
            self.paths.entry(serial).or_insert_with(|| (first, Vec::new())).1.push(particles.bodies.pose(b));
        }
        self.times.push(info.time);
        Ok(())
    }
}
