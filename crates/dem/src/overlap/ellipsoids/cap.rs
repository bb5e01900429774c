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
    volume: f64,
    first: Vector,
}

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
            volume: 0.0,
            first: Vector::zeros(),
        }
    }
    /// Takes k along or against p such that places of the curve, with mean `middle`, are far from −k; −k belongs to the
    /// piece if it lies in the `other` body.
    pub(super) fn aim(&mut self, middle: Vector, other: &Posed) {
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
        let far = self.body.centre - self.body.ball_to_world() * self.k;
        self.whole = (other.to_ball() * (far - other.centre)).norm_squared() < 1.0;
    }
    #[inline]
    /// Adds the place `w` of the curve and its change `dw`.
    pub(super) fn add(&mut self, w: Vector, dw: Vector) {
        let (k, h, eta) = (self.k, self.h, self.eta);
        // u − k, without cancellation where the curve is near k.
        let from_k = self.to_ball * w - eta * k;
        let du = self.to_ball * dw;
        let y = 0.5 * from_k.norm_squared();
        let across = from_k + y * k;
        let turn = k.dot(&from_k.cross(&du));
        let rest = 2.0 - y;
        self.volume += (y / rest + eta) * turn;
        let upward = (eta * eta * (1.0 - 0.5 * y) - h * y * y / 3.0) / rest;
        let bulge = bulge(y);
        self.first += k * (upward * turn) + across * ((h * bulge + eta * (bulge + 1.0 / 3.0)) * turn);
    }
    /// Volume, each place of the curve having the `weight`, negative for a curve that runs the other way round.
    pub(super) fn volume(&self, weight: f64) -> f64 {
        let ball = if self.whole { 2.0 / 3.0 * TAU } else { 0.0 };
        self.body.semi_axes.product() * (self.volume * weight / 6.0 + ball)
    }
    /// First moment about the point.
    pub(super) fn first(&self, weight: f64) -> Vector {
        let volume = self.body.semi_axes.product();
        let ball = if self.whole { 2.0 / 3.0 * TAU * volume } else { 0.0 };
        self.body.ball_to_world() * self.first * (0.25 * weight * volume)
            + (self.body.centre - self.point) * ball
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
