use crate::testing::{Balls, Brick, Faceted, Staggered};
use crate::{IbmError, cut_cells, cut_walls};
use interfaces::{Aabb, BodyId, Point, Pose, Rotation, Solid, ThinPart, Vector};
use std::f64::consts::PI;

/// Faces of `n` cells over 4 m.
fn sides(n: usize) -> Vec<f64> {
    (0..=n).map(|i| 4.0 * i as f64 / n as f64).collect()
}

/// Bounded sides on all axes, cells 0.1 m (2D) and 0.2 m (3D) wide; `along_x` cells along x.
fn bounded(dim: usize, along_x: usize) -> Staggered {
    let (x, y) = (sides(along_x), sides(if dim == 2 { 40 } else { 20 }));
    if dim == 2 { Staggered::between([&x[..], &y]) } else { Staggered::between([&x[..], &y, &y]) }
}

/// Thin parts by both kinds of cuts.
fn both(field: &Staggered, bodies: &Balls) -> [Result<Vec<ThinPart>, IbmError>; 2] {
    [cut_walls(field, bodies).map(|walls| walls.thin), cut_cells(field, bodies).map(|cells| cells.thin)]
}

/// Bodies that leave no node inside the box: beyond a side, touching it from outside, beyond an edge or a corner.
#[test]
fn a_body_outside_the_box_is_an_error() {
    for (dim, along_x) in [(2, 40), (2, 2), (2, 1), (3, 20), (3, 2)] {
        let flat = if dim == 2 { 0.0 } else { 1.0 };
        let field = bounded(dim, along_x);
        for (x, y, z, axis) in [
            (-1.0, 2.0, 2.0, 0),
            (-0.5, 2.0, 2.0, 0),
            (7.0, 2.0, 2.0, 0),
            (2.0, -0.5, 2.0, 1),
            (2.0, 40.0, 2.0, 1),
            (-0.4, -0.39, 2.0, 0),
            (4.4, 4.41, 2.0, 1),
            (2.0, 2.0, -0.5, 2),
            (2.0, 4.4, 4.41, 2),
            (-0.3, -0.31, 4.32, 2),
        ] {
            if axis >= dim {
                continue;
            }
            let ball = Balls::new(dim, 0.5, vec![[x, y, flat * z]]);
            for found in both(&field, &ball) {
                let Err(IbmError::Outside { body, axis: along, low, high, box_ }) = found else {
                    panic!("{dim} {x} {y} {z}: {found:?}")
                };
                let centre = [x, y, z][axis];
                assert!(body == BodyId(0) && along == axis && box_ == [0.0, 4.0], "{along} {axis} {box_:?}");
                assert!((low - centre + 0.5).abs() < 1e-12 && (high - centre - 0.5).abs() < 1e-12);
            }
        }
        // A second body inside does not hide the first.
        let two = Balls::new(dim, 0.5, vec![[2.0, 2.0, 2.0 * flat], [2.0, -0.6, 2.0 * flat]]);
        if along_x > 2 {
            assert!(
                both(&field, &two)
                    .iter()
                    .all(|found| matches!(found, Err(IbmError::Outside { body: BodyId(1), axis: 1, .. })))
            );
        }
    }
}

/// Bodies that reach beyond sides are walls as long as nodes are inside, and there is no outside along periodic axes.
#[test]
fn bodies_partly_outside_are_walls() {
    for (x, y) in [(0.0, 2.0), (-0.2, 2.0), (2.0, 4.3), (0.1, 0.1), (-0.1, 4.1)] {
        for found in both(&bounded(2, 40), &Balls::new(2, 0.5, vec![[x, y, 0.0]])) {
            assert_eq!(found, Ok(vec![]), "{x} {y}");
        }
        for found in both(&bounded(3, 20), &Balls::new(3, 0.7, vec![[x, y, 2.0]])) {
            assert_eq!(found, Ok(vec![]), "{x} {y}");
        }
    }
    let periodic = Staggered::new([40, 40], 0.1, [0.0; 2]);
    for x in [-0.6, 4.6, 104.0, -51.3] {
        assert!(both(&periodic, &Balls::new(2, 0.5, vec![[x, 3.9, 0.0]])).iter().all(Result::is_ok));
    }
}

/// A plate of half-widths `half` at an angle about z (and, in 3D, tilted about x).
fn plate(dim: usize, thickness: f64, angle: f64, place: [f64; 2]) -> Balls {
    let flat = if dim == 2 { 0.0 } else { 1.0 };
    let mut pose = Pose::at([place[0], place[1], 2.0 * flat]);
    pose.orientation = Rotation::from_euler_angles(flat * 0.7 * angle, 0.0, angle.to_radians());
    if dim == 3 {
        pose.orientation = Rotation::from_scaled_axis(Vector::z() * angle.to_radians())
            * Rotation::from_scaled_axis(Vector::x() * (0.5 * angle).to_radians());
    }
    Balls::of(Brick([1.0, 0.5 * thickness, flat]), 1.0, vec![pose])
}

/// A plate is refused below max |n_a| h at any angle and place, and accepted above: links are cut wherever it is.
#[test]
fn thin_plates_are_errors_at_any_angle() {
    for dim in [2, 3] {
        let field = bounded(dim, if dim == 2 { 40 } else { 20 });
        let h = if dim == 2 { 0.1 } else { 0.2 };
        for angle in [0.0, 7.0, 20.0, 30.0, 45.0, 60.0, 81.0, 90.0, 135.0] {
            for place in [[2.0, 2.0], [2.013, 1.971]] {
                let normal = plate(dim, 1.0, angle, place).poses[0].orientation * Vector::y();
                let needed = h * normal.amax();
                for share in [0.1, 0.3, 0.6, 0.97] {
                    for found in both(&field, &plate(dim, share * needed, angle, place)) {
                        match found {
                            Err(IbmError::Unseen { .. }) => {}
                            Err(IbmError::Thin { part }) => {
                                // Normals at the plate's edges lie between those of its faces.
                                let ratio = part.thickness / (share * part.needed);
                                assert!((0.8..1.06).contains(&ratio), "{dim} {angle} {share} {part:?}");
                                assert!(part.share > 0.6, "{dim} {angle} {share} {part:?}");
                                assert!(
                                    part.needed > 0.999 * needed && part.needed <= h,
                                    "{part:?} {needed}"
                                );
                            }
                            found => panic!("{dim} {angle} {share}: {found:?}"),
                        }
                    }
                }
                for found in both(&field, &plate(dim, 1.03 * needed, angle, place)) {
                    let thin = found.unwrap();
                    assert!(thin.iter().all(|part| part.share < 0.1), "{dim} {angle} {thin:?}");
                }
            }
        }
    }
    let thin = cut_walls(&bounded(2, 40), &plate(2, 0.03, 30.0, [2.0, 2.0])).unwrap_err().to_string();
    assert!(thin.contains("thin") && thin.contains("3.00") && thin.contains(" % of its surface"), "{thin}");
}

/// Symmetric airfoil with thickness 12 % of the chord and a sharp trailing edge (NACA 0012), as a polygon in 2D; the distance is that
/// from the nearest of its edges.
struct Airfoil(Vec<Vector>);

impl Airfoil {
    fn new(chord: f64) -> Self {
        let half = |x: f64| {
            0.6 * (0.2969 * x.sqrt() - 0.1260 * x - 0.3516 * x * x + 0.2843 * x.powi(3) - 0.1036 * x.powi(4))
        };
        let n = 200;
        let at = |i: usize| {
            let t = 2.0 * PI * i as f64 / n as f64;
            let x = 0.5 * (1.0 + t.cos());
            Vector::new(x - 0.5, half(x).max(0.0) * t.sin().signum(), 0.0) * chord
        };
        Self((0..n).map(at).collect())
    }
}

impl Solid for Airfoil {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        let (mut least, mut inside) = (f64::INFINITY, false);
        for (i, a) in self.0.iter().enumerate() {
            let (b, p) = (self.0[(i + 1) % self.0.len()], x.coords);
            let t = ((p - a).dot(&(b - a)) / (b - a).norm_squared()).clamp(0.0, 1.0);
            least = least.min((p - a - (b - a) * t).norm());
            if (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y) {
                inside = !inside;
            }
        }
        if inside { -least } else { least }
    }
    fn aabb(&self) -> Aabb {
        let [min, max] = [0, 1].map(|side| {
            let best = if side == 0 { f64::min } else { f64::max };
            Point::from(self.0.iter().fold(self.0[0], |m, p| m.zip_map(p, best)))
        });
        Aabb { min, max }
    }
}

/// Ellipse of these half-axes; the distance is that from a polygon of its points.
fn ellipse(a: f64, b: f64) -> Airfoil {
    Airfoil(
        (0..256)
            .map(|i| (2.0 * PI * f64::from(i) / 256.0).sin_cos())
            .map(|(s, c)| Vector::new(a * c, b * s, 0.0))
            .collect(),
    )
}

/// Thin edges of thick bodies are named, with the share of the surface that they have.
#[test]
fn thin_parts_of_thick_bodies_are_named() {
    let field = Staggered::new([80, 80], 0.05, [0.0; 2]);
    let turned = |solid: Airfoil, angle: f64| {
        let mut pose = Pose::at([2.01, 1.98, 0.0]);
        pose.orientation = Rotation::from_scaled_axis(Vector::z() * angle.to_radians());
        Balls::of(solid, 1.0, vec![pose])
    };
    for angle in [0.0, 10.0, 33.0] {
        for found in both(&field, &turned(Airfoil::new(3.0), angle)) {
            let thin = found.unwrap();
            assert!(thin.len() == 1 && thin[0].body == 0, "{thin:?}");
            // Thickness 2 · 0.6 · 0.18 (1 − x) near the trailing edge.
            let tip =
                0.05 * f64::to_radians(angle).cos().max(f64::to_radians(angle).sin()) / (1.2 * 0.195 * 3.0);
            assert!((0.5 * tip..1.8 * tip).contains(&thin[0].share), "{tip} {thin:?}");
            let place = turned(Airfoil::new(3.0), angle).poses[0].to_body(thin[0].place);
            assert!(place.x > 1.2, "{place}");
        }
    }
    // An ellipse is thinner than a share h/2b of its middle's thickness on 1 − √(1 − (h/2b)²) of its length.
    for (b, refused) in [(0.02, true), (0.0275, true), (0.03, false), (0.06, false)] {
        for found in both(&field, &turned(ellipse(1.5, b), 0.0)) {
            match found {
                Ok(thin) => {
                    let share = 1.0 - (1.0 - (0.025_f64 / b).powi(2)).sqrt();
                    assert!(!refused && (thin[0].share - share).abs() < 0.05, "{b} {share} {thin:?}");
                }
                Err(IbmError::Unseen { .. }) => assert!(refused, "{b}"),
                Err(IbmError::Thin { part }) => assert!(refused && part.share > 0.5, "{b} {part:?}"),
                found => panic!("{b}: {found:?}"),
            }
        }
    }
}

/// Thick bodies have no thin parts, whatever lies next to them: edges, corners, narrow gaps, liners on other bodies and on sides.
#[test]
fn narrow_gaps_and_liners_are_not_thin() {
    let field = bounded(2, 40);
    let at = |x: f64, y: f64| Pose::at([x, y, 0.0]);
    let bricks = Balls::of(Brick([0.5, 0.3, 0.0]), 0.6, vec![at(2.0, 1.0), at(2.0, 1.63), at(2.7, 2.301)]);
    for found in both(&field, &bricks) {
        assert_eq!(found, Ok(vec![]));
    }
    let diamond = Balls::of(Brick([0.3, 0.3, 0.0]), 0.36, vec![plate(2, 0.1, 45.0, [2.0, 2.0]).poses[0]]);
    for found in both(&field, &diamond) {
        assert_eq!(found, Ok(vec![]));
    }
    // Plates of 0.4 cells on each other, and one plate on a side of the box.
    let stacked = [0.0, 0.04, 0.08, 0.12].map(|y| at(2.0, 2.0 + y)).to_vec();
    for found in both(&field, &Balls::of(Brick([0.5, 0.0205, 0.0]), 0.1, stacked)) {
        assert!(!matches!(found, Err(IbmError::Thin { .. })), "{found:?}");
    }
}

/// Meshes: hollow ones are as thin as their walls.
#[test]
fn hollow_meshes_are_thin() {
    let field = bounded(3, 20);
    let ball = Faceted::sphere(1.0, 1);
    let whole = Balls::of(ball.clone(), 4.0, vec![Pose::at([2.01, 2.02, 1.99])]);
    assert!(both(&field, &whole).iter().all(|found| found == &Ok(vec![])));
    struct Shell(Faceted, f64);
    impl Solid for Shell {
        fn signed_distance(&self, x: Point, band: f64) -> f64 {
            self.0.signed_distance(x, band).max(-self.0.signed_distance(x, band) - self.1)
        }
        fn aabb(&self) -> Aabb {
            self.0.aabb()
        }
    }
    let shell = Balls::of(Shell(ball, 0.08), 1.0, vec![Pose::at([2.01, 2.02, 1.99])]);
    for found in both(&field, &shell) {
        assert!(
            matches!(found, Err(IbmError::Thin { part }) if (part.thickness - 0.08).abs() < 0.02),
            "{found:?}"
        );
    }
}
