//! Files that NumPy, meshio and our own writers wrote, whole and damaged.
use super::*;
use crate::Mat;
use crate::pod::{Pod, PodError, PodParams, StreamingPod};
use interfaces::vtk::{self, DataArray};
use std::fs;
use std::path::PathBuf;

fn data(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("src/snapshots/data").join(name)
}

/// A folder of this test's own.
fn folder(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("mor-snapshots-{name}-{}", std::process::id()));
    fs::create_dir_all(&path).unwrap();
    path
}

/// x + 10 y + 100 t on 4 × 3 cells at 5 times.
fn value(row: usize, t: usize) -> f64 {
    (row % 4 + 10 * (row / 4) + 100 * t) as f64
}

fn check(source: &dyn SnapshotSource) {
    assert_eq!((source.n_rows(), source.n_snapshots()), (12, 5));
    let all = source.to_mat().unwrap();
    for first in [[0, 0], [5, 0], [0, 2], [7, 3]] {
        for size in [[12 - first[0], 5 - first[1]], [2, 1], [1, 2], [0, 1]] {
            let mut part = Mat::zeros(size[0], size[1]);
            source.read(first[0], first[1], part.as_mut()).unwrap();
            for (i, j) in (0..size[0]).flat_map(|i| (0..size[1]).map(move |j| (i, j))) {
                assert_eq!(part[(i, j)], value(first[0] + i, first[1] + j), "{first:?} {i} {j}");
                assert_eq!(part[(i, j)], all[(first[0] + i, first[1] + j)]);
            }
        }
    }
    let outside = source.read(11, 0, Mat::zeros(2, 5).as_mut());
    assert!(matches!(outside, Err(SnapshotError::Outside { rows: [11, 13], .. })), "{outside:?}");
}

#[test]
fn arrays_of_numpy() {
    check(&NpyArray::open(data("times_first.npy"), SnapshotAxis::First).unwrap());
    check(&NpyArray::open(data("c_order_f4.npy"), SnapshotAxis::Last).unwrap());
    check(&NpyArray::open(data("fortran_big.npy"), SnapshotAxis::Last).unwrap());
    for name in ["stored.npz", "deflated.npz"] {
        let file = NpzFile::open(data(name)).unwrap();
        assert_eq!(file.names().collect::<Vec<_>>(), ["velocity", "pressure"]);
        for array in ["velocity", "pressure"] {
            check(&file.array(array, SnapshotAxis::Last).unwrap());
        }
        let none = file.array("density", SnapshotAxis::Last).err().unwrap();
        assert!(matches!(&none, SnapshotError::NoArray { there, .. } if there.len() == 2), "{none}");
    }
}

#[test]
fn damaged_files_are_errors() {
    let folder = folder("damaged");
    let open = |bytes: &[u8]| {
        let path = folder.join("a.npy");
        fs::write(&path, bytes).unwrap();
        NpyArray::open(&path, SnapshotAxis::Last).err()
    };
    let whole = fs::read(data("c_order_f4.npy")).unwrap();
    assert!(open(&whole).is_none());
    let short = open(&whole[..whole.len() - 3]);
    assert!(matches!(short, Some(SnapshotError::Truncated { expected: 240, found: 237, .. })), "{short:?}");
    assert!(matches!(open(&whole[..40]), Some(SnapshotError::Format { .. })));
    assert!(matches!(open(b"PK\x03\x04 and so on"), Some(SnapshotError::Format { .. })));
    let integers = NpyArray::open(data("whole.npy"), SnapshotAxis::Last).err();
    assert!(
        matches!(&integers, Some(SnapshotError::DataType { found, .. }) if found == "<i8"),
        "{integers:?}"
    );
    let missing = NpyArray::open(folder.join("none.npy"), SnapshotAxis::Last).err();
    assert!(matches!(missing, Some(SnapshotError::Io { kind: std::io::ErrorKind::NotFound, .. })));
    // Every cut and every byte that flips: an error or an answer, never a panic.
    for name in ["stored.npz", "deflated.npz"] {
        let whole = fs::read(data(name)).unwrap();
        let read = |bytes: &[u8]| {
            let path = folder.join(name);
            fs::write(&path, bytes).unwrap();
            let file = NpzFile::open(&path)?;
            let name = file.names().next().unwrap_or_default().to_owned();
            file.array(&name, SnapshotAxis::Last)?.to_mat()
        };
        for cut in (0..whole.len()).step_by(7) {
            assert!(read(&whole[..cut]).is_err(), "{name} cut at {cut}");
        }
        for at in (0..whole.len()).step_by(5) {
            let mut bytes = whole.clone();
            bytes[at] ^= 0x55;
            let _ = read(&bytes);
        }
    }
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn files_of_vtk() {
    for name in ["text.vtu", "base64.vtu", "packed.vtu"] {
        let file = VtkFile::open(data(name)).unwrap();
        assert_eq!(file.field("p").unwrap(), [1.5, -2.0, 3e-3], "{name}");
        let components = [1.0, 4.0, 7.0, 2.0, 5.0, 8.0, 3.0, 6.0, 9.0];
        assert_eq!(file.field("u").unwrap(), components, "{name}");
        assert_eq!(file.array("u").unwrap().components, 3);
        assert!(matches!(file.field("q"), Err(SnapshotError::NoArray { .. })));
        assert!(file.grid().is_none());
        let whole = fs::read(data(name)).unwrap();
        let folder = folder(name);
        let path = folder.join("cut.vtu");
        for cut in (0..whole.trim_ascii_end().len()).step_by(11) {
            fs::write(&path, &whole[..cut]).unwrap();
            assert!(VtkFile::open(&path).is_err(), "{name} cut at byte {cut} of {}", whole.len());
        }
        fs::remove_dir_all(folder).unwrap();
    }
}

/// An image whose text has fewer numbers than cells is refused, whether its end is there or not.
#[test]
fn images_of_text_with_numbers_missing() {
    let folder = folder("text-image");
    let path = folder.join("image.vti");
    let image = |numbers: &str| {
        format!(
            "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 2 0 2 0 1\" Spacing=\"1 1 1\">\
             <Piece Extent=\"0 2 0 2 0 1\"><CellData><DataArray type=\"Float64\" Name=\"p\" format=\"ascii\">\
             {numbers}</DataArray></CellData></Piece></ImageData></VTKFile>"
        )
    };
    fs::write(&path, image("1 2 3 4")).unwrap();
    assert_eq!(VtkFile::open(&path).unwrap().field("p").unwrap(), [1.0, 2.0, 3.0, 4.0]);
    fs::write(&path, image("1 2 3")).unwrap();
    let short = VtkFile::open(&path).unwrap().field("p");
    assert!(matches!(short, Err(SnapshotError::Shape { expected: 4, found: 3, .. })), "{short:?}");
    let whole = image("1 2 3 4");
    for cut in 0..whole.len() {
        fs::write(&path, &whole[..cut]).unwrap();
        assert!(VtkFile::open(&path).is_err(), "cut at {cut}");
    }
    fs::remove_dir_all(folder).unwrap();
}

/// A series of images as `fv-mesh` writes them.
fn series(folder: &std::path::Path, nan: Option<usize>, odd: Option<usize>) -> PathBuf {
    let mut entries = String::new();
    for t in 0..5 {
        let count = if odd == Some(t) { 11 } else { 12 };
        let at = |i: usize| if nan == Some(t) && i == 6 { f64::NAN } else { value(i, t) };
        let arrays = vec![
            DataArray::float64("velocity", 3, (0..3 * count).map(|i| (i % 3) as f64 + value(i / 3, t))),
            DataArray::float32("lambda", 1, (0..count).map(at)),
        ];
        let mut bytes = Vec::new();
        let whole = "WholeExtent=\"0 4 0 3 0 1\" Origin=\"1 2 0\" Spacing=\"0.5 0.25 1\"";
        vtk::write(&mut bytes, "ImageData", whole, "Extent=\"0 4 0 3 0 1\"", &[("CellData", "", arrays)])
            .unwrap();
        fs::write(folder.join(format!("{t}.vti")), bytes).unwrap();
        entries += &format!("<DataSet timestep=\"{t}\" part=\"0\" file=\"{t}.vti\"/>\n");
    }
    let path = folder.join("all.pvd");
    let text = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\"><Collection>\n{entries}</Collection></VTKFile>"
    );
    fs::write(&path, text).unwrap();
    path
}

#[test]
fn series_of_our_own_images() {
    let folder = folder("series");
    let run = VtkSeries::open(series(&folder, None, None), "lambda").unwrap();
    assert_eq!(run.times(), [0.0, 1.0, 2.0, 3.0, 4.0]);
    check(&run);
    let grid = run.grid().unwrap();
    assert_eq!((grid.cells(), grid.spacing()), ([4, 3, 1], [0.5, 0.25, 1.0]));
    assert_eq!([grid.first().x, grid.first().y], [1.25, 2.125]);
    let velocity = VtkSeries::open(folder.join("all.pvd"), "velocity").unwrap().to_mat().unwrap();
    assert_eq!((velocity.nrows(), velocity[(12 + 5, 3)]), (36, value(5, 3) + 1.0));
    // One short of a value, one with a NaN, one cut short.
    let odd = VtkSeries::open(series(&folder, None, Some(3)), "lambda").unwrap().to_mat();
    assert!(matches!(odd, Err(SnapshotError::Shape { expected: 12, found: 11, .. })), "{odd:?}");
    let run = VtkSeries::open(series(&folder, Some(2), None), "lambda").unwrap();
    let pod = Pod::of(&run, &PodParams::default());
    assert!(matches!(pod, Err(PodError::NotFinite { snapshot: 2, row: 6, .. })), "{pod:?}");
    let file = fs::read(folder.join("4.vti")).unwrap();
    fs::write(folder.join("4.vti"), &file[..file.len() - 60]).unwrap();
    let cut = run.to_mat();
    assert!(matches!(&cut, Err(e) if e.to_string().contains("cut short")), "{cut:?}");
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn modes_of_files_are_those_of_matrices() {
    let file = NpyArray::open(data("fortran_big.npy"), SnapshotAxis::Last).unwrap();
    let matrix = file.to_mat().unwrap();
    for subtract_mean in [false, true] {
        let params = PodParams { subtract_mean, ..PodParams::default() };
        let [a, b] = [Pod::of(&file, &params).unwrap(), Pod::new(matrix.as_ref(), &params).unwrap()];
        let mut streaming = StreamingPod::new(5);
        if subtract_mean {
            streaming = streaming.subtracting_mean();
        }
        (0..5).for_each(|j| streaming.add(matrix.col_as_slice(j)).unwrap());
        let c = streaming.finish().unwrap();
        assert_eq!([a.rank(), b.rank(), c.rank()], [if subtract_mean { 1 } else { 2 }; 3]);
        for other in [&b, &c] {
            for (s, t) in a.singular_values.iter().zip(&other.singular_values).take(a.rank()) {
                assert!((s - t).abs() < 1e-12 * a.singular_values[0], "{s} {t}");
            }
            assert!((a.energy - other.energy).abs() < 1e-12 * a.energy);
        }
    }
}
