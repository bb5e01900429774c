//! Tables of bodies: round trips to the bit, and what is said of tables that are wrong.
use dem::placing::{BodyRow, BodyTableError, Orientations, read_bodies, write_bodies};
use interfaces::{Point, Pose, Twist, Vector};
use proptest::prelude::*;

fn read(text: &str) -> Result<Vec<BodyRow>, BodyTableError> {
    read_bodies(text.as_bytes())
}
fn bits(v: Vector) -> [u64; 3] {
    [v.x.to_bits(), v.y.to_bits(), v.z.to_bits()]
}

fn finite() -> impl Strategy<Value = f64> {
    any::<u64>().prop_map(f64::from_bits).prop_filter("finite", |v| v.is_finite())
}
fn vector() -> impl Strategy<Value = Vector> {
    [finite(), finite(), finite()].prop_map(Vector::from)
}
fn row() -> impl Strategy<Value = BodyRow> {
    let twist = proptest::option::of((vector(), vector()));
    let size = proptest::option::of(finite().prop_map(f64::abs).prop_filter("positive", |v| *v > 0.0));
    (vector(), any::<u64>(), twist, size, any::<String>()).prop_map(|(place, seed, twist, size, kind)| {
        BodyRow {
            pose: Pose {
                position: Point::from(place),
                orientation: Orientations::Random.of(seed).next().unwrap(),
            },
            twist: twist.map(|(linear, angular)| Twist { linear, angular }),
            size,
            kind,
        }
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(500) })]

    #[test]
    fn round_trips_keep_every_bit(rows in proptest::collection::vec(row(), 0..20)) {
        let mut file = Vec::new();
        write_bodies(&mut file, &rows).unwrap();
        let back = read_bodies(file.as_slice()).unwrap();
        prop_assert_eq!(&back, &rows);
        for (a, b) in back.iter().zip(&rows) {
            // −0 equals 0, but is another number.
            prop_assert_eq!(bits(a.pose.position.coords), bits(b.pose.position.coords));
            let (p, q) = (a.pose.orientation.coords, b.pose.orientation.coords);
            prop_assert!(p.iter().zip(q.iter()).all(|(p, q)| p.to_bits() == q.to_bits()));
            if let (Some(a), Some(b)) = (a.twist, b.twist) {
                prop_assert_eq!((bits(a.linear), bits(a.angular)), (bits(b.linear), bits(b.angular)));
            }
        }
    }

    #[test]
    fn bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        let _ = read_bodies(bytes.as_slice());
    }

    #[test]
    fn what_looks_like_a_table_never_panics(text in "(\u{feff})?[xyz,qw]{0,8}(x,y,z(,size|,kind|,qw,qx,qy,qz|,vx,vy,vz,wx,wy,wz){0,3})?(\r\n|\n|\r)([-+0-9.einfa\",\r\n \u{e9}]{0,20}(,|\n)){0,20}") {
        if let Ok(rows) = read(&text) {
            for row in rows {
                prop_assert!(row.pose.position.iter().all(|c| c.is_finite()));
                prop_assert!((row.pose.orientation.quaternion().norm() - 1.0).abs() < 1e-8);
                prop_assert!(row.size.is_none_or(|s| s > 0.0 && s.is_finite()));
            }
        }
    }

    #[test]
    fn damaged_tables_never_panic(rows in proptest::collection::vec(row(), 1..5), at in any::<prop::sample::Index>(), byte: u8) {
        let mut file = Vec::new();
        write_bodies(&mut file, &rows).unwrap();
        let at = at.index(file.len());
        file[at] = byte;
        let _ = read_bodies(file.as_slice());
        let _ = read_bodies(&file[..at]);
    }
}

#[test]
fn columns_in_any_order() {
    let rows = read("\u{feff}kind,qz, qy,qx,qw,z,y,x,wz,wy,wx,vz,vy,vx,size\r\n\"a, b\",0,0,0.707,0.707,3,2,1,6,5,4,3,2,1,0.5\r\n,0,0,0,1,0,0,0,,,,,,,\r\n").unwrap();
    assert_eq!(rows.len(), 2);
    assert_eq!(rows[0].pose.position, Point::new(1.0, 2.0, 3.0));
    assert_eq!(rows[0].kind, "a, b");
    let twist = rows[0].twist.unwrap();
    assert_eq!((twist.linear, twist.angular), (Vector::new(1.0, 2.0, 3.0), Vector::new(4.0, 5.0, 6.0)));
    assert_eq!(rows[0].size, Some(0.5));
    // Rounded quaternions are brought to length one: a quarter turn about x.
    assert!((rows[0].pose.orientation * Vector::y() - Vector::z()).norm() < 1e-15);
    assert_eq!(rows[1], BodyRow::from(Pose::at([0.0; 3])));
    assert!(read("x,y,z\n").unwrap().is_empty());
}

#[test]
fn what_is_wrong_is_told_with_its_line() {
    use BodyTableError as E;
    let header = "x,y,z,qw,qx,qy,qz\n";
    let line = |text: &str| read(&format!("{header}0,0,0,1,0,0,0\n\n\r\n{text}\n")).unwrap_err();
    assert!(matches!(read(""), Err(E::NoHeader)));
    assert!(matches!(read("x,y\n"), Err(E::Missing { line: 1, name: "z" })));
    assert!(matches!(read("\n\nx,y,z,qw\n"), Err(E::Missing { line: 3, name: "qx" })));
    assert!(matches!(read("x,y,z,wz\n"), Err(E::Missing { name: "vx", .. })));
    assert!(matches!(read("x,y,z,x\n"), Err(E::Column { line: 1, number: 4, problem: "there twice", .. })));
    let Err(E::Column { number: 2, name, problem: "not known", .. }) = read("x,radius,y,z\n") else {
        panic!()
    };
    assert_eq!(name, "radius");
    assert!(matches!(line("0,0,0"), E::Width { line: 5, expected: 7, found: 3 }));
    assert!(matches!(line("0,0,inf,1,0,0,0"), E::Field { line: 5, column: "z", .. }));
    assert!(matches!(line("0,,0,1,0,0,0"), E::Field { line: 5, column: "y", .. }));
    assert!(matches!(line("0,0,0,0,0,0,0"), E::Quaternion { line: 5, length: 0.0 }));
    assert!(matches!(line("0,0,0,1e200,1e200,0,0"), E::Quaternion { line: 5, .. }));
    let wrong = |size: &str| read(&format!("x,y,z,size\n0,0,0,{size}\n")).unwrap_err();
    for size in ["-1", "0", "nan", "big"] {
        let E::Field { line: 2, column: "size", text, .. } = wrong(size) else { panic!() };
        assert_eq!(text, size);
    }
    let half = read("x,y,z,vx,vy,vz,wx,wy,wz\n0,0,0,1,2,3,,,\n");
    assert!(matches!(half, Err(E::Field { line: 2, column: "wx", .. })));
    let bytes = read_bodies(b"x,y,z,kind\n0,0,0,\xff\n".as_slice());
    assert!(matches!(bytes, Err(E::Field { line: 2, column: "kind", .. })));
    let message = line("0,0,abc,1,0,0,0").to_string();
    assert_eq!(message, "line 5, column \"z\": a finite number was expected, not \"abc\"");
}

#[test]
fn what_could_not_be_read_again_is_not_written() {
    let ball = BodyRow::from(Pose::at([0.0; 3]));
    let unit = nalgebra::Unit::new_unchecked(nalgebra::Quaternion::new(2.0, 0.0, 0.0, 0.0));
    for (row, name) in [
        (BodyRow::from(Pose::at([0.0, f64::NAN, 0.0])), "y"),
        (BodyRow { size: Some(-1.0), ..ball.clone() }, "size"),
        (BodyRow { size: Some(f64::INFINITY), ..ball.clone() }, "size"),
        (BodyRow::from(Pose { orientation: unit, ..Pose::at([0.0; 3]) }), "quaternion's length"),
    ] {
        let wrong = write_bodies(Vec::new(), &[ball.clone(), row]);
        let Err(BodyTableError::Row { body: 1, what, .. }) = wrong else { panic!("{wrong:?}") };
        assert_eq!(what, name);
    }
}
