//! A cylinder or a sphere at rest in a turbulent stream, its wall immersed in the grid: steady flow with k–ω SST and wall functions.
//!
//! The body has a diameter of 1 m in a stream of 1 m/s. The drag is that of the boundary layer the model makes: turbulent from the
//! stagnation point on, whatever the Reynolds number, so that it is to be held against computations with the same model and not
//! against measurements with a laminar layer.
//!
//! Sample run: `cargo run --release --example bluff_body --features turb -- --re 1e4 --half`, a quarter of a minute.
use clap::{Parser, ValueEnum};
use example_support::Outcome;
use example_support::axes::gathered;
use siltflow::dem::{Disc, Sphere};
use siltflow::flow::{
    CartesianGrid, Convection, FlowError, Fluid, Modelled, Profile, Side, Simple, SimpleParams,
    TransportParams, WallStress,
};
use siltflow::ibm::{StaticBodies, cut_cells};
use siltflow::interfaces::{Pose, Solid};
use turb::{Inflow, KOmegaSst, Sst};

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Body {
    Cylinder,
    Sphere,
}

#[derive(Parser)]
struct Cli {
    #[arg(long, value_enum, default_value = "cylinder")]
    body: Body,
    /// Reynolds number by the diameter
    #[arg(long, default_value_t = 1e6)]
    re: f64,
    /// Cells per diameter beside the body
    #[arg(long, default_value_t = 40)]
    cells: usize,
    #[arg(long, default_value_t = 1500)]
    iterations: usize,
    /// Relaxation factor of the velocity
    #[arg(long, default_value_t = 0.9)]
    relaxation: f64,
    /// How far beside the body the cells are even, in diameters; three times as far behind it
    #[arg(long, default_value_t = 0.3)]
    margin: f64,
    /// Intensity of the turbulence that enters; with next to none the wall functions take the layer for a laminar one
    #[arg(long, default_value_t = 0.05)]
    intensity: f64,
    /// Its ν_t/ν
    #[arg(long, default_value_t = 100.0)]
    ratio: f64,
    /// Half of the flow: a plane of symmetry along the stream keeps the wake from swinging
    #[arg(long)]
    half: bool,
}

/// Where the stream begins and ends along its way, and how far to either side it goes \[m\].
const ENDS: [f64; 3] = [-10.0, 40.0, 20.0];

fn main() -> Outcome<()> {
    let cli = Cli::parse();
    if !(cli.re.is_finite() && cli.re > 0.0) || cli.cells < 8 || !(0.0..=3.0).contains(&cli.margin) {
        return Err(
            "give a positive Reynolds number, at least 8 cells per diameter and a margin of 0 to 3".into()
        );
    }
    match cli.body {
        Body::Cylinder => run::<2, _>(&cli, Disc::new(0.5)?, 1.0),
        Body::Sphere => run::<3, _>(&cli, Sphere::new(0.5)?, 0.25 * std::f64::consts::PI),
    }
}

fn run<const D: usize, S: Solid + Copy + 'static>(cli: &Cli, body: S, face: f64) -> Outcome<()> {
    let h = 1.0 / cli.cells as f64;
    let [from, to, aside] = ENDS;
    let side = 0.5 + cli.margin;
    let across = |a: usize| {
        if cli.half && a == 1 {
            let all = gathered(2.0 * aside, h, [aside - side, aside + side], 1.1, 0.0)?;
            let faces: Vec<f64> =
                all.faces().iter().map(|x| x - aside).filter(|x| *x > -1e-9 * aside).collect();
            return siltflow::flow::Axis::from_faces(faces);
        }
        let range = if a == 0 {
            [-from - side, -from + side + 2.0 * cli.margin]
        } else {
            [aside - side, aside + side]
        };
        let length = if a == 0 { to - from } else { 2.0 * aside };
        gathered(length, h, range, 1.1, 0.0)
    };
    let axes: Vec<_> = (0..D).map(across).collect::<Result<_, _>>()?;
    let axes: [_; D] = axes.try_into().map_err(|_| "an axis is missing")?;
    let grid = CartesianGrid::from_axes(axes)?;
    let place: [f64; D] = std::array::from_fn(|a| match a {
        0 => -from,
        1 if cli.half => 0.0,
        _ => aside,
    });
    let mut stream = [0.0; 3];
    stream[0] = 1.0;
    let sides = std::array::from_fn(|a| match a {
        0 => [Side::Inlet(Profile::Uniform(stream)), Side::PressureOutlet(0.0)],
        _ => Side::FreeSlip.both(),
    });
    let fluid = Fluid { density: 1.0, viscosity: 1.0 / cli.re };
    let params = SimpleParams { velocity_relaxation: cli.relaxation, ..SimpleParams::turbulent() };
    let mut flow = Simple::new(grid, sides, fluid)?.with_convection(Convection::Quick).with_params(params)?;
    let centre = std::array::from_fn(|a| place.get(a).copied().unwrap_or(0.0));
    let walls = StaticBodies::new().with(body, Pose::at(centre));
    let cuts = cut_cells(flow.velocity(), &walls)?;
    flow.set_walls(Some((&cuts, WallStress::LAW_OF_THE_WALL)))?;
    flow.set_velocity(|_| std::array::from_fn(|a| if a == 0 { 1.0 } else { 0.0 }));
    let n = flow.grid().n_cells();
    let inflow = Inflow::from_viscosity_ratio(1.0, cli.intensity, cli.ratio, fluid.viscosity)?;
    let closure = KOmegaSst::new(Sst::default(), n, inflow)?;
    let mut model = Modelled::new(closure, flow.grid(), flow.sides(), TransportParams::steady())?;
    let grid = flow.grid().clone();
    for (i, distance) in model.transport_mut().wall_distance_mut().iter_mut().enumerate() {
        let x = grid.centre(grid.cell(i));
        let r2: f64 = (0..D).map(|a| (x[a] - place[a]).powi(2)).sum();
        *distance = (r2.sqrt() - 0.5).max(0.0);
    }
    println!("{n} cells, {} with wall", cuts.walls.len());
    let start = std::time::Instant::now();
    let face = if cli.half { 0.5 * face } else { face };
    let drag = |flow: &Simple<D>| {
        let sum = |list: Vec<siltflow::interfaces::Wrench>| list.iter().map(|w| w.force.x).sum::<f64>();
        [sum(flow.wall_pressure_force()), sum(flow.wall_friction())].map(|f| 2.0 * f / face)
    };
    println!("{:>6} {:>9} {:>9} {:>9} {:>9} {:>9}", "its", "momentum", "mass", "model", "Cd", "friction");
    let mut largest = f64::INFINITY;
    while largest > 1e-5 && flow.iterations() < cli.iterations {
        let most = (cli.iterations / 20).clamp(1, cli.iterations - flow.iterations());
        let told = match flow.solve_with(&mut model, most, 1e-5) {
            Ok(info) => [info.momentum.into_iter().fold(0.0, f64::max), info.continuity, info.closure],
            Err(FlowError::NotSteady { momentum, continuity, closure, .. }) => {
                [momentum, continuity, closure]
            }
            Err(error) => return Err(error.into()),
        };
        largest = told.into_iter().fold(0.0, f64::max);
        let [form, friction] = drag(&flow);
        println!(
            "{:>6} {:>9.1e} {:>9.1e} {:>9.1e} {:>9.4} {friction:>9.4}",
            flow.iterations(),
            told[0],
            told[1],
            told[2],
            form + friction
        );
    }
    let y = model.closure.y_plus();
    let seconds = start.elapsed().as_secs_f64();
    println!("y+ {:.0} to {:.0}, mean {:.0}; {seconds:.0} s", y.least, y.most, y.mean);
    if largest > 1e-5 {
        println!("not steady to 1e-5: the wake swings, or more iterations are needed");
    }
    Ok(())
}
