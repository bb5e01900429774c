//! The curve against integrals of what discs and ellipses share.
use super::Posed;
use crate::{Ellipsoid, Overlap, OverlapSolver, Route};
use interfaces::{Point, Pose, Rotation, Vector};
use nalgebra::{Matrix2, Matrix3, Vector2};
use proptest::prelude::*;
use std::f64::consts::PI;

/// ∫ over the unit disc's share of an ellipse: 1, x, y, and the number of crossings of both; the ellipse is (x − c)ᵀM(x − c) ≤ 1.
/// Over |x| ≤ 1 on pieces between the crossings, where the ends of columns are smooth but for square roots at the ends.
fn shared(m: &Matrix2<f64>, c: Vector2<f64>, rule: &[(f64, f64)]) -> ([f64; 3], usize) {
    // Columns at x: y = c_y + (−m₁₂ u ± √(m₂₂ − det u²))/m₂₂, u = x − c_x.
    let det = m.determinant();
    let reach = (m[(1, 1)] / det).sqrt();
    let column = |x: f64| {
        let u = x - c.x;
        let (middle, half) =
            (c.y - m[(0, 1)] * u / m[(1, 1)], (m[(1, 1)] - det * u * u).max(0.0).sqrt() / m[(1, 1)]);
        let rim = (1.0 - x * x).max(0.0).sqrt();
        ([middle - half, middle + half], rim)
    };
    let (from, to) = ((c.x - reach).max(-1.0), (c.x + reach).min(1.0));
    if from >= to {
        return ([0.0; 3], 0);
    }
    // Where an end of the ellipse's column is at the rim, up or down.
    let gaps = |x: f64| {
        let ([low, high], rim) = column(x);
        [high - rim, high + rim, low - rim, low + rim]
    };
    let mut breaks = vec![from, to];
    let at = |k: usize| 0.5 * (from + to) - 0.5 * (to - from) * (PI * k as f64 / 400.0).cos();
    let mut last = (from, gaps(from));
    for k in 1..=400 {
        let x = if k == 400 { to } else { at(k) };
        let now = (x, gaps(x));
        for i in 0..4 {
            if (last.1[i] > 0.0) != (now.1[i] > 0.0) {
                let (mut low, mut high) = (last.0, now.0);
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    if (gaps(middle)[i] > 0.0) == (last.1[i] > 0.0) { low = middle } else { high = middle }
                }
                breaks.push(0.5 * (low + high));
            }
        }
        last = now;
    }
    breaks.sort_by(f64::total_cmp);
    let mut sums = [0.0; 3];
    for w in breaks.windows(2) {
        let (middle, half) = (0.5 * (w[0] + w[1]), 0.5 * (w[1] - w[0]));
        for (phi, weight) in rule {
            let x = middle + half * phi.sin();
            let ([low, high], rim) = column(x);
            let (low, high) = (low.max(-rim), high.min(rim));
            if high > low {
                let dx = weight * half * phi.cos();
                sums[0] += (high - low) * dx;
                sums[1] += x * (high - low) * dx;
                sums[2] += 0.5 * (high * high - low * low) * dx;
            }
        }
    }
    (sums, breaks.len())
}

/// Gauss-Legendre points of n pieces of [−π/2, π/2].
fn rule(n: usize) -> Vec<(f64, f64)> {
    let gauss = [
        (0.0, 128.0 / 225.0),
        (0.5384693101056831, 0.47862867049936647),
        (0.906179845938664, 0.23692688505618908),
    ];
    let half = 0.5 * PI / n as f64;
    (0..n)
        .flat_map(|k| {
            let middle = -0.5 * PI + (2 * k + 1) as f64 * half;
            gauss.into_iter().flat_map(move |(x, w)| {
                let sides = if x == 0.0 { vec![0.0] } else { vec![-x, x] };
                sides.into_iter().map(move |x| (middle + half * x, w * half))
            })
        })
        .collect()
}

/// Volume and centroid by rules of 5n points: the first body is made the unit ball, the second one cut into slices across its longest axis there; both
/// have ellipses there, and the first one's are discs.
fn by_slices(n: usize, a: &Ellipsoid, at_a: &Pose, b: &Ellipsoid, at_b: &Pose) -> (f64, Vector) {
    let ([p, q], origin) =
        ([(a, at_a), (b, at_b)].map(|(e, at)| Posed::new(e.semi_axes(), at, at_a.position)), at_a.position);
    let to_ball = q.to_ball() * p.ball_to_world();
    let centre = p.to_ball() * q.centre;
    let form = to_ball.tr_mul(&to_ball);
    let eigen = form.symmetric_eigen();
    let turn: Matrix3<f64> = eigen.eigenvectors;
    // Any axis serves; one that is not a symmetry's.
    let turn =
        Rotation::from_scaled_axis(Vector::new(0.3, 0.5, 0.1)).to_rotation_matrix().into_inner() * turn;
    let (form, centre) = (turn.tr_mul(&(form * turn)), turn.tr_mul(&centre));
    let inverse = form.try_inverse().unwrap();
    let high = inverse[(2, 2)].sqrt();
    let (from, to) = ((centre.z - high).max(-1.0), (centre.z + high).min(1.0));
    // xᵀFx = (u + s z)ᵀM(u + s z) + z²/high².
    let m = form.fixed_view::<2, 2>(0, 0).into_owned();
    let shift = m.try_inverse().unwrap() * Vector2::new(form[(0, 2)], form[(1, 2)]);
    let inner = rule(n);
    let at = |h: f64, rule: &[(f64, f64)]| {
        let z = h - centre.z;
        let (r2, left) = (1.0 - h * h, 1.0 - z * z / (high * high));
        if r2 <= 0.0 || left <= 0.0 {
            return ([0.0; 4], 0);
        }
        let r = r2.sqrt();
        let ([area, x, y], crossings) = shared(&(m * (r2 / left)), (centre.xy() - shift * z) / r, rule);
        ([area * r2, x * r * r2, y * r * r2, h * area * r2], crossings)
    };
    // Between heights at which the number of crossings changes.
    let looks = 1000;
    let height =
        |k: i32| 0.5 * (from + to) - 0.5 * (to - from) * (PI * f64::from(k) / f64::from(looks)).cos();
    let mut breaks = vec![from, to];
    for k in 1..looks - 1 {
        let [mut low, mut high] = [height(k), height(k + 1)];
        let count = at(low, &[]).1;
        if count != at(high, &[]).1 {
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                if at(middle, &[]).1 == count { low = middle } else { high = middle }
            }
            breaks.push(low);
        }
    }
    breaks.sort_by(f64::total_cmp);
    let mut sums = [0.0; 4];
    for w in breaks.windows(2) {
        for (phi, weight) in &inner {
            let h = 0.5 * (w[0] + w[1]) + 0.5 * (w[1] - w[0]) * phi.sin();
            let dh = weight * 0.5 * (w[1] - w[0]) * phi.cos();
            let (slice, _) = at(h, &inner);
            sums.iter_mut().zip(slice).for_each(|(sum, x)| *sum += x * dh);
        }
    }
    let [volume, x, y, z] = sums;
    let first = Vector::new(x, y, z);
    let cell = p.semi_axes.product();
    (volume * cell, origin.coords + p.ball_to_world() * turn * (first / volume))
}

fn ellipsoid(e: [f64; 3]) -> Ellipsoid {
    Ellipsoid::new(e).unwrap()
}
fn solve(tolerance: f64, a: &Ellipsoid, at_a: &Pose, b: &Ellipsoid, at_b: &Pose) -> Option<Overlap> {
    let mut solver = OverlapSolver::new().with_route(Some(Route::Curve)).with_tolerance(tolerance);
    solver.solve(a, at_a, b, at_b).unwrap().first().copied()
}
fn direction() -> impl Strategy<Value = Vector> {
    prop::array::uniform3(-1.0..1.0f64)
        .prop_filter_map("no direction", |v| Vector::from(v).try_normalize(0.1))
}
type Scene = (Ellipsoid, Pose, Ellipsoid, Pose);
/// Ellipsoids of up to 1 : 10 with their centres near to one another.
fn deep() -> impl Strategy<Value = Scene> {
    let axes = || prop::array::uniform3(-1.0..1.3f64).prop_map(|e| ellipsoid(e.map(f64::exp)));
    let turn = || prop::array::uniform3(-2.0..2.0f64).prop_map(|v| Rotation::from_scaled_axis(v.into()));
    (axes(), turn(), axes(), turn(), direction(), 0.0..1.0f64).prop_map(|(a, turn_a, b, turn_b, u, share)| {
        let at_a = Pose { position: Point::new(0.1, -0.3, 0.2), orientation: turn_a };
        let reach = share * (a.semi_axes().min() + b.semi_axes().min());
        (a, at_a, b, Pose { position: at_a.position + u * reach, orientation: turn_b })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(40) })]

    /// Against an integral that shares nothing with the curve.
    #[test]
    fn deep_ones_by_slices((a, at_a, b, at_b) in deep()) {
        let (volume, centroid) = by_slices(20, &a, &at_a, &b, &at_b);
        // How far that may be off.
        let unsure = 2.0 * (by_slices(10, &a, &at_a, &b, &at_b).0 / volume - 1.0).abs();
        for tolerance in [1e-5, 1e-10] {
            let o = solve(tolerance, &a, &at_a, &b, &at_b).unwrap();
            prop_assert!((o.volume / volume - 1.0).abs() < 1e-5 + unsure, "{} {} {}", tolerance, o.volume, volume);
            prop_assert!((o.centroid.coords - centroid).norm() < (1e-4 + 10.0 * unsure) * volume.cbrt(), "{:?} {:?}", o.centroid, centroid);
        }
    }

    /// Swapped, bodies have other cones and caps; columns are another way, whose rays keep 1e-7 about. Bodies nearly alike and
    /// aligned, where all axes are nearly equivalent, go by rays too (else 1e-9 is kept but in one pair of ten thousand).
    #[test]
    fn deep_ones_swapped_and_by_columns((a, at_a, b, at_b) in deep()) {
        let o = solve(1e-10, &a, &at_a, &b, &at_b).unwrap();
        let swapped = solve(1e-10, &b, &at_b, &a, &at_a).unwrap().swapped();
        let size = o.volume.cbrt();
        let area = o.area() + size * size;
        prop_assert!((o.volume / swapped.volume - 1.0).abs() < 2e-7, "{} {}", o.volume, swapped.volume);
        prop_assert!((o.gradient - swapped.gradient).norm() < 1e-4 * area, "{:?} {:?}", o, swapped);
        prop_assert!((o.moment - swapped.moment).norm() < 1e-4 * area * area.sqrt(), "{:?} {:?}", o, swapped);
        let mut columns = OverlapSolver::new().with_route(Some(Route::Columns)).with_tolerance(1e-10);
        let columns = columns.solve(&a, &at_a, &b, &at_b).unwrap()[0];
        prop_assert!((o.volume / columns.volume - 1.0).abs() < 1e-6, "{} {}", o.volume, columns.volume);
    }
}

/// Swapped, in so many pairs that some have two small loops next to one another as seen from a flat cone (one in 20 000).
#[test]
fn many_deep_ones_swapped() {
    let mut state = 7_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    for k in 0..17_000 {
        let [a, b] = [0; 2].map(|_| ellipsoid([0; 3].map(|_| (2.3 * next() - 1.0).exp())));
        let [at_a, at_b] = [0.0, 1.0].map(|far| {
            let turn = [0; 3].map(|_| 4.0 * next() - 2.0);
            let position = Point::from([0; 3].map(|_| far * (next() - 0.5)));
            Pose { position, orientation: Rotation::from_scaled_axis(turn.into()) }
        });
        let one = solve(1e-5, &a, &at_a, &b, &at_b).map_or(0.0, |o| o.volume);
        let two = solve(1e-5, &b, &at_b, &a, &at_a).map_or(0.0, |o| o.volume);
        assert!((one - two).abs() <= 1e-5 * one, "{k}: {one} {two}");
    }
}
