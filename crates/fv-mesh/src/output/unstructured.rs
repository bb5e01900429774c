//! Unstructured grids of chosen cells.
use super::{Arrays, OutputError};
use crate::CartesianGrid;
use interfaces::vtk::{self, DataArray};
use std::io::Write;

/// VTK's numbers of a quadrilateral and a hexahedron.
const TYPES: [u8; 2] = [9, 12];

/// Corners of a cell in VTK's order: round the lower face, then round the upper one.
const CORNERS: [[usize; 3]; 8] =
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];

/// Writes the cells flagged by `keep` as quadrilaterals in z = 0 or hexahedra that share their corners.
pub(super) fn write<const D: usize>(
    out: &mut impl Write,
    grid: &CartesianGrid<D>,
    keep: &[bool],
    arrays: Arrays<'_>,
) -> Result<(), OutputError> {
    let shape = grid.cells().map(|n| n + 1);
    // Number of each node of the grid among the points of the file.
    let mut numbers = vec![-1_i64; shape.iter().product()];
    let (mut points, mut connectivity) = (Vec::new(), Vec::new());
    let (per_cell, mut cells) = (1 << D, 0);
    for cell in (0..keep.len()).filter(|&i| keep[i]).map(|i| grid.cell(i)) {
        cells += 1;
        for corner in &CORNERS[..per_cell] {
            let node = (0..D).rev().fold(0, |sum, a| sum * shape[a] + cell[a] + corner[a]);
            if numbers[node] < 0 {
                numbers[node] = (points.len() / 3) as i64;
                points.extend(
                    (0..3).map(|a| if a < D { grid.axis(a).faces()[cell[a] + corner[a]] } else { 0.0 }),
                );
            }
            connectivity.push(numbers[node]);
        }
    }
    let piece = format!("NumberOfPoints=\"{}\" NumberOfCells=\"{cells}\"", points.len() / 3);
    let topology = vec![
        DataArray::int64("connectivity", connectivity),
        DataArray::int64("offsets", (1..=cells).map(|i| (i * per_cell) as i64)),
        DataArray::uint8("types", (0..cells).map(|_| TYPES[D - 2])),
    ];
    let sections = [
        ("CellData", "", arrays.into_section()),
        ("Points", "", vec![DataArray::float64("points", 3, points)]),
        ("Cells", "", topology),
    ];
    Ok(vtk::write(out, "UnstructuredGrid", "", &piece, &sections)?)
}
