//! The benchmark 2D-1 of Schäfer & Turek (1996), a cylinder in a channel at Re 20, by all ways to immerse it, on grids of which
//! the cells are moved against the cylinder (those beside the sides make up for it).
use crate::Outcome;
use example_support::cpu::Stopwatch;
use example_support::still_bodies::StillBodies;
use siltflow::dem::Disc;
use siltflow::flow::{
    Axis, CartesianGrid, Convection, Diffusion, Fluid, Profile, Projection, SampleError, Sampler, Side,
};
use siltflow::ibm::{Forcing, Hfdib, SmoothForcing, cut_walls};
use siltflow::interfaces::{BodyId, Vector};

const DIAMETER: f64 = 0.1;
const LENGTHS: [f64; 2] = [2.2, 0.41];
const FLUID: Fluid = Fluid { density: 1.0, viscosity: 1e-3 };
/// Largest and mean speed at the inlet.
const PEAK: f64 = 0.3;
const MEAN: f64 = 0.2;
/// Nabh (1998).
const DRAG: f64 = 5.57953523384;
const LIFT: f64 = 0.010618948146;
/// Pressure drop across the cylinder \[Pa\].
const DROP: f64 = 0.11752016697;
/// The drag is looked at once per unit of time; the flow is steady when it changes by less than this.
const STEADY: f64 = 2e-5;

/// The ways to immerse it.
#[derive(Clone, Copy)]
enum Way {
    CutLinks(Convection),
    Smooth,
    Hfdib,
}

/// What advances the flow by one step and tells the impulse on the cylinder.
type Step = Box<dyn FnMut(&mut Projection<2>, f64) -> Outcome<Vector>>;

impl Way {
    fn step(self, flow: &mut Projection<2>, bodies: StillBodies) -> Outcome<Step> {
        Ok(match self {
            Self::Smooth => forced(SmoothForcing::new(FLUID.density), bodies),
            Self::Hfdib => forced(Hfdib::new(FLUID.density), bodies),
            Self::CutLinks(_) => {
                let walls = cut_walls(flow.velocity(), &bodies)?;
                flow.set_walls(Some(walls))?;
                Box::new(|flow, dt| {
                    flow.advance(dt, [0.0; 2])?;
                    Ok(flow.wall_impulses()[0].force)
                })
            }
        })
    }
    fn name(self) -> String {
        match self {
            Self::CutLinks(scheme) => format!("cut links, {scheme:?}"),
            Self::Smooth => "SmoothForcing".into(),
            Self::Hfdib => "Hfdib".into(),
        }
    }
}

fn forced(mut forcing: impl Forcing + 'static, bodies: StillBodies) -> Step {
    Box::new(move |flow, dt| {
        flow.predict(dt, [0.0; 2])?;
        // Nothing moves: this clears the reaction.
        forcing.place(flow.velocity(), &bodies)?;
        for _ in 0..forcing.rounds() {
            forcing.force(flow.velocity_mut(), &bodies);
            flow.project(dt)?;
        }
        flow.finish(dt)?;
        Ok(forcing.reaction(BodyId(0)).force)
    })
}

/// An axis of cells of size `h` but for the first and last, moved by `shift` cells.
fn axis(length: f64, h: f64, shift: f64) -> Outcome<Axis> {
    let n = (length / h).round() as usize;
    let mut faces: Vec<f64> = (0..=n).map(|i| (i as f64 + shift) * h).collect();
    (faces[0], faces[n]) = (0.0, length);
    Ok(Axis::from_faces(faces)?)
}

/// An axis of cells of size `h` within `patch`, moved by `shift` cells, that grow by `ratio` from cell to cell outside.
fn gathered(length: f64, h: f64, patch: [f64; 2], ratio: f64, shift: f64) -> Outcome<Axis> {
    let [from, to] = patch.map(|x| ((x / h).round() + shift) * h);
    // So many cells, and the room shared among them in proportion.
    let grown = |room: f64| {
        let n = ((1.0 + room / h * (ratio - 1.0) / ratio).ln() / ratio.ln()).round();
        let widths: Vec<f64> = (1..=n as i32).map(|i| ratio.powi(i)).collect();
        let sum: f64 = widths.iter().sum();
        widths.into_iter().map(move |w| w * room / sum).collect::<Vec<f64>>()
    };
    let inner = ((to - from) / h).round() as usize;
    let widths = grown(from).into_iter().rev().chain(std::iter::repeat_n(h, inner)).chain(grown(length - to));
    let mut faces = vec![0.0];
    faces.extend(widths.scan(0.0, |x, w| {
        *x += w;
        Some(*x)
    }));
    if let Some(last) = faces.last_mut() {
        *last = length;
    }
    Ok(Axis::from_faces(faces)?)
}

/// The cells: all equal but beside the sides, or gathered round the cylinder.
#[derive(Clone, Copy)]
enum Cells {
    Equal,
    Gathered(f64),
}

fn run(way: Way, kind: Cells, cells: usize, shift: [f64; 2]) -> Outcome<()> {
    let start = Stopwatch::start();
    let h = DIAMETER / cells as f64;
    let axes = match kind {
        Cells::Equal => [axis(LENGTHS[0], h, shift[0])?, axis(LENGTHS[1], h, shift[1])?],
        Cells::Gathered(ratio) => [
            gathered(LENGTHS[0], h, [0.12, 0.36], ratio, shift[0])?,
            gathered(LENGTHS[1], h, [0.12, 0.28], ratio, shift[1])?,
        ],
    };
    let grid = CartesianGrid::from_axes(axes)?;
    let count = grid.n_cells();
    let sides =
        [[Side::Inlet(Profile::Parabolic { peak: PEAK }), Side::PressureOutlet(0.0)], Side::WALL.both()];
    let mut flow = Projection::new(grid, sides, FLUID)?.with_diffusion(Diffusion::Explicit);
    if let Way::CutLinks(scheme) = way {
        flow = flow.with_convection(scheme);
    }
    flow.set_velocity(|x| [4.0 * PEAK * x[1] * (LENGTHS[1] - x[1]) / (LENGTHS[1] * LENGTHS[1]), 0.0]);
    let bodies = StillBodies::default().with(Disc::new(0.5 * DIAMETER)?, [0.2, 0.2, 0.0], 0.0);
    let mut step = way.step(&mut flow, bodies)?;
    let coefficient = 2.0 / (FLUID.density * MEAN * MEAN * DIAMETER);
    let (mut last, mut next) = (f64::INFINITY, 6.0);
    let force = loop {
        let dt = flow.stable_dt(0.4);
        let force = step(&mut flow, dt)? * (coefficient / dt);
        if flow.time() < next {
            continue;
        }
        if (force.x / last - 1.0).abs() < STEADY || flow.time() > 60.0 {
            break force;
        }
        (last, next) = (force.x, flow.time() + 1.0);
    };
    // At the stagnation points, from one and two cells before and behind.
    let sampler = Sampler::new(flow.grid(), flow.sides());
    let pressure = |x: f64| sampler.at(flow.pressure(), [x, 0.2]);
    let ends =
        [(0.15, -h), (0.25, h)].map(|(x, out)| Ok(2.0 * pressure(x + out)? - pressure(x + 2.0 * out)?));
    let [front, back]: [Result<f64, SampleError>; 2] = ends;
    let drop = front? - back?;
    println!(
        "{:>32} {cells:>6} {count:>7} {:>5.2} {:>5.2} {:>9.5} {:>8.3}% {:>10.6} {:>8.1}% {:>8.2}% {:>7} {:>8.2}",
        match kind {
            Cells::Equal => way.name(),
            Cells::Gathered(_) => format!("{}, gathered", way.name()),
        },
        shift[0],
        shift[1],
        force.x,
        100.0 * (force.x / DRAG - 1.0),
        force.y,
        100.0 * (force.y / LIFT - 1.0),
        100.0 * (drop / DROP - 1.0),
        flow.steps(),
        start.elapsed().cpu
    );
    Ok(())
}

pub(crate) fn table() -> Outcome<()> {
    println!("\nCylinder in a channel, Re 20: Cd {DRAG:.6} and Cl {LIFT:.6} wanted");
    println!(
        "{:>32} {:>6} {:>7} {:>11} {:>9} {:>9} {:>10} {:>9} {:>9} {:>7} {:>8}",
        "way", "per D", "cells", "grid moved", "Cd", "error", "Cl", "error", "Δp", "steps", "CPU s"
    );
    let shifts = [[0.0, 0.0], [0.37, 0.3], [0.5, 0.5]];
    let cut = [Convection::Central, Convection::Quick].map(Way::CutLinks);
    for way in cut {
        for (cells, shift) in [10, 20, 40].into_iter().flat_map(|n| shifts.map(|shift| (n, shift))) {
            run(way, Cells::Gathered(1.05), cells, shift)?;
        }
    }
    for way in [cut[0], cut[1], Way::Smooth, Way::Hfdib] {
        for cells in [10, 20, 40] {
            for shift in &shifts[..if cells == 40 { 1 } else { 3 }] {
                run(way, Cells::Equal, cells, *shift)?;
            }
        }
    }
    Ok(())
}
