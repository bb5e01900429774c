//! Modes in files.
use crate::shifted::Grid;
use interfaces::vtk::{self, DataArray};
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Writes fields on a grid, each of one or several components one below the other, as cell data of an image (`.vti`).
pub(super) fn write_modes<'a>(
    path: &Path,
    grid: &Grid,
    named: impl Iterator<Item = (String, &'a [f64])>,
) -> io::Result<()> {
    let (cells, h) = (grid.cells(), grid.spacing());
    let mut fields: Vec<(String, &[f64])> = Vec::new();
    for (name, field) in named {
        let components: Vec<&[f64]> = field.chunks(grid.n_cells()).collect();
        if let [one] = components[..] {
            fields.push((name, one));
        } else {
            let several = components.iter().enumerate();
            fields.extend(several.map(|(c, part)| (format!("{name} component {c}"), *part)));
        }
    }
    let arrays =
        fields.iter().map(|(name, part)| DataArray::float64(name, 1, part.iter().copied())).collect();
    let extent = format!("0 {} 0 {} 0 {}", cells[0], cells[1], cells[2]);
    let corner = [0, 1, 2].map(|a| grid.first()[a] - 0.5 * h[a]);
    let whole = format!(
        "WholeExtent=\"{extent}\" Origin=\"{} {} {}\" Spacing=\"{} {} {}\"",
        corner[0], corner[1], corner[2], h[0], h[1], h[2]
    );
    let mut out = BufWriter::new(File::create(path)?);
    let piece = format!("Extent=\"{extent}\"");
    vtk::write(&mut out, "ImageData", &whole, &piece, &[("CellData", "", arrays)])?;
    out.flush()
}
