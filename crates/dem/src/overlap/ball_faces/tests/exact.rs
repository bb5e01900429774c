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

/// One within the other: all of the smaller one, and nothing changes when they move.
#[test]
fn containment() {
    for pose in [origin(), somewhere()] {
        let inner = Round::ball(0.4, pose.to_world(Point::new(0.3, -0.5, 0.2)));
        let outer = Round::ball(1e3, pose.to_world(Point::new(500.0, 3.0, -7.0)));
        let egg = Pose { position: inner.centre, ..somewhere() };
        for (a, v, x) in [
            (inner, WHOLE * 0.064, inner.centre),
            (Round::ellipsoid(Vector::new(0.3, 0.2, 0.1), &egg), WHOLE * 0.006, inner.centre),
            (outer, 8.0, pose.position),
            (Round::ellipsoid(Vector::new(3.0, 4.0, 2.5), &pose), 8.0, pose.position),
        ] {
            let hollow =
                cuboid([-9.0; 3], [9.0; 3]).with(&cuboid([-8.0; 3], [8.0; 3]), true).with(&cube(), false);
            for o in [one(&a, &cube(), &pose), one(&a, &quads([-1.0; 3], [1.0; 3]), &pose)] {
                assert_relative_eq!(o.volume, v, max_relative = 1e-13);
                assert_relative_eq!(o.centroid, x, epsilon = 1e-12);
                assert_eq!((o.gradient, o.moment), (Vector::zeros(), Vector::zeros()));
            }
            if v < 5.0 {
                assert_relative_eq!(volume(&a, &hollow, &pose), v, max_relative = 1e-13);
            }
        }
        // Sharp ends poke out of the ball.
        let a = Round::ball(1.5, pose.position);
        assert!(volume(&a, &cube(), &pose) < 8.0);
        assert_relative_eq!(
            volume(&Round::ball(1.74, pose.position), &cube(), &pose),
            8.0,
            max_relative = 1e-14
        );
    }
}

#[test]
fn apart_and_touching() {
    let small = cuboid([-9.0; 3], [9.0; 3]).with(&cuboid([-2.0; 3], [2.0; 3]), true);
    for (a, b) in [
        (ball(1.0, [2.0, 0.0, 0.0]), cube()),    // On a face,
        (ball(1.0, [1.6, 1.8, 0.0]), cube()),    // an edge,
        (ball(0.75, [1.5, 1.5, 1.25]), cube()),  // a corner,
        (ball(2.0, [0.0; 3]), small.clone()),    // from within a hole;
        (ball(1.0, [0.0, 0.0, 0.5]), small),     // in it,
        (ball(1.0, [1.5, 1.9, 1.7]), cube()),    // near a corner,
        (ball(0.1, [1.5, 1.5, 0.5]), l_block()), // in the corner of an L,
        (ball(0.5, [1.5, 1.5, 0.5]), l_block()), // and on both its sides.
    ] {
        assert_eq!(regions(&a, &b, &origin()), []);
        let b = Body { convex: false, ..b };
        assert_eq!(regions(&a, &b, &origin()), []);
    }
    // A ball that fills the cube just so.
    assert_relative_eq!(volume(&ball(1.0, [0.0; 3]), &cube(), &origin()), WHOLE, max_relative = 1e-14);
}

/// Sizes from 1e-9 to 1e6: volumes go with the cube of it, without NaN.
#[test]
fn scales() {
    let at = |s: f64| Pose { position: Point::from(somewhere().position.coords * s), ..somewhere() };
    let place = [1.1, 0.9, 0.3]; // In the frame of the body.
    for shape in [cube(), l_block(), icosphere(1.1, 2)] {
        let a = |s: f64| Round::ball(0.6 * s, at(s).to_world(Point::from(place) * s));
        let plain = one(&a(1.0), &shape, &at(1.0));
        for s in [1e-9, 3e-5, 7e2, 1e6] {
            let o = one(&a(s), &shape.clone().mapped(|x| x * s), &at(s));
            assert_relative_eq!(o.volume, s.powi(3) * plain.volume, max_relative = 1e-12);
            assert_relative_eq!(o.gradient, s * s * plain.gradient, max_relative = 1e-12);
            assert_relative_eq!(o.moment, s.powi(3) * plain.moment, max_relative = 1e-10);
            assert_relative_eq!(o.centroid.coords, s * plain.centroid.coords, max_relative = 1e-12);
        }
    }
    // A ball far bigger than the body cuts it like a plane: here the cube in half, but for its own bulge; and the
    // other way around.
    for (r, tolerance) in [(1e3, 1e-9), (1e6, 1e-3)] {
        let half = one(&ball(r, [r, 0.0, 0.0]), &cube(), &origin());
        assert_relative_eq!(half.volume, 4.0 - 4.0 / 3.0 / r, max_relative = 1e-9);
        // The slice that the bulge takes, (y² + z²)/2r thick, is at x ≈ 0.
        assert_relative_eq!(
            half.centroid,
            Point::new(2.0 / half.volume, 0.0, 0.0),
            epsilon = tolerance + 0.2 / (r * r)
        );
    }
    let speck = one(&ball(1e-6, [1.0 + 0.5e-6, 0.3, 0.2]), &cube(), &origin());
    assert_relative_eq!(speck.volume, cap(1e-6, 0.5e-6), max_relative = 1e-9);
}

/// A body wholly in the ball but for one corner, and holes: what the faces beyond cut off is taken from the whole.
#[test]
fn holes_and_regions() {
    // A plate that the ball sticks through on both sides: one region, two caps short of the ball.
    let plate = cuboid([-9.0, -9.0, -0.3], [9.0, 9.0, 0.2]);
    for z in [0.0, 0.5, -0.25, 0.9] {
        let cut = |at: f64| cap(1.0, (1.0 + at - z).clamp(0.0, 2.0));
        let o = one(&ball(1.0, [0.5, 0.2, z]), &Body { convex: false, ..plate.clone() }, &origin());
        assert_relative_eq!(o.volume, cut(0.2) - cut(-0.3), max_relative = 1e-13);
    }
    // A hollow box, a cube in it: seven eighths of the ball are the wall, and the cube a region of its own.
    let shell = cuboid([-9.0; 3], [9.0; 3]).with(&cuboid([-1.0; 3], [1.0; 3]), true);
    let a = ball(0.5, [1.1, 0.0, 0.0]);
    assert_relative_eq!(one(&a, &shell, &origin()).volume, WHOLE / 8.0 - cap(0.5, 0.4), max_relative = 1e-13);
    let a = ball(0.5, [0.9, 0.0, 0.0]);
    assert_relative_eq!(one(&a, &shell, &origin()).volume, cap(0.5, 0.4), max_relative = 1e-13);
    for x in [0.85, 0.95, 1.05] {
        // Wall from 1 on, a block up to 0.8.
        let both = shell.clone().with(&cuboid([-0.8; 3], [0.8; 3]), false);
        let all = regions(&ball(0.5, [x, 0.0, 0.0]), &both, &origin());
        assert_eq!(all.len(), 2);
        for o in &all {
            let depth = if o.centroid.x < 0.9 { 1.3 - x } else { x - 0.5 };
            assert_relative_eq!(o.volume, cap(0.5, depth), max_relative = 1e-13);
        }
    }
    // Across the slot of a U it touches both legs; three regions with a bar in the slot.
    let o = regions(&ball(0.6, [1.5, 1.7, 0.5]), &u_block(), &origin());
    assert_eq!(o.len(), 2);
    for o in &o {
        let side = (o.centroid.x - 1.5).signum();
        assert_relative_eq!(o.normal.x, -side, epsilon = 0.1);
        assert_relative_eq!(
            o.volume,
            volume(&ball(0.6, [1.5, 1.7, 0.5]), &leg(side), &origin()),
            max_relative = 1e-12
        );
    }
    // Without knowing which corners are the same it is all one.
    let loose = |b: &Body| Body {
        vertices: b.faces.iter().flatten().map(|i| b.vertices[*i as usize]).collect(),
        faces: (0..b.faces.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        convex: false,
    };
    let all = one(&ball(0.6, [1.5, 1.7, 0.5]), &loose(&u_block()), &origin());
    assert_relative_eq!(all.volume, o[0].volume + o[1].volume, max_relative = 1e-13);
    // Where it rests on the ground as well it is one region.
    assert_eq!(regions(&ball(0.72, [1.5, 1.5, 0.5]), &u_block(), &origin()).len(), 1);
    let bar = u_block().with(&cuboid([1.4, 1.2, -3.0], [1.6, 1.9, 3.0]), false);
    assert_eq!(regions(&ball(0.55, [1.5, 1.65, 0.5]), &bar, &origin()).len(), 3);
}

fn leg(side: f64) -> Body {
    let x = if side < 0.0 { 0.0 } else { 2.0 };
    cuboid([x, 0.0, 0.0], [x + 1.0, 2.0, 1.0])
}

/// Depth as a power of 1/2, volume, gradient, centroid.
type Known = [(i32, f64, [f64; 3], [f64; 3]); 4];

/// Balls of radius 1, depth 1/8 to 7e-9 in a corner or edge at the origin. The numbers of the bodies are exact; what is known
/// is the sum over cones from the centre in 120 digits. A volume can be known to ε/depth, the centroid to ε.
#[test]
#[rustfmt::skip]
fn shallow_corners_and_edges() {
    let corner: Known = [
        (3, 0.000870070861559686, [2.301967527459583e-06, -6.727743057634614e-05, -0.020560163682168238], [7.078621806442608e-05, -0.0024689490278963725, -0.09227542936505453]),
        (10, 4.353061425371135e-10, [1.1780329988819804e-14, -3.625216747561686e-11, -1.3370830270823418e-06], [5.28888945963877e-09, -2.033619263201414e-05, -0.0007323246683403409]),
        (20, 4.0557176597940604e-19, [1.0743957658598215e-26, -3.3797625900841647e-20, -1.2758182947833598e-12], [5.052739665815615e-15, -1.9868206470992468e-08, -7.152556445394463e-07]),
        (27, 1.9339176299514014e-25, [4.0024469187636033e-35, -1.6115980170379914e-26, -7.786980905046539e-17], [3.083952804804009e-19, -1.5522042858657982e-10, -5.5879354420309265e-09]),
    ];
    let edge: Known = [
        (3, 0.008672999967016913, [0.0, -0.0014615756153920337, -0.1697526871838632], [0.0, -0.006194087696451998, -0.07006818812195942]),
        (10, 4.9430031771974367e-08, [0.0, -9.870647155387643e-09, -0.00012651809007871204], [0.0, -5.573562705200092e-05, -0.0005579415316102513]),
        (20, 1.4737928060049436e-15, [0.0, -2.9475811304235117e-16, -3.863458733323991e-09], [0.0, -5.449561033364233e-08, -5.449566623139424e-07]),
        (27, 7.95081590422617e-21, [0.0, -1.5901631619567128e-21, -2.667851112360022e-12], [0.0, -4.2574745872081095e-10, -4.257474621325439e-09]),
    ];
    let flat: Known = [
        (3, 0.038847928556623855, [0.0, 0.0114336802855731, -0.6391234249147292], [0.0, 0.015789104061496667, -0.04921694320817774]),
        (10, 7.34476691064159e-07, [0.0, 6.1185942505952925e-06, -0.0018201002691286487], [0.0, 0.002544045565665181, -0.0005312694081088242]),
        (20, 2.4113779870341647e-14, [0.0, 2.8922923394072966e-13, -6.320984983629343e-08], [0.0, 3.268629226838021e-06, -5.449211426325391e-07]),
        (27, 1.3010414094894795e-19, [0.0, 1.5612439500844795e-18, -4.365568943146034e-11], [0.0, 2.5544779901581674e-08, -4.257472452445379e-09]),
    ];
    let ridge = [[-2.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
    for (body, known) in [
        (tetrahedron([[0.0; 3], [3.0, 0.25, -3.0], [-2.0, 2.5, -3.0], [-1.0, -3.0, -3.0]]), corner),
        (tetrahedron([ridge[0], ridge[1], [0.25, 3.0, -3.0], [0.5, -3.0, -2.5]]), edge),
        (tetrahedron([ridge[0], ridge[1], [0.25, 3.0, -0.125], [0.5, -3.0, -0.25]]), flat),
    ] {
        for (power, volume, gradient, centroid) in known {
            let depth = 0.5f64.powi(power);
            let o = one(&ball(1.0, [0.0, 0.0, 1.0 - depth]), &body, &origin());
            let tolerance = 1e-14 + 3.0 * f64::EPSILON / depth;
            assert_relative_eq!(o.volume, volume, max_relative = tolerance);
            assert_relative_eq!(o.gradient, Vector::from(gradient), epsilon = tolerance * o.area());
            assert_relative_eq!(o.centroid, Point::from(centroid), epsilon = 1e-14);
        }
    }
}

/// Volume and centroid by points on a lattice that fills the ball evenly.
#[test]
fn by_counting() {
    let (l, egg) = (l_block(), Round::ellipsoid(Vector::new(0.9, 0.7, 0.5), &somewhere()));
    for a in [
        ball(0.7, [1.1, 1.2, 0.8]),
        ball(0.9, [0.2, -0.3, 0.4]),
        Round { centre: Point::new(1.0, 0.9, 0.9), ..egg },
    ] {
        let o = one(&a, &l, &origin());
        let (n, mut count, mut sum) = (400_000, 0, Vector::zeros());
        // Roberts' sequence of low discrepancy; radius and height make equal volumes.
        let g: f64 = 1.220_744_084_605_759_5;
        for i in 1..=n {
            let [u, v, w] = [1, 2, 3].map(|k| (f64::from(i) / g.powi(k)).fract());
            let (z, phi) = (2.0 * v - 1.0, 2.0 * PI * w);
            let flat = (1.0 - z * z).sqrt();
            let y = Vector::new(flat * phi.cos(), flat * phi.sin(), z) * u.cbrt();
            let x = a.centre + a.orientation * y.component_mul(&a.axes);
            let inside = |low: [f64; 3], high: [f64; 3]| (0..3).all(|k| low[k] < x[k] && x[k] < high[k]);
            if inside([0.0; 3], [2.0, 1.0, 1.0]) || inside([0.0; 3], [1.0, 2.0, 1.0]) {
                count += 1;
                sum += x.coords;
            }
        }
        let volume = WHOLE * a.axes.product() * f64::from(count) / f64::from(n);
        assert_relative_eq!(o.volume, volume, max_relative = 1e-3);
        assert_relative_eq!(o.centroid.coords, sum / f64::from(count), epsilon = 1e-3);
    }
}
