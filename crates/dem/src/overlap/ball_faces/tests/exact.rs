//! Against closed forms.
use super::bodies::*;
use super::*;
use approx::assert_relative_eq;
use std::f64::consts::PI;

const WHOLE: f64 = 4.0 / 3.0 * PI;

fn cap(r: f64, depth: f64) -> f64 {
    PI * depth * depth * (3.0 * r - depth) / 3.0
}

/// A ball that reaches one face only, by less than the face is wide: a cap, whatever way the face is cut into triangles.
#[test]
fn caps() {
    for at in [[0.3, 0.1], [0.0, 0.0], [0.25, 0.25], [0.2, -0.55]] {
        for depth in [1e-9, 1e-6, 1e-3, 0.1, 0.4, 0.5, 0.7, 0.999] {
            let r = 0.5;
            if depth > r && at[1] < -0.4 {
                continue;
            }
            // What is left of the depth when the place is rounded.
            let x = 1.0 + r - depth;
            let depth = 1.0 + r - x;
            let a = ball(r, [x, at[0], at[1]]);
            let reach = (depth * (2.0 * r - depth)).sqrt().min(r);
            if at[1] - reach < -1.0 {
                continue;
            }
            for o in [one(&a, &cube(), &origin()), one(&a, &quads([-1.0; 3], [1.0; 3]), &origin())] {
                assert_relative_eq!(o.volume, cap(r, depth), max_relative = 2e-13);
                assert_relative_eq!(o.normal, Vector::x(), epsilon = 1e-13);
                assert_relative_eq!(o.area(), PI * depth * (2.0 * r - depth), max_relative = 1e-13);
                let arm = 0.75 * (2.0 * r - depth).powi(2) / (3.0 * r - depth);
                assert_relative_eq!(o.centroid, Point::new(x - arm, at[0], at[1]), epsilon = 1e-13);
                assert!(o.moment.norm() < 1e-12 * o.area());
            }
        }
    }
}

/// Centre on a face, an edge, a corner of the cube: a half, a quarter, an eighth; also turned, where nothing is exact.
#[test]
fn centre_on_the_surface() {
    for pose in [origin(), somewhere()] {
        for r in [1e-9, 0.3, 0.9] {
            for (x, share) in [
                ([1.0, 0.0, 0.0], 0.5), // Also on the diagonal of the face.
                ([1.0, 0.05, -0.02], 0.5),
                ([1.0, 1.0, 0.07], 0.25),
                ([1.0, -1.0, 0.0], 0.25),
                ([1.0, 1.0, 1.0], 0.125),
                ([-1.0, 1.0, -1.0], 0.125),
            ] {
                let at = pose.to_world(Point::from(x));
                let a = Round::ball(r, at);
                for o in [one(&a, &cube(), &pose), one(&a, &quads([-1.0; 3], [1.0; 3]), &pose)] {
                    assert_relative_eq!(
                        o.volume,
                        share * WHOLE * r.powi(3),
                        max_relative = 1e-7 * (1e-9 / r) + 1e-13
                    );
                }
            }
        }
        // The inner edge and corner of an L have more than half.
        for (x, share) in [([1.0, 1.0, 0.5], 0.75), ([1.0, 1.0, 1.0], 0.375), ([0.0, 0.0, 0.0], 0.125)] {
            let a = Round::ball(0.4, pose.to_world(Point::from(x)));
            assert_relative_eq!(volume(&a, &l_block(), &pose), share * WHOLE * 0.064, max_relative = 1e-13);
        }
    }
}
