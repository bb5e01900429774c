//! Files as another program reads them.
use super::polygon_surface::EDGES;
use super::*;
use crate::{Cuboid, Disc, Ellipsoid, Material, Polygon};
use interfaces::{Freedom, Periods, Pose, Rotation};
use std::collections::HashMap;

/// An array as the header describes it and the appended block holds it.
pub(super) struct Read {
    section: String,
    kind: String,
    components: usize,
    bytes: Vec<u8>,
}
impl Read {
    pub(super) fn floats(&self) -> Vec<f64> {
        if self.kind == "Float32" {
            return self.bytes.as_chunks().0.iter().map(|b| f32::from_le_bytes(*b).into()).collect();
        }
        assert_eq!(self.kind, "Float64");
        self.bytes.as_chunks().0.iter().map(|b| f64::from_le_bytes(*b)).collect()
    }
    pub(super) fn ints(&self) -> Vec<usize> {
        if self.kind == "Int32" {
            return self.bytes.as_chunks().0.iter().map(|b| i32::from_le_bytes(*b) as usize).collect();
        }
        assert_eq!(self.kind, "Int64");
        self.bytes.as_chunks().0.iter().map(|b| i64::from_le_bytes(*b) as usize).collect()
    }
}

pub(super) fn attribute<'a>(tag: &'a str, name: &str) -> &'a str {
    let from = tag.find(&format!("{name}=\"")).unwrap_or_else(|| panic!("no {name} in <{tag}>"));
    tag[from + name.len() + 2..].split('"').next().unwrap()
}

/// Checks that every element is closed by its own end tag and that the blocks follow one another
/// without gaps; returns the attributes of the piece and the arrays by name, those of cells by
/// "Lines connectivity" and so on.
pub(super) fn read(file: &[u8]) -> (String, HashMap<String, Read>) {
    let mark = b"<AppendedData encoding=\"raw\">\n_";
    let header = file.windows(mark.len()).position(|w| w == mark).expect("appended data");
    let data = &file[header + mark.len()..];
    let text = std::str::from_utf8(&file[..header]).unwrap();
    assert!(text.starts_with("<?xml version=\"1.0\"?>\n"));

    let (mut open, mut piece, mut arrays, mut end) = (Vec::<&str>::new(), String::new(), HashMap::new(), 0);
    for tag in text.split('<').skip(2).map(|t| t.split('>').next().unwrap()) {
        assert_eq!(tag.matches('"').count() % 2, 0, "quotes in <{tag}>");
        let name = tag.trim_start_matches('/').split([' ', '/']).next().unwrap();
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name));
        } else if tag.ends_with('/') {
            let at: usize = attribute(tag, "offset").parse().unwrap();
            assert_eq!((attribute(tag, "format"), at), ("appended", end));
            let size = u64::from_le_bytes(data[at..at + 8].try_into().unwrap()) as usize;
            end = at + 8 + size;
            let (section, kind) = ((*open.last().unwrap()).to_owned(), attribute(tag, "type").to_owned());
            let components = attribute(tag, "NumberOfComponents").parse().unwrap();
            let bytes = data[at + 8..end].to_vec();
            let mut name = attribute(tag, "Name").to_owned();
            if ["connectivity", "offsets"].contains(&name.as_str()) {
                name = format!("{section} {name}");
            }
            arrays.insert(name, Read { section, kind, components, bytes });
        } else {
            open.push(name);
            if name == "Piece" {
                piece = tag.to_owned();
            }
        }
    }
    assert_eq!(open, ["VTKFile"]);
    assert_eq!(&data[end..], b"\n</AppendedData>\n</VTKFile>\n");
    (piece, arrays)
}

/// Cells of a section, by their points.
fn cells(arrays: &HashMap<String, Read>, section: &str) -> Vec<Vec<usize>> {
    let [corners, ends] = ["connectivity", "offsets"].map(|name| arrays[&format!("{section} {name}")].ints());
    let starts = std::iter::once(0).chain(ends.iter().copied());
    starts.zip(&ends).map(|(start, &end)| corners[start..end].to_vec()).collect()
}

fn places(arrays: &HashMap<String, Read>) -> Vec<Point> {
    arrays["points"].floats().chunks_exact(3).map(Point::from_slice).collect()
}

/// Discs, of which the second is drawn one period on: a polygon each and a line that turns with it.
#[test]
fn discs_are_polygons_with_a_mark() {
    let quarter = Rotation::from_scaled_axis(Vector::z() * 0.5 * PI);
    let twist = Twist { linear: Vector::new(1.0, 2.0, 0.0), angular: Vector::new(0.0, 0.0, 3.0) };
    let mut bodies = RigidBodies::new(Periods::new([Some(10.0), None, None]));
    for x in [3.0, -2.0] {
        let pose = Pose { position: Point::new(x, 1.0, 0.0), orientation: quarter };
        bodies.add(Disc::new(0.5).unwrap(), Material::default(), pose, twist, Freedom::PLANAR).unwrap();
    }
    let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    let angle = Polygon::new(&corners).unwrap();
    let pose = Pose::at([5.0, 5.0, 0.0]);
    bodies.add(angle, Material::default(), pose, Twist::default(), Freedom::PLANAR).unwrap();
    let mut file = Vec::new();
    bodies.write_vtp(&mut file, Point::origin()).unwrap();
    let (piece, arrays) = read(&file);
    let (places, lines, polygons) = (places(&arrays), cells(&arrays, "Lines"), cells(&arrays, "Polys"));
    for (name, count) in
        [("NumberOfPoints", places.len()), ("NumberOfLines", lines.len()), ("NumberOfPolys", polygons.len())]
    {
        assert_eq!(attribute(&piece, name), count.to_string(), "{name}");
    }
    assert_eq!((lines.len(), polygons[0].len(), polygons[1].len()), (2, EDGES, EDGES));
    for (b, x) in [3.0, 8.0].into_iter().enumerate() {
        let centre = Point::new(x, 1.0, 0.0);
        let [middle, rim] = [0, 1].map(|i| places[lines[b][i]]);
        assert!((middle - centre).norm() < 1e-6);
        // Turned from x to y.
        assert!((rim - Point::new(x, 1.5, 0.0)).norm() < 1e-6);
        assert!(polygons[b].iter().all(|&p| ((places[p] - centre).norm() - 0.5).abs() < 1e-6));
    }
    let mut owners = vec![0, 1, 0, 1];
    owners.resize(lines.len() + polygons.len(), 2);
    assert_eq!(arrays["body"].ints(), owners);
    for (name, value) in [("velocity", [1.0, 2.0, 0.0]), ("angular_velocity", [0.0, 0.0, 3.0])] {
        assert_eq!((arrays[name].section.as_str(), arrays[name].components), ("CellData", 3));
        let values: Vec<f64> = owners.iter().flat_map(|&b| if b < 2 { value } else { [0.0; 3] }).collect();
        assert_eq!(arrays[name].floats(), values);
    }
}

/// A cube by its faces and an ellipsoid, each at its pose, outward.
#[test]
fn solids_are_at_their_poses() {
    let mut bodies = RigidBodies::new(Periods::default());
    let (cube, egg) = (Cuboid::new([2.0; 3]).unwrap(), Ellipsoid::new([1.0, 2.0, 3.0]).unwrap());
    let (material, still) = (Material::default(), Twist::default());
    bodies.add(cube, material, Pose::at([0.0; 3]), still, Freedom::FREE).unwrap();
    let quarter = Rotation::from_scaled_axis(Vector::z() * 0.5 * PI);
    let pose = Pose { position: Point::new(10.0, 0.0, 0.0), orientation: quarter };
    bodies.add(egg, material, pose, still, Freedom::FREE).unwrap();
    let mut file = Vec::new();
    bodies.write_vtp(&mut file, Point::origin()).unwrap();
    let (_, arrays) = read(&file);
    let (places, polygons, owners) = (places(&arrays), cells(&arrays, "Polys"), arrays["body"].ints());
    assert_eq!(
        (owners.len(), &owners[..6], &owners[6..8]),
        (polygons.len(), [0; 6].as_slice(), [1; 2].as_slice())
    );
    assert!(places[..8].iter().all(|p| p.iter().all(|x| x.abs() == 1.0)));
    let middle = [Point::origin(), Point::new(10.0, 0.0, 0.0)];
    let mut volumes = [0.0; 2];
    for (polygon, &b) in polygons.iter().zip(&owners) {
        let corner = |i: usize| places[polygon[i]] - middle[b];
        for i in 2..polygon.len() {
            volumes[b] += corner(0).dot(&corner(i - 1).cross(&corner(i))) / 6.0;
        }
    }
    assert!(
        (volumes[0] - 8.0).abs() < 1e-6 && (0.98..1.0).contains(&(volumes[1] / (8.0 * PI))),
        "{volumes:?}"
    );
    let far = |a: usize| places[8..].iter().map(|p| (p - middle[1])[a]).fold(0.0, f64::max);
    let semi_axes = [2.0, 1.0, 3.0];
    assert!((0..3).all(|a| (far(a) - semi_axes[a]).abs() < 1e-5), "{} {} {}", far(0), far(1), far(2));
}

/// Points of some of the bodies, and surfaces of the others.
#[test]
fn points_for_glyphs() {
    let quarter = Rotation::from_scaled_axis(Vector::z() * 0.5 * std::f64::consts::PI);
    let twist = Twist { linear: Vector::new(1.0, 2.0, 3.0), angular: Vector::new(4.0, 5.0, 6.0) };
    let mut bodies = RigidBodies::new(Periods::new([Some(10.0), None, None]));
    let (cube, egg) = (Cuboid::new([2.0; 3]).unwrap(), Ellipsoid::new([1.0, 2.0, 0.5]).unwrap());
    let (material, still) = (Material::default(), Twist::default());
    bodies.add(cube, material, Pose::at([0.0; 3]), still, Freedom::NONE).unwrap();
    let pose = Pose { position: Point::new(-3.0, 1.0, 2.0), orientation: quarter };
    bodies.add(egg, material, pose, twist, Freedom::FREE).unwrap();
    let mut file = Vec::new();
    bodies.write_vtp_points(&mut file, Point::origin(), [BodyId(1)]).unwrap();
    let (piece, arrays) = read(&file);
    assert_eq!((attribute(&piece, "NumberOfPoints"), attribute(&piece, "NumberOfVerts")), ("1", "1"));
    assert_eq!(arrays["points"].floats(), [7.0, 1.0, 2.0], "one period on");
    assert_eq!(arrays["body"].ints(), [1]);
    assert!(
        (arrays["diameter"].floats()[0] - 2.0).abs() < 1e-6,
        "semi-axes 1, 2 and a half: a unit ball's volume"
    );
    assert_eq!(arrays["extent"].floats(), [2.0, 4.0, 1.0]);
    let half = 0.5_f64.sqrt();
    let q = arrays["orientation"].floats();
    assert!(q.iter().zip([half, 0.0, 0.0, half]).all(|(a, b)| (a - b).abs() < 1e-7), "{q:?}");
    assert_eq!(arrays["velocity"].floats(), [1.0, 2.0, 3.0]);
    assert_eq!(arrays["angular_velocity"].floats(), [4.0, 5.0, 6.0]);
    assert_eq!(cells(&arrays, "Verts"), [[0]]);

    let mut walls = Vec::new();
    bodies.write_vtp_of(&mut walls, Point::origin(), [BodyId(0)]).unwrap();
    assert_eq!(read(&walls).1["body"].ints(), [0; 6]);
}

#[test]
fn no_bodies_are_a_valid_file() {
    let mut file = Vec::new();
    RigidBodies::new(Periods::default()).write_vtp(&mut file, Point::origin()).unwrap();
    let (piece, arrays) = read(&file);
    assert_eq!(attribute(&piece, "NumberOfPoints"), "0");
    assert!(arrays.values().all(|a| a.bytes.is_empty()));
}

/// Errors of the disk reach the caller.
#[test]
fn a_full_disk_is_an_error() {
    let mut bodies = RigidBodies::new(Periods::default());
    let (disc, still) = (Disc::new(1.0).unwrap(), Twist::default());
    bodies.add(disc, Material::default(), Pose::at([0.0; 3]), still, Freedom::PLANAR).unwrap();
    let mut small = [0_u8; 500];
    assert!(bodies.write_vtp(&mut small.as_mut_slice(), Point::origin()).is_err());
}
