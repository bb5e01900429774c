//! Deep overlaps: rays from a point of both.
use super::pair::View;
use super::rules::KRONROD;
use crate::overlap::doubling::Doubling;
use crate::overlap::integrals::Integrals;
use interfaces::Vector;
use std::f64::consts::{PI, TAU};

/// What the rays found.
pub(super) enum Found {
    /// All of this body (0 or 1) lies within the other.
    Within(usize),
    /// The surfaces cross.
    Crossing(Integrals),
}

/// Meridians to begin with; the doubling ends at the second.
const FIRST: usize = 8;
const MOST: usize = 64;
/// Places on a meridian where the nearer body is asked for.
const PLACES: usize = 12;
/// Halvings of a piece of a meridian, and of a range of meridians, at most.
const HALVINGS: [u32; 2] = [6, 9];

/// The overlap of the bodies seen by `views` from a point in both: V = ∫ϱ³/3 dω, ϱ the distance of the nearer surface, to
/// a share of `tolerance`; `lengths` are those of the axes.
///
/// Every meridian is split where the nearer body changes and integrated by Gauss-Kronrod rules; over the azimuth the
/// trapezoidal rule is doubled, and where that does not settle, adaptive Gauss-Kronrod rules take its place.
pub(super) fn polar(views: &[View; 2], lengths: [f64; 3], tolerance: f64) -> Found {
    let rays = Rays { views, lengths, tolerance };
    let (mut sums, mut doubling) = (Integrals::default(), Doubling::new(tolerance));
    let mut around = FIRST;
    let mut extremes = Extremes::default();
    loop {
        let (start, step) = if around == FIRST { (0, 1) } else { (1, 2) };
        let mut k = start;
        while k < around {
            sums = sums + rays.meridian(TAU * k as f64 / around as f64, &mut extremes);
            k += step;
        }
        if around == FIRST
            && let Some(body) = rays.within(&extremes)
        {
            return Found::Within(body);
        }
        let mean = sums * (1.0 / around as f64);
        // Few meridians may miss what lies between them.
        if doubling.settled(mean.volume, mean.area.norm()) && around > 2 * FIRST {
            return Found::Crossing(sums * (TAU / around as f64));
        }
        if around == MOST {
            break;
        }
        around *= 2;
    }
    // Octants, so that symmetric pairs are split where they are.
    let whole = sums.volume * (TAU / around as f64);
    let sums = (0..8).map(|i| f64::from(i) * TAU / 8.0).fold(Integrals::default(), |sums, from| {
        sums + kronrod(from, from + TAU / 8.0, tolerance * whole, HALVINGS[1], &|phi| {
            rays.meridian(phi, &mut Extremes::default())
        })
    });
    Found::Crossing(sums)
}

/// ∫f over `from` … `to`, halved until the error of the volume is about `error`, and that of the area ten times as much.
fn kronrod(from: f64, to: f64, error: f64, halvings: u32, f: &impl Fn(f64) -> Integrals) -> Integrals {
    let width = to - from;
    let (mut fine, mut coarse, mut coarse_area) = (Integrals::default(), 0.0, Vector::zeros());
    for [at, weight, seven] in KRONROD {
        let value = f(from + width * at);
        fine = fine + value * (width * weight);
        coarse += width * seven * value.volume;
        coarse_area += value.area * (width * seven);
    }
    // Smooth pieces are far better by the better rule, kinks only by a factor.
    let left = |change: f64, scale: f64| change * (1e4 * change / scale).sqrt().min(1.0);
    let of_volume = left((fine.volume - coarse).abs(), fine.volume.abs());
    let of_area = left((fine.area - coarse_area).norm(), fine.area.norm() + fine.volume.abs());
    let guess = if of_area > 10.0 * of_volume { 0.1 * of_area } else { of_volume };
    if halvings == 0 || guess.is_nan() || guess <= error {
        return fine;
    }
    let middle = from + 0.5 * width;
    kronrod(from, middle, 0.75 * error, halvings - 1, f) + kronrod(middle, to, 0.75 * error, halvings - 1, f)
}

/// The directions in which the first body reaches least and most beyond the second, and by how much.
#[derive(Default)]
struct Extremes {
    least: Option<(f64, Vector)>,
    most: Option<(f64, Vector)>,
}

struct Rays<'a> {
    views: &'a [View<'a>; 2],
    lengths: [f64; 3],
    tolerance: f64,
}

impl Rays<'_> {
    /// Distances to both surfaces along `u`.
    fn reach(&self, u: Vector) -> [f64; 2] {
        self.views.each_ref().map(|v| {
            let along = v.axes[0] * u[0] + v.axes[1] * u[1] + v.axes[2] * u[2];
            v.shape.chord(v.origin, along).map_or(0.0, |ends| ends[1].max(0.0))
        })
    }
    /// How far the first body reaches beyond the second along `u`: 1/ϱ_b − 1/ϱ_a, times the larger of both, so between
    /// −1 and 1.
    fn beyond(&self, u: Vector) -> f64 {
        let [a, b] = self.reach(u);
        if a < b {
            a / b - 1.0
        } else if a > b {
            1.0 - b / a
        } else {
            0.0
        }
    }
    /// What a ray along `u` adds per solid angle.
    fn ray(&self, u: Vector) -> Integrals {
        let [a, b] = self.reach(u);
        let r = a.min(b);
        let mut sums =
            Integrals { volume: r * r * r / 3.0, first: u * (0.25 * r.powi(4)), ..Integrals::default() };
        if a <= b && r > 0.0 {
            let v = &self.views[0];
            let along = v.axes[0] * u[0] + v.axes[1] * u[1] + v.axes[2] * u[2];
            let (_, gradient) = v.shape.level(v.origin + along * r);
            let n = Vector::from(v.axes.each_ref().map(|axis| axis.dot(&gradient)));
            let n = n * (r * r / n.dot(&u));
            let [x, y, z] = self.lengths;
            let (p, q) = ([x * x, y * y, z * z], u * r);
            sums.area = n;
            sums.moment = Vector::new(
                x * (p[1] * q[1] * n[2] - p[2] * q[2] * n[1]),
                y * (p[2] * q[2] * n[0] - p[0] * q[0] * n[2]),
                z * (p[0] * q[0] * n[1] - p[1] * q[1] * n[0]),
            );
        }
        sums
    }
    /// The integrals over the meridian at the azimuth `phi`.
    fn meridian(&self, phi: f64, extremes: &mut Extremes) -> Integrals {
        let (sin, cos) = phi.sin_cos();
        let towards = |theta: f64| {
            let (s, c) = theta.sin_cos();
            Vector::new(s * cos, s * sin, c)
        };
        let at = |i: usize| PI * i as f64 / PLACES as f64;
        let f = |theta: f64| self.ray(towards(theta)) * theta.sin();
        let error = 0.1 * self.tolerance;
        let (mut sums, mut from) = (Integrals::default(), 0.0);
        let mut last = self.beyond(towards(0.0));
        for i in 0..=PLACES {
            let now = if i == 0 { last } else { self.beyond(towards(at(i))) };
            extremes.note(now, towards(at(i)));
            if (now < 0.0) != (last < 0.0) {
                let root = crossing([at(i - 1), at(i)], [last, now], |theta| self.beyond(towards(theta)));
                sums = sums + kronrod(from, root, error, HALVINGS[0], &f);
                from = root;
            }
            last = now;
        }
        sums + kronrod(from, PI, error, HALVINGS[0], &f)
    }
    /// Which body lies within the other, if one does: climbs from the direction where it reaches farthest.
    fn within(&self, extremes: &Extremes) -> Option<usize> {
        let (least, most) = (extremes.least?, extremes.most?);
        let (body, sign, mut best) = if most.0 <= 0.0 {
            (0, 1.0, most)
        } else if least.0 >= 0.0 {
            (1, -1.0, (-least.0, least.1))
        } else {
            return None;
        };
        let mut step = 0.3;
        // Convex bodies cannot rise farther than this between the places.
        while best.0 > -0.15 && step > 1e-9 {
            let mut other = Vector::zeros();
            other[best.1.iamin()] = 1.0;
            let t = best.1.cross(&other).normalize();
            let s = best.1.cross(&t);
            let better = [t, -t, s, -s]
                .map(|d| (best.1 + step * d).normalize())
                .map(|u| (sign * self.beyond(u), u))
                .into_iter()
                .fold(best, |a, b| if b.0 > a.0 { b } else { a });
            if better.0 > 0.0 {
                return None;
            }
            if better.0 > best.0 { best = better } else { step *= 0.5 }
        }
        Some(body)
    }
}

impl Extremes {
    fn note(&mut self, value: f64, u: Vector) {
        if self.least.is_none_or(|l| value < l.0) {
            self.least = Some((value, u));
        }
        if self.most.is_none_or(|m| value > m.0) {
            self.most = Some((value, u));
        }
    }
}

/// Where `f` changes its sign between `ends`, at which it has these `values`: regula falsi, Illinois.
fn crossing(mut ends: [f64; 2], mut values: [f64; 2], f: impl Fn(f64) -> f64) -> f64 {
    let mut x = ends[1];
    for _ in 0..60 {
        let before = x;
        x = (ends[0] * values[1] - ends[1] * values[0]) / (values[1] - values[0]);
        let y = f(x);
        if y == 0.0 || (x - before).abs() < 1e-10 || (ends[1] - ends[0]).abs() < 1e-12 {
            break;
        }
        if (y < 0.0) == (values[1] < 0.0) {
            values[0] *= 0.5;
        } else {
            (ends[0], values[0]) = (ends[1], values[1]);
        }
        (ends[1], values[1]) = (x, y);
    }
    x
}
