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
