//! Arrays of every order of axes against the cells of a grid.
use crate::shifted::Grid;
use crate::snapshots::{NpyArray, SnapshotAxis, SnapshotError, SnapshotSource};
use std::path::Path;

const CELLS: [usize; 3] = [4, 3, 2];
const TIMES: usize = 5;

/// Differs in every direction: x + 10 y + 100 z + 1000 t + 10⁴ c.
fn value([x, y, z]: [usize; 3], t: usize, c: usize) -> f64 {
    (x + 10 * y + 100 * z + 1000 * t + 10_000 * c) as f64
}

/// Bytes of an array of axes named by letters, as `np.save` writes them.
fn bytes(axes: &str, fortran: bool, components: usize) -> Vec<u8> {
    let length = |axis: char| match axis {
        'x' => CELLS[0],
        'y' => CELLS[1],
        'z' => CELLS[2],
        't' => TIMES,
        _ => components,
    };
    let shape: Vec<usize> = axes.chars().map(length).collect();
    let words: Vec<String> = shape.iter().map(ToString::to_string).collect();
    let order = if fortran { "True" } else { "False" };
    let header =
        format!("{{'descr': '<f8', 'fortran_order': {order}, 'shape': ({},), }}\n", words.join(", "));
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend((header.len() as u16).to_le_bytes());
    file.extend(header.as_bytes());
    for number in 0..shape.iter().product() {
        let (mut rest, mut at) = (number, vec![0; shape.len()]);
        for step in 0..shape.len() {
            let axis = if fortran { step } else { shape.len() - 1 - step };
            (at[axis], rest) = (rest % shape[axis], rest / shape[axis]);
        }
        let of = |name: char| axes.chars().position(|axis| axis == name).map_or(0, |axis| at[axis]);
        file.extend(value(['x', 'y', 'z'].map(of), of('t'), of('c')).to_le_bytes());
    }
    file
}

fn open(axes: &str, fortran: bool, components: usize, axis: SnapshotAxis) -> NpyArray {
    NpyArray::of_bytes(Path::new("a.npy"), axis, bytes(axes, fortran, components)).unwrap()
}

#[test]
fn rows_are_cells_with_x_fastest() {
    let grid = Grid::new(CELLS, [1.0; 3]).unwrap();
    let flat = Grid::new([CELLS[0], CELLS[1]], [1.0; 2]).unwrap();
    let (first, last) = (SnapshotAxis::First, SnapshotAxis::Last);
    for (axes, fortran, axis, components) in [
        ("tzyx", false, first, 1),
        ("tyx", false, first, 1),
        ("tcyx", false, first, 2),
        ("tczyx", false, first, 3),
        ("zyxt", false, last, 1),
        ("yxt", false, last, 1),
        ("cyxt", false, last, 2),
        ("xyzt", true, last, 1),
        ("xyct", true, last, 2),
        ("txy", true, first, 1),
    ] {
        let grid = if axes.contains('z') { grid } else { flat };
        let array = open(axes, fortran, components, axis);
        let all = match grid.cells() {
            [nx, ny, 1] => array.on_cells([nx, ny]),
            cells => array.on_cells(cells),
        };
        let all = all.unwrap().to_mat().unwrap();
        assert_eq!(all.shape(), (grid.n_cells() * components, TIMES), "{axes}");
        for (row, t) in (0..all.nrows()).flat_map(|row| (0..TIMES).map(move |t| (row, t))) {
            let (component, centre) = (row / grid.n_cells(), grid.centre(row % grid.n_cells()));
            let cell = [centre.x, centre.y, centre.z].map(|x| x as usize);
            assert_eq!(all[(row, t)], value(cell, t, component), "{axes}, row {row}, time {t}");
        }
    }
}

/// The remedy names the axes that NumPy is to transpose to, which then fit.
#[test]
fn other_orders_are_errors_with_a_command() {
    let (first, last) = (SnapshotAxis::First, SnapshotAxis::Last);
    for (axes, fortran, axis, remedy) in [
        ("txy", false, first, "a.transpose(0, 2, 1)"),
        ("tyx", true, first, "a.transpose(0, 1, 2)"),
        ("tyxc", false, first, "a.transpose(0, 3, 1, 2)"),
        ("xyt", false, last, "a.transpose(2, 1, 0)"),
        ("yxct", false, last, "a.transpose(3, 2, 0, 1)"),
        ("tyx", false, last, "open it with `SnapshotAxis::First`"),
        ("yxt", false, first, "open it with `SnapshotAxis::Last`"),
    ] {
        let error = open(axes, fortran, 2, axis).on_cells([CELLS[0], CELLS[1]]).err().unwrap();
        assert!(matches!(error, SnapshotError::CellOrder { .. }));
        assert!(error.to_string().contains(remedy), "{axes}: {error}");
        if let Some((_, order)) = remedy.split_once('(') {
            let order = order.trim_end_matches(')').split(", ");
            let axes: String =
                order.map(|axis| axes.as_bytes()[axis.parse::<usize>().unwrap()] as char).collect();
            assert!(open(&axes, false, 2, first).on_cells([CELLS[0], CELLS[1]]).is_ok(), "{axes}");
        }
    }
    let error = open("tyx", false, 1, first).on_cells([7, 3]).err().unwrap().to_string();
    assert!(error.contains("check the cells") && error.contains("[4, 3]"), "{error}");
    // A vector of one component, a single snapshot, and rows that are one axis.
    assert!(open("tzyxc", false, 1, first).on_cells(CELLS).is_ok());
    assert!(open("tzyx", false, 1, first).on_cells([24]).is_err());
    assert!(open("xt", false, 1, last).on_cells([2, 2]).is_ok());
    assert!(open("xt", false, 1, last).on_cells([3, 2]).is_err());
}
