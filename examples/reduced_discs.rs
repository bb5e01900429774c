//! Reduced models of two falling discs: figure 9 of Isoz et al. (2023).
//!
//! The modes φ of POD stay where they are; those of shifted POD move along with the discs,
//!
//! ```text
//! λ(x, t) ≈ Σ_i a_i(t) φ_i(x)                       PODIANN
//! λ(x, t) ≈ Σ_k Σ_i a_ki(t) φ_ki(x − x_k(t))        sPODIANN, x_k: path of disc k
//! ```
//!
//! and the coefficients a between snapshots are those of the method (networks, splines, radial
//! functions) that predicts held-out snapshots best. Every second snapshot makes the models, the
//! others assess them by ‖λ − λ̂‖/‖λ‖; the projection error is what the modes cannot show. With 20
//! moving modes, coefficients of the last ones vary from cell to cell, too fast to interpolate.
//!
//! `cargo run --release --example reduced_discs [FOLDER]`, 8 s; `out/reduced_discs/lambda.png`.
use mor::Mat;
use mor::models::{Assessment, Podiann, Spodiann, SpodiannParams};
use mor::pod::{Pod, PodParams};
use mor::shifted::fourier::Als;
use mor::shifted::{Grid, Interpolation, Motions};
use render::Scalar;
use render::gallery::{Gallery, Row, Tile};
use siltflow::coupling::{self, BodyPaths, Particles, Quantity, Schedule, Simulation};
use siltflow::coupling::{SnapshotFeed, WeightBalance};
use siltflow::dem::{Disc, Material, RigidBodies};
use siltflow::flow::{CartesianGrid, Diffusion, Fluid, Projection, Side};
use siltflow::ibm::SmoothForcing;
use siltflow::interfaces::{Freedom, Periods, Pose, SnapshotSink, Twist, Vector};
use std::error::Error;
use std::sync::atomic::AtomicBool;

const CELLS: [usize; 2] = [100, 200]; // 10 per diameter
const SIZE: [f64; 2] = [0.01, 0.02]; // m
const WATER: Fluid = Fluid { density: 1000.0, viscosity: 1e-6 };

/// Snapshots one after the other.
#[derive(Default)]
struct Snapshots {
    times: Vec<f64>,
    fields: Vec<Vec<f64>>,
}

impl SnapshotSink for Snapshots {
    fn push(&mut self, time: f64, field: &[f64]) -> Result<(), Box<dyn Error + Send + Sync>> {
        self.times.push(time);
        self.fields.push(field.to_vec());
        Ok(())
    }
}

/// Poses of each disc at all times.
type Paths = Vec<Vec<Pose>>;

/// λ at 201 times, and the poses of both discs.
fn fall() -> Result<(Snapshots, Paths), Box<dyn Error>> {
    let grid = CartesianGrid::new(CELLS, SIZE)?;
    let flow = Projection::new(grid, Side::Periodic.everywhere(), WATER)?.with_diffusion(Diffusion::Explicit);
    let mut discs = RigidBodies::new(Periods::new([Some(SIZE[0]), Some(SIZE[1]), None]));
    for (density, x, y) in [(1060.0, 0.005, 0.016), (1030.0, 0.00505, 0.0135)] {
        let (material, pose) = (Material { density, ..Material::default() }, Pose::at([x, y, 0.0]));
        discs.add(Disc::new(5e-4)?, material, pose, Twist::default(), Freedom::PLANAR)?;
    }
    let gravity = Vector::new(0.0, -9.81, 0.0);
    let particles = Particles::new(discs, SmoothForcing::new(WATER.density), WATER.density, gravity);
    let mut fall = Simulation::new(flow, particles, WeightBalance::NetWeight)?;
    let schedule = Schedule { end: 0.6, intervals: 200, ..Schedule::default() };
    let feed = SnapshotFeed::new(Quantity::SolidFraction, Snapshots::default());
    let mut observers = (feed, BodyPaths::default());
    coupling::run(&mut fall, &schedule, &mut observers, &AtomicBool::new(false))?;
    Ok((observers.0.sink, observers.1.whole()))
}

fn main() -> Result<(), Box<dyn Error>> {
    let out = std::env::args().nth(1).unwrap_or("out/reduced_discs".into());
    let (lambda, paths) = fall()?;
    // Every second snapshot, from the first or the second on: times, fields, frames of the discs.
    let part = |from: usize| -> Result<_, Box<dyn Error>> {
        let which: Vec<usize> = (from..lambda.times.len()).step_by(2).collect();
        let points = Mat::from_fn(1, which.len(), |_, j| lambda.times[which[j]]);
        let fields = Mat::from_fn(CELLS[0] * CELLS[1], which.len(), |i, j| lambda.fields[which[j]][i]);
        // All frames begin at the first snapshot of the fall.
        let shift = |path: &Vec<Pose>| which.iter().map(|&j| path[j].position - path[0].position).collect();
        let motions = Motions::translations(&paths.iter().map(shift).collect::<Vec<_>>())?;
        Ok((points, fields, motions))
    };
    let (points, fields, motions) = part(0)?;
    let (times, between, moved) = part(1)?;

    let h = SIZE[0] / CELLS[0] as f64;
    let grid = Grid::new(CELLS, [h, h])?.starting_at([0.5 * h, 0.5 * h, 0.0].into());
    let shown = 50; // between snapshots of the models
    let mut tiles = vec![("simulation".to_string(), between.col_as_slice(shown).to_vec())];
    println!("modes  PODIANN (projection)   sPODIANN (projection)");
    for modes in [4, 10, 20] {
        let pod = Pod::new(fields.as_ref(), &PodParams::of_rank(modes))?;
        let still = Podiann::new(points.as_ref(), &pod, None)?;
        let shifted = Als { stagnation: 1e-2, ..Als::new([modes / 2; 2]) };
        let found = shifted.solve(&grid, &motions, fields.as_ref(), None, None, &mut |_| true)?;
        let params = SpodiannParams { coefficients: None, paths: None };
        let spectral = (grid, Interpolation::Spectral);
        let moving = Spodiann::new(points.as_ref(), &found, spectral, &motions, params)?;
        let still_errors = still.assess(times.as_ref(), between.as_ref())?;
        let moving_errors = moving.assess(times.as_ref(), between.as_ref(), &moved)?;
        let percents = |e: Assessment| format!("{:8.2} % ({:6.2} %)", 100.0 * e.total, 100.0 * e.projection);
        println!("{modes:5}  {}  {}", percents(still_errors), percents(moving_errors));
        let mut field = vec![0.0; still.rows()];
        still.predict(&[times[(0, shown)]], &mut field)?;
        tiles.push((format!("POD, {modes} modes"), field.clone()));
        moving.predict(&[times[(0, shown)]], &mut field)?;
        tiles.push((format!("sPOD, {modes} modes"), field));
    }
    let [nx, ny] = CELLS;
    let tiles =
        tiles.iter().map(|(title, values)| Tile { title: title.clone(), field: Scalar { nx, ny, values } });
    let label = format!("λ at t = {:.4} s", times[(0, shown)]);
    let row = Row { label, range: Some((0.0, 1.0)), tiles: tiles.collect() };
    std::fs::create_dir_all(&out)?;
    let gallery = Gallery { periodic: [true; 2], aspect: 2.0, rows: vec![row] };
    Ok(gallery.draw(format!("{out}/lambda.png").as_ref())?)
}
