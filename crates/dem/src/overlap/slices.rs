//! Capsules and cylinders with one another, with spheres and with ellipsoids: integrals over parallel slices.
mod adaptive;
mod apart;
mod ball;
mod breaks;
mod circle;
mod common;
mod crossing;
mod ellipse;
mod ellipsoid;
mod ends;
mod flat;
mod frame;
mod heights;
mod known;
mod lanes;
mod outline;
mod piece;
mod region;
mod rules;
mod slice;
mod sliced_tube;
mod sums;
mod sweep;
#[cfg(test)]
mod tests;
mod touches;
mod vertex;

use super::Overlap;
use super::integrals::Integrals;
use super::tube::{Ends, Tube};
use crate::{Form, Shape};
use frame::Frame;
use interfaces::Pose;
#[cfg(test)]
pub(super) use outline::segment;
use region::Region;
use slice::Slice;
use sliced_tube::SlicedTube;

/// The finest tolerance worth asking for.
const FINEST: f64 = 1e-12;
/// Lines nearer to one another than this share of the size are taken for one.
const SLACK: f64 = 4e-16;
/// Sine of the angle between axes that are taken for parallel.
const PARALLEL: f64 = 1e-15;
/// Sine of the angle between axes from which on they are not parallel.
const STEEP: f64 = 1e-3;

/// Slices along the axes of both bodies. A capsule's is all within a radius of a straight line, a
/// cylinder's a rectangle: what two of them share has an outline of straight pieces and arcs, along
/// which area, first moment and the integrals of the surface's normal are known exactly. What remains
/// is one integral over the height. Balls and ellipsoids are sliced across the tube's axis instead,
/// where they are discs and ellipses and tubes are discs.
#[derive(Clone, Debug, Default)]
pub(super) struct Slices {
    slices: [Slice; 2],
    region: Region,
}

impl Slices {
    /// Adds what both share, to a share of `tolerance` of its volume; answers whether these are shapes for it.
    pub(super) fn overlap(
        &mut self,
        a: (&Form<'_>, &Pose),
        b: (&Form<'_>, &Pose),
        tolerance: f64,
        out: &mut Vec<Overlap>,
    ) -> bool {
        // Also where it is not a number.
        let tolerance = FINEST.max(tolerance);
        if let (Form::Ellipsoid(_), Form::Capsule(_) | Form::Cylinder(_)) = (a.0, b.0) {
            let first = out.len();
            let found = self.overlap(b, a, tolerance, out);
            out[first..].iter_mut().for_each(|o| *o = o.swapped());
            return found;
        }
        let Some(tube) = Tube::of(a.0, a.1) else { return false };
        match b.0 {
            Form::Ellipsoid(q) => {
                let apart = tube.at.position - b.1.position;
                let reach = tube.bound() + q.bounding_radius();
                if apart.norm_squared() < reach * reach {
                    let normal = apart.try_normalize(0.0).unwrap_or(tube.axis);
                    out.extend(ellipsoid::overlap(&tube, q, b.1, normal, tolerance));
                }
            }
            _ => match Tube::of(b.0, b.1) {
                Some(other) => out.extend(self.tubes(&tube, &other, tolerance)),
                None => return false,
            },
        }
        true
    }

    fn tubes(&mut self, a: &Tube, b: &Tube, tolerance: f64) -> Option<Overlap> {
        let apart = b.at.position - a.at.position;
        let reach = a.bound() + b.bound();
        if apart.norm_squared() >= reach * reach {
            return None;
        }
        if let Some(found) = ends::overlap(a, b) {
            return Some(found);
        }
        if a.ends == Ends::Round && b.ends == Ends::Round && ends::apart(a, b) {
            return None;
        }
        let normal = (-apart).try_normalize(0.0).unwrap_or(-b.axis);
        if a.half == 0.0 {
            return ball::overlap(a.at.position, a.radius, b, normal, tolerance);
        }
        if b.half == 0.0 {
            return ball::overlap(b.at.position, b.radius, a, -normal, tolerance).map(|o| o.swapped());
        }
        let found = crossing::overlap(a, b, tolerance).or_else(|| ends::end(a, b, normal, tolerance));
        if found.is_some() {
            return found;
        }
        self.along_both(a, b, tolerance, a.axis.cross(&b.axis).norm() > STEEP)
    }

    /// By slices along both axes, from one known height at which their outline changes to the next (`known`) if there are any.
    fn along_both(&mut self, a: &Tube, b: &Tube, tolerance: f64, known: bool) -> Option<Overlap> {
        let apart = b.at.position - a.at.position;
        let both = a.axis.cross(&b.axis);
        // Across both axes or, where there is but one direction, across that and the way to the other centre.
        let symmetric = both.norm() <= PARALLEL;
        let across = if symmetric { a.axis.cross(&apart) } else { both };
        let origin = if a.bound() < b.bound() { a.at.position } else { b.at.position };
        let frame = Frame::new(origin, a.axis, across);
        let slack = SLACK * (a.bound() + b.bound() + apart.norm());
        let scene = Scene { slack, tolerance, symmetric };
        let sliced = [a, b].map(|tube| SlicedTube::new(tube, &frame));
        let found = if known { known::integrate(sliced, tolerance) } else { None };
        let [first, second] = sliced;
        let found = found.or_else(|| self.integrate(&scene, first, second))?;
        let normal = (-apart).try_normalize(0.0).unwrap_or(-a.axis);
        match found.of {
            [true, false] => Some(Overlap::whole(a.volume(), a.at.position, normal)),
            [false, true] => Some(Overlap::whole(b.volume(), b.at.position, normal)),
            _ => frame.overlap(&found.sums, found.base, normal),
        }
    }

    fn integrate(&mut self, scene: &Scene, mut a: SlicedTube, mut b: SlicedTube) -> Option<Swept> {
        let range = [a.low.max(b.low), a.high.min(b.high)];
        // Heights from the middle of those that both have.
        let base = 0.5 * (range[0] + range[1]);
        a.lift(-base);
        b.lift(-base);
        let mut range = [a.low.max(b.low), a.high.min(b.high)];
        if scene.symmetric {
            range[0] = 0.0;
        }
        if range[0].is_nan() || range[1].is_nan() || range[0] >= range[1] {
            return None;
        }
        // A tube's slices end in a line.
        let lines = range.map(|h| [a.low, a.high, b.low, b.high].contains(&h));
        let arcs = a.is_round() || b.is_round();
        let Self { slices: [one, two], region, .. } = self;
        (one.body, two.body) = (0, 1);
        let at = |h: f64, one: &mut Slice, two: &mut Slice| {
            a.slice(h, one);
            b.slice(h, two);
        };
        let ends = heights::heights(range, 1e-4 * scene.tolerance.sqrt(), |h| {
            at(h, one, two);
            apart::gap(one, two)
        })?;
        let mut round = [0, 1].map(|i| arcs || (ends[i] == range[i] && lines[i]));
        if scene.symmetric && ends[0] == 0.0 {
            round[0] = false;
        }
        let places = [(ends[0], round[0]), (ends[1], round[1])];
        let (sums, of) = sweep::sweep(&places, arcs, scene.tolerance, |h| {
            at(h, one, two);
            region.section(one, two, scene.slack)
        });
        let sums = if scene.symmetric { sums + sums.mirrored() } else { sums };
        Some(Swept { sums, base, of })
    }
}

/// How finely a pair is sliced.
struct Scene {
    slack: f64,
    tolerance: f64,
    /// Whether slices as far above the middle of all heights as below it are the same.
    symmetric: bool,
}

/// Integrals with the heights counted from a base, and of which bodies pieces of the surface were met.
struct Swept {
    sums: Integrals,
    base: f64,
    of: [bool; 2],
}
