//! What lies between a point inside an ellipsoid and a piece of its surface.
use super::Posed;
use interfaces::Vector;
use nalgebra::Matrix3;
use std::f64::consts::TAU;

/// Volume and first moment of the cone from a point p to the piece of the surface that a curve encloses, as integrals
/// along the curve.
///
/// Where the ellipsoid is the unit ball and p = hk with a unit vector k, η = 1 − h and y = 1 − u·k at the place u of the curve,
/// stereographic potentials of the solid angle about k give
///
/// ```text
/// ∫dV           = 1/6 ∮ (y/(2 − y) + η) k·(u × du)
/// ∫(x − p)·k dV = 1/4 ∮ (η² − η²y/2 − hy²/3)/(2 − y) k·(u × du)
/// ∫(x − p)⊥ dV  = 1/4 ∮ (h(K − ⅓) + ηK) u⊥ k·(u × du),  K = (θ − sin θ cos θ)/(2 sin³θ), cos θ = 1 − y
/// ```
///
/// for pieces without −k; others add the whole ball. All terms are small where the piece is, so no digits are lost.
///
/// They grow without bounds where the curve comes near −k. The solid angle Ω alone needs a potential like that, from any k. With
/// A = ½∮u × du and B = 1/6 ∮ ((u × du)(u·p) + u ((u × du)·p)), which is ∫(u(u·p) − p/3)dΩ since spherical harmonics are their own
/// Laplacians but for a factor,
///
/// ```text
/// ∫dV         = 1/3 (Ω − p·A)
/// ∫(x − p) dV = 1/4 (A − 4/3 Ωp − B + p (p·A))
/// ```
///
/// Wide pieces are summed up like this, which loses digits in small ones.
pub(super) struct Cap {
    body: Posed,
    /// From the coordinates of the curve to those of the ball.
    to_ball: Matrix3<f64>,
    /// p in the ball.
    place: Vector,
    k: Vector,
    h: f64,
    eta: f64,
    /// p, as seen from the first body's centre.
    point: Vector,
    whole: bool,
    wide: bool,
    /// Sums of the volume and the first moment as above without what stands before the integrals, of wide pieces of Ω and B.
    volume: f64,
    first: Vector,
    /// Of u × du, for wide pieces.
    area: Vector,
}

/// Places of the curve with less than this 1 + u·k are too near to −k.
const NEAR: f64 = 0.4;

impl Cap {
    /// Seen from `point`, with the curve given in coordinates along `axes` about it.
    pub(super) fn new(body: &Posed, point: Vector, axes: &Matrix3<f64>) -> Self {
        let to_ball = body.to_ball();
        let place = to_ball * (point - body.centre);
        Self {
            body: *body,
            to_ball: to_ball * axes,
            place,
            k: Vector::z(),
            h: 0.0,
            eta: 0.0,
            point,
            whole: false,
            wide: false,
            volume: 0.0,
            first: Vector::zeros(),
            area: Vector::zeros(),
        }
    }
    /// Takes k along or against p such that `places` of the curve are far from −k, or elsewhere if none of them is; −k belongs to
    /// the piece if it lies in the `other` body.
    pub(super) fn aim(&mut self, places: &[[Vector; 2]], other: &Posed) {
        let middle = places.iter().map(|[w, _]| w).sum::<Vector>() / places.len() as f64;
        let radius = self.place.norm();
        let from_centre = self.place + self.to_ball * middle;
        self.k = self.place.try_normalize(0.0).or(from_centre.try_normalize(0.0)).unwrap_or(Vector::z());
        if from_centre.dot(&self.k) >= 0.0 {
            self.h = radius;
            // 1 − h from 1 − h², which the level function gives.
            self.eta = (1.0 - radius * radius) / (1.0 + radius);
        } else {
            (self.k, self.h, self.eta) = (-self.k, -radius, 1.0 + radius);
        }
        let nearest = |k: Vector| {
            let along = |[w, _]: &[Vector; 2]| 1.0 + k.dot(&(self.place + self.to_ball * w));
            places.iter().map(along).fold(f64::INFINITY, f64::min)
        };
        if nearest(self.k) < NEAR {
            self.wide = true;
            let signs = [-1.0, 0.0, 1.0];
            let axes = signs.iter().flat_map(|x| signs.iter().map(move |y| (x, y)));
            let axes = axes.flat_map(|(x, y)| signs.iter().map(move |z| Vector::new(*x, *y, *z)));
            let axes = axes.filter_map(|k| k.try_normalize(0.0)).map(|k| (nearest(k), k));
            self.k = axes.fold((0.0, self.k), |best, now| if now.0 > best.0 { now } else { best }).1;
        }
        let far = self.body.centre - self.body.ball_to_world() * self.k;
        self.whole = (other.to_ball() * (far - other.centre)).norm_squared() < 1.0;
    }
    /// Adds the place `w` of the curve and its change `dw`.
    #[inline]
    pub(super) fn add(&mut self, w: Vector, dw: Vector) {
        let du = self.to_ball * dw;
        if self.wide {
            return self.add_wide(self.place + self.to_ball * w, du);
        }
        let (k, h, eta) = (self.k, self.h, self.eta);
        // u − k, without cancellation where the curve is near k.
        let from_k = self.to_ball * w - eta * k;
        let y = 0.5 * from_k.norm_squared();
        let across = from_k + y * k;
        let turn = k.dot(&from_k.cross(&du));
        let rest = 2.0 - y;
        self.volume += (y / rest + eta) * turn;
        let upward = (eta * eta * (1.0 - 0.5 * y) - h * y * y / 3.0) / rest;
        let bulge = bulge(y);
        self.first += k * (upward * turn) + across * ((h * bulge + eta * (bulge + 1.0 / 3.0)) * turn);
    }
    fn add_wide(&mut self, u: Vector, du: Vector) {
        let area = u.cross(&du);
        self.volume += self.k.dot(&area) / (1.0 + self.k.dot(&u));
        self.first += (area * u.dot(&self.place) + u * area.dot(&self.place)) / 6.0;
        self.area += area;
    }
    /// Volume, each place of the curve having the `weight`, negative for a curve that runs the other way round.
    pub(super) fn volume(&self, weight: f64) -> f64 {
        let ball = if self.whole { 2.0 / 3.0 * TAU } else { 0.0 };
        let sum = if self.wide {
            (self.volume - 0.5 * self.place.dot(&self.area)) / 3.0
        } else {
            self.volume / 6.0
        };
        self.body.semi_axes.product() * (sum * weight + ball)
    }
    /// First moment about the point.
    pub(super) fn first(&self, weight: f64) -> Vector {
        let volume = self.body.semi_axes.product();
        let ball = if self.whole { 2.0 / 3.0 * TAU * volume } else { 0.0 };
        let sum = if self.wide {
            let (p, area) = (self.place, 0.5 * self.area);
            area - self.first + p * (p.dot(&area) - 4.0 / 3.0 * self.volume)
        } else {
            self.first
        };
        self.body.ball_to_world() * sum * (0.25 * weight * volume) + (self.body.centre - self.point) * ball
    }
}

/// Coefficients of the series 1/5, 4/35, …, each (j + 4)/(2j + 7) times the one before.
const BULGE: [f64; 10] = [
    0.2,
    0.1142857142857143,
    0.0634920634920635,
    0.03463203463203464,
    0.01864801864801865,
    0.009945609945609947,
    0.005265322912381736,
    0.0027712225854640716,
    0.0014515927828621328,
    0.0007573527562758954,
];

/// (θ − sin θ cos θ)/(2 sin³θ) − ⅓ with 1 − cos θ = y; near zero by its power series in y, whose rest is below 1e-9.
#[inline]
fn bulge(y: f64) -> f64 {
    if y > 0.25 {
        let (sin2, cos) = ((y * (2.0 - y)).max(f64::MIN_POSITIVE), 1.0 - y);
        let sin = sin2.sqrt();
        return (sin.atan2(cos) - sin * cos) / (2.0 * sin * sin2) - 1.0 / 3.0;
    }
    y * BULGE.iter().rev().fold(0.0, |sum, c| sum * y + c)
}
