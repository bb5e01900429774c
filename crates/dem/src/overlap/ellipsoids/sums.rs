//! Integrals along the curve where two ellipsoids cross.
use super::cap::Cap;
use super::common_point::CommonPoint;
use super::{Overlap, Posed};
use crate::overlap::doubling::Doubling;
use interfaces::{Point, Vector};
use nalgebra::Matrix3;

/// Integrals along the curve, given by places on the unit sphere.
pub(super) struct Sums {
    bodies: [Posed; 2],
    /// From the coordinates of the curve to lengths, about this point as seen from the first body's centre.
    axes: Matrix3<f64>,
    point: Vector,
    /// From the first body into the second.
    upwards: Vector,
    caps: [Cap; 2],
    /// S, and −½∮|x|²dx.
    area: Vector,
    moment: Vector,
}

impl Sums {
    /// In coordinates turned by `turn` from those of the common point.
    pub(super) fn new(a: Posed, b: Posed, common: &CommonPoint, turn: &Matrix3<f64>) -> Self {
        let axes = common.axes * turn;
        let caps = [Cap::new(&a, common.point, &axes), Cap::new(&b, common.point, &axes)];
        let (area, moment) = (Vector::zeros(), Vector::zeros());
        let upwards = common.axes.column(2).normalize();
        Self { bodies: [a, b], axes, point: common.point, upwards, caps, area, moment }
    }
    /// Looks where the curve is, before anything is added.
    pub(super) fn aim(&mut self, places: &[[Vector; 2]]) {
        let [a, b] = &self.bodies;
        self.caps[0].aim(places, b);
        self.caps[1].aim(places, a);
    }
    /// Adds the place `w` of the curve and its change `dw`.
    #[inline]
    pub(super) fn add(&mut self, w: Vector, dw: Vector) {
        self.caps.iter_mut().for_each(|cap| cap.add(w, dw));
        let (x, dx) = (self.axes * w, self.axes * dw);
        self.area += 0.5 * x.cross(&dx);
        self.moment -= 0.5 * x.norm_squared() * dx;
    }
    fn volume(&self, weight: f64) -> f64 {
        self.caps[0].volume(weight) + self.caps[1].volume(-weight)
    }
    /// Whether more places, each of this `weight`, would change no more than the tolerance.
    pub(super) fn settled(&self, doubling: &mut Doubling, weight: f64) -> bool {
        doubling.settled(self.volume(weight), self.area.norm() * weight)
    }
    /// What both share if each place has this `weight`; `None` if it is nothing.
    pub(super) fn overlap(&self, weight: f64) -> Option<Overlap> {
        let (volume, gradient) = (self.volume(weight), self.area * weight);
        let middle = (self.caps[0].first(weight) + self.caps[1].first(-weight)) / volume;
        let position: Point = self.bodies[0].position;
        (volume > 0.0).then(|| Overlap {
            volume,
            centroid: position + (self.point + middle),
            normal: (-gradient).try_normalize(0.0).unwrap_or(-self.upwards),
            gradient,
            moment: self.moment * weight - middle.cross(&gradient),
            pivot: nalgebra::Matrix3::zeros(),
        })
    }
}
