//! A bent channel at Re 10⁶ whose walls are immersed, beside the same on a body-fitted grid: figure 5 of Isoz et al. (2023).
//!
//! The duct is 1 m high, air enters at 1 m/s with 5 % turbulence. `--bend 90` is held against simpleFoam's solution in
//! `tests/data/bends`; a straight duct that is turned (`--bend 0 --turn 15`) against the station one height before that bend.
//!
//! Sample run: `cargo run --release --example bent_channel --features turb -- --cells 160 --model sst`, half a minute.
mod compare;
mod duct;

use clap::{Parser, ValueEnum};
use duct::Duct;
use example_support::axes::{even, widening};
use example_support::files::make_folder;
use example_support::steadily::steadily;
use example_support::{Outcome, told};
use siltflow::flow::{
    Axis, CartesianGrid, CellWriter, Convection, Fluid, Modelled, Patch, Profile, Side, Simple, SimpleParams,
    TransportParams, WallStress,
};
use siltflow::ibm::{StaticBodies, cut_cells};
use siltflow::interfaces::{Closure, CutCells, Pose};
use std::path::PathBuf;
use std::process::ExitCode;
use turb::{
    Inflow, KEpsilon, KOmega, KOmegaSst, Realizable, RealizableKEpsilon, Sst, StandardKEpsilon,
    TurbulenceError, Wilcox,
};

/// Residual to which coarser grids are solved.
const COARSE: f64 = 1e-3;

#[derive(Clone, Copy, ValueEnum)]
enum Model {
    Sst,
    KOmega,
    KEpsilon,
    Realizable,
}

#[derive(Parser)]
struct Cli {
    /// Angle of the bend in degrees: 0, 90 or 180
    #[arg(long, default_value_t = 90.0)]
    bend: f64,
    /// Angle by which a straight duct is turned against the grid, in degrees, 0 to 45
    #[arg(long, default_value_t = 0.0)]
    turn: f64,
    #[arg(long, value_enum, default_value = "sst")]
    model: Model,
    /// Cells across the duct
    #[arg(long, default_value_t = 80)]
    cells: usize,
    #[arg(long, default_value_t = 1e6)]
    re: f64,
    #[arg(long, default_value_t = 1000)]
    iterations: usize,
    /// Relaxation factor of the velocity; what is steady does not depend on it
    #[arg(long, default_value_t = 0.9)]
    relaxation: f64,
    /// How much wider every cell is than the one before it along straight parts, up to a tenth of the height
    #[arg(long, default_value_t = 1.05)]
    growth: f64,
    /// So many coarser grids come first, each of half as many cells along each axis, and say where the next one starts
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=6))]
    nested: u32,
    /// Where pictures and the flow go
    #[arg(long, default_value = "target/bent_channel")]
    out: PathBuf,
}

fn main() -> ExitCode {
    told(chosen(&Cli::parse()))
}

/// The channel with the model that was asked for.
fn chosen(cli: &Cli) -> Outcome<()> {
    let known = [0.0, 90.0, 180.0].contains(&cli.bend) && (0.0..=45.0).contains(&cli.turn);
    let grows = (1.0..=2.0).contains(&cli.growth);
    if !known || cli.turn > 0.0 && cli.bend > 0.0 || cli.cells < 8 || !grows {
        let asked =
            "--bend 0, 90 or 180, --turn 0 to 45 for a straight duct, at least 8 cells and --growth 1 to 2";
        return Err(format!("give {asked}").into());
    }
    make_folder(&cli.out)?;
    let duct = Duct { bend: cli.bend.to_radians(), turn: cli.turn.to_radians() };
    let inflow = Inflow::from_length(1.0, 0.05, 0.07)?;
    match cli.model {
        Model::Sst => run(cli, duct, "kOmegaSST", |n| KOmegaSst::new(Sst::default(), n, inflow)),
        Model::KOmega => {
            // The constants of the reference runs: Wilcox 1998 without its corrections.
            let law = Wilcox { beta: 0.072, gamma: 0.52, ..Wilcox::default() };
            run(cli, duct, "kOmega", |n| KOmega::new(law, n, inflow))
        }
        Model::KEpsilon => {
            run(cli, duct, "kEpsilon", |n| KEpsilon::new(StandardKEpsilon::default(), n, inflow))
        }
        Model::Realizable => {
            run(cli, duct, "realizableKE", |n| RealizableKEpsilon::new(Realizable::default(), n, inflow))
        }
    }
}

/// Even where walls are not along the axes, wider along straight parts.
fn grid(cli: &Cli, duct: Duct, cells: usize) -> Outcome<CartesianGrid<2>> {
    let h = 1.0 / cells as f64;
    let margin = 2.0 * h;
    let widening = |length, h| widening(length, h, cli.growth, 0.1);
    let before: Vec<f64> = widening(5.0, h).iter().rev().map(|e| -e).collect();
    let axes = match cli.bend as usize {
        90 => {
            let behind = widening(10.0, h);
            [[before, even(0.0, 2.0 + margin, h)].concat(), [even(-2.0 - margin, 0.0, h), behind].concat()]
        }
        180 => [[before, even(0.0, 2.0 + margin, h)].concat(), even(-2.0 - margin, 2.0 + margin, h)],
        _ if cli.turn == 0.0 => {
            let behind = widening(10.0, h);
            [[before, vec![0.0], behind].concat(), even(-2.0 - margin, -1.0 + margin, h)]
        }
        _ => {
            // From where both walls have begun to where the first one ends.
            let corners = [-5.0, 4.0].map(|s| [1.0, 2.0].map(|r| duct.point(s, r)));
            let x = [corners[0][0][0].max(corners[0][1][0]), corners[1][0][0].min(corners[1][1][0])];
            let y = [corners[0][1][1] - 1.0, corners[1][0][1] + 1.0];
            [even(x[0], x[1], h), even(y[0], y[1], h)]
        }
    };
    let [x, y] = axes.map(Axis::from_faces);
    Ok(CartesianGrid::from_axes([x?, y?])?)
}

fn sides(cli: &Cli, duct: Duct) -> [[Side; 2]; 2] {
    let [u, v] = duct.along(-1.0);
    let inlet = Side::Inlet(Profile::Uniform([u, v, 0.0]));
    let outlet = Side::PressureOutlet(0.0);
    match cli.bend as usize {
        90 => [[inlet, Side::FreeSlip], [Side::FreeSlip, outlet]],
        180 => {
            let part =
                |lower, upper, side| Patch { lower: [-9.0, lower, 0.0], upper: [9.0, upper, 0.0], side };
            let left = Side::Patches(vec![part(-9.0, 0.0, inlet), part(0.0, 9.0, outlet)]);
            [[left, Side::FreeSlip], Side::FreeSlip.both()]
        }
        _ => [[inlet, outlet], Side::FreeSlip.both()],
    }
}

/// The flow and its model at first.
fn scene<C: Closure>(
    cli: &Cli,
    duct: Duct,
    cells: usize,
    closure: impl Fn(usize) -> Result<C, TurbulenceError>,
) -> Outcome<(Simple<2>, Modelled<2, C>, CutCells)> {
    let grid = grid(cli, duct, cells)?;
    let fluid = Fluid { density: 1.0, viscosity: 1.0 / cli.re };
    let mut flow = Simple::new(grid.clone(), sides(cli, duct), fluid)?
        .with_convection(Convection::Quick)
        .with_params(SimpleParams { velocity_relaxation: cli.relaxation, ..SimpleParams::turbulent() })?;
    let walls = StaticBodies::new().with(duct, Pose::at([0.0; 3]));
    let cuts = cut_cells(flow.velocity(), &walls)?;
    flow.set_walls(Some((&cuts, WallStress::LAW_OF_THE_WALL)))?;
    flow.set_velocity(|x| duct.along_at(x));
    let closure = closure(grid.n_cells())?;
    let mut model = Modelled::new(closure, &grid, flow.sides(), TransportParams::steady())?;
    let centres = (0..grid.n_cells()).map(|i| grid.centre(grid.cell(i)));
    for (distance, x) in model.transport_mut().wall_distance_mut().iter_mut().zip(centres) {
        *distance = duct.distance(x).max(0.0);
    }
    Ok((flow, model, cuts))
}

fn run<C: Closure>(
    cli: &Cli,
    duct: Duct,
    name: &str,
    closure: impl Fn(usize) -> Result<C, TurbulenceError>,
) -> Outcome<()> {
    let start = std::time::Instant::now();
    let mut coarser: Option<(Simple<2>, Modelled<2, C>, CutCells)> = None;
    for level in (1..=cli.nested).rev() {
        let (mut flow, mut model, cuts) = scene(cli, duct, (cli.cells >> level).max(8), &closure)?;
        if let Some((found, known, _)) = &coarser {
            flow.start_with(&mut model, found, known)?;
        }
        println!("{} cells", flow.grid().n_cells());
        steadily(&mut flow, &mut model, (cli.iterations, COARSE), &[], |_| Vec::new())?;
        coarser = Some((flow, model, cuts));
    }
    let (mut flow, mut model, cuts) = scene(cli, duct, cli.cells, closure)?;
    if let Some((found, known, _)) = coarser.take() {
        flow.start_with(&mut model, &found, &known)?;
    }
    let grid = flow.grid().clone();
    let fluid_cells = (0..grid.n_cells()).filter(|&i| duct.distance(grid.centre(grid.cell(i))) > 0.0).count();
    println!("{} cells, {fluid_cells} in the fluid, {} with wall", grid.n_cells(), cuts.walls.len());
    let before = start.elapsed().as_secs_f64();
    let told = steadily(&mut flow, &mut model, (cli.iterations, 1e-5), &[], |_| Vec::new())?;
    let seconds = start.elapsed().as_secs_f64() - before;
    let iterations = flow.iterations();
    if told.largest() > 1e-5 {
        println!("not steady to 1e-5: more iterations are needed, or a smaller relaxation factor");
    }
    let cost = seconds / iterations.max(1) as f64 / fluid_cells as f64 * 1e6;
    println!(
        "{iterations} iterations, {before:.1} s before, {seconds:.1} s, {cost:.2} µs per cell in the fluid and iteration"
    );
    let eddy = model.closure.eddy_viscosity().unwrap_or_default();
    compare::report(&flow, eddy, &cuts.walls, duct, name, &cli.out)?;
    let centred = |c: usize| -> Vec<f64> {
        let (u, [_, rows]) = (flow.velocity().field(c), grid.cells());
        let mean = |k: usize| {
            let [i, j] = grid.cell(k);
            let here = u.row(j)[i];
            let next = if c == 0 { u.row(j).get(i + 1) } else { u.row((j + 1).min(rows - 1)).get(i) };
            0.5 * (here + next.unwrap_or(&here))
        };
        (0..grid.n_cells()).map(mean).collect()
    };
    let file = CellWriter::new(&grid)
        .scalar("p", flow.pressure().values())
        .scalar("nu_t", eddy.iter().copied())
        .scalar("k", model.closure.kinetic_energy().unwrap_or_default().iter().copied())
        .vector("u", [centred(0), centred(1)]);
    let path = cli.out.join(format!("flow.{}", file.extension()));
    file.write(&mut std::io::BufWriter::new(std::fs::File::create(path)?))?;
    Ok(())
}
