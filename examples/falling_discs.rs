//! Two discs of different weight fall in a periodic box of water (Isoz et al. 2023, section 5 and
//! figure 9): the main job of the library as a program of one's own.
//!
//! ```text
//! ∂u/∂t + ∇·(uu) = −∇p/ρ + ν∇²u + f_ib + b,   ∇·u = 0,   m dv/dt = F_fluid + F_contact + F_weight
//! ```
//!
//! The forcing f_ib makes the fluid move with the discs; the uniform body force b balances their
//! net weight, since nothing else in a periodic box can. The numbers are those of
//! `scenes/two_discs.toml`, and so is the fall.
//!
//! `cargo run --release --example falling_discs [FOLDER]`, 3 s; `out/falling_discs` has
//! `speed.png`, `trajectories.csv`, and `fields.pvd` and `bodies.pvd` for ParaView.
use render::progress::{Progress, Status};
use render::section::{BodySection, Layer, Section, Sheet};
use siltflow::coupling::{self, CouplingError, FileOutput, Ledger, Observer, Particles};
use siltflow::coupling::{Schedule, Simulation, StepInfo, WeightBalance};
use siltflow::dem::{Disc, Material, RigidBodies};
use siltflow::flow::{CartesianGrid, Diffusion, Fluid, Projection, Side};
use siltflow::ibm::SmoothForcing;
use siltflow::interfaces::{Bodies, BodyId, Freedom, Kinematics, Periods, Pose, Twist, Vector};
use std::error::Error;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

type Fall = Simulation<2, Particles<SmoothForcing, RigidBodies>>;

const CELLS: [usize; 2] = [150, 300]; // 15 per diameter
const SIZE: [f64; 2] = [0.01, 0.02]; // m
const WATER: Fluid = Fluid { density: 1000.0, viscosity: 1e-6 };

/// The progress line of the terminal.
struct Show(Progress);

impl Observer<Fall> for Show {
    fn step(&mut self, fall: &mut Fall, info: &StepInfo) -> Result<(), CouplingError> {
        let StepInfo { step, time, dt, courant, .. } = *info;
        self.0.step(step, || {
            let divergence = fall.flow.statistics().divergence * dt;
            Status { time, dt, courant, divergence }
        });
        Ok(())
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let out = PathBuf::from(std::env::args().nth(1).unwrap_or("out/falling_discs".into()));
    let grid = CartesianGrid::new(CELLS, SIZE)?;
    let flow = Projection::new(grid, Side::Periodic.everywhere(), WATER)?.with_diffusion(Diffusion::Explicit);

    let mut discs = RigidBodies::new(Periods::new([Some(SIZE[0]), Some(SIZE[1]), None]));
    for (density, x, y) in [(1060.0, 0.005, 0.016), (1030.0, 0.00505, 0.0135)] {
        let material = Material { density, ..Material::default() };
        let (pose, rest) = (Pose::at([x, y, 0.0]), Twist::default());
        discs.add(Disc::new(5e-4)?, material, pose, rest, Freedom::PLANAR)?;
    }
    let gravity = Vector::new(0.0, -9.81, 0.0);
    let particles = Particles::new(discs, SmoothForcing::new(WATER.density), WATER.density, gravity);
    let mut fall = Simulation::new(flow, particles, WeightBalance::NetWeight)?;

    let schedule = Schedule { end: 0.6, intervals: 60, ..Schedule::default() };
    let (mut files, mut ledger) = (FileOutput::new(&out)?, Ledger::new());
    let mut show = Show(Progress::new(0.0, schedule.end));
    let observers = &mut (&mut files, (&mut ledger, &mut show));
    let summary = coupling::run(&mut fall, &schedule, observers, &AtomicBool::new(false))?;
    files.finish()?;
    show.0.finish(summary.steps, "the discs have fallen");

    for (b, name) in ["heavy", "light"].iter().enumerate() {
        let bodies = &fall.particles.bodies;
        let (x, v) = (bodies.pose(BodyId(b)).position, bodies.twist(BodyId(b)).linear);
        println!("{name}: at ({:.3}, {:.3}) mm, {:.2} mm/s", 1e3 * x.x, 1e3 * x.y, 1e3 * v.norm());
    }
    let report = ledger.report();
    println!(
        "momentum: {:.0e} of the impulses; energy: {:.1e} of the work; divergence × dt: {:.0e}",
        report.momentum_total,
        report.energy_residual / report.work,
        report.divergence
    );
    draw(&fall, &out)
}

/// Speed of the fluid at the end, with the discs in it and their periodic images.
fn draw(fall: &Fall, out: &std::path::Path) -> Result<(), Box<dyn Error>> {
    let flow = &fall.flow;
    let speed: Vec<f64> =
        flow.centred_velocity(0).zip(flow.centred_velocity(1)).map(|(u, v)| u.hypot(v)).collect();
    let faces = [0, 1].map(|a| (0..=CELLS[a]).map(|i| SIZE[a] * i as f64 / CELLS[a] as f64).collect());
    let [across, up]: [Vec<f64>; 2] = faces;
    let bodies = &fall.particles.bodies;
    let image = |b: usize, shift: f64| {
        let mut pose = bodies.pose(BodyId(b));
        pose.position.y = pose.position.y.rem_euclid(SIZE[1]) + shift * SIZE[1];
        BodySection { solid: bodies.solid(BodyId(b)), pose, axes: [0, 1], plane: [0.0; 3] }
    };
    let images = (0..2).flat_map(|b| [-1.0, 0.0, 1.0].map(|shift| image(b, shift)));
    let layer = Layer {
        values: &speed,
        solid: None,
        bodies: &images.collect::<Vec<_>>(),
        solids_alone: false,
        limits: [0.0, 0.03],
        label: "speed in m/s",
        signed: false,
    };
    let section = Section { across: &across, up: &up, names: ["x", "y"] };
    let time = format!("t = {:.2} s", flow.time());
    let path = out.join("speed.png");
    section.draw(&mut Sheet::default(), &path, &layer, ["Two falling discs", &time])?;
    println!("{}", path.display());
    Ok(())
}
