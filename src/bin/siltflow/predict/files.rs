//! Files of predicted fields.
use crate::outcome::Failure;
use interfaces::SnapshotSink;
use interfaces::vtk::{self, DataArray};
use mor::shifted::Grid;
use mor::snapshots::NpyWriter;
use render::Scalar;
use render::gallery::{Gallery, Row, Tile};
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Fields and their inputs.
type Fields<'a> = [(&'a str, Vec<f64>)];

/// Writes the file `name` in `folder` by `write`.
fn write(
    folder: &Path,
    name: &str,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), Failure> {
    let path = folder.join(name);
    let written = File::create(&path).map(BufWriter::new).and_then(|mut file| {
        write(&mut file)?;
        file.flush()
    });
    written.map_err(|error| Failure::of_output(format!("writing {}: {error}", path.display())))
}

/// Writes `fields.npy`, fields × unknowns.
pub(super) fn npy(folder: &Path, fields: &Fields<'_>) -> Result<(), Failure> {
    let mut writer = NpyWriter::create(folder.join("fields.npy")).map_err(Failure::of_output)?;
    for (number, (_, field)) in fields.iter().enumerate() {
        writer.push(number as f64, field).map_err(|error| Failure::of_output(error.to_string()))?;
    }
    writer.flush().map_err(Failure::of_output)
}

/// Writes `fields.csv`, with the centres of the cells if the grid is known.
pub(super) fn csv(folder: &Path, grid: Option<&Grid>, fields: &Fields<'_>) -> Result<(), Failure> {
    write(folder, "fields.csv", |file| {
        let place = if grid.is_some() { "component,x [m],y [m],z [m]" } else { "row" };
        let names: String = fields.iter().map(|(at, _)| format!(",\"{at}\"")).collect();
        writeln!(file, "{place}{names}")?;
        for row in 0..fields.first().map_or(0, |(_, field)| field.len()) {
            match grid {
                Some(grid) => {
                    let x = grid.centre(row % grid.n_cells());
                    write!(file, "{},{},{},{}", row / grid.n_cells(), x.x, x.y, x.z)?;
                }
                None => write!(file, "{row}")?,
            }
            fields.iter().try_for_each(|(_, field)| write!(file, ",{}", field[row]))?;
            writeln!(file)?;
        }
        Ok(())
    })
}

/// Components of a field.
fn components<'a>(grid: &Grid, field: &'a [f64]) -> Vec<&'a [f64]> {
    field.chunks_exact(grid.n_cells()).collect()
}

/// Writes `field_NNNN.vti`, one for each field.
pub(super) fn vti(folder: &Path, grid: &Grid, fields: &Fields<'_>) -> Result<(), Failure> {
    let (n, h) = (grid.cells(), grid.spacing());
    let corner = [0, 1, 2].map(|a| grid.first()[a] - 0.5 * h[a]);
    let extent = format!("0 {} 0 {} 0 {}", n[0], n[1], n[2]);
    let whole = format!(
        "WholeExtent=\"{extent}\" Origin=\"{} {} {}\" Spacing=\"{} {} {}\"",
        corner[0], corner[1], corner[2], h[0], h[1], h[2]
    );
    let piece = format!("Extent=\"{extent}\"");
    for (number, (_, field)) in fields.iter().enumerate() {
        let components = components(grid, field);
        let names: Vec<String> = (0..components.len()).map(|c| format!("component {c}")).collect();
        let named = names.iter().zip(components);
        let arrays = named.map(|(name, x)| DataArray::float64(name, 1, x.iter().copied())).collect();
        write(folder, &format!("field_{number:04}.vti"), |file| {
            vtk::write(file, "ImageData", &whole, &piece, &[("CellData", "", arrays)])
        })?;
    }
    Ok(())
}

/// Draws `fields.png`: fields from left to right, components from top to bottom.
pub(super) fn png(folder: &Path, grid: &Grid, fields: &Fields<'_>) -> Result<(), Failure> {
    let ([nx, ny, nz], h) = (grid.cells(), grid.spacing());
    if nz > 1 || ny == 1 {
        let message = format!("--write png draws plane grids; this one has {nx} × {ny} × {nz} cells");
        return Err(Failure::of_input(message));
    }
    let number = fields.first().map_or(0, |(_, field)| components(grid, field).len());
    let row = |c: usize| {
        let parts: Vec<(&str, &[f64])> =
            fields.iter().map(|(at, field)| (*at, components(grid, field)[c])).collect();
        let all = || parts.iter().flat_map(|(_, x)| x.iter().copied());
        let range = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
        let tile =
            |(at, values): (&str, _)| Tile { title: format!("at {at}"), field: Scalar { nx, ny, values } };
        Row {
            label: if number == 1 { String::new() } else { format!("component {c}") },
            range: (range.0 < range.1).then_some(range),
            tiles: parts.into_iter().map(tile).collect(),
        }
    };
    let aspect = ny as f64 * h[1] / (nx as f64 * h[0]);
    let [px, py, _] = grid.periodic();
    let gallery = Gallery { periodic: [px, py], aspect, rows: (0..number).map(row).collect() };
    gallery.draw(&folder.join("fields.png")).map_err(|error| Failure::of_output(error.to_string()))
}
