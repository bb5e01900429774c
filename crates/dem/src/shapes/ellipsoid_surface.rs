//! Elements of equal area on the level surfaces of an ellipsoid.
use crate::{Ellipsoid, SmoothConvex};
use interfaces::{Point, SurfaceElement, Vector};
use std::f64::consts::{PI, TAU};

/// Rings of a table of areas between the poles.
const RINGS: usize = 512;
/// Points on a ring.
const AROUND: usize = 128;

/// Elements of equal area, about `spacing` apart, on the level surface at signed distance `offset`: on a golden-angle spiral
/// about the longest axis, moved along the rings and from ring to ring such that the area grows evenly.
pub(crate) fn elements(shape: &Ellipsoid, spacing: f64, offset: f64) -> Option<Vec<SurfaceElement>> {
    let e = shape.semi_axes();
    // Beyond the smallest radius of curvature the level surface folds.
    let smallest = e.min() * (e.min() / e.max());
    if offset.is_nan() || offset <= -smallest {
        return None;
    }
    let pole = e.imax();
    let axes = [(pole + 1) % 3, (pole + 2) % 3, pole];
    // The point at polar angle θ and azimuth φ of the sphere that the ellipsoid is an affine image of.
    let at = |theta: f64, phi: f64| {
        let unit = [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()];
        let mut x = Point::origin();
        for (axis, u) in axes.iter().zip(unit) {
            x[*axis] = e[*axis] * u;
        }
        x
    };
    // Area of the level surface per dθ dφ: abc |g| (1 + dκ₁)(1 + dκ₂) sin θ, g = (x/a², y/b², z/c²).
    let density = |theta: f64, phi: f64| {
        let x = at(theta, phi);
        let [sum, product] = shape.curvatures(x);
        let stretch = 1.0 + offset * (sum + offset * product);
        0.5 * e.product() * shape.level(x).1.norm() * stretch * theta.sin()
    };
    let ring = |theta: f64| -> [f64; AROUND] {
        std::array::from_fn(|j| density(theta, TAU * (j as f64 + 0.5) / AROUND as f64))
    };
    // Area above each ring's lower edge, by Gauss-Legendre over the ring's height.
    let height = PI / RINGS as f64;
    let mut above = vec![0.0];
    for i in 0..RINGS {
        let mid = (i as f64 + 0.5) * height;
        let off = 0.5 * height / 3f64.sqrt();
        let sum: f64 = ring(mid - off).iter().chain(&ring(mid + off)).sum();
        above.push(above[i] + 0.5 * height * TAU / AROUND as f64 * sum);
    }
    let whole = above[RINGS];
    if !(spacing > 0.0 && whole > 0.0) {
        return None;
    }
    let n = (whole / (spacing * spacing)).round().max(6.0);
    let golden = 0.5 * (3.0 - 5f64.sqrt());
    let element = |k: usize| {
        let target = whole * (k as f64 + 0.5) / n;
        let i = above.partition_point(|a| *a <= target).clamp(1, RINGS) - 1;
        let theta = (i as f64 + (target - above[i]) / (above[i + 1] - above[i])) * height;
        let densities = ring(theta);
        let mut turn = (golden * k as f64).fract() * densities.iter().sum::<f64>();
        let mut j = 0;
        while j + 1 < AROUND && turn > densities[j] {
            turn -= densities[j];
            j += 1;
        }
        let c = at(theta, TAU * (j as f64 + turn / densities[j]) / AROUND as f64);
        let normal: Vector = shape.level(c).1.normalize();
        SurfaceElement { point: c + offset * normal, normal, area: whole / n }
    };
    Some((0..n as usize).map(element).collect())
}
