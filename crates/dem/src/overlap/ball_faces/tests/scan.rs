use super::bodies::*;
use super::*;
#[test]
#[ignore]
fn scan() {
    let text = std::fs::read_to_string("/root/h4/cases.txt").unwrap();
    let mut worst: std::collections::BTreeMap<String, [f64; 3]> = Default::default();
    for line in text.lines() {
        let w: Vec<&str> = line.split(' ').collect();
        let x: Vec<f64> = w[3..].iter().map(|s| s.parse().unwrap()).collect();
        let p = |i: usize| [x[3 * i], x[3 * i + 1], x[3 * i + 2]];
        let t = tetrahedron([p(0), p(1), p(2), p(3)]);
        let o = one(&ball(1.0, p(4)), &t, &origin());
        let s = Vector::from(<[f64; 3]>::try_from(&x[16..19]).unwrap());
        let g = Point::from(<[f64; 3]>::try_from(&x[19..22]).unwrap());
        let e = [
            (o.volume / x[15] - 1.0).abs(),
            (o.gradient - s).norm() / s.norm().max(x[15].powf(0.667)),
            (o.centroid - g).norm(),
        ];
        let v = worst.entry(format!("{} {} {}", w[0], w[1], w[2])).or_default();
        for i in 0..3 {
            v[i] = v[i].max(e[i]);
        }
    }
    for (k, v) in worst {
        println!("{k:20} V {:.1e} S {:.1e} centroid {:.1e}", v[0], v[1], v[2]);
    }
}
#[test]
#[ignore]
fn cubeonly() {
    super::speed::measure("cube, 12 triangles", &cube(), 0.5, 0.05);
    super::speed::measure("cube, 6 squares", &quads([-1.0; 3], [1.0; 3]), 0.5, 0.05);
    super::speed::measure("icosahedron, 20 triangles", &icosphere(1.0, 0), 0.5, 0.05);
}
#[test]
#[ignore]
fn fineonly() {
    super::speed::measure("sphere, 1280 triangles", &icosphere(1.0, 3), 0.5, 0.05);
    super::speed::picked();
}
#[test]
#[ignore]
fn debug_edge() {
    use super::super::face::Face;
    let b = tetrahedron([[-2.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.25, 3.0, -3.0], [0.5, -3.0, -2.5]]);
    let c = Point::new(0.0, 0.0, 1.0 - 0.5f64.powi(10));
    for f in &b.faces {
        let x = f.map(|i| b.vertices[i as usize] - c);
        if let Some(face) = Face::new(&x) {
            println!("{f:?} {:?}", face.part(&mut [[0.0; 2]; 3], |i, _| println!("cut {i}")));
        }
    }
    let b = cube();
    for f in &b.faces {
        let x = f.map(|i| (b.vertices[i as usize] - Point::new(1e6, 0.0, 0.0)) * 1e-6);
        if let Some(face) = Face::new(&x) {
            println!("{f:?} {:?}", face.part(&mut [[0.0; 2]; 3], |i, _| println!("cut {i}")));
        }
    }
}
#[test]
#[ignore]
fn pickedonly() {
    super::speed::picked();
}
