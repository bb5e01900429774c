//! Ellipsoids and cylinders at plane walls, exactly.
use super::closed::{segment, sphere_wall};
use super::columns::rules::KRONROD;
use super::{Overlap, outline};
use crate::{Cylinder, Ellipsoid, HalfSpace, Shape};
use interfaces::{Point, Pose, Vector};
use nalgebra::Matrix3;
use std::f64::consts::PI;

/// All of a body within the wall with outward normal `n`.
fn sunk(shape: &dyn Shape, at: &Pose, n: Vector) -> Overlap {
    Overlap::whole(shape.inertia(1.0).volume, at.position, n)
}

/// An ellipsoid E at a `wall` that stands where it is: the affine image of the cap of a unit ball that is cut off at D/h from
/// its centre, D the distance of the centre and h = |E n| the farthest reach along the normal. The cut has the area
/// abc/h times the ball's; S and the moment are −∫ n dA and −∫ (x − centroid) × n dA over it.
pub(super) fn ellipsoid(shape: &Ellipsoid, at: &Pose, wall: &HalfSpace) -> Option<Overlap> {
    let (e, n) = (shape.semi_axes(), wall.normal());
    let scaled = e.component_mul(&at.orientation.inverse_transform_vector(&n));
    let reach = scaled.norm();
    let distance = wall.signed_distance(at.position) / reach;
    let ball = sphere_wall(1.0, Point::origin(), distance, scaled / reach)?;
    if ball.area() == 0.0 {
        return Some(sunk(shape, at, n));
    }
    let to_world = |x: Vector| at.orientation * e.component_mul(&x);
    let gradient = n * -(ball.area() * e.product() / reach);
    let to_cut = to_world(scaled * (-distance / reach) - ball.centroid.coords);
    // The cut of the ball has ∫ x xᵀ dA = ¼ A ρ² (1 − s sᵀ), ρ its radius and s the direction to it.
    let axes = at.orientation.to_rotation_matrix().matrix() * Matrix3::from_diagonal(&e);
    let along = scaled / reach;
    let across = Matrix3::identity() - along * along.transpose();
    let quarter = 0.25 * gradient.norm() * ball.area() / PI;
    let spread = axes * across * axes.transpose() * quarter;
    Some(Overlap {
        volume: e.product() * ball.volume,
        centroid: at.position + to_world(ball.centroid.coords),
        normal: n,
        gradient,
        moment: to_cut.cross(&gradient),
        pivot: outline::pivot(&spread, n),
    })
}

/// A cylinder at a `wall` that stands where it is: whole discs, then segments whose depth changes linearly along the axis. With
/// the angle α that spans half a segment as the variable, all integrands are products of α and its sines, and 15 points are
/// exact to round-off.
pub(super) fn cylinder(shape: &Cylinder, at: &Pose, wall: &HalfSpace) -> Option<Overlap> {
    let (r, h, n) = (shape.radius(), 0.5 * shape.length(), wall.normal());
    let distance = wall.signed_distance(at.position);
    let mut axis = at.orientation * Vector::z();
    // The axis leads out of the wall.
    if axis.dot(&n) < 0.0 {
        axis = -axis;
    }
    let cos = axis.dot(&n);
    let off = n - axis * cos;
    let sin = off.norm();
    let out = off.try_normalize(0.0).unwrap_or_default();
    if distance - cos * h - sin * r >= 0.0 {
        return None;
    }
    if distance + cos * h + sin * r <= 0.0 {
        return Some(sunk(shape, at, n));
    }
    let mut sums = Sums::default();
    // Height at which the plane is at u radii from the axis, and the other way round; u = −1 ends the whole discs.
    let height = |u: f64| (u * sin * r - distance) / cos;
    let across = |z: f64| ((distance + cos * z) / (sin * r)).clamp(-1.0, 1.0);
    if sin < 1e-14 {
        let top = -distance / cos;
        sums.discs(r, -h, top);
        (sums.cut, sums.cut_z) = (PI * r * r, PI * r * r * top);
        let quarter = 0.25 * PI * r.powi(4);
        sums.spread = [top * sums.cut_z, 0.0, quarter, quarter];
    } else {
        let (first, last) = (height(-1.0), height(1.0));
        // Infinite or not a number where the axis is along the plane.
        let (z0, u0) = if first > -h { (first, -1.0) } else { (-h, across(-h)) };
        let (z1, u1) = if last < h { (last, 1.0) } else { (h, across(h)) };
        sums.discs(r, -h, z0.min(h));
        let length = if z0 == -h && z1 == h { 2.0 * h } else { (u1 - u0) * sin * r / cos };
        sums.segments(r, [u0, u1], z1, length, sin);
    }
    let volume = sums.volume;
    if volume <= 0.0 {
        return None;
    }
    let middle = (axis * sums.z + out * sums.out) / volume;
    let gradient = n * -sums.cut;
    let first = axis * sums.cut_z + out * sums.cut_out;
    let to_cut = first - middle * sums.cut;
    // Without a direction away from the axis, any across it.
    let out = if sin < 1e-14 { axis.cross(&at.orientation.transform_vector(&Vector::x())) } else { out };
    let side = axis.cross(&out);
    let [zz, zu, uu, ww] = sums.spread;
    let mixed = axis * out.transpose() + out * axis.transpose();
    let about_origin =
        axis * axis.transpose() * zz + mixed * zu + out * out.transpose() * uu + side * side.transpose() * ww;
    let spread = about_origin - first * first.transpose() / sums.cut;
    let pivot = if sums.cut > 0.0 { outline::pivot(&spread, n) } else { Matrix3::zeros() };
    let moment = -to_cut.cross(&n);
    Some(Overlap { volume, centroid: at.position + middle, normal: n, gradient, moment, pivot })
}

/// Integrals over the part of a cylinder within a wall and over the plane that cuts it: of one, of the height and of the
/// distance from the axis.
#[derive(Default)]
struct Sums {
    volume: f64,
    z: f64,
    out: f64,
    cut: f64,
    cut_z: f64,
    cut_out: f64,
    /// ∫ z², z u, u² and w² over the plane, u away from the axis and w across both.
    spread: [f64; 4],
}

impl Sums {
    /// Whole discs between two heights.
    fn discs(&mut self, r: f64, from: f64, to: f64) {
        let length = (to - from).max(0.0);
        let volume = PI * r * r * length;
        self.volume += volume;
        self.z += volume * 0.5 * (from + to);
    }
    /// Segments beyond u radii from the axis, u between the `ends`, over a `length` up to the height `top`.
    fn segments(&mut self, r: f64, ends: [f64; 2], top: f64, length: f64, sin: f64) {
        let [wide, narrow] = ends.map(f64::acos);
        let (middle, mut range) = (0.5 * (wide + narrow), wide - narrow);
        let rise = ends[1] - ends[0];
        if range < 0.5 && middle > 0.0 {
            // The difference of two near angles.
            range = 2.0 * (0.5 * rise / middle.sin()).min(1.0).asin();
        }
        for [at, weight, _] in KRONROD {
            let angle = narrow + at * range;
            // Share of the length below the top, and of the length per share of the range.
            let (below, density) = if rise > 0.0 {
                let below = 2.0 * (narrow + 0.5 * at * range).sin() * (0.5 * at * range).sin() / rise;
                (below, angle.sin() * range / rise)
            } else {
                (at, 1.0)
            };
            let (z, dz) = (top - below * length, weight * density * length);
            let half = (0.5 * angle).sin();
            let part = segment(r, 2.0 * r * half * half);
            self.volume += dz * part.volume;
            self.z += dz * part.volume * z;
            self.out -= dz * part.volume * part.centroid;
            let strip = dz * part.cut / sin;
            self.cut += strip;
            self.cut_z += strip * z;
            let u = -r * angle.cos();
            self.cut_out += strip * u;
            let second = [z * z, z * u, u * u, part.cut * part.cut / 12.0];
            self.spread.iter_mut().zip(second).for_each(|(sum, x)| *sum += strip * x);
        }
    }
}
