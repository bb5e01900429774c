//! CPU time per pair: `cargo test --release -p dem --lib ball_faces -- --ignored --nocapture`.
use super::bodies::*;
use super::*;
use cpu_time::ThreadTime;
use std::hint::black_box;

/// A body with the faces that a search tree would give.
struct Picked<'a>(&'a Body, Vec<[u32; 3]>);

impl Faces for Picked<'_> {
    fn n_corners(&self) -> usize {
        self.0.vertices.len()
    }
    fn corner(&self, i: u32) -> Point {
        self.0.vertices[i as usize]
    }
    fn each(&self, visit: impl FnMut(&[u32])) {
        self.0.each(visit);
    }
    fn near(&self, _centre: Point, _reach: f64, mut visit: impl FnMut(&[u32])) {
        self.1.iter().for_each(|f| visit(f));
    }
    fn convex(&self) -> bool {
        self.0.convex
    }
}

/// The least of several medians \[µs\].
fn cost(mut work: impl FnMut(usize)) -> f64 {
    let mut once = || {
        let start = ThreadTime::now();
        (0..400).for_each(&mut work);
        start.elapsed().as_secs_f64() * 1e6 / 400.0
    };
    let mut median = || {
        let mut all: Vec<f64> = (0..21).map(|_| once()).collect();
        all.sort_by(f64::total_cmp);
        all[10]
    };
    (0..5).map(|_| median()).fold(f64::INFINITY, f64::min)
}

/// Places all around a body of unit size, at which a ball of radius `r` is `depth` deep in it.
fn places(b: &impl Faces, r: f64, depth: f64) -> Vec<(Round, Pose)> {
    let turn = |i: usize| {
        let x = i as f64;
        Rotation::from_scaled_axis(Vector::new((1.7 * x).sin(), (2.3 * x).cos(), (0.9 * x).sin()) * 2.0)
    };
    (0..50)
        .map(|i| {
            let pose = Pose { position: Point::new(0.1, 0.2, -0.3), orientation: turn(3 * i + 1) };
            let way = turn(i) * Vector::z();
            let at = |d: f64| Round::ball(r, pose.position + way * d);
            // Where it just touches.
            let (mut low, mut high) = (0.0, 4.0 + r);
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                if volume(&at(middle), b, &pose) > 0.0 { low = middle } else { high = middle }
            }
            (at(low - depth), pose)
        })
        .collect()
}

fn measure(name: &str, b: &impl Faces, r: f64, depth: f64) {
    let places = places(b, r, depth);
    let (mut route, mut out) = (BallFaces::default(), Vec::new());
    let all = cost(|i| {
        out.clear();
        let (a, pose) = &places[i % places.len()];
        route.overlap(a, b, pose, &mut out);
        black_box(&out);
    });
    println!("{name:28} ball {r:6} depth {depth:6}: {all:8.3} µs");
}

#[test]
#[ignore = "prints CPU times"]
fn cpu_time_per_pair() {
    for (r, depth) in [(0.5, 0.005), (0.5, 0.05), (0.5, 0.4), (2.0, 0.02)] {
        measure("cube, 12 triangles", &cube(), r, depth);
        measure("cube, 6 squares", &quads([-1.0; 3], [1.0; 3]), r, depth);
        measure("icosahedron, 20 triangles", &icosphere(1.0, 0), r, depth);
        let fine = icosphere(1.0, 3);
        measure("sphere, 1280 triangles", &fine, r, depth);
        let plain = Body { convex: false, ..fine.clone() };
        measure("  not known to be convex", &plain, r, depth);
    }
}

/// The faces there, as from a tree.
#[test]
#[ignore = "prints CPU times"]
fn cpu_time_with_the_faces_at_hand() {
    let fine = icosphere(1.0, 3);
    for depth in [0.005, 0.05, 0.4] {
        let places = places(&fine, 0.5, depth);
        let (a, pose) = &places[0];
        let mut near = Vec::new();
        fine.near(pose.to_body(a.centre), 0.5, |f| near.push([f[0], f[1], f[2]]));
        let (faces, mut route, mut out) = (near.len(), BallFaces::default(), Vec::new());
        let picked = Picked(&fine, near);
        let all = cost(|_| {
            out.clear();
            route.overlap(a, &picked, pose, &mut out);
            black_box(&out);
        });
        println!("sphere, {faces} faces picked, depth {depth}: {all:.3} µs");
    }
}
