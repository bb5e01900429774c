//! Images and rectilinear grids.
use super::{Arrays, OutputError};
use interfaces::vtk::{self, DataArray};
use std::io::Write;

/// Writes the cells between these faces along x, y and z, as an image if `uniform`. An axis with one face is flat.
pub(crate) fn write_cells(
    out: &mut impl Write,
    faces: [&[f64]; 3],
    uniform: bool,
    arrays: Arrays<'_>,
) -> Result<(), OutputError> {
    let n = faces.map(|f| f.len() - 1);
    let extent = format!("0 {} 0 {} 0 {}", n[0], n[1], n[2]);
    let (whole, piece) = (format!("WholeExtent=\"{extent}\""), format!("Extent=\"{extent}\""));
    let cells = ("CellData", "", arrays.into_section());
    if uniform {
        let origin = faces.map(|f| f[0]);
        let h: [f64; 3] =
            std::array::from_fn(
                |a| if n[a] == 0 { 1.0 } else { (faces[a][n[a]] - faces[a][0]) / n[a] as f64 },
            );
        let grid = format!(
            "{whole} Origin=\"{} {} {}\" Spacing=\"{} {} {}\"",
            origin[0], origin[1], origin[2], h[0], h[1], h[2]
        );
        vtk::write(out, "ImageData", &grid, &piece, &[cells])?;
    } else {
        let coordinates =
            (0..3).map(|a| DataArray::float64(["x", "y", "z"][a], 1, faces[a].iter().copied())).collect();
        vtk::write(out, "RectilinearGrid", &whole, &piece, &[cells, ("Coordinates", "", coordinates)])?;
    }
    Ok(())
}
