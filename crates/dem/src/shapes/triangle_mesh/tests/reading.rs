//! Files: what they hold, what is wrong with them, and bytes that are none.
use super::*;

fn text(faces: &[[u32; 3]], vertices: &[[f64; 3]]) -> String {
    let facet = |f: &[u32; 3]| {
        let corners = f.map(|v| vertices[v as usize]).map(|p| format!("vertex {} {} {}\n", p[0], p[1], p[2]));
        format!("facet normal 0 0 0\nouter loop\n{}endloop\nendfacet\n", corners.concat())
    };
    format!("solid box\n{}endsolid box\n", faces.iter().map(facet).collect::<String>())
}

fn triangles((vertices, faces): &Faces) -> Vec<stl_io::Triangle> {
    let corner = |v: u32| stl_io::Vertex::new(vertices[v as usize].map(|x| x as f32));
    let triangle =
        |f: &[u32; 3]| stl_io::Triangle { normal: stl_io::Normal::new([0.0; 3]), vertices: f.map(corner) };
    faces.iter().map(triangle).collect()
}

fn binary(faces: &Faces) -> Vec<u8> {
    let mut bytes = Vec::new();
    stl_io::write_stl(&mut bytes, triangles(faces).iter()).unwrap();
    bytes
}

fn obj((vertices, faces): &Faces) -> String {
    let vertices: String = vertices.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n")).collect();
    let faces: String = faces.iter().map(|f| format!("f {} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1)).collect();
    vertices + &faces
}

fn volume(bytes: &[u8], unit: f64) -> f64 {
    TriangleMesh::try_from(TriangleSoup::from_stl_bytes(bytes, unit).unwrap()).unwrap().volume()
}

#[test]
fn files_are_read() {
    let faces = brick([0.0; 3], [2.0, 1.0, 1.0]);
    let path = |end: &str| std::env::temp_dir().join(format!("dem-mesh-{}.{end}", std::process::id()));
    let (stl, wavefront) = (path("stl"), path("obj"));
    std::fs::write(&stl, text(&faces.1, &faces.0)).unwrap();
    std::fs::write(&wavefront, obj(&faces)).unwrap();
    for mesh in
        [TriangleMesh::from_stl(&stl, 1e-3).unwrap(), TriangleMesh::from_obj(&wavefront, 1e-3).unwrap()]
    {
        assert!((mesh.volume() - 2e-9).abs() < 1e-21 && mesh.n_faces() == 12);
    }
    std::fs::write(&stl, text(&faces.1[1..], &faces.0)).unwrap();
    let error = TriangleMesh::from_stl(&stl, 1e-3).unwrap_err();
    assert!(matches!(error, MeshError::NotClosed { count: 3, .. }), "{error}");
    // What is wrong with the text is said of the file.
    let error = TriangleMesh::from_stl(&wavefront, 1.0).unwrap_err();
    assert!(
        matches!(&error, MeshError::File { path, what } if *path == wavefront && what.contains("line 1")),
        "{error}"
    );
    assert!(matches!(TriangleMesh::from_stl(&stl, -1.0), Err(MeshError::Unit { unit: -1.0 })));
    for path in [stl, wavefront] {
        std::fs::remove_file(&path).unwrap();
        assert!(matches!(TriangleMesh::from_stl(&path, 1.0), Err(MeshError::File { .. })));
        assert!(matches!(TriangleMesh::from_obj(&path, 1.0), Err(MeshError::File { .. })));
    }
}

/// Another reader finds the same triangles.
#[test]
fn stl_is_read_as_others_read_it() {
    let faces = star();
    let text = text(&faces.1, &faces.0);
    for bytes in [binary(&faces), text.into_bytes()] {
        let ours = TriangleSoup::from_stl_bytes(&bytes, 1.0).unwrap();
        let other = stl_io::read_stl(&mut std::io::Cursor::new(bytes)).unwrap();
        assert_eq!((ours.faces.len(), ours.vertices.len()), (other.faces.len(), other.vertices.len()));
        for (f, g) in ours.faces.iter().zip(&other.faces) {
            assert_eq!(f.map(|v| v as usize), g.vertices);
        }
        for (v, w) in ours.vertices.iter().zip(&other.vertices) {
            assert_eq!(v.map(|x| x as f32), w.0);
        }
    }
}

#[test]
fn stl_as_programs_write_it() {
    let faces = brick([0.0; 3], [2.0, 1.0, 1.0]);
    // Several solids, words in capitals, no names, odd spaces and ends of lines; −0 is 0.
    let (one, two) = (text(&faces.1[..5], &faces.0), text(&faces.1[5..], &faces.0).to_uppercase());
    let odd = format!("  {one}\n\n{two}")
        .replace("box", "")
        .replace("BOX", "")
        .replace('\n', " \r\n\t")
        .replace(" 0 1 ", " -0 1 ");
    assert!(odd.contains("-0"));
    assert_eq!(volume(odd.as_bytes(), 1.0), 2.0);
    // A binary file that begins like text, and one with something at its end.
    let mut bytes = binary(&faces);
    bytes[..6].copy_from_slice(b"solid ");
    assert_eq!(volume(&bytes, 1.0), 2.0);
    let mut bytes = binary(&faces);
    bytes.extend([7; 33]);
    assert_eq!(volume(&bytes, 2.0), 16.0);
    // All digits of text.
    let digits = text(&faces.1, &faces.0).replace(" 2", " 2.000000000001");
    assert!((volume(digits.as_bytes(), 1.0) - 2.000000000001).abs() < 1e-15);
}

#[test]
fn bad_stl_is_named() {
    let faces = brick([0.0; 3], [1.0; 3]);
    let read = |bytes: &[u8]| TriangleSoup::from_stl_bytes(bytes, 1.0);
    let mut bytes = binary(&faces);
    bytes[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    assert_eq!(read(&bytes), Err(MeshError::Truncated { triangles: u32::MAX, bytes: 684 }));
    assert!(read(&bytes).unwrap_err().to_string().contains("214748364834 bytes"));
    assert_eq!(read(&binary(&faces)[..683]), Err(MeshError::Truncated { triangles: 12, bytes: 683 }));
    let text = text(&faces.1, &faces.0);
    let line = |bytes: &[u8]| match read(bytes) {
        Err(MeshError::Text { format: "STL", line, what }) => (line, what),
        other => panic!("{other:?}"),
    };
    assert_eq!(
        line(text.replacen("outer", "inner", 1).as_bytes()),
        (3, "no \"outer\" behind a facet's normal".into())
    );
    assert_eq!(line(text.replacen("vertex 0", "vertex 0,", 1).as_bytes()), (4, "\"0,\" is no number".into()));
    let end = line(&text.as_bytes()[..text.len() - 13]);
    assert!(end.1.contains("the file ends before"), "{end:?}");
    assert!(line(b"v 0 0 0").1.contains("instead of \"solid\""));
    assert_eq!(read(b""), Ok(TriangleSoup::default()));
    assert!(matches!(TriangleMesh::try_from(read(b"").unwrap()), Err(MeshError::Empty { .. })));
    for unit in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(TriangleSoup::from_stl_bytes(&binary(&faces), unit), Err(MeshError::Unit { .. })));
        assert!(matches!(TriangleSoup::from_obj_bytes(b"", unit), Err(MeshError::Unit { .. })));
    }
}

/// Faces and vertices are numbered by 32 bits.
#[test]
fn counts_beyond_32_bits_are_named() {
    let most = u32::MAX as usize;
    assert_eq!(MeshError::check_count("corners", most), Ok(()));
    let error = MeshError::check_count("corners", most + 1).unwrap_err();
    assert_eq!(error, MeshError::TooMany { what: "corners", count: most + 1, most: u32::MAX });
    assert!(error.to_string().contains("4294967296 corners; no more than 4294967295"), "{error}");
}

#[test]
fn obj_as_programs_write_it() {
    let cube = "# a cube\nmtllib none.mtl\no cube\nv -1 -1 -1 0.5 0.5 0.5\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nvt 0 0\nvn 0 0 1\n\
                v -1 -1 1 1\nv 1 -1 1\nv 1 1 1 # a comment\nv -1 1 1\ng sides\nusemtl red\ns off\n\
                f 4 3 2 1\r\nf 5/1 6/1 7/1 8/1\nf 1//1 2//1 6//1 5//1\nf 2/1/1 3/1/1 7/1/1 6/1/1\nf -6 \\\n -5 -1 \\\n -2\nf -5 -8 -4 -1\nl 1 2\n";
    let soup = TriangleSoup::from_obj_bytes(cube.as_bytes(), 0.5).unwrap();
    assert_eq!((soup.vertices.len(), soup.faces.len()), (8, 12));
    assert_eq!(soup.faces[..2], [[3, 2, 1], [3, 1, 0]]);
    let mesh = TriangleMesh::try_from(soup).unwrap();
    assert!((mesh.volume() - 1.0).abs() < 1e-15);
    // A fan of a polygon with many corners.
    let ring: String = (0..50)
        .map(|i| format!("v {} {} 0\n", (0.1 * f64::from(i)).cos(), (0.1 * f64::from(i)).sin()))
        .collect();
    let all: Vec<String> = (1..=50).map(|i| i.to_string()).collect();
    let fan = TriangleSoup::from_obj_bytes(format!("{ring}f {}\n", all.join(" ")).as_bytes(), 1.0).unwrap();
    assert!(
        fan.faces.len() == 48
            && fan.faces.iter().enumerate().all(|(i, f)| *f == [0, i as u32 + 1, i as u32 + 2])
    );
}

#[test]
fn bad_obj_is_named() {
    let error = |text: &str| match TriangleSoup::from_obj_bytes(text.as_bytes(), 1.0) {
        Err(MeshError::Text { format: "OBJ", line, what }) => (line, what),
        other => panic!("{other:?}"),
    };
    assert_eq!(error("v 0 0 0\nv 1 0\n"), (2, "a number is missing".into()));
    assert_eq!(error("v 0 x 0"), (1, "\"x\" is no number".into()));
    assert_eq!(error("v 0 0 0\n\nf 1 2\n"), (3, "a face of 2 vertices".into()));
    assert_eq!(error("f 1 2 three"), (1, "\"three\" is no vertex".into()));
    for zero in ["f 1 0 2", "f 0/1 1 2"] {
        assert!(error(zero).1.contains("there is no vertex 0"));
    }
    let three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    assert_eq!(
        error(&format!("{three}f -4 -2 -1")),
        (4, "there is no vertex -4; 3 were given before".into())
    );
    for wild in ["-9223372036854775808", "9223372036854775807", "4294967297"] {
        assert!(error(&format!("{three}f 1 2 {wild}")).1.contains("there is no vertex"), "{wild}");
    }
    // A vertex that never comes is named with its face.
    let soup = TriangleSoup::from_obj_bytes(format!("{three}f 1 2 9").as_bytes(), 1.0).unwrap();
    assert!(matches!(
        TriangleMesh::try_from(soup),
        Err(MeshError::NoVertex { face: 0, vertex: 8, vertices: 3 })
    ));
}

/// Every corner by itself, off by round-off of single precision: open until it is welded.
#[test]
fn welding_closes_what_round_off_opened() {
    let (vertices, faces) = icosphere(1.0, 3);
    let mut soup = TriangleSoup::default();
    for (i, v) in faces.as_flattened().iter().enumerate() {
        let noise = |a: usize| 6e-8 * ((i * 3 + a) as f64 * 12.9898).sin();
        soup.vertices.push([0, 1, 2].map(|a| vertices[*v as usize][a] + noise(a)));
        soup.faces.push([0, 1, 2].map(|k| (3 * (i / 3) + k) as u32));
    }
    soup.faces.dedup();
    assert!(
        soup.admission(None).faults.iter().any(|f| matches!(f, MeshError::NotClosed { count: 3840, .. }))
    );
    let welded = soup.clone().welded(1e-6).unwrap();
    assert_eq!((welded.vertices.len(), welded.faces.len()), (642, 1280));
    assert!(welded.admission(None).is_admissible());
    // So little joins none; so much joins all, and no face is left.
    assert_eq!(soup.clone().welded(1e-14).unwrap().vertices.len(), 3840);
    let one = soup.clone().welded(5.0).unwrap();
    assert_eq!((one.vertices.len(), one.faces.len()), (1, 0));
    // Digit by digit.
    let copies = TriangleSoup { vertices: vec![[0.5; 3], [0.0; 3], [0.5; 3], [-0.0; 3]], faces: vec![] };
    assert_eq!(copies.welded(0.0).unwrap().vertices, [[0.5; 3], [0.0; 3]]);
    for tolerance in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(soup.clone().welded(tolerance), Err(MeshError::Tolerance { .. })));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]
    /// No vertex is nearer to one before it than the tolerance, and every vertex has one that near.
    #[test]
    fn welded_vertices_are_apart(points in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 0..80), tolerance in 0.0..0.8_f64) {
        let distance = |a: &[f64; 3], b: &[f64; 3]| (Vector::from(*a) - Vector::from(*b)).norm();
        let n = points.len() as u32;
        // Out of range stays out of range.
        let soup = TriangleSoup { vertices: points.clone(), faces: vec![[n, n + 1, n + 7]] };
        let welded = soup.welded(tolerance).unwrap();
        for (i, v) in welded.vertices.iter().enumerate() {
            prop_assert!(welded.vertices[..i].iter().all(|w| distance(v, w) > tolerance * (1.0 - 1e-12)));
        }
        let near = |p: &[f64; 3]| welded.vertices.iter().any(|w| distance(p, w) <= tolerance * (1.0 + 1e-12));
        prop_assert!(points.iter().all(near));
        prop_assert!(welded.faces.iter().flatten().all(|v| *v as usize >= welded.vertices.len()));
    }
}

/// All that may be done with what a file holds: no panic, no NaN.
fn use_all(soup: Result<TriangleSoup, MeshError>) -> bool {
    let soup = match soup {
        Ok(soup) => soup,
        Err(e) => {
            assert!(!e.to_string().is_empty());
            return false;
        }
    };
    let soup = soup.welded(1e-6).unwrap();
    let report = soup.admission(Some(0.1));
    assert!(!report.to_string().is_empty());
    let mesh = TriangleMesh::try_from(soup);
    // As words, since NaN is not equal to itself.
    assert_eq!(format!("{:?}", mesh.as_ref().err()), format!("{:?}", report.faults.first()));
    mesh.is_ok_and(|mesh| {
        let x = Point::new(0.3, 0.2, 0.1);
        let numbers =
            [mesh.signed_distance(x, f64::INFINITY), mesh.winding_number(x), mesh.inertia(1.0).tensor.norm()];
        assert!(numbers.iter().all(|x| x.is_finite()), "{numbers:?}");
        true
    })
}

/// Valid files, some of them cut off, with bytes changed, left out or put in.
fn damaged(files: Vec<Vec<u8>>) -> impl Strategy<Value = Vec<u8>> {
    let change = (any::<prop::sample::Index>(), 0..4_u8, any::<u8>());
    let changes = prop::collection::vec(change, 0..4);
    (prop::sample::select(files), changes, 0..8_u8, any::<prop::sample::Index>()).prop_map(
        |(mut bytes, changes, cut, end)| {
            for (at, how, byte) in changes {
                if bytes.is_empty() {
                    break;
                }
                let at = at.index(bytes.len());
                match how {
                    0 => bytes[at] = byte,
                    1 => bytes[at] ^= 1 << (byte % 8),
                    2 => _ = bytes.remove(at),
                    _ => bytes.insert(at, byte),
                }
            }
            if cut == 0 && !bytes.is_empty() {
                bytes.truncate(end.index(bytes.len()));
            }
            bytes
        },
    )
}

fn stl_files() -> Vec<Vec<u8>> {
    let (small, tent) = (brick([0.0; 3], [1.0; 3]), tetrahedron());
    vec![
        binary(&small),
        binary(&tent),
        text(&small.1, &small.0).into_bytes(),
        text(&tent.1, &tent.0).into_bytes(),
    ]
}

fn tetrahedron() -> Faces {
    let vertices = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    (vertices, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
}

/// Words of both formats, and numbers of all kinds.
fn words() -> impl Strategy<Value = Vec<u8>> {
    let word = prop::sample::select(vec![
        "solid",
        "endsolid",
        "facet",
        "normal",
        "outer",
        "loop",
        "vertex",
        "endloop",
        "endfacet",
        "v",
        "f",
        "vn",
        "#",
        "\n",
        "\n",
        "\\\n",
        "0",
        "1",
        "2",
        "3",
        "-1",
        "-0",
        "1/2/3",
        "4//",
        "1e308",
        "-1e999",
        "nan",
        "inf",
        "1e-320",
        "99999999999999999999",
        "\u{e9}",
        "/",
    ]);
    prop::collection::vec(word, 0..60).prop_map(|words| words.join(" ").into_bytes())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn damaged_stl_never_panics(bytes in damaged(stl_files())) {
        use_all(TriangleSoup::from_stl_bytes(&bytes, 1.0));
    }

    #[test]
    fn damaged_obj_never_panics(bytes in damaged(vec![obj(&brick([0.0; 3], [1.0; 3])).into_bytes(), obj(&tetrahedron()).into_bytes()])) {
        use_all(TriangleSoup::from_obj_bytes(&bytes, 1.0));
    }

    #[test]
    fn any_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..300), words in words()) {
        for bytes in [bytes, words] {
            use_all(TriangleSoup::from_stl_bytes(&bytes, 1.0));
            use_all(TriangleSoup::from_obj_bytes(&bytes, 1.0));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 8_000, failure_persistence: None, ..ProptestConfig::default() })]
    /// Triangles of wild numbers, alike and not, of all sizes, that all bytes of a binary file may be.
    #[test]
    fn wild_numbers_never_panic(which in prop::collection::vec(0..12_usize, 9..90), exponent in -60..60_i32) {
        let wild = [0.0, 1.0, -1.0, 0.5, 1e-3, 1e38, -1e38, 1e-38, f64::NAN, f64::INFINITY, 2.0, 1.0 + 1e-7];
        let few = if exponent % 2 == 0 { 5 } else { 12 };
        let corners: Vec<[f64; 3]> = which.as_chunks::<3>().0.iter().map(|c| c.map(|i| wild[i % few])).collect();
        let n = corners.len() as u32;
        let faces = (0..2 * n).map(|i| [i % n, (i * 7 + 1) % n, (i * 3 + 2) % n]).collect();
        let mut soup = TriangleSoup { vertices: corners, faces };
        soup.vertices.as_flattened_mut().iter_mut().for_each(|x| *x *= 2.0_f64.powi(exponent));
        use_all(Ok(soup));
    }
}

/// The damage is not such that nothing is a body any more.
#[test]
fn undamaged_files_are_bodies() {
    assert!(stl_files().iter().all(|bytes| use_all(TriangleSoup::from_stl_bytes(bytes, 1.0))));
    assert!(use_all(TriangleSoup::from_obj_bytes(obj(&star()).as_bytes(), 1e-3)));
}
