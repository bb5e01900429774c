//! What must hold wherever a ball or ellipsoid stands.
use super::bodies::*;
use super::*;
use approx::assert_relative_eq;
use nalgebra::Matrix3;
use proptest::prelude::*;

/// A body of some kind around the origin, about as large as 1.
fn body(kind: usize) -> Body {
    match kind {
        0 => cube().mapped(|x| Point::new(0.9 * x.x, 0.7 * x.y, 0.5 * x.z)),
        1 => tetrahedron([[-0.8, -0.7, -0.5], [1.1, -0.6, -0.4], [0.1, 1.2, -0.6], [0.0, 0.2, 1.3]]),
        2 => icosphere(0.8, 1),
        3 => l_block().mapped(|x| x - Vector::new(0.8, 0.7, 0.5)),
        _ => u_block().mapped(|x| x - Vector::new(1.5, 1.1, 0.5)),
    }
}

/// A ball or ellipsoid near the origin.
fn rounds() -> impl Strategy<Value = Round> {
    let three = |s: f64| prop::array::uniform3(-s..s).prop_map(Vector::from);
    (three(1.2), three(3.0), prop::array::uniform3(0.2..1.0f64), any::<bool>()).prop_map(
        |(at, turn, axes, plain)| {
            if plain {
                Round::ball(axes[0], Point::from(at))
            } else {
                let pose = Pose { position: Point::from(at), orientation: Rotation::from_scaled_axis(turn) };
                Round::ellipsoid(axes.into(), &pose)
            }
        },
    )
}
fn poses() -> impl Strategy<Value = Pose> {
    (prop::array::uniform3(-2.0..2.0f64), prop::array::uniform3(-2.0..2.0f64)).prop_map(|(at, turn)| Pose {
        position: Point::from(at),
        orientation: Rotation::from_scaled_axis(Vector::from(turn)),
    })
}

/// The round body and whatever it stands in, moved as one.
fn moved(a: &Round, by: &Pose) -> Round {
    Round { centre: by.to_world(a.centre), orientation: by.orientation * a.orientation, ..*a }
}
/// Turned by the rotation vector `turn` about `about`, then shifted.
fn shaken(a: &Round, shift: Vector, turn: Vector, about: Point) -> Round {
    let turn = Rotation::from_scaled_axis(turn);
    Round { centre: about + turn * (a.centre - about) + shift, orientation: turn * a.orientation, ..*a }
}
/// All regions taken together.
fn total(a: &Round, b: &impl Faces, at: &Pose) -> (f64, Vector, Vector) {
    regions(a, b, at).iter().fold((0.0, Vector::zeros(), Vector::zeros()), |(v, x, s), o| {
        (v + o.volume, x + o.volume * o.centroid.coords, s + o.gradient)
    })
}
fn whole(a: &Round) -> f64 {
    4.0 / 3.0 * std::f64::consts::PI * a.axes.product()
}
fn size(b: &Body) -> f64 {
    super::super::within(b).unwrap().0
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn moves_with_the_pair(a in rounds(), kind in 0..5usize, by in poses()) {
        let b = body(kind);
        let (one, two) = (regions(&a, &b, &origin()), regions(&moved(&a, &by), &b, &by));
        let smaller = whole(&a).min(size(&b));
        let sum = |all: &[Overlap]| all.iter().map(|o| o.volume).sum::<f64>();
        prop_assert!((sum(&one) - sum(&two)).abs() < 1e-12 * smaller);
        prop_assert!(sum(&one) <= smaller * (1.0 + 1e-12));
        if one.len() == two.len() {
            for (p, q) in one.iter().zip(&two) {
                assert_relative_eq!(by.orientation * p.gradient, q.gradient, epsilon = 1e-11);
                assert_relative_eq!(by.orientation * p.moment, q.moment, epsilon = 1e-11);
                if p.volume > 1e-4 * smaller {
                    assert_relative_eq!(by.to_world(p.centroid), q.centroid, epsilon = 1e-9);
                }
            }
        } else {
            // Only regions too small to be known come and go.
            let least = |all: &[Overlap]| all.iter().map(|o| o.volume).fold(f64::INFINITY, f64::min);
            prop_assert!(least(&one).min(least(&two)) < 1e-12 * smaller);
        }
    }

    /// Whatever is said of the body, the sums are the same; a ball is an ellipsoid.
    #[test]
    fn one_way_or_the_other(a in rounds(), kind in 0..3usize, by in poses()) {
        let b = body(kind);
        let plain = Body { convex: false, ..b.clone() };
        let (one, two) = (regions(&a, &b, &by), regions(&a, &plain, &by));
        prop_assert_eq!(one, two);
        let ball = Round { axes: Vector::repeat(0.7), ..a };
        let nearly = Round { axes: Vector::new(0.7, 0.7, 0.7 * (1.0 + 1e-15)), ..a };
        for (p, q) in regions(&ball, &b, &by).iter().zip(&regions(&nearly, &b, &by)) {
            assert_relative_eq!(p.volume, q.volume, max_relative = 1e-9, epsilon = 1e-13);
            assert_relative_eq!(p.gradient, q.gradient, epsilon = 1e-12);
            assert_relative_eq!(p.moment, q.moment, epsilon = 1e-12);
        }
    }

    /// A box cut in two, and a block of an L.
    #[test]
    fn additive(a in rounds(), at in -0.9..0.9f64, axis in 0..3usize) {
        let (mut low, mut high) = ([-0.9; 3], [0.9; 3]);
        let all = total(&a, &cuboid(low, high), &origin());
        (low[axis], high[axis]) = (at, at);
        let (one, two) = (total(&a, &cuboid([-0.9; 3], high), &origin()), total(&a, &cuboid(low, [0.9; 3]), &origin()));
        prop_assert!((all.0 - one.0 - two.0).abs() < 1e-12);
        assert_relative_eq!(all.1, one.1 + two.1, epsilon = 1e-12);
        assert_relative_eq!(all.2, one.2 + two.2, epsilon = 1e-12);
        let all = total(&a, &body(3), &origin());
        let part = |low: [f64; 3], high| total(&a, &cuboid(low, high).mapped(|x| x - Vector::new(0.8, 0.7, 0.5)), &origin());
        let (one, two) = (part([0.0; 3], [2.0, 1.0, 1.0]), part([0.0, 1.0, 0.0], [1.0, 2.0, 1.0]));
        prop_assert!((all.0 - one.0 - two.0).abs() < 1e-12);
        assert_relative_eq!(all.1, one.1 + two.1, epsilon = 1e-12);
        assert_relative_eq!(all.2, one.2 + two.2, epsilon = 1e-12);
    }

    /// Whole and half numbers: centres on faces, edges and corners, spheres that touch or pass through them.
    #[test]
    fn additive_where_all_is_special(at in prop::array::uniform3(-2..=8i32), squared in 1..=12i32, turned in any::<bool>()) {
        let by = if turned { somewhere() } else { origin() };
        let radius = (0.25 * f64::from(squared)).sqrt();
        let a = Round::ball(radius, by.to_world(Point::from(at.map(|x| 0.5 * f64::from(x)))));
        let part = |low: [f64; 3], high| total(&a, &cuboid(low, high), &by);
        let sum = |parts: &[(f64, Vector, Vector)]| parts.iter().fold((0.0, Vector::zeros(), Vector::zeros()),
            |s, p| (s.0 + p.0, s.1 + p.1, s.2 + p.2));
        let l = [part([0.0; 3], [2.0, 1.0, 1.0]), part([0.0, 1.0, 0.0], [1.0, 2.0, 1.0])];
        let u = [part([0.0; 3], [3.0, 1.0, 1.0]), part([0.0, 1.0, 0.0], [1.0, 2.0, 1.0]), part([2.0, 1.0, 0.0], [3.0, 2.0, 1.0])];
        for (b, parts) in [(l_block(), sum(&l)), (u_block(), sum(&u))] {
            let all = total(&a, &b, &by);
            prop_assert!((all.0 - parts.0).abs() < 1e-12, "{} {}", all.0, parts.0);
            assert_relative_eq!(all.1, parts.1, epsilon = 1e-11);
            assert_relative_eq!(all.2, parts.2, epsilon = 1e-12);
        }
    }

    /// Gradient and moment are the rates at which the volume changes, by differences of fourth order. Where the surface touches a
    /// face, edge or corner the second derivative jumps, by about the size of the bodies; then the step is what the error goes with.
    #[test]
    fn gradient_and_moment(a in rounds(), kind in 0..5usize, way in prop::array::uniform3(-1.0..1.0f64),
                           by in poses()) {
        let (b, way, a) = (body(kind), Vector::from(way), moved(&a, &by));
        let all = regions(&a, &b, &by);
        prop_assume!(all.len() == 1);
        let o = all[0];
        let slope = |h: f64, shake: &dyn Fn(f64) -> Round| {
            let v = |x: f64| volume(&shake(x * h), &b, &by);
            (8.0 * (v(1.0) - v(-1.0)) - v(2.0) + v(-2.0)) / (12.0 * h)
        };
        let push = |x| shaken(&a, way * x, Vector::zeros(), o.centroid);
        let turn = |x| shaken(&a, Vector::zeros(), way * x, o.centroid);
        let none = Vector::zeros();
        for (rate, shake) in [(o.rate(way, none), &push as &dyn Fn(f64) -> Round), (o.rate(none, way), &turn)] {
            let error = |h| (slope(h, shake) - rate).abs();
            prop_assert!(error(1e-4) < 1e-7 || error(1e-6) < 1e-5, "{} {}", rate, slope(1e-4, shake));
        }
    }

    /// V^⅓ is concave along any way (Brunn and Minkowski).
    #[test]
    fn concave(a in rounds(), kind in 0..3usize, way in prop::array::uniform3(-1.0..1.0f64)) {
        let b = body(kind);
        let root = |x: f64| volume(&shaken(&a, Vector::from(way) * x, Vector::zeros(), a.centre), &b, &origin()).cbrt();
        let (one, two, three) = (root(0.0), root(0.5), root(1.0));
        if one.min(three) > 1e-4 {
            prop_assert!(two >= 0.5 * (one + three) - 1e-12, "{} {} {}", one, two, three);
        }
    }

    /// An ellipsoid is the image of a ball: so are volume and centroid.
    #[test]
    fn affine(at in prop::array::uniform3(-1.0..1.0f64), axes in prop::array::uniform3(0.3..2.0f64), kind in 0..5usize, by in poses()) {
        let (b, ball) = (body(kind), Round::ball(0.6, Point::from(at)));
        let map = by.orientation.to_rotation_matrix() * Matrix3::from_diagonal(&axes.into());
        let image = |x: Point| by.position + map * x.coords;
        let egg = Pose { position: image(ball.centre), ..by };
        let (plain, mapped) = (
            regions(&ball, &b, &origin()),
            regions(&Round::ellipsoid(Vector::from(axes) * 0.6, &egg), &b.clone().mapped(image), &origin()),
        );
        let det = axes.iter().product::<f64>();
        for (p, q) in plain.iter().zip(&mapped) {
            assert_relative_eq!(p.volume * det, q.volume, epsilon = 1e-12);
            if p.volume > 1e-6 {
                assert_relative_eq!(image(p.centroid), q.centroid, epsilon = 1e-8);
            }
        }
    }
}
