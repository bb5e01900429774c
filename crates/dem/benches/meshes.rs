//! CPU time of triangle meshes, the least of several: `cargo bench -p siltflow-dem --bench meshes`.
//!
//! Tessellated spheres: admission, report, reading, distances and winding numbers. Surfaces of 1e5 faces that are hard
//! for trees of boxes: admission and report.
#[path = "../src/shapes/triangle_mesh/tests/large.rs"]
mod large;

use cpu_time::ProcessTime;
use dem::{AdmissionReport, TriangleMesh, TriangleSoup};
use interfaces::{Point, Solid};
use std::hint::black_box;

fn best<T>(work: impl FnMut() -> T) -> f64 {
    best_of(10, work)
}

/// The least CPU time of several \[s\].
fn best_of<T>(times: usize, mut work: impl FnMut() -> T) -> f64 {
    let time = |_| {
        let start = ProcessTime::now();
        black_box(work());
        start.elapsed().as_secs_f64()
    };
    (0..times).map(time).fold(f64::INFINITY, f64::min)
}

/// As a binary STL file.
fn stl(vertices: &[[f64; 3]], faces: &[[u32; 3]]) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend((faces.len() as u32).to_le_bytes());
    for face in faces {
        bytes.extend([0; 12]);
        bytes.extend(face.iter().flat_map(|v| vertices[*v as usize]).flat_map(|x| (x as f32).to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

fn main() {
    for times in [3, 5] {
        let mesh = TriangleMesh::sphere(0.5, times).expect("a sphere");
        let vertices: Vec<[f64; 3]> = mesh.vertices().iter().map(|v| (*v).into()).collect();
        let faces = mesh.faces().to_vec();
        let file = stl(&vertices, &faces);
        let n = faces.len();
        println!("{n} triangles, ms:");
        println!("  made     {:8.2}", 1e3 * best(|| TriangleMesh::new(&vertices, &faces)));
        println!("  reported {:8.2}", 1e3 * best(|| AdmissionReport::of(&vertices, &faces, Some(0.1))));
        println!("  read     {:8.2}", 1e3 * best(|| TriangleSoup::from_stl_bytes(&file, 1.0)));
        let soup = TriangleSoup::from_stl_bytes(&file, 1.0).expect("a file");
        println!("  welded   {:8.2}", 1e3 * best(|| soup.clone().welded(1e-6)));
        let at = |i: i32| Point::new(0.011 * f64::from(i) - 0.5, 0.1, 0.2);
        let winding = best(|| (0..10).map(|i| mesh.winding_number(at(9 * i))).sum::<f64>()) / 10.0;
        println!("  winding number of a point {:.1} µs", 1e6 * winding);
        let distance =
            best(|| (0..100).map(|i| mesh.signed_distance(at(i), f64::INFINITY)).sum::<f64>()) / 100.0;
        println!("  distance of a point       {:.2} µs", 1e6 * distance);
    }
    for (kind, (vertices, faces)) in large::kinds(100_000) {
        let made = best_of(3, || TriangleMesh::new(&vertices, &faces).expect("a mesh"));
        let reported = best_of(3, || AdmissionReport::of(&vertices, &faces, Some(0.1)));
        println!("{kind}, {} triangles, s: made {made:.2}, reported {reported:.2}", faces.len());
    }
}
