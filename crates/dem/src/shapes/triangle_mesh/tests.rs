//! Mass, distances and signs of meshes; what is refused.
mod admission;
mod cost;
mod crossings;
mod large;
mod reading;
mod signs;

use super::*;
use crate::shapes::icosphere;
use interfaces::Pose;
use proptest::prelude::*;
use std::f64::consts::PI;

type Faces = (Vec<[f64; 3]>, Vec<[u32; 3]>);

/// A box from `low` to `high`, its faces outward.
fn brick(low: [f64; 3], high: [f64; 3]) -> Faces {
    let vertices =
        (0..8).map(|i| [0, 1, 2].map(|a| if i >> a & 1 == 1 { high[a] } else { low[a] })).collect();
    let quads: [[u32; 4]; 6] =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    (vertices, quads.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect())
}

fn inverted((vertices, mut faces): Faces) -> Faces {
    faces.iter_mut().for_each(|f| f.swap(1, 2));
    (vertices, faces)
}

fn joined((mut vertices, mut faces): Faces, (more, others): Faces) -> Faces {
    let first = vertices.len() as u32;
    vertices.extend(more);
    faces.extend(others.into_iter().map(|f| f.map(|v| v + first)));
    (vertices, faces)
}

/// A star of five rays, 1 m thick: concave, with sharp edges.
fn star() -> Faces {
    let mut vertices = Vec::new();
    for z in [-0.5, 0.5] {
        for i in 0..10 {
            let (r, angle) = (if i % 2 == 0 { 1.0 } else { 0.35 }, PI * f64::from(i) / 5.0);
            vertices.push([r * angle.cos(), r * angle.sin(), z]);
        }
        vertices.push([0.0, 0.0, z]);
    }
    let mut faces = Vec::new();
    for i in 0..10_u32 {
        let j = (i + 1) % 10;
        faces.extend([[i, j, 11 + j], [i, 11 + j, 11 + i], [10, j, i], [21, 11 + i, 11 + j]]);
    }
    (vertices, faces)
}

/// Does a ray from `x` cross the faces an odd number of times? In a direction that no edge has.
fn inside_by_parity((vertices, faces): &Faces, x: Point) -> bool {
    let ray = Vector::new(0.5415, 0.7812, 0.3107);
    let crossed = faces.iter().filter(|face| {
        let [a, b, c] = face.map(|v| Point::from(vertices[v as usize]) - x);
        let side = |p: Vector, q: Vector| ray.dot(&p.cross(&q)) > 0.0;
        let all = [side(a, b), side(b, c), side(c, a)];
        let volume = a.dot(&b.cross(&c));
        // The ray's line passes within; the face is ahead.
        all[0] == all[1] && all[1] == all[2] && (volume > 0.0) == all[0]
    });
    crossed.count() % 2 == 1
}

/// Distance to the nearest of all faces.
fn brute_distance((vertices, faces): &Faces, x: Point) -> f64 {
    let distances = faces.iter().map(|face| {
        let [a, b, c] = face.map(|v| Vector::from(vertices[v as usize]));
        // Minimises over the plane and the three edges, each by itself.
        let n = (b - a).cross(&(c - a));
        let height = n.dot(&(x.coords - a)) / n.norm();
        let foot = x.coords - n * (height / n.norm());
        let within = [(a, b), (b, c), (c, a)].iter().all(|(p, q)| n.dot(&(q - p).cross(&(foot - p))) >= 0.0);
        let edge = |p: Vector, q: Vector| {
            let t = ((x.coords - p).dot(&(q - p)) / (q - p).norm_squared()).clamp(0.0, 1.0);
            (x.coords - p - (q - p) * t).norm()
        };
        let edges = edge(a, b).min(edge(b, c)).min(edge(c, a));
        if within { height.abs().min(edges) } else { edges }
    });
    distances.fold(f64::INFINITY, f64::min)
}

fn made((vertices, faces): &Faces) -> TriangleMesh {
    TriangleMesh::new(vertices, faces).unwrap()
}

#[test]
fn mass_of_a_brick() {
    let mesh = made(&brick([1.0, 2.0, 3.0], [3.0, 5.0, 7.0]));
    let i = mesh.inertia(2.0);
    assert!((mesh.volume() - 24.0).abs() < 1e-12 && (i.mass - 48.0).abs() < 1e-12);
    assert!((mesh.origin() - Point::new(2.0, 3.5, 5.0)).norm() < 1e-14);
    let exact = [25.0, 20.0, 13.0].map(|s| 48.0 / 12.0 * s);
    for a in 0..3 {
        for b in 0..3 {
            assert!((i.tensor[(a, b)] - if a == b { exact[a] } else { 0.0 }).abs() < 1e-11, "{}", i.tensor);
        }
    }
    assert!((mesh.aabb().min - Point::new(-1.0, -1.5, -2.0)).norm() < 1e-14);
    // Inside out it is the same body.
    let turned = made(&inverted(brick([1.0, 2.0, 3.0], [3.0, 5.0, 7.0])));
    assert!((turned.volume() - 24.0).abs() < 1e-12 && turned.signed_distance(Point::origin(), 9.0) < 0.0);
}

/// Far from the origin no digits are lost; a sphere's moments converge with the tessellation.
#[test]
fn mass_of_spheres() {
    let errors = [3, 4].map(|times| {
        let (vertices, faces) = icosphere(0.5, times);
        let far: Vec<_> = vertices.iter().map(|v| [v[0] + 1e4, v[1] - 2e4, v[2]]).collect();
        let i = TriangleMesh::new(&far, &faces).unwrap().inertia(1.0);
        let near = TriangleMesh::new(&vertices, &faces).unwrap().inertia(1.0);
        assert!((i.volume / near.volume - 1.0).abs() < 1e-9);
        assert!((i.tensor - near.tensor).norm() < 1e-9);
        let exact = 0.1 * PI / 6.0;
        (near.tensor[(2, 2)] / exact - 1.0).abs()
    });
    assert!(errors[1] < 0.26 * errors[0] && errors[1] < 0.01, "{errors:?}");
    assert_eq!(TriangleMesh::sphere(1.0, 5).unwrap().n_faces(), 20_480);
}

#[test]
fn bad_meshes_are_named() {
    let sphere = || icosphere(1.0, 1);
    let fails = |(vertices, faces): Faces| TriangleMesh::new(&vertices, &faces).unwrap_err();
    let (vertices, mut faces) = sphere();
    assert_eq!(fails((vertices.clone(), vec![])), MeshError::Empty { vertices: 42 });
    faces.remove(17);
    let MeshError::NotClosed { count: 3, faces: open } = fails((vertices, faces)) else { panic!() };
    assert_eq!(open.len(), 3);

    let (vertices, mut faces) = sphere();
    faces[5].swap(0, 1);
    let MeshError::Inconsistent { count: 3, faces: pairs } = fails((vertices, faces)) else { panic!() };
    assert!(pairs.iter().all(|p| p.contains(&5)), "{pairs:?}");

    let (mut vertices, mut faces) = sphere();
    faces[3][1] = 99;
    assert!(matches!(fails((vertices.clone(), faces)), MeshError::NoVertex { face: 3, vertex: 99, .. }));
    vertices[7][1] = f64::NAN;
    assert!(matches!(fails((vertices, sphere().1)), MeshError::NotFinite { vertex: 7, .. }));

    let (vertices, mut faces) = sphere();
    faces.push([4, 5, 4]);
    assert_eq!(fails((vertices, faces)), MeshError::Degenerate { count: 1, faces: vec![80] });

    // Both sides of one triangle; two boxes that share an edge.
    let flat = (vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2], [0, 2, 1]]);
    assert!(matches!(fails(flat), MeshError::Flat { .. }));
    let (a, b) = (brick([0.0; 3], [1.0; 3]), brick([1.0, 1.0, 0.0], [2.0, 2.0, 1.0]));
    let (vertices, mut faces) = joined(a, b);
    // The second's edge at x = y = 1 is made the first's.
    faces.iter_mut().flatten().for_each(|v| {
        *v = if *v == 8 {
            3
        } else if *v == 12 {
            7
        } else {
            *v
        }
    });
    assert!(matches!(fails((vertices, faces)), MeshError::NotManifold { count: 1, .. }));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]
    /// The distance from a tessellated sphere is that of the sphere within its sagitta.
    #[test]
    fn distances_from_a_sphere(x in -1.0..1.0_f64, y in -1.0..1.0_f64, z in -1.0..1.0_f64) {
        let faces = icosphere(0.5, 3);
        let mesh = made(&faces);
        let exact = Vector::new(x, y, z).norm() - 0.5;
        let d = mesh.signed_distance(Point::new(x, y, z), 10.0);
        // The faces are inside the sphere, no deeper than the inscribed one.
        prop_assert!(d >= exact - 1e-12 && d < exact + 0.004, "{d} {exact}");
        prop_assert!((d.abs() - brute_distance(&faces, Point::new(x, y, z))).abs() < 1e-12);
    }

    /// Sign and distance of a concave body with sharp edges and of one with a cavity.
    #[test]
    fn sign_is_that_of_ray_parity(x in -1.3..1.3_f64, y in -1.3..1.3_f64, z in -1.0..1.0_f64) {
        let hollow = joined(brick([-1.0; 3], [1.0; 3]), inverted(brick([-0.6, -0.7, -0.5], [0.5, 0.6, 0.7])));
        for faces in [star(), hollow] {
            let mesh = made(&faces);
            let p = Point::new(x, y, z);
            let d = mesh.signed_distance(p - mesh.origin().coords, 10.0);
            prop_assert!((d.abs() - brute_distance(&faces, p)).abs() < 1e-12, "{d}");
            prop_assert!(d.abs() < 1e-9 || (d < 0.0) == inside_by_parity(&faces, p), "{p}: {d}");
        }
    }

    /// Points on the axes of vertices and edges, where several faces are equally near.
    #[test]
    fn sign_beyond_corners_and_edges(i in 0_usize..22, j in 0_usize..22, t in 0.0..1.0_f64, far in -0.5..0.5_f64) {
        let faces = star();
        let mesh = made(&faces);
        let [a, b] = [i, j].map(|k| Vector::from(faces.0[k]));
        let p = Point::from((a * t + b * (1.0 - t)) * (1.0 + far));
        let d = mesh.signed_distance(p - mesh.origin().coords, 10.0);
        prop_assert!(d.abs() < 1e-9 || (d < 0.0) == inside_by_parity(&faces, p), "{p}: {d}");
    }

    /// A batch answers like single points, within the band; beyond it the sign holds.
    #[test]
    fn batches_answer_alike(
        start in prop::array::uniform3(-1.2..1.2_f64), step in prop::array::uniform3(-0.2..0.2_f64), band in 0.01..1.0_f64,
    ) {
        let faces = star();
        let mesh = made(&faces);
        let points: Vec<Point> = (0..60).map(|i| Point::from(start) + Vector::from(step) * f64::from(i % 23)).collect();
        let mut out = vec![f64::NAN; 60];
        mesh.signed_distances(&points, band, &mut out);
        for (x, d) in points.iter().zip(&out) {
            let exact = mesh.signed_distance(*x, f64::INFINITY);
            if exact.abs() < band {
                prop_assert!((d - exact).abs() < 1e-13, "{d} {exact}");
            } else {
                prop_assert!(d.abs() >= band && d.abs() <= exact.abs() + 1e-13, "{d} {exact} {band}");
            }
            prop_assert!(exact == 0.0 || d.signum() == exact.signum());
        }
    }

    /// Normals point where the distance grows.
    #[test]
    fn normals_are_gradients(x in -1.3..1.3_f64, y in -1.3..1.3_f64, z in -1.0..1.0_f64) {
        let mesh = made(&star());
        let p = Point::new(x, y, z);
        let (d, n) = (mesh.signed_distance(p, 10.0), mesh.normal(p, 1.0));
        prop_assert!((n.norm() - 1.0).abs() < 1e-12);
        let foot = p - n * d;
        prop_assert!(mesh.signed_distance(foot, 1.0).abs() < 1e-12);
    }
}

#[test]
fn small_convex_meshes_are_cut_like_hulls() {
    let cube = made(&brick([-0.5; 3], [0.5; 3]));
    let ball = made(&icosphere(1.0, 2));
    assert!(matches!(cube.form(), Form::Hull(_)));
    // Too large, and not convex.
    assert!(matches!(ball.form(), Form::Facets(_)));
    assert!(matches!(made(&star()).form(), Form::Facets(_)));
    let mut dented = icosphere(1.0, 0);
    dented.0[0] = dented.0[0].map(|x| 0.2 * x);
    assert!(matches!(made(&dented).form(), Form::Facets(_)));
    // A fold of 1e-11 along the diagonal of a face is no round-off: inwards it is not convex, outwards it is.
    let folded = [-1e-11, 1e-11].map(|step| {
        let mut faces = brick([-0.5; 3], [0.5; 3]);
        faces
            .0
            .iter_mut()
            .for_each(|v| v[0] += if v[1] * v[2] * v[0] > 0.0 { step * v[0].signum() } else { 0.0 });
        matches!(made(&faces).form(), Form::Hull(_))
    });
    assert!(folded.contains(&false), "{folded:?}");
    let at = Pose {
        position: Point::new(0.7, 0.5, 0.6),
        orientation: interfaces::Rotation::from_scaled_axis(Vector::new(0.3, -0.5, 0.2)),
    };
    let by = |route| {
        let mut solver = crate::OverlapSolver::new().with_route(Some(route));
        solver.solve(&cube, &Pose::at([0.0; 3]), &cube, &at).unwrap()[0]
    };
    let (cut, crossed) = (by(crate::Route::Clip), by(crate::Route::Crossings));
    assert!((cut.volume - crossed.volume).abs() < 1e-15, "{} {}", cut.volume, crossed.volume);
    assert!((cut.gradient - crossed.gradient).norm() < 1e-14);
    assert!((cut.moment - crossed.moment).norm() < 1e-14);
}
