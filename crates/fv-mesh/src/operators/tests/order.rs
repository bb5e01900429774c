//! Orders of accuracy.
use super::*;
use crate::Convection;
use crate::operators::Operators;
use std::f64::consts::PI;

/// φ and its derivatives; monotone along every axis of the unit box.
struct Wave;

impl Wave {
    /// The k-th derivative along axis a.
    fn factor(a: usize, k: usize, x: f64) -> f64 {
        let (w, shift) = ([0.7, -0.6, 0.5][a], [0.2, 0.1, -0.1][a]);
        let phase = w * x + shift;
        w.powi(k as i32) * [2.0 + phase.sin(), phase.cos(), -phase.sin()][k]
    }
    fn derivative<const D: usize>(order: [usize; D], x: [f64; D]) -> f64 {
        (0..D).map(|a| Self::factor(a, order[a], x[a])).product()
    }
    fn value<const D: usize>(x: [f64; D]) -> f64 {
        Self::derivative([0; D], x)
    }
    fn slope<const D: usize>(c: usize, x: [f64; D]) -> f64 {
        Self::derivative(std::array::from_fn(|a| usize::from(a == c)), x)
    }
    fn laplacian<const D: usize>(x: [f64; D]) -> f64 {
        (0..D).map(|c| Self::derivative(std::array::from_fn(|a| 2 * usize::from(a == c)), x)).sum()
    }
}

fn gamma<const D: usize>(x: [f64; D]) -> f64 {
    1.5 + (0..D).map(|a| (x[a] + 0.3 * a as f64).sin()).sum::<f64>()
}

/// Upwards along x, downwards along the other axes.
fn velocity<const D: usize>(x: [f64; D]) -> [f64; D] {
    std::array::from_fn(|c| {
        let s = (0..D).map(|a| (0.4 + 0.2 * (a + c) as f64) * x[a]).sum::<f64>();
        [1.0, -1.0, -1.0][c] * (1.3 + s.sin())
    })
}
fn velocity_slope<const D: usize>(c: usize, b: usize, x: [f64; D]) -> f64 {
    let w = |a: usize| 0.4 + 0.2 * (a + c) as f64;
    let s = (0..D).map(|a| w(a) * x[a]).sum::<f64>();
    [1.0, -1.0, -1.0][c] * w(b) * s.cos()
}

/// Errors of every operator on n cells per axis, away from the sides.
fn errors<const D: usize>(family: Family, n: usize) -> Vec<(String, f64, [f64; 2])> {
    let grid: CartesianGrid<D> = family.grid(n);
    let metrics = Metrics::new(&grid, [false; D]);
    let ops = Operators::new(&grid, [false; D]);
    // Smooth, so that which cells count does not disturb the order.
    let norms = Norms::new(&grid, |x| {
        x.iter().map(|x| (PI * ((x - 0.1) / 0.8).clamp(0.0, 1.0)).sin()).product::<f64>()
    });
    let field = |f: &dyn Fn([f64; D]) -> f64| exact(&grid, &metrics, None, f);
    let phi = field(&Wave::value);
    let mut out = Field::zeros(&grid);
    let mut list = Vec::new();
    let mut faces: [Field<D>; D] = std::array::from_fn(|_| Field::zeros(&grid));
    ops.face_gradient(&phi, &mut faces).unwrap();
    for c in 0..D {
        ops.gradient(&phi, c, &mut out).unwrap();
        let exact_slope = field(&|x| Wave::slope(c, x));
        list.push((format!("gradient {c}"), 2.0, norms.of(&out, &exact_slope)));
        let on_faces = exact(&grid, &metrics, Some(c), |x| Wave::slope(c, x));
        list.push((format!("face gradient {c}"), 2.0, norms.of(&faces[c], &on_faces)));
        ops.to_faces(&phi, c, &mut out).unwrap();
        let on_faces = exact(&grid, &metrics, Some(c), Wave::value);
        list.push((format!("to faces {c}"), 2.0, norms.of(&out, &on_faces)));
        ops.to_centres(&on_faces, c, &mut out).unwrap();
        list.push((format!("to centres {c}"), 2.0, norms.of(&out, &phi)));
    }
    let flux = std::array::from_fn(|c| exact(&grid, &metrics, Some(c), |x| velocity(x)[c]));
    ops.divergence(&flux, &mut out).unwrap();
    let divergence = |x| (0..D).map(|c| velocity_slope::<D>(c, c, x)).sum::<f64>();
    list.push(("divergence".into(), 2.0, norms.of(&out, &field(&divergence))));
    ops.laplacian(1.7, &phi, &mut out).unwrap();
    list.push(("laplacian".into(), 2.0, norms.of(&out, &field(&|x| 1.7 * Wave::laplacian(x)))));
    ops.variable_laplacian(&field(&gamma), &phi, &mut out).unwrap();
    let variable = |x: [f64; D]| {
        let mixed = |a: usize| (x[a] + 0.3 * a as f64).cos() * Wave::slope(a, x);
        gamma(x) * Wave::laplacian(x) + (0..D).map(mixed).sum::<f64>()
    };
    list.push(("variable laplacian".into(), 2.0, norms.of(&out, &field(&variable))));

    let u = exact_velocity(&grid, &metrics, velocity);
    let convected = |x: [f64; D]| {
        -(0..D).map(|c| velocity(x)[c] * Wave::slope(c, x)).sum::<f64>() - Wave::value(x) * divergence(x)
    };
    for scheme in Convection::ALL {
        ops.convection(&u, &phi, scheme, &mut out).unwrap();
        let order = if scheme == Convection::Upwind { 1.0 } else { 2.0 };
        list.push((format!("{scheme:?}"), order, norms.of(&out, &field(&convected))));
    }
    for (a, b) in (0..D).flat_map(|a| (0..D).map(move |b| (a, b))) {
        ops.velocity_gradient(&u, [a, b], &mut out).unwrap();
        let slope = field(&|x| velocity_slope(a, b, x));
        list.push((format!("velocity gradient {a}{b}"), 2.0, norms.of(&out, &slope)));
    }
    ops.strain_rate(&u, &mut out).unwrap();
    let strain = |x: [f64; D]| {
        let s = |a, b| 0.5 * (velocity_slope(a, b, x) + velocity_slope(b, a, x));
        let pairs = (0..D).flat_map(|a| (0..D).map(move |b| (a, b)));
        (2.0 * pairs.map(|(a, b)| s(a, b) * s(a, b)).sum::<f64>()).sqrt()
    };
    list.push(("strain rate".into(), 2.0, norms.of(&out, &field(&strain))));
    list
}

fn orders<const D: usize>(n: usize) {
    for &family in families(D) {
        let (coarse, fine) = (errors::<D>(family, n), errors::<D>(family, 2 * n));
        for ((name, order, coarse), (.., fine)) in coarse.into_iter().zip(fine) {
            assert_order(&format!("{family:?} {D}-D {name}"), coarse, fine, order);
        }
    }
}

#[test]
fn orders_in_the_plane() {
    orders::<2>(128);
}

#[test]
fn orders_in_space() {
    orders::<3>(32);
}
