//! Predictions in files.
use example_support::Outcome;
use mor::shifted::Grid;
use mor::snapshots::NpyWriter;
use render::Scalar;
use render::gallery::{Gallery, Row, Tile};
use siltflow::interfaces::SnapshotSink;
use siltflow::interfaces::vtk::{self, DataArray};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

/// Fields and what they are at.
type Named<'a> = [(&'a str, &'a [f64])];

pub(crate) fn npy(out: &Path, fields: &Named<'_>) -> Outcome<()> {
    let mut writer = NpyWriter::create(out.join("fields.npy"))?;
    for (number, (_, field)) in fields.iter().enumerate() {
        writer.push(number as f64, field).map_err(|why| why.to_string())?;
    }
    Ok(writer.flush()?)
}

/// With the cells' centres, if the grid is known.
pub(crate) fn csv(out: &Path, grid: Option<&Grid>, fields: &Named<'_>) -> Outcome<()> {
    let mut file = BufWriter::new(File::create(out.join("fields.csv"))?);
    let place = if grid.is_some() { "component,x [m],y [m],z [m]" } else { "row" };
    let names: String = fields.iter().map(|(at, _)| format!(",\"{at}\"")).collect();
    writeln!(file, "{place}{names}")?;
    for row in 0..fields.first().map_or(0, |f| f.1.len()) {
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
    Ok(file.flush()?)
}

/// Components of one field.
fn components<'a>(grid: &Grid, field: &'a [f64]) -> Vec<&'a [f64]> {
    field.chunks_exact(grid.n_cells()).collect()
}

pub(crate) fn vti(out: &Path, grid: &Grid, fields: &Named<'_>) -> Outcome<()> {
    let (n, h) = (grid.cells(), grid.spacing());
    let corner = [0, 1, 2].map(|a| grid.first()[a] - 0.5 * h[a]);
    let extent = format!("0 {} 0 {} 0 {}", n[0], n[1], n[2]);
    let whole = format!(
        "WholeExtent=\"{extent}\" Origin=\"{} {} {}\" Spacing=\"{} {} {}\"",
        corner[0], corner[1], corner[2], h[0], h[1], h[2]
    );
    for (number, (_, field)) in fields.iter().enumerate() {
        let named: Vec<(String, &[f64])> = components(grid, field)
            .into_iter()
            .enumerate()
            .map(|(c, x)| (format!("component {c}"), x))
            .collect();
        let arrays = named.iter().map(|(name, x)| DataArray::float64(name, 1, x.iter().copied())).collect();
        let mut file = BufWriter::new(File::create(out.join(format!("field_{number:04}.vti")))?);
        let piece = format!("Extent=\"{extent}\"");
        vtk::write(&mut file, "ImageData", &whole, &piece, &[("CellData", "", arrays)])?;
        file.flush()?;
    }
    Ok(())
}

/// Fields beside one another, a row for each component.
pub(crate) fn png(out: &Path, grid: &Grid, fields: &Named<'_>) -> Outcome<()> {
    let ([nx, ny, nz], h) = (grid.cells(), grid.spacing());
    if nz > 1 || ny == 1 {
        return Err(format!("--write png is for plane grids; this one has {nx} × {ny} × {nz} cells").into());
    }
    let number = fields.first().map_or(0, |f| components(grid, f.1).len());
    let row = |c: usize| {
        let parts: Vec<(&str, &[f64])> = fields.iter().map(|(at, f)| (*at, components(grid, f)[c])).collect();
        let all = || parts.iter().flat_map(|(_, x)| x.iter().copied());
        let range = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
        let tile =
            |(at, values): (&str, _)| Tile { title: format!("at {at}"), field: Scalar { nx, ny, values } };
        let label = if number == 1 { String::new() } else { format!("component {c}") };
        Row {
            label,
            range: (range.0 < range.1).then_some(range),
            tiles: parts.into_iter().map(tile).collect(),
        }
    };
    let aspect = ny as f64 * h[1] / (nx as f64 * h[0]);
    let [px, py, _] = grid.periodic();
    Gallery { periodic: [px, py], aspect, rows: (0..number).map(row).collect() }
        .draw(&out.join("fields.png"))?;
    Ok(())
}
