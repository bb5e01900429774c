//! Files read back.
use super::{CellWriter, OutputError, TimeSeries};
use crate::{Axis, CartesianGrid, Cluster, Field, Precision, Sampler, Side, Sides};
use std::io;

/// A file taken apart: its header and the bytes behind it.
struct Parsed {
    header: String,
    data: Vec<u8>,
}

/// The attribute `key` in a tag.
fn attribute<'a>(tag: &'a str, key: &str) -> Option<&'a str> {
    tag.split_once(&format!(" {key}=\""))?.1.split('"').next()
}

impl Parsed {
    fn new(file: &[u8]) -> Self {
        let marker = b"<AppendedData encoding=\"raw\">\n_";
        let at = file.windows(marker.len()).position(|w| w == marker).unwrap() + marker.len();
        let end = b"\n</AppendedData>\n</VTKFile>\n";
        assert!(file.ends_with(end));
        Self {
            header: String::from_utf8(file[..at].to_vec()).unwrap(),
            data: file[at..file.len() - end.len()].to_vec(),
        }
    }
    /// The first tag of this kind.
    fn tag(&self, name: &str) -> &str {
        let start = self.header.find(&format!("<{name} ")).unwrap();
        self.header[start..].split_inclusive('>').next().unwrap()
    }
    /// The array of this name, its type and number of components.
    fn array(&self, name: &str) -> (Vec<f64>, &str, &str) {
        let tags = self.header.split("<DataArray").skip(1);
        let tag = tags.into_iter().find(|t| attribute(t, "Name") == Some(name)).unwrap();
        let offset: usize = attribute(tag, "offset").unwrap().parse().unwrap();
        let length = u64::from_le_bytes(self.data[offset..][..8].try_into().unwrap()) as usize;
        let bytes = &self.data[offset + 8..][..length];
        let kind = attribute(tag, "type").unwrap();
        let values = match kind {
            "Float32" => bytes.as_chunks().0.iter().map(|b| f64::from(f32::from_le_bytes(*b))).collect(),
            "Float64" => bytes.as_chunks().0.iter().map(|b| f64::from_le_bytes(*b)).collect(),
            "Int64" => bytes.as_chunks().0.iter().map(|b| i64::from_le_bytes(*b) as f64).collect(),
            _ => bytes.iter().map(|&b| f64::from(b)).collect(),
        };
        (values, kind, attribute(tag, "NumberOfComponents").unwrap())
    }
    /// Bytes of all arrays with their lengths.
    fn size(&self) -> usize {
        self.data.len()
    }
}

fn written<const D: usize>(writer: CellWriter<'_, D>) -> Parsed {
    let mut file = Vec::new();
    writer.write(&mut file).unwrap();
    Parsed::new(&file)
}

fn stretched() -> CartesianGrid<3> {
    let axes = [
        Axis::geometric(4, -1.0, 1.0, 1.4),
        Axis::uniform(3, 0.0, 3.0),
        Axis::tanh(2, 0.0, 0.5, 1.5, Cluster::Lower),
    ];
    CartesianGrid::from_axes(axes.map(Result::unwrap)).unwrap()
}

#[test]
fn uniform_grids_become_images() {
    let grid = CartesianGrid::new([4, 3], [2.0, 0.6]).unwrap().with_origin([1.0, -2.0]).unwrap();
    let p = Field::from_fn(&grid, |x| x[0] + 0.1 * x[1]);
    let values: Vec<f64> = p.values().collect();
    let minus: Vec<f64> = p.values().map(|v| -v).collect();
    let writer = CellWriter::new(&grid)
        .scalar("p & \"q\"", p.values())
        .double_precision()
        .vector("u", [values.clone(), minus.clone()]);
    assert_eq!(writer.extension(), "vti");
    let file = written(writer);
    let tag = file.tag("ImageData");
    assert_eq!(attribute(tag, "WholeExtent"), Some("0 4 0 3 0 1"));
    let spacing = format!("{} {} 1", grid.spacing()[0], grid.spacing()[1]);
    assert_eq!(attribute(tag, "Origin"), Some("1 -2 -0.5"));
    assert_eq!(attribute(tag, "Spacing"), Some(spacing.as_str()));
    let (found, kind, components) = file.array("p &amp; &quot;q&quot;");
    assert_eq!((kind, components), ("Float32", "1"));
    assert!(found.iter().zip(&values).all(|(f, v)| *f == f64::from(*v as f32)) && found.len() == 12);
    let (found, kind, components) = file.array("u");
    assert_eq!((kind, components, found.len()), ("Float64", "3", 36));
    for (i, u) in found.chunks(3).enumerate() {
        assert_eq!(u, [values[i], minus[i], 0.0]);
    }
    assert_eq!(file.size(), 8 + 12 * 4 + 8 + 36 * 8);
}

#[test]
fn stretched_grids_become_rectilinear() {
    let grid = stretched();
    let writer = CellWriter::new(&grid).scalar("i", (0..24).map(f64::from));
    assert_eq!(writer.extension(), "vtr");
    let file = written(writer);
    assert_eq!(attribute(file.tag("RectilinearGrid"), "WholeExtent"), Some("0 4 0 3 0 2"));
    assert_eq!(attribute(file.tag("Piece"), "Extent"), Some("0 4 0 3 0 2"));
    for a in 0..3 {
        assert_eq!(file.array(["x", "y", "z"][a]), (grid.axis(a).faces().to_vec(), "Float64", "1"));
    }
    assert_eq!(file.array("i").0, (0..24).map(f64::from).collect::<Vec<_>>());
}

#[test]
fn chosen_cells_become_unstructured() {
    let grid = stretched();
    let chosen = [[0, 0, 0], [1, 0, 0], [3, 2, 1]];
    let writer =
        CellWriter::of_cells(&grid, |c| chosen.contains(&c)).scalar("i", (0..24).map(f64::from)).vector(
            "x",
            std::array::from_fn(|a| (0..24).map(move |i| stretched().centre(stretched().cell(i))[a])),
        );
    assert_eq!(writer.extension(), "vtu");
    let file = written(writer);
    let piece = file.tag("Piece");
    // Two neighbours share four corners.
    assert_eq!(
        (attribute(piece, "NumberOfCells"), attribute(piece, "NumberOfPoints")),
        (Some("3"), Some("20"))
    );
    assert_eq!(file.array("i").0, [0.0, 1.0, 23.0]);
    assert_eq!(file.array("offsets").0, [8.0, 16.0, 24.0]);
    assert_eq!(file.array("types"), (vec![12.0; 3], "UInt8", "1"));
    let (points, centres) = (file.array("points").0, file.array("x").0);
    let connectivity = file.array("connectivity").0;
    for (c, corners) in connectivity.chunks(8).enumerate() {
        for a in 0..3 {
            let mean = corners.iter().map(|&p| points[3 * p as usize + a]).sum::<f64>() / 8.0;
            assert!((mean - centres[3 * c + a]).abs() < 1e-6);
        }
        // The diagonal from the first corner to the seventh spans the cell.
        let volume: f64 = (0..3)
            .map(|a| points[3 * corners[6] as usize + a] - points[3 * corners[0] as usize + a])
            .product();
        assert!((volume - grid.cell_volume(chosen[c])).abs() < 1e-12);
    }

    let plane = CartesianGrid::new([4, 4], [4.0, 4.0]).unwrap();
    let file =
        written(CellWriter::in_box(&plane, [1.0, 0.0], [3.0, 1.0]).scalar("i", (0..16).map(f64::from)));
    assert_eq!(file.array("i").0, [1.0, 2.0]);
    assert_eq!(file.array("types").0, [9.0, 9.0]);
    assert_eq!(file.array("points").0[..12], [1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 2.0, 1.0, 0.0, 1.0, 1.0, 0.0]);
    let none = written(CellWriter::of_cells(&plane, |_| false).scalar("i", (0..16).map(f64::from)));
    assert!(none.array("i").0.is_empty());
}

#[test]
fn wrong_arrays_are_errors_and_write_nothing() {
    let grid = CartesianGrid::new([2, 2], [1.0, 1.0]).unwrap();
    let new = || CellWriter::new(&grid);
    let four = || [1.0; 4];
    let count = |writer: CellWriter<'_, 2>| {
        let mut file = Vec::new();
        match writer.write(&mut file) {
            Err(OutputError::Count { expected: 4, found, .. }) if file.is_empty() => found,
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(count(new().scalar("a", [0.0; 3])), 3);
    assert_eq!(count(new().scalar("a", std::iter::repeat(0.0))), 5);
    assert_eq!(count(new().scalar("a", [0.0; 0]).scalar("b", four())), 0);
    assert_eq!(count(new().vector("u", [vec![0.0; 4], vec![0.0; 2]])), 2);
    assert_eq!(count(new().vector("u", [vec![0.0; 9], vec![0.0; 4]])), 5);
    assert_eq!(count(CellWriter::of_cells(&grid, |_| false).scalar("a", [0.0; 2])), 2);
    let fails = |writer: CellWriter<'_, 2>| writer.write(&mut Vec::new()).unwrap_err();
    assert!(matches!(fails(new().scalar("", four())), OutputError::Name { .. }));
    assert!(matches!(
        fails(new().scalar("a", four()).vector("a", [four(), four()])),
        OutputError::Name { .. }
    ));
    assert!(matches!(fails(new().scalar("a", [1e39; 4])), OutputError::Range { value: 1e39, .. }));
    assert!(new().double_precision().scalar("a", [1e39; 4]).write(&mut Vec::new()).is_ok());
    let mut small = [0; 10];
    let error = new().scalar("a", four()).write(&mut small.as_mut_slice()).unwrap_err();
    assert!(matches!(error, OutputError::Io(_)));
    assert_eq!(io::Error::from(fails(new().scalar("a", [0.0; 3]))).kind(), io::ErrorKind::InvalidInput);
}

#[test]
fn planes_lie_in_space() {
    let grid = stretched();
    let sides = Sides::new(Side::WALL.everywhere()).unwrap();
    let sampler = Sampler::new(&grid, &sides);
    let p = Field::from_fn(&grid, |x| x[0] + 10.0 * x[2]);
    let plane = sampler.plane(1, 1.2).unwrap().with("p", &p).unwrap();
    assert_eq!(plane.extension(), "vtr");
    let mut file = Vec::new();
    plane.write_vtk(&mut file, Precision::Double).unwrap();
    let file = Parsed::new(&file);
    assert_eq!(attribute(file.tag("Piece"), "Extent"), Some("0 4 0 0 0 2"));
    assert_eq!(file.array("y").0, [1.2]);
    assert_eq!(file.array("p").0, plane.values("p", 0).unwrap());
    let uniform = CartesianGrid::new([3, 2], [3.0, 1.0]).unwrap();
    let sampler = Sampler::new(&uniform, &Sides::new(Side::Periodic.everywhere()).unwrap());
    let p = Field::zeros(&uniform);
    let plane = sampler.plane(1, 0.3).unwrap().with("p", &p).unwrap();
    assert_eq!(plane.extension(), "vti");
    let mut file = Vec::new();
    plane.write_vtk(&mut file, Precision::Single).unwrap();
    let file = Parsed::new(&file);
    let tag = file.tag("ImageData");
    assert_eq!(attribute(tag, "WholeExtent"), Some("0 3 0 0 0 0"));
    assert_eq!((attribute(tag, "Origin"), attribute(tag, "Spacing")), (Some("0 0.3 0"), Some("1 1 1")));
}

#[test]
fn series_list_their_files() {
    let folder = std::env::temp_dir().join(format!("fv-mesh-series-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let mut series = TimeSeries::new(folder.join("run.pvd"));
    series.push(0.0, "a.vti").unwrap();
    series.push(0.5, "b<1>.vti").unwrap();
    for time in [0.4, f64::NAN, f64::INFINITY] {
        assert!(matches!(series.push(time, "c.vti"), Err(OutputError::Time { last: 0.5, .. })));
    }
    assert_eq!(series.entries().collect::<Vec<_>>(), [(0.0, "a.vti"), (0.5, "b<1>.vti")]);
    let text = std::fs::read_to_string(series.path()).unwrap();
    let sets: Vec<&str> = text.split("<DataSet").skip(1).collect();
    assert_eq!(sets.len(), 2);
    assert_eq!(attribute(sets[1], "timestep").unwrap().parse(), Ok(0.5));
    assert_eq!(attribute(sets[1], "file"), Some("b&lt;1&gt;.vti"));
    assert!(!folder.join("run.pvd.part").exists());
    // A run that goes on from some time forgets what came after it.
    for (time, kept) in [(0.0, 1), (0.5, 2)] {
        let resumed = TimeSeries::resume(series.path(), time).unwrap();
        assert!(resumed.entries().eq(series.entries().take(kept)), "{resumed:?}");
    }
    assert!(matches!(TimeSeries::resume(folder.join("none.pvd"), 1.0), Err(OutputError::Io(_))));
    std::fs::remove_dir_all(&folder).unwrap();
    assert!(matches!(series.push(1.0, "c.vti"), Err(OutputError::Io(_))));
    assert_eq!(series.entries().count(), 2);
}
