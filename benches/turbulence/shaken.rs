//! A cylinder that swings in fluid at rest, with models of two equations that see it.
use render::cpu::Stopwatch;
use render::section::{Layer, Section, Sheet};
use siltflow::flow::Projection;
use siltflow::ibm::SmoothForcing;
use std::path::Path;
use turb::{Inflow, Law, Realizable, Sst, StandardKEpsilon, Wilcox};
use validation::Outcome;
use validation::moved_body::{Noise, Swinging};
use validation::sliding_plate::with_model;

/// Harmonics that belong to the flow.
const HARMONICS: usize = 12;
const SWINGS: usize = 3;
const FOLDER: &str = "out/turbulence";

pub(crate) fn swinging_cylinder() -> Outcome<()> {
    println!("\nSwinging cylinder, KC 5, in fluid at rest with turbulence: in-line force in swing {SWINGS}");
    println!(
        "{:>16} {:>7} {:>6} {:>6} {:>8} {:>8} {:>10} {:>9} {:>10} {:>10} {:>10} {:>8}",
        "model",
        "Re",
        "per D",
        "steps",
        "y+ mean",
        "peak",
        "noise",
        "set",
        "least k",
        "least w,e",
        "most nu_t",
        "CPU s"
    );
    std::fs::create_dir_all(FOLDER)?;
    without_model(20)?;
    for (per_diameter, halvings) in [(10, 0), (20, 0), (20, 1)] {
        of_model("k-omega SST", Sst::default(), 1e4, per_diameter, halvings)?;
    }
    of_model("k-omega SST", Sst::default(), 1e5, 20, 0)?;
    of_model("k-omega", Wilcox::default(), 1e4, 20, 0)?;
    of_model("k-epsilon", StandardKEpsilon::default(), 1e4, 20, 0)?;
    of_model("realizable k-eps", Realizable::default(), 1e4, 20, 2)
}

/// Without a model.
fn without_model(per_diameter: usize) -> Outcome<()> {
    let watch = Stopwatch::start();
    let steps = 20 * per_diameter;
    let mut cylinder = Swinging::new(per_diameter, steps, [0.37, 0.3], Box::new(SmoothForcing::new(1.0)))?;
    let mut series = Vec::new();
    for _ in 0..SWINGS {
        series = cylinder.swing()?;
    }
    let noise = Noise::of(&series, HARMONICS);
    println!(
        "{:>16} {:>7} {per_diameter:>6} {steps:>6} {:>8} {:>8.4} {:>9.3}% {:>9} {:>10} {:>10} {:>10} {:>8.1}",
        "none",
        100,
        "",
        noise.peak,
        100.0 * noise.rms / noise.peak,
        "",
        "",
        "",
        "",
        watch.elapsed().cpu
    );
    Ok(())
}

fn of_model<L: Law>(name: &str, law: L, reynolds: f64, per_diameter: usize, halvings: usize) -> Outcome<()>
where
    turb::TwoEquation<L>: siltflow::interfaces::Closure,
{
    let watch = Stopwatch::start();
    let steps = (20 << halvings) * per_diameter;
    let still: Projection<2> = Swinging::still(per_diameter, [0.37, 0.3], 1.0 / reynolds)?;
    let start = Inflow::from_viscosity_ratio(1.0, 0.05, 10.0, 1.0 / reynolds)?;
    let flow = with_model(still, law, start)?;
    let mut cylinder = Swinging::within(flow, steps, Box::new(SmoothForcing::new(1.0)))?;
    let (mut series, mut floored) = (Vec::new(), 0);
    for _ in 0..SWINGS {
        series.clear();
        for _ in 0..steps {
            series.push(cylinder.step()?);
            floored += cylinder.flow().hooks.closure.model.closure.floored();
        }
    }
    let model = &cylinder.flow().hooks.closure.model.closure;
    // In the body k is given.
    let in_fluid = |list: &[f64]| {
        let near = cylinder.flow().hooks.closure.near_walls();
        let fluid = |c: &usize| near.solid().binary_search(c).is_err();
        (0..list.len()).filter(fluid).map(|c| list[c]).fold(f64::INFINITY, f64::min)
    };
    let noise = Noise::of(&series, HARMONICS);
    println!(
        "{name:>16} {reynolds:>7} {per_diameter:>6} {steps:>6} {:>8.1} {:>8.4} {:>9.3}% {floored:>9} {:>10.2e} {:>10.2e} {:>10.2e} {:>8.1}",
        model.y_plus().mean,
        noise.peak,
        100.0 * noise.rms / noise.peak,
        in_fluid(model.k()),
        in_fluid(model.scale()),
        model.nu_t().iter().copied().fold(0.0, f64::max),
        watch.elapsed().cpu
    );
    if name == "k-omega SST" && reynolds < 2e4 && halvings == 0 && per_diameter == 20 {
        picture(cylinder.flow().grid(), cylinder.flow().hooks.closure.near_walls().solid(), model)?;
    }
    Ok(())
}

/// ν_t/ν and k around the cylinder.
fn picture<L: Law>(
    grid: &siltflow::flow::CartesianGrid<2>,
    solid: &[usize],
    model: &turb::TwoEquation<L>,
) -> Outcome<()> {
    let window = [[17.0, 23.0], [13.0, 17.0]];
    let inside = [0, 1].map(|a| {
        let (axis, [low, high]) = (grid.axis(a), window[a]);
        let first = axis.faces().partition_point(|x| *x < low);
        first..axis.faces().partition_point(|x| *x <= high) - 1
    });
    let faces = [0, 1].map(|a| grid.axis(a).faces()[inside[a].start..=inside[a].end].to_vec());
    let cells: Vec<usize> =
        inside[1].clone().flat_map(|j| inside[0].clone().map(move |i| grid.index([i, j]))).collect();
    let solid: Vec<f64> = cells.iter().map(|c| f64::from(solid.binary_search(c).is_ok())).collect();
    let section = Section { across: &faces[0], up: &faces[1], names: ["x/D", "y/D"] };
    let fields = [("k", "k/U^2", model.k()), ("nu_t", "nu_t/(U D)", model.nu_t())];
    for (file, label, list) in fields {
        let values: Vec<f64> = cells.iter().map(|&c| list[c]).collect();
        let most = values.iter().copied().fold(0.0, f64::max);
        let layer = Layer {
            values: &values,
            solid: Some(&solid),
            bodies: &[],
            solids_alone: false,
            limits: [0.0, most],
            label,
            signed: false,
        };
        let path = format!("{FOLDER}/shaken_{file}.png");
        section.draw(
            &mut Sheet::default(),
            Path::new(&path),
            &layer,
            ["Swinging cylinder, SST, Re 10 000, KC 5", ""],
        )?;
    }
    Ok(())
}
