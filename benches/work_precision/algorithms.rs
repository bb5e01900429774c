//! The paper's algorithm beside ours: the falling discs by both, with what their books do not account for.
use crate::discs::{at, percent, theory};
use render::cpu::Stopwatch;
use siltflow::coupling::{
    self, CouplingError, Exchange, FlowSolver, Ledger, Observer, Particles, Schedule, Simulation, StepInfo,
};
use siltflow::dem::RigidBodies;
use siltflow::ibm::{Forcing, SmoothForcing};
use siltflow::interfaces::{BodyId, Kinematics};
use std::sync::atomic::AtomicBool;
use validation::Outcome;
use validation::falling_discs::FLUID;

/// End of the runs \[s\].
const END: f64 = 0.2;

/// Speeds at the times of the theory, and the slip.
#[derive(Default)]
struct Look {
    speeds: Vec<[f64; 2]>,
    /// Largest slip at a snapshot over the speed of the faster disc.
    slip: f64,
}

/// When speeds are noted: the numbers of snapshots a millisecond apart.
const TIMES: [usize; 2] = [5, 30];

impl<A: FlowSolver<2>, F: Forcing, S: Exchange<2, A>> Observer<Simulation<2, Particles<F, RigidBodies, S>, A>>
    for Look
{
    fn step(
        &mut self,
        simulation: &mut Simulation<2, Particles<F, RigidBodies, S>, A>,
        info: &StepInfo,
    ) -> Result<(), CouplingError> {
        let Some(snapshot) = info.snapshot else { return Ok(()) };
        let Particles { bodies, forcing, .. } = &simulation.particles;
        let speeds = [0, 1].map(|b| bodies.twist(BodyId(b)).linear.norm());
        if TIMES.contains(&snapshot) {
            self.speeds.push(speeds);
        }
        if snapshot >= TIMES[0] {
            let fastest = speeds[0].max(speeds[1]);
            self.slip = self.slip.max(forcing.slip(simulation.flow.velocity(), bodies) / fastest);
        }
        Ok(())
    }
}

fn row<A: FlowSolver<2>, F: Forcing, S: Exchange<2, A>>(
    name: &str,
    mut simulation: Simulation<2, Particles<F, RigidBodies, S>, A>,
    dt: Option<f64>,
) -> Outcome<()> {
    let intervals = (END / 1e-3).round() as usize;
    let schedule = Schedule { end: END, intervals, dt, ..Schedule::default() };
    let (mut look, mut ledger, watch) = (Look::default(), Ledger::new(), Stopwatch::start());
    coupling::run(&mut simulation, &schedule, &mut (&mut look, &mut ledger), &AtomicBool::new(false))?;
    let (cpu, books) = (watch.elapsed().cpu, ledger.report());
    print!("{name:>10}{:7}", simulation.flow.steps());
    for (v, k) in look.speeds.iter().zip(TIMES) {
        let exact = theory(1e-3 * k as f64)?;
        print!("{:9.2}{:8.2}", percent(v[0], exact[0]), percent(v[1], exact[1]));
    }
    let twist = |b| simulation.particles.bodies.twist(BodyId(b)).linear.norm();
    println!(
        "{:11.3}{:9.3}{:11.1e}{:11.1e}{:10.2}{:10.2}{cpu:9.2}",
        1e3 * twist(0),
        1e3 * twist(1),
        books.momentum_step,
        books.momentum_total,
        100.0 * books.energy_residual / books.work,
        100.0 * look.slip
    );
    Ok(())
}

/// Prints the table.
pub(crate) fn run() -> Outcome<()> {
    println!("\nthe paper's algorithm beside ours: falling discs to {END} s");
    println!(
        "errors at 0.005 and 0.03 s against unsteady Stokes theory in %, both discs; speeds at the end in mm/s;"
    );
    println!(
        "momentum not accounted for over the impulses: worst step, whole run; energy over the work in %; largest slip over speed in %"
    );
    println!(
        "{:>5}{:>10}{:>7}{:>17}{:>17}{:>20}{:>11}{:>11}{:>10}{:>10}{:>9}",
        "cells", "", "steps", "at 0.005 s", "at 0.03 s", "speeds", "step", "run", "energy", "slip", "CPU s"
    );
    for cells in [10, 15, 20] {
        let scene = at(cells);
        let dt = Some(scene.flow()?.stable_dt(0.1));
        for half in [1.0, 0.5] {
            print!("{cells:5}");
            row("ours", scene.build(SmoothForcing::new(FLUID.density))?, dt.map(|dt| half * dt))?;
            print!("{cells:5}");
            row("paper", scene.hfdib_dem()?, dt.map(|dt| half * dt))?;
        }
    }
    Ok(())
}
