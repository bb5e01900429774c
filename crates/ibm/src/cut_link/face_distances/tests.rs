use super::*;
use proptest::prelude::*;

/// Distances d + a x + b y over a unit face around its node.
fn plane(d: f64, a: f64, b: f64) -> FaceDistances {
    let corner = |k: usize| d + a * ((k & 1) as f64 - 0.5) + b * ((k >> 1) as f64 - 0.5);
    FaceDistances::new([0, 1, 2, 3].map(corner), d)
}

/// Flux through such a face where the velocity is αt + βt² at distance t.
fn flux(d: f64, a: f64, b: f64, alpha: f64, beta: f64) -> f64 {
    let u = |t: f64| if t > 0.0 { alpha * t + beta * t * t } else { 0.0 };
    let cut = plane(d, a, b);
    let mut face = CutFace { index: 0, open: cut.open(), constant: 0.0, terms: [(0, 0.0); 4] };
    let next = |k: usize, rise: f64| {
        let t = d + rise.abs();
        (if t > 0.0 { Support::Node(k) } else { Support::Wall(0.0) }, rise.abs())
    };
    cut.weights([next(1, a), next(2, b)], &mut face);
    face.terms.iter().map(|&(index, weight)| weight * u(d + [0.0, a.abs(), b.abs()][index])).sum()
}

proptest! {
    /// Against sums over points, and the share and its complement.
    #[test]
    fn moments_are_those_of_many_points(d in -1.0..1.0_f64, a in -1.0..1.0_f64, b in -1.0..1.0_f64, level in -0.3..0.3_f64) {
        let cut = plane(d, a, b);
        let n = 200;
        let mut sums = [0.0; 3];
        for i in 0..n * n {
            let [x, y] = [i % n, i / n].map(|i| (f64::from(i) + 0.5) / f64::from(n) - 0.5);
            let t = d + a * x + b * y - level;
            if t > 0.0 {
                (0..3).for_each(|m| sums[m] += t.powi(m as i32) / f64::from(n * n));
            }
        }
        let found = cut.moments(level);
        prop_assert!((found[0] - sums[0]).abs() < 0.02);
        prop_assert!((found[1] - sums[1]).abs() < 1e-4 && (found[2] - sums[2]).abs() < 1e-4);
        prop_assert!((cut.open() + plane(-d, -a, -b).open() - 1.0).abs() < 1e-9);
    }

    /// The flux of a velocity that is linear in the distance is exact however the face is cut, if its neighbours are in the fluid.
    #[test]
    fn linear_profiles_are_exact(d in -0.5..0.7_f64, a in -1.0..1.0_f64, b in -1.0..1.0_f64) {
        let size = a.hypot(b);
        prop_assume!(size > 0.1);
        let (d, a, b) = (d * size, a / size, b / size);
        let cut = plane(d, a, b);
        let open = cut.open();
        prop_assume!(open > 0.0 && open < 1.0 && d + a.abs().min(b.abs()) > 0.0);
        let exact = cut.moments(0.0)[1];
        let found = flux(d, a, b, 1.0, 0.0);
        // Neighbours nearer to the wall than the mean of the open part count less.
        prop_assume!(d > 0.0 || d + a.abs().min(b.abs()) > exact);
        prop_assume!(d <= 0.0 || cut.moments(d)[1] <= a.abs().min(b.abs()));
        prop_assert!((found - exact).abs() < 1e-12, "{found} {exact}");
    }
}

/// No jump where the wall passes a corner or the node; whole faces carry the velocity of their node.
#[test]
fn fluxes_are_continuous() {
    let small = 1e-8;
    for (a, b) in
        [(1.0, 0.0), (0.0, -1.0), (0.8, 0.6), (0.5_f64.sqrt(), 0.5_f64.sqrt()), (0.6, -0.1), (1.0, 1e-12)]
    {
        for (alpha, beta) in [(1.0, 0.0), (0.3, 2.0)] {
            let at = |d: f64| flux(d, a, b, alpha, beta);
            let whole = 0.5 * (f64::abs(a) + f64::abs(b));
            let node = alpha * whole + beta * whole * whole;
            assert!(
                (at(whole * (1.0 - small)) - node).abs() < 20.0 * small,
                "{a} {b} {} {node}",
                at(whole * (1.0 - small))
            );
            for d in [0.0, whole - a.abs(), whole - b.abs(), -a.abs(), -b.abs()] {
                assert!(
                    (at(d + small) - at(d - small)).abs() < 20.0 * small,
                    "{a} {b} {d} {} {}",
                    at(d + small),
                    at(d - small)
                );
            }
            assert!(at(small - whole).abs() < small);
        }
    }
    // A curved wall that comes to the corners of the face from below: the face is whole when they are out.
    let curved = |level: f64| FaceDistances::new([level; 4], level + 0.1).open();
    assert!(curved(1e-9) == 1.0 && (curved(-1e-9) - 1.0).abs() < 1e-6, "{}", curved(-1e-9));
}
