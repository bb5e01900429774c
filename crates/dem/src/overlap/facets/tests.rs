//! Overlaps of triangle meshes against closed forms and one another.
use super::{FacetOverlap, Overlap};
use crate::shapes::Facets;
use approx::assert_relative_eq;
use interfaces::{Point, Pose, Rotation, Vector};
use std::f64::consts::{FRAC_PI_4, SQRT_2};

fn facets(vertices: &[[f64; 3]], faces: &[[u32; 3]]) -> Facets {
    Facets::new(vertices.iter().map(|v| Vector::from(*v)).collect(), faces.to_vec()).unwrap()
}

/// A box around the origin.
fn brick(size: [f64; 3]) -> Facets {
    let corner = |i: u32| [0, 1, 2].map(|a| if i >> a & 1 == 1 { 0.5 * size[a] } else { -0.5 * size[a] });
    let vertices: Vec<_> = (0..8).map(corner).collect();
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let faces: Vec<_> = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    facets(&vertices, &faces)
}

fn solve(a: &Facets, at_a: &Pose, b: &Facets, at_b: &Pose) -> Vec<Overlap> {
    let mut out = Vec::new();
    FacetOverlap::default().overlap(a, at_a, b, at_b, &mut out).unwrap();
    out
}

fn turned(position: [f64; 3], about: Vector) -> Pose {
    Pose { position: position.into(), orientation: Rotation::from_scaled_axis(about) }
}

/// Unit cubes, the second moved and turned, in both orders.
fn cubes(at: Pose) -> Option<Overlap> {
    let cube = brick([1.0; 3]);
    let origin = Pose::at([0.0; 3]);
    let (one, two) = (solve(&cube, &origin, &cube, &at), solve(&cube, &at, &cube, &origin));
    assert!(one.len() <= 1 && two.len() <= 1);
    if let (Some(one), Some(two)) = (one.first(), two.first()) {
        assert_relative_eq!(one.volume, two.volume, epsilon = 1e-14);
    }
    one.first().copied()
}

#[test]
fn closed_forms_of_the_reference_page() {
    let o = cubes(Pose::at([0.9, 0.8, 0.7])).unwrap();
    assert_relative_eq!(o.volume, 0.006, epsilon = 1e-15);
    assert_relative_eq!(o.centroid, Point::new(0.45, 0.40, 0.35), epsilon = 1e-13);
    // The first moves along x: less and less is shared.
    assert_relative_eq!(o.gradient, Vector::new(0.06, 0.03, 0.02), epsilon = 1e-15);
    let o = cubes(turned([0.0; 3], Vector::z() * FRAC_PI_4)).unwrap();
    assert_relative_eq!(o.volume, 2.0 * (SQRT_2 - 1.0), epsilon = 1e-14);
    let diagonal = Vector::repeat(1.0).normalize();
    let o = cubes(turned([0.0; 3], diagonal * std::f64::consts::FRAC_PI_3)).unwrap();
    assert_relative_eq!(o.volume, 0.75, epsilon = 1e-14);
    let o = cubes(turned([0.5 + SQRT_2 / 2.0 - 0.1, 0.0, 0.0], Vector::z() * FRAC_PI_4)).unwrap();
    assert_relative_eq!(o.volume, 0.01, epsilon = 1e-14);
    let orientation = Rotation::from_scaled_axis(Vector::z() * 30f64.to_radians())
        * Rotation::from_scaled_axis(Vector::x() * 20f64.to_radians());
    let o = cubes(Pose { position: Point::new(0.6, 0.3, 0.2), orientation }).unwrap();
    assert_relative_eq!(o.volume, 0.23487641844, epsilon = 1e-11);
    assert_relative_eq!(o.centroid, Point::new(0.30536, 0.16032, 0.10173), epsilon = 1e-5);
}

#[test]
fn a_corner_goes_in() {
    // The corner's diagonal along x.
    let turn = Rotation::rotation_between(&Vector::repeat(-1.0), &-Vector::x()).unwrap();
    let d = 0.1;
    let at = Pose { position: Point::new(0.5 + 3f64.sqrt() / 2.0 - d, 0.0, 0.0), orientation: turn };
    assert_relative_eq!(cubes(at).unwrap().volume, 3f64.sqrt() / 2.0 * d.powi(3), epsilon = 1e-15);
}

#[test]
fn identical_and_stacked() {
    assert_relative_eq!(cubes(Pose::at([0.0; 3])).unwrap().volume, 1.0, epsilon = 1e-14);
    for (at, volume) in [
        ([0.98, 0.0, 0.0], 0.02),
        ([0.0, 0.98, 0.0], 0.02),
        ([0.0, 0.0, 0.98], 0.02),
        ([0.5, 0.5, 0.0], 0.25),
        ([0.0, -0.5, 0.5], 0.25),
    ] {
        assert_relative_eq!(cubes(Pose::at(at)).unwrap().volume, volume, epsilon = 1e-14);
    }
    for at in [
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 1.0],
        [1.0, 1.0, 1.0],
        [1.0, 0.3, 0.2],
        [-1.0, 0.0, 0.5],
    ] {
        let volume = cubes(Pose::at(at)).map_or(0.0, |o| o.volume);
        assert!(volume.abs() < 1e-14, "{at:?} {volume}");
    }
    for at in [[1.1, 0.0, 0.0], [0.0, 0.0, -3.0], [1e9, 0.0, 0.0]] {
        assert!(cubes(Pose::at(at)).is_none());
    }
}

#[test]
fn contained() {
    let (small, large) = (brick([0.5; 3]), brick([2.0; 3]));
    for at in [[0.0; 3], [0.1, -0.2, 0.3], [0.75, 0.75, 0.75], [0.75, 0.0, -0.75]] {
        for patches in [
            solve(&small, &Pose::at(at), &large, &Pose::at([0.0; 3])),
            solve(&large, &Pose::at([0.0; 3]), &small, &Pose::at(at)),
        ] {
            assert_eq!(patches.len(), 1);
            assert_relative_eq!(patches[0].volume, 0.125, epsilon = 1e-14);
            assert_relative_eq!(patches[0].centroid, Point::from(at), epsilon = 1e-14);
        }
    }
}

/// A cube of three by three quads a face, each of two triangles.
fn gridded(edge: f64) -> Facets {
    const N: u32 = 3;
    let (mut vertices, mut faces): (Vec<[f64; 3]>, Vec<[u32; 3]>) = Default::default();
    let mut numbers = std::collections::HashMap::new();
    let mut vertex = |grid: [u32; 3]| {
        *numbers.entry(grid).or_insert_with(|| {
            vertices.push(grid.map(|i| edge * (f64::from(i) / f64::from(N) - 0.5)));
            vertices.len() as u32 - 1
        })
    };
    for (axis, side) in (0..3).flat_map(|a| [(a, 0), (a, N)]) {
        for (i, j) in (0..N).flat_map(|i| (0..N).map(move |j| (i, j))) {
            let corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]].map(|[u, v]| {
                let mut grid = [side; 3];
                (grid[(axis + 1) % 3], grid[(axis + 2) % 3]) = (u, v);
                vertex(grid)
            });
            let [p, q, r, s] = corners;
            faces.extend(if side == 0 { [[p, r, q], [p, s, r]] } else { [[p, q, r], [p, r, s]] });
        }
    }
    facets(&vertices, &faces)
}

/// A cube flush in the corner of a larger one, both turned alike: rounding decides for every vertex on which side of the
/// other surface it is.
#[test]
fn flush_corners_share_all_of_the_smaller_cube() {
    let (large, small) = (gridded(1.0), gridded(0.3));
    let mut draw = crate::draw::Draw(3);
    for _ in 0..3000 {
        let turn = draw.turn();
        let at = Pose { position: (turn * Vector::repeat(0.35)).into(), orientation: turn };
        let still = Pose { position: Point::origin(), orientation: turn };
        for found in [solve(&large, &still, &small, &at), solve(&small, &at, &large, &still)] {
            let volume: f64 = found.iter().map(|o| o.volume).sum();
            assert_relative_eq!(volume, 0.027, epsilon = 1e-14);
        }
    }
    // Boxes of different edges, flush in one corner.
    let (large, small) = (brick([0.924, 0.764, 0.735]), brick([0.552, 0.319, 0.320]));
    let shift = [0.5 * (0.924 - 0.552), 0.5 * (0.764 - 0.319), 0.5 * (0.735 - 0.320)];
    let volume: f64 =
        solve(&large, &Pose::at([0.0; 3]), &small, &Pose::at(shift)).iter().map(|o| o.volume).sum();
    assert_relative_eq!(volume, 0.552 * 0.319 * 0.320, epsilon = 1e-15);
}
