//! Mass properties from signed distances against formulas.
use super::*;
use std::f64::consts::PI;

/// A distance, and a box.
#[derive(Debug)]
struct Given(fn(Vector) -> f64, [f64; 3]);

impl Solid for Given {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        (self.0)(x.coords)
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), self.1.into())
    }
}

/// Volume 2π²Rr², moments m(R² + ¾r²) about z and m(½R² + ⅝r²) about x.
#[test]
fn a_torus_converges() {
    let torus = || Given(|x| (x.x.hypot(x.y) - 0.7).hypot(x.z) - 0.3, [1.0, 1.0, 0.3]);
    for tolerance in [1e-2, 1e-3, 1e-4] {
        let i = Implicit::new("torus", torus(), tolerance).unwrap().inertia(2.0);
        let mass = 2.0 * 2.0 * PI * PI * 0.7 * 0.09;
        assert!((i.mass / mass - 1.0).abs() < tolerance, "{tolerance}: {i:?}");
        let about = [0.245 + 0.625 * 0.09, 0.245 + 0.625 * 0.09, 0.49 + 0.75 * 0.09];
        for a in 0..3 {
            assert!((i.tensor[(a, a)] / (mass * about[a]) - 1.0).abs() < 3.0 * tolerance);
        }
        assert!(i.tensor[(0, 1)].abs() + i.tensor[(1, 2)].abs() < tolerance * mass);
    }
}

/// A ball away from the origin of its frame, and a box that is turned: products of inertia.
#[test]
fn what_is_off_the_origin_is_moved_there() {
    let ball = Given(|x| (x - Vector::new(0.4, -0.3, 0.2)).norm() - 0.5, [1.0; 3]);
    let ball = Implicit::new("ball", ball, 1e-5).unwrap();
    assert!((ball.centre() - Point::new(0.4, -0.3, 0.2)).norm() < 1e-6);
    assert!(ball.signed_distance(Point::origin(), 1.0) + 0.5 < 1e-6);
    assert!((0.5..0.65).contains(&ball.bounding_radius()), "{}", ball.bounding_radius());
    let mut two = [0.0; 2];
    ball.signed_distances(&[Point::origin(), Point::new(1.0, 0.0, 0.0)], 1.0, &mut two);
    assert!((two[1] - 0.5).abs() < 1e-6);
    // Half-edges 0.6 and 0.3 along the diagonals of x and y, 0.2 along z.
    let brick = |x: Vector| {
        let half = 0.5_f64.sqrt();
        let q =
            Vector::new((half * (x.x + x.y)).abs() - 0.6, (half * (x.x - x.y)).abs() - 0.3, x.z.abs() - 0.2);
        q.map(|q| q.max(0.0)).norm() + q.max().min(0.0)
    };
    let i = Implicit::new("brick", Given(brick, [0.7, 0.7, 0.25]), 1e-3).unwrap().inertia(1.0);
    let volume: f64 = 8.0 * 0.6 * 0.3 * 0.2;
    let (long, short) = (volume * 0.36 / 3.0, volume * 0.09 / 3.0);
    assert!((i.volume / volume - 1.0).abs() < 1e-3);
    assert!((i.tensor[(0, 1)] + 0.5 * (long - short)).abs() < 2e-3 * volume, "{i:?}");
    assert!((i.tensor[(2, 2)] - long - short).abs() < 2e-3 * volume);
}

#[test]
fn what_makes_no_body_is_told() {
    let make = |given, tolerance| Implicit::new("x", given, tolerance).unwrap_err();
    assert!(matches!(make(Given(|x| x.norm() + 1.0, [1.0; 3]), 1e-2), DemError::Empty { .. }));
    assert!(matches!(make(Given(|x| x.norm() - 1.0, [1.0, 1.0, 0.0]), 1e-2), DemError::Bounds { .. }));
    assert!(matches!(make(Given(|x| x.norm() - 1.0, [1.0; 3]), 0.0), DemError::Refinement { .. }));
    let error = make(Given(|x| if x.x > 0.3 { f64::NAN } else { x.norm() - 1.0 }, [1.0; 3]), 1e-2);
    assert!(matches!(error, DemError::Distance { point: [x, ..], .. } if x > 0.3), "{error}");
}
