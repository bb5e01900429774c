//! Signs of distances against winding numbers and parity, where the nearest face's normal alone is wrong.
use super::*;
use std::f64::consts::TAU;

/// A cone of so many sides, from a base of radius `r` in z = 0 to `(0, 0, height)`.
fn cone(sides: u32, r: f64, height: f64) -> Faces {
    let ring = |i: u32| (TAU * f64::from(i) / f64::from(sides)).sin_cos();
    let mut vertices: Vec<[f64; 3]> = (0..sides).map(ring).map(|(s, c)| [r * c, r * s, 0.0]).collect();
    vertices.extend([[0.0; 3], [0.0, 0.0, height]]);
    let side = |i: u32| {
        let j = (i + 1) % sides;
        [[i, j, sides + 1], [j, i, sides]]
    };
    (vertices, (0..sides).flat_map(side).collect())
}

/// Over a plane bottom: a ring of high and low vertices around one between them, a saddle of so many valleys.
fn saddle(valleys: u32, height: f64) -> Faces {
    let n = 2 * valleys;
    let (mut vertices, faces) = cone(n, 1.0, 0.0);
    let top = n + 2;
    for i in 0..n {
        let [x, y, _] = vertices[i as usize];
        vertices.push([x, y, 1.0 + if i % 2 == 0 { height } else { -height }]);
    }
    vertices.push([0.0, 0.0, 1.0]);
    let bottom = faces.into_iter().skip(1).step_by(2);
    let rest = (0..n).flat_map(|i| {
        let j = (i + 1) % n;
        [[i, j, top + j], [i, top + j, top + i], [top + i, top + j, top + n]]
    });
    (vertices, bottom.chain(rest).collect())
}

fn hollow() -> Faces {
    joined(brick([-1.0; 3], [1.0; 3]), inverted(brick([-0.6, -0.7, -0.5], [0.5, 0.6, 0.7])))
}

/// A brick in a brick's cavity.
fn kernel() -> Faces {
    joined(hollow(), brick([-0.1, -0.2, -0.1], [0.2, 0.1, 0.1]))
}

/// Spikes, edges of a knife, saddles, plates and cavities.
fn bad_cases() -> Vec<Faces> {
    let tip = joined(cone(3, 0.01, 2.0), brick([-0.5, -0.5, -1.0], [0.5, 0.5, -1e-3]));
    let knife = (
        vec![
            [0.0, -1.0, 0.0],
            [0.0, 1.0, 0.0],
            [1.0, -1.0, 0.01],
            [1.0, 1.0, 0.01],
            [1.0, -1.0, -0.01],
            [1.0, 1.0, -0.01],
        ],
        vec![[0, 2, 3], [0, 3, 1], [0, 1, 5], [0, 5, 4], [2, 4, 5], [2, 5, 3], [0, 4, 2], [1, 3, 5]],
    );
    let plates = [1e-3, 1e-6, 1e-9].map(|h| brick([-1.0, -1.0, 0.0], [1.0, 1.0, h]));
    let mut cases = vec![star(), hollow(), kernel(), tip, knife, cone(12, 0.01, 1.0), cone(3, 1.0, 0.02)];
    cases.extend([saddle(2, 0.9), saddle(3, 0.5), saddle(5, 0.05)]);
    cases.extend(plates);
    cases
}

/// The sign that the normal of one of the nearest faces says.
fn by_nearest_normal((vertices, faces): &Faces, x: Point) -> bool {
    let distance = |f: &[u32; 3]| brute_distance(&(vertices.clone(), vec![*f]), x);
    let nearest = faces.iter().min_by(|f, g| distance(f).total_cmp(&distance(g))).unwrap();
    let [a, b, c] = nearest.map(|v| Point::from(vertices[v as usize]));
    (b - a).cross(&(c - a)).dot(&(x - a)) < 0.0
}

/// How often the sign is not that of winding number and parity, and that of the nearest face's normal is not, at points this
/// far from vertices, edges and faces.
fn wrong(faces: &Faces, near: f64, way: [f64; 3]) -> [usize; 2] {
    let mesh = made(faces);
    let (vertices, triangles) = faces;
    let mut wrong = [0, 0];
    for face in triangles {
        let [a, b, c] = face.map(|v| Vector::from(vertices[v as usize]));
        for from in [a, 0.5 * (a + b), 0.3 * a + 0.7 * b, (a + b + c) / 3.0] {
            for way in [Vector::from(way), -Vector::from(way)] {
                let p = Point::from(from + way * near);
                let local = p - mesh.origin().coords;
                let d = mesh.signed_distance(local, 10.0);
                assert!((d.abs() - brute_distance(faces, p)).abs() < 1e-12 * (1.0 + near), "{p} {d}");
                // The sign on the surface itself means nothing.
                if d.abs() < 1e-11 {
                    continue;
                }
                let (winding, parity) = (mesh.winding_number(local), inside_by_parity(faces, p));
                assert!(
                    (winding - winding.round()).abs() < 0.1 && (winding > 0.5) == parity,
                    "{p} {winding}"
                );
                wrong[0] += usize::from((d < 0.0) != parity);
                wrong[1] += usize::from(by_nearest_normal(faces, p) != parity);
            }
        }
    }
    wrong
}

#[test]
fn nearest_normals_alone_would_be_wrong() {
    let ways = (0..40).map(|i| {
        let (s, c) = (2.4 * f64::from(i)).sin_cos();
        let z = f64::from(i) / 20.0 - 0.975;
        let r = (1.0 - z * z).sqrt();
        [r * c, r * s, z]
    });
    let mut sum = [0, 0];
    for (i, way) in ways.enumerate() {
        for faces in bad_cases() {
            let [ours, nearest] = wrong(&faces, 10.0_f64.powi(-(i as i32) % 6), way);
            sum = [sum[0] + ours, sum[1] + nearest];
        }
    }
    assert!(sum[0] == 0 && sum[1] > 100, "{sum:?}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]
    /// At any distance from any corner, edge and face of any of them.
    #[test]
    fn signs_are_winding_numbers(case in 0..13_usize, near in -6.0..0.5_f64, way in prop::array::uniform3(-1.0..1.0_f64)) {
        prop_assert_eq!(wrong(&bad_cases()[case], 10.0_f64.powf(near), way)[0], 0);
    }

    /// Shells within one another: all around, or none.
    #[test]
    fn winding_numbers_count_shells(x in prop::array::uniform3(-1.2..1.2_f64)) {
        let (mesh, p) = (made(&kernel()), Point::from(x));
        let within = |low: [f64; 3], high: [f64; 3]| (0..3).all(|a| low[a] < x[a] && x[a] < high[a]);
        let solid = within([-1.0; 3], [1.0; 3]) && !within([-0.6, -0.7, -0.5], [0.5, 0.6, 0.7])
            || within([-0.1, -0.2, -0.1], [0.2, 0.1, 0.1]);
        let local = p - mesh.origin().coords;
        let expected = f64::from(u8::from(solid));
        prop_assert!((mesh.winding_number(local) - expected).abs() < 1e-12);
        prop_assert_eq!(mesh.signed_distance(local, 9.0) < 0.0, solid);
    }
}
