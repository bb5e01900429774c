//! Closed surfaces of triangles, convex or not, exactly and without building what they share.
//!
//! Volume and moments are sums over the edges of the shared region: the segments in which two triangles cross, and the parts
//! of either body's edges that lie in the other. Which triangles cross, and where along an edge, is decided by exact signs with
//! consistent ties ([`signs`]), so coplanar and coincident faces need no care.
mod body;
mod crossings;
mod groups;
mod inside;
mod pairs;
mod signs;
mod sums;
#[cfg(test)]
mod tests;

pub(crate) use groups::Groups;
pub(crate) use inside::holds;
pub(crate) use sums::Sums;

use super::Overlap;
use crate::shapes::Facets;
use body::{Body, Marks};
use crossings::Crossings;
use interfaces::{Point, Pose, Vector};
use nalgebra::Matrix3;
use signs::Side;

/// Overlaps of closed surfaces of triangles; keeps the memory that they take.
#[derive(Clone, Debug, Default)]
pub(crate) struct FacetOverlap {
    marks: [Marks; 2],
    crossings: Crossings,
    groups: Groups,
    stack: Vec<[u32; 2]>,
}

impl FacetOverlap {
    /// Whether [`Overlap::pivot`] is requested.
    pub(crate) fn set_pivots(&mut self, pivots: bool) {
        self.groups.pivots = pivots;
    }

    /// One patch per connected region.
    ///
    /// # Errors
    /// [`Impossible`], if a surface crosses itself.
    pub(crate) fn overlap(
        &mut self,
        a: &Facets,
        at_a: &Pose,
        b: &Facets,
        at_b: &Pose,
        out: &mut Vec<Overlap>,
    ) -> Result<(), Impossible> {
        // In the frame of the smaller one, where the numbers are small.
        if a.radius < b.radius {
            let first = out.len();
            self.overlap(b, at_b, a, at_a, out)?;
            out[first..].iter_mut().for_each(|o| *o = o.swapped());
            return Ok(());
        }
        let apart = at_a.position - at_b.position;
        if apart.norm() > a.radius + b.radius {
            return Ok(());
        }
        let turn = at_b.orientation.inverse() * at_a.orientation;
        let shift = at_b.orientation.inverse_transform_vector(&apart);
        let turn = *turn.to_rotation_matrix().matrix();
        let Some([low, high]) = meeting(a, &turn, shift, b) else { return Ok(()) };
        let reference = 0.5 * (low + high);
        let [marks_a, marks_b] = &mut self.marks;
        marks_a.start(a);
        marks_b.start(b);
        let moved = Some((turn, shift));
        let mut bodies = Bodies {
            first: Body { facets: a, marks: marks_a, moved, reference },
            second: Body { facets: b, marks: marks_b, moved: None, reference },
        };
        self.crossings.clear();
        bodies.find_pairs(&mut self.stack, &mut self.crossings);
        self.groups.clear(&self.crossings);
        bodies.find_inside(&self.crossings, &mut self.groups);
        let regions = bodies.sum(&self.crossings, &mut self.groups);
        let to_world = |x: Vector| (at_b.to_world(Point::from(reference + x)), at_b.orientation * x);
        let round_off = 1e-12 * b.radius.powi(3);
        let (volume, most) = (regions.iter().map(|r| r.sums.volume).sum::<f64>(), (high - low).product());
        let least = regions.iter().map(|r| r.sums.volume).fold(0.0, f64::min);
        if !(-round_off <= least && volume <= most + round_off) {
            return Err(Impossible { volume: if least < 0.0 { least } else { volume }, most });
        }
        let towards = apart.try_normalize(0.0).unwrap_or(Vector::x());
        let own = regions.iter().filter(|r| r.sums.volume > 0.0);
        out.extend(own.map(|r| r.sums.overlap(&r.outline, to_world, towards)));
        Ok(())
    }
}

/// Surfaces that share a negative volume, or more than the boxes around them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Impossible {
    pub(crate) volume: f64,
    pub(crate) most: f64,
}

/// The two bodies, in the frame of the second.
struct Bodies<'a> {
    first: Body<'a>,
    second: Body<'a>,
}

impl<'a> Bodies<'a> {
    fn on(&mut self, side: Side) -> &mut Body<'a> {
        match side {
            Side::First => &mut self.first,
            Side::Second => &mut self.second,
        }
    }
}

/// What the boxes of the two share, as its corners, in the frame of the second; `None` if they are apart.
fn meeting(a: &Facets, turn: &Matrix3<f64>, shift: Vector, b: &Facets) -> Option<[Vector; 2]> {
    let ([low, high], [low_b, high_b]) = (a.bounds, b.bounds);
    let (centre, half) = (turn * (0.5 * (low + high)) + shift, turn.abs() * (0.5 * (high - low)));
    let slack = Vector::repeat(1e-14 * (a.radius + b.radius + shift.norm()));
    let (low, high) = (low_b.sup(&(centre - half)) - slack, high_b.inf(&(centre + half)) + slack);
    (low <= high).then_some([low, high])
}
