//! Fields from a saved reduced model (PODIANN or sPODIANN), at any times and parameters.
//!
//! ```text
//! cargo run --release --example predict -- out/parameter_study/lambda.model --at 1.5,1.05,0.6 --write png
//! cargo run --release --example predict -- out/parameter_study/velocity.model --at 1.5,1.05,0.6 --cells 150,300 --write npy,vti
//! ```
//!
//! `--at` takes what the model was made of, in that order: time, then parameters. A model with frames of reference knows its grid; of one without `--cells` tells it, if pictures or
//! VTK files are wanted.
mod files;

use clap::{Parser, ValueEnum};
use example_support::files::make_folder;
use example_support::{Outcome, told};
use mor::interpolation::Record;
use mor::models::{ModelError, Podiann, Spodiann};
use mor::shifted::Grid;
use std::path::PathBuf;
use std::process::ExitCode;

/// Fields from a saved reduced model.
#[derive(Clone, Debug, Parser)]
#[command(version)]
struct Cli {
    /// What a scene, an example or `record().save` left: `NAME.model`.
    model: PathBuf,
    /// Time and parameters, separated by commas; once for every field.
    #[arg(long = "at", required = true, allow_hyphen_values = true)]
    at: Vec<String>,
    /// Cells along x, y, z of a model that does not know them.
    #[arg(long, value_delimiter = ',', num_args = 1..=3)]
    cells: Vec<usize>,
    /// Their sizes [m].
    #[arg(long, value_delimiter = ',', num_args = 1..=3)]
    spacing: Vec<f64>,
    /// Kinds of files.
    #[arg(long, value_delimiter = ',', default_values_t = [Kind::Npy, Kind::Csv])]
    write: Vec<Kind>,
    /// Folder for everything that is written.
    #[arg(long, default_value = "out/predict")]
    out: PathBuf,
}

/// What a prediction is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// NumPy: fields × rows.
    Npy,
    /// A row per unknown, a column per field.
    Csv,
    /// For ParaView, a file per field.
    Vti,
    /// Fields beside one another, components below one another; of plane grids.
    Png,
}

impl std::fmt::Display for Kind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let name = self.to_possible_value().map(|v| v.get_name().to_owned());
        f.write_str(&name.unwrap_or_default())
    }
}

/// Either kind of model.
enum Model {
    Still(Box<Podiann>),
    Moving(Box<Spodiann>),
}

impl Model {
    fn load(cli: &Cli) -> Outcome<Self> {
        let record = Record::load(&cli.model)?;
        Ok(match record.kind() {
            "PODIANN" => Self::Still(Box::new(Podiann::from_record(&record)?)),
            // Which says what else it is.
            _ => Self::Moving(Box::new(Spodiann::from_record(&record)?)),
        })
    }
    fn inputs(&self) -> usize {
        match self {
            Self::Still(model) => model.inputs(),
            Self::Moving(model) => model.inputs(),
        }
    }
    fn rows(&self) -> usize {
        match self {
            Self::Still(model) => model.rows(),
            Self::Moving(model) => model.rows(),
        }
    }
    fn covers(&self, x: &[f64]) -> bool {
        match self {
            Self::Still(model) => model.covers(x),
            Self::Moving(model) => model.covers(x),
        }
    }
    /// The field, and what its relative error may be.
    fn predict(&self, x: &[f64], field: &mut [f64]) -> Result<f64, ModelError> {
        match self {
            Self::Still(model) => model.predict(x, field).and_then(|()| model.error_indicator(x)),
            Self::Moving(model) => model.predict(x, field).and_then(|()| model.error_indicator(x)),
        }
    }
    /// The model's own grid, or that of the command line.
    fn grid(&self, cli: &Cli) -> Outcome<Option<Grid>> {
        let grid = match self {
            Self::Moving(model) => *model.grid(),
            Self::Still(_) if cli.cells.is_empty() => return Ok(None),
            Self::Still(_) => {
                let n = [0, 1, 2].map(|a| cli.cells.get(a).copied().unwrap_or(1));
                let h = [0, 1, 2].map(|a| cli.spacing.get(a).copied().unwrap_or(1.0));
                Grid::new(n, h)?.starting_at(h.map(|h| 0.5 * h).into())
            }
        };
        if self.rows().is_multiple_of(grid.n_cells()) {
            return Ok(Some(grid));
        }
        let (rows, cells) = (self.rows(), grid.n_cells());
        Err(format!("{rows} unknowns are no whole number of fields on {cells} cells (--cells)").into())
    }
}

fn point(text: &str, inputs: usize) -> Outcome<Vec<f64>> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|x| x.trim().parse()).collect();
    let numbers = numbers.map_err(|why| format!("--at {text}: {why}; give numbers, as in --at 0.1,1050"))?;
    if numbers.len() == inputs {
        return Ok(numbers);
    }
    let given = numbers.len();
    Err(format!("--at {text}: {given} numbers were given, the model takes {inputs}: time, then parameters")
        .into())
}

fn main() -> ExitCode {
    told(run(&Cli::parse()))
}

fn run(cli: &Cli) -> Outcome<()> {
    make_folder(&cli.out)?;
    let model = Model::load(cli)?;
    let grid = model.grid(cli)?;
    let points: Vec<Vec<f64>> = cli.at.iter().map(|at| point(at, model.inputs())).collect::<Outcome<_>>()?;
    let mut fields = vec![vec![0.0; model.rows()]; points.len()];
    for ((x, field), at) in points.iter().zip(&mut fields).zip(&cli.at) {
        let error = model.predict(x, field)?;
        let beyond = if model.covers(x) { "" } else { "; outside of what the model has seen" };
        println!("at {at}: relative error about {error:.1e}{beyond}");
    }
    let named: Vec<(&str, &[f64])> =
        cli.at.iter().map(String::as_str).zip(fields.iter().map(|f| &f[..])).collect();
    for kind in &cli.write {
        match kind {
            Kind::Npy => files::npy(&cli.out, &named)?,
            Kind::Csv => files::csv(&cli.out, grid.as_ref(), &named)?,
            Kind::Vti | Kind::Png => {
                let grid = grid.as_ref().ok_or(format!("--write {kind} needs --cells"))?;
                if *kind == Kind::Vti {
                    files::vti(&cli.out, grid, &named)?
                } else {
                    files::png(&cli.out, grid, &named)?
                }
            }
        }
    }
    println!("written to {}", cli.out.display());
    Ok(())
}
