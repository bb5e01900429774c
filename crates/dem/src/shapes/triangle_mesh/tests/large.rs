//! Surfaces that cost trees of boxes most: many faces around a vertex, narrow faces, many shells.
use interfaces::{Rotation, Vector};
use std::f64::consts::PI;

type Faces = (Vec<[f64; 3]>, Vec<[u32; 3]>);

/// Points on a circle of radius 1 at height `z(i)`.
fn ring(n: u32, z: impl Fn(u32) -> f64) -> Vec<[f64; 3]> {
    let at = |i: u32| {
        let (sin, cos) = (2.0 * PI * f64::from(i) / f64::from(n)).sin_cos();
        [cos, sin, z(i)]
    };
    (0..n).map(at).collect()
}

/// Two fans of n faces each between a ring and points on its axis.
fn double_fan(n: u32, height: f64, z: impl Fn(u32) -> f64) -> Faces {
    let mut vertices = ring(n, z);
    vertices.extend([[0.0, 0.0, -height], [0.0, 0.0, height]]);
    let faces = (0..n).flat_map(|i| [[n, (i + 1) % n, i], [n + 1, i, (i + 1) % n]]);
    (vertices, faces.collect())
}

/// A cylinder of 4n faces, each of its ends a fan.
fn can(n: u32, radius: f64) -> Faces {
    let mut vertices = ring(n, |_| 0.0);
    vertices.extend(ring(n, |_| 1.0));
    vertices.iter_mut().for_each(|v| (v[0], v[1]) = (radius * v[0], radius * v[1]));
    vertices.extend([[0.0; 3], [0.0, 0.0, 1.0]]);
    let faces = (0..n).flat_map(|i| {
        let j = (i + 1) % n;
        [[2 * n, j, i], [2 * n + 1, n + i, n + j], [i, j, n + j], [i, n + j, n + i]]
    });
    (vertices, faces.collect())
}

/// n³ tetrahedra apart from one another.
fn crowd(n: u32) -> Faces {
    let corners = [[0.0; 3], [0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.5]];
    let one = |i: u32| {
        let place = [i % n, i / n % n, i / (n * n)].map(f64::from);
        let vertices: Vec<[f64; 3]> = corners.iter().map(|c| [0, 1, 2].map(|a| c[a] + place[a])).collect();
        (vertices, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    };
    let mut all = Faces::default();
    for (vertices, faces) in (0..n.pow(3)).map(one) {
        let first = all.0.len() as u32;
        all.0.extend(vertices);
        all.1.extend(faces.into_iter().map(|f: [u32; 3]| f.map(|v| v + first)));
    }
    all
}

fn turned((vertices, faces): Faces) -> Faces {
    let turn = Rotation::from_scaled_axis(Vector::new(0.3, 0.7, 1.1));
    (vertices.iter().map(|v| (turn * Vector::from(*v)).into()).collect(), faces)
}

/// Bodies of about n faces whose boxes along the axes meet by the thousand.
pub(crate) fn kinds(n: u32) -> Vec<(&'static str, Faces)> {
    let zigzag = |i: u32| if i.is_multiple_of(2) { 0.5 } else { -0.5 };
    vec![
        ("can", can(n / 4, 1.0)),
        ("turned can", turned(can(n / 4, 1.0))),
        ("strips", turned(can(n / 4, 1e-2))),
        ("double fan", turned(double_fan(n / 2, 1.0, |_| 0.0))),
        ("flat double fan", turned(double_fan(n / 2, 1e-3, |_| 0.0))),
        ("needles", turned(double_fan(n / 2, 1e3, |_| 0.0))),
        ("crown", turned(double_fan(n / 4 * 2, 2.0, zigzag))),
        ("crowd", turned(crowd((f64::from(n) / 4.0).cbrt() as u32))),
    ]
}
