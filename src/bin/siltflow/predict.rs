//! `siltflow predict`.
mod files;

use crate::outcome::{Failure, print};
use clap::{Args, ValueEnum};
use mor::models::SavedModel;
use mor::shifted::Grid;
use serde_json::{Value, json};
use std::fmt;
use std::path::PathBuf;

#[derive(Args)]
pub(crate) struct PredictArgs {
    /// Model that a scene with [[models]] left: NAME.model.
    model: PathBuf,
    /// Time [s] and parameters, separated by commas; once for each field.
    #[arg(long = "at", required = true, allow_hyphen_values = true, value_name = "T,...")]
    at: Vec<String>,
    /// Cells along x, y, z, for a model without frames, which does not know them.
    #[arg(long, value_delimiter = ',', num_args = 1..=3)]
    cells: Vec<usize>,
    /// Widths of these cells along x, y, z [m].
    #[arg(long, value_delimiter = ',', num_args = 1..=3)]
    spacing: Vec<f64>,
    /// Kinds of files.
    #[arg(long, value_delimiter = ',', default_values_t = [Kind::Npy, Kind::Csv])]
    write: Vec<Kind>,
    /// Folder for the files.
    #[arg(long, default_value = "out/predict")]
    out: PathBuf,
    /// Prints JSON: the estimated error of each field, and whether the snapshots cover it.
    #[arg(long)]
    json: bool,
}

/// Kind of files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// NumPy array, fields × unknowns.
    Npy,
    /// Table with a row for each unknown and a column for each field.
    Csv,
    /// ParaView, a file for each field.
    Vti,
    /// Picture with fields from left to right and components from top to bottom; plane grids.
    Png,
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.to_possible_value().as_ref().map_or("", |value| value.get_name()))
    }
}

impl PredictArgs {
    /// Predicts the fields and writes them; returns the exit code.
    pub(crate) fn predict(&self) -> Result<u8, Failure> {
        let model = SavedModel::load(&self.model)
            .map_err(|error| Failure::of_input(format!("{}: {error}", self.model.display())))?;
        let grid = self.grid(&model).map_err(Failure::of_input)?;
        let points = self.at.iter().map(|at| point(at, model.inputs()).map_err(Failure::of_input));
        let points = points.collect::<Result<Vec<_>, _>>()?;
        let (mut fields, mut estimates) = (Vec::new(), Vec::new());
        for (x, at) in points.iter().zip(&self.at) {
            let mut field = vec![0.0; model.rows()];
            let error = model.predict(x, &mut field).map_err(Failure::of_input)?;
            fields.push((at.as_str(), field));
            estimates.push((at.as_str(), error, model.covers(x)));
        }
        std::fs::create_dir_all(&self.out)
            .map_err(|error| Failure::of_output(format!("making {}: {error}", self.out.display())))?;
        for kind in &self.write {
            match (kind, &grid) {
                (Kind::Npy, _) => files::npy(&self.out, &fields)?,
                (Kind::Csv, grid) => files::csv(&self.out, grid.as_ref(), &fields)?,
                (Kind::Vti, Some(grid)) => files::vti(&self.out, grid, &fields)?,
                (Kind::Png, Some(grid)) => files::png(&self.out, grid, &fields)?,
                (kind, None) => {
                    let message = format!("--write {kind} needs the grid of this model: --cells NX,NY");
                    return Err(Failure::of_input(message));
                }
            }
        }
        print(&self.printed(&estimates))?;
        Ok(0)
    }

    fn printed(&self, estimates: &[(&str, f64, bool)]) -> String {
        if self.json {
            let row = |&(at, error, covered): &(&str, f64, bool)| json!({ "at": at, "relative_error": error, "covered": covered });
            let all: Vec<Value> = estimates.iter().map(row).collect();
            return format!("{:#}\n", json!({ "folder": self.out, "fields": all }));
        }
        let line = |&(at, error, covered): &(&str, f64, bool)| {
            let beyond = if covered { "" } else { "; beyond the snapshots: an extrapolation" };
            format!("at {at}: relative error about {error:.1e}{beyond}\n")
        };
        let lines: String = estimates.iter().map(line).collect();
        format!("{lines}files in {}\n", self.out.display())
    }

    /// Grid of the model, or that of the arguments.
    fn grid(&self, model: &SavedModel) -> Result<Option<Grid>, String> {
        let grid = match model.grid() {
            Some(grid) => *grid,
            None if self.cells.is_empty() => return Ok(None),
            None => {
                let n = [0, 1, 2].map(|a| self.cells.get(a).copied().unwrap_or(1));
                let h = [0, 1, 2].map(|a| self.spacing.get(a).copied().unwrap_or(1.0));
                let grid = Grid::new(n, h).map_err(|error| format!("--cells, --spacing: {error}"))?;
                grid.starting_at(h.map(|h| 0.5 * h).into())
            }
        };
        let (rows, cells) = (model.rows(), grid.n_cells());
        if rows.is_multiple_of(cells) {
            return Ok(Some(grid));
        }
        Err(format!("--cells: {rows} unknowns are no whole number of fields on {cells} cells"))
    }
}

/// Inputs of a model in `text`.
fn point(text: &str, inputs: usize) -> Result<Vec<f64>, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|x| x.trim().parse()).collect();
    let numbers =
        numbers.map_err(|why| format!("--at {text}: {why}; numbers are needed, as in --at 0.1,1050"))?;
    if numbers.len() == inputs {
        return Ok(numbers);
    }
    let given = numbers.len();
    Err(format!("--at {text}: {given} numbers are given, the model takes {inputs}: time, then parameters"))
}
