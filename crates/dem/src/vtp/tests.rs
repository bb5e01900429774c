//! The file as a stranger's reader would take it apart.
use super::*;
use crate::{Cuboid, Disc, Ellipsoid, Material, Shape, Sphere};
use interfaces::{Freedom, Periods, Pose, Rotation, Twist};
use std::collections::HashMap;
use std::sync::Arc;

/// An array as the header describes it and the appended block holds it.
struct Read {
    section: String,
    kind: String,
    components: usize,
    bytes: Vec<u8>,
}
impl Read {
    fn floats(&self) -> Vec<f64> {
        if self.kind == "Float32" {
            return self.bytes.as_chunks().0.iter().map(|b| f32::from_le_bytes(*b).into()).collect();
        }
        assert_eq!(self.kind, "Float64");
        self.bytes.as_chunks().0.iter().map(|b| f64::from_le_bytes(*b)).collect()
    }
    fn ints(&self) -> Vec<usize> {
        if self.kind == "Int32" {
            return self.bytes.as_chunks().0.iter().map(|b| i32::from_le_bytes(*b) as usize).collect();
        }
        assert_eq!(self.kind, "Int64");
        self.bytes.as_chunks().0.iter().map(|b| i64::from_le_bytes(*b) as usize).collect()
    }
}

fn attribute<'a>(tag: &'a str, name: &str) -> &'a str {
    let from = tag.find(&format!("{name}=\"")).unwrap_or_else(|| panic!("no {name} in <{tag}>"));
    tag[from + name.len() + 2..].split('"').next().unwrap()
}

/// Checks that every element is closed by its own end tag and that the blocks follow one another without gaps;
/// answers the attributes of the piece and the arrays by name.
fn read(file: &[u8]) -> (String, HashMap<String, Read>) {
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
            arrays.insert(attribute(tag, "Name").to_owned(), Read { section, kind, components, bytes });
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

#[test]
fn arrays_and_counts_agree() {
    let quarter = Rotation::from_scaled_axis(Vector::z() * 0.5 * std::f64::consts::PI);
    let twist = Twist { linear: Vector::new(1.0, 2.0, 0.0), angular: Vector::new(0.0, 0.0, 3.0) };
    for spheres in [false, true] {
        let mut bodies = RigidBodies::new(Periods::new([Some(10.0), None, None]));
        for x in [3.0, -2.0] {
            let pose = Pose { position: Point::new(x, 1.0, 0.0), orientation: quarter };
            let shape: Arc<dyn Shape> =
                if spheres { Arc::new(Sphere::new(0.5).unwrap()) } else { Arc::new(Disc::new(0.5).unwrap()) };
            bodies.add(shape, Material::default(), pose, twist, Freedom::PLANAR).unwrap();
        }
        let mut file = Vec::new();
        bodies.write_vtp(&mut file, Point::origin()).unwrap();
        let (piece, arrays) = read(&file);
        let lines_each = if spheres { 3 } else { 1 };
        let (lines, points) = (2 * lines_each, 2 * lines_each * (CORNERS[0] + 1));
        assert_eq!(attribute(&piece, "NumberOfPoints"), points.to_string());
        assert_eq!(attribute(&piece, "NumberOfLines"), lines.to_string());

        let coordinates = &arrays["points"];
        assert_eq!((coordinates.section.as_str(), coordinates.components), ("Points", 3));
        let places: Vec<Point> = coordinates.floats().chunks_exact(3).map(Point::from_slice).collect();
        assert_eq!(places.len(), points);
        // The second body is drawn one period on.
        assert_eq!(places[0], Point::new(3.0, 1.0, 0.0));
        assert_eq!(places[points / 2], Point::new(8.0, 1.0, 0.0));

        let (connectivity, offsets) = (arrays["connectivity"].ints(), arrays["offsets"].ints());
        assert_eq!((offsets.len(), offsets.last()), (lines, Some(&connectivity.len())));
        let mut start = 0;
        for end in offsets {
            let line = &connectivity[start..end];
            let centre = places[line[0]];
            assert!(line[1..].iter().all(|&p| ((places[p] - centre).norm() - 0.5).abs() < 1e-6));
            assert_eq!((line.len(), line[1]), (CORNERS[0] + 2, *line.last().unwrap()), "closed");
            start = end;
        }
        // The mark from the centre to the rim has turned with the body, from x to y.
        assert!((places[1] - Point::new(3.0, 1.5, 0.0)).norm() < 1e-6);

        let owners: Vec<usize> = (0..lines).map(|l| l / lines_each).collect();
        assert_eq!(arrays["body"].ints(), owners);
        for (name, value) in [("velocity", [1.0, 2.0, 0.0]), ("angular_velocity", [0.0, 0.0, 3.0])] {
            assert_eq!((arrays[name].section.as_str(), arrays[name].components), ("CellData", 3));
            assert_eq!(arrays[name].floats(), value.repeat(lines));
        }
    }
}

/// A cube is drawn by its triangles, an ellipsoid by ellipses.
#[test]
fn other_shapes() {
    let mut bodies = RigidBodies::new(Periods::default());
    let (cube, egg) = (Cuboid::new([2.0; 3]).unwrap(), Ellipsoid::new([1.0, 2.0, 3.0]).unwrap());
    let (material, still) = (Material::default(), Twist::default());
    bodies.add(cube, material, Pose::at([0.0; 3]), still, Freedom::FREE).unwrap();
    bodies.add(egg, material, Pose::at([10.0, 0.0, 0.0]), still, Freedom::FREE).unwrap();
    let mut file = Vec::new();
    bodies.write_vtp(&mut file, Point::origin()).unwrap();
    let (_, arrays) = read(&file);
    assert_eq!(arrays["body"].ints(), [vec![0; 12], vec![1; 3]].concat());
    let places: Vec<Point> = arrays["points"].floats().chunks_exact(3).map(Point::from_slice).collect();
    let corners = 8;
    assert!(places[..corners].iter().all(|p| p.iter().all(|x| x.abs() == 1.0)));
    let far =
        |a: usize| places[corners..].iter().map(|p| (p - Point::new(10.0, 0.0, 0.0))[a]).fold(0.0, f64::max);
    assert!((0..3).all(|a| (far(a) - (a + 1) as f64).abs() < 1e-6), "{} {} {}", far(0), far(1), far(2));
}

/// Points of some of the bodies, and outlines of the others.
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
        (arrays["diameter"].floats()[0] - 2.0).abs() < 1e-12,
        "semi-axes 1, 2 and a half: a unit ball's volume"
    );
    assert_eq!(arrays["extent"].floats(), [2.0, 4.0, 1.0]);
    let half = 0.5_f64.sqrt();
    let q = arrays["orientation"].floats();
    assert!(q.iter().zip([half, 0.0, 0.0, half]).all(|(a, b)| (a - b).abs() < 1e-14), "{q:?}");
    assert_eq!(arrays["velocity"].floats(), [1.0, 2.0, 3.0]);
    assert_eq!(arrays["angular_velocity"].floats(), [4.0, 5.0, 6.0]);
    assert_eq!((arrays["connectivity"].ints(), arrays["offsets"].ints()), (vec![0], vec![1]));

    let mut walls = Vec::new();
    bodies.write_vtp_of(&mut walls, Point::origin(), [BodyId(0)]).unwrap();
    assert_eq!(read(&walls).1["body"].ints(), [0; 12]);
}

/// Of many the ellipses have fewer corners.
#[test]
fn many_bodies_have_fewer_corners() {
    let mut bodies = RigidBodies::new(Periods::default());
    let disc: Arc<dyn Shape> = Arc::new(Disc::new(0.4).unwrap());
    for i in 0..1000 {
        let pose = Pose::at([f64::from(i), 0.0, 0.0]);
        bodies.add(disc.clone(), Material::default(), pose, Twist::default(), Freedom::PLANAR).unwrap();
    }
    let mut file = Vec::new();
    bodies.write_vtp(&mut file, Point::origin()).unwrap();
    let (piece, arrays) = read(&file);
    assert_eq!(attribute(&piece, "NumberOfPoints"), (1000 * (CORNERS[1] + 1)).to_string());
    assert_eq!(arrays["connectivity"].ints().len(), 1000 * (CORNERS[1] + 2));
}

#[test]
fn no_bodies_are_a_valid_file() {
    let mut file = Vec::new();
    RigidBodies::new(Periods::default()).write_vtp(&mut file, Point::origin()).unwrap();
    let (piece, arrays) = read(&file);
    assert_eq!(attribute(&piece, "NumberOfPoints"), "0");
    assert!(arrays.values().all(|a| a.bytes.is_empty()));
}

/// What the disk answers reaches the caller.
#[test]
fn a_full_disk_is_an_error() {
    let mut bodies = RigidBodies::new(Periods::default());
    let (disc, still) = (Disc::new(1.0).unwrap(), Twist::default());
    bodies.add(disc, Material::default(), Pose::at([0.0; 3]), still, Freedom::PLANAR).unwrap();
    let mut small = [0_u8; 500];
    assert!(bodies.write_vtp(&mut small.as_mut_slice(), Point::origin()).is_err());
}
