//! Checks whether the grid resolves bodies that are walls.
use super::distances::{Distances, Ticks};
use crate::IbmError;
use crate::neighbour::Neighbour;
use interfaces::{Aabb, Bodies, BodyId, Point, Solid, ThinPart, Vector, VelocityField};

/// Faces of the cells along every axis: the corners of the cells.
pub(crate) fn vertices(velocity: &dyn VelocityField) -> [Ticks; 3] {
    [0, 1, 2].map(|a| match a < velocity.dim() {
        true => Ticks::faces(&velocity.lattice(a).axes[a]),
        false => Ticks::nodes(&velocity.lattice(0).axes[a]),
    })
}

/// Requires that every body has a node inside; `corners` are the corners of the cells.
///
/// # Errors
/// [`IbmError::Outside`] for a body that reaches beyond a bounded side, [`IbmError::Unseen`] for others.
pub(crate) fn require_seen<B: Bodies + ?Sized>(
    bodies: &B,
    unseen: &[BodyId],
    corners: &[Ticks],
) -> Result<(), IbmError> {
    let Some(&body) = unseen.first() else { return Ok(()) };
    let bounds = bodies.aabb(body);
    let mut beyond: Option<(f64, IbmError)> = None;
    for (axis, box_) in corners.iter().enumerate().filter_map(|(a, ticks)| Some((a, ticks.ends()?))) {
        let (low, high) = (bounds.min[axis], bounds.max[axis]);
        let overlap = high.min(box_[1]) - low.max(box_[0]);
        if (low < box_[0] || high > box_[1]) && beyond.as_ref().is_none_or(|(least, _)| overlap < *least) {
            beyond = Some((overlap, IbmError::Outside { body, axis, low, high, box_ }));
        }
    }
    let extent = bodies.solid(body).aabb().extent();
    let size = extent.iter().take(corners.len()).fold(f64::INFINITY, |m, &e| m.min(e));
    let spacing = corners.iter().map(Ticks::widest).fold(f64::INFINITY, f64::min);
    Err(beyond.map_or(IbmError::Unseen { body, size, spacing }, |(_, outside)| outside))
}

/// Parts of bodies so thin that fluid lies on both sides of them within one link between neighbouring nodes: with the chord τ of the solid
/// along the inward normal n, a link of length h_a along axis a crosses the solid over τ/|n_a|, so none has both its ends in the fluid
/// where
///
/// ```text
/// τ ≥ max_a |n_a| h_a
/// ```
///
/// Chords begin at the foot points of the corners of cells in a layer of this width around the body, each of which counts for
/// the area V/(layer's width) of its cell of volume V. What lies inside another body or beyond the box is no fluid.
///
/// # Errors
/// [`IbmError::Thin`] for a body of whose surface more than half is that thin; of others these are parts.
pub(crate) fn thin_parts<B: Bodies + ?Sized>(
    velocity: &dyn VelocityField,
    bodies: &B,
    corners: &[Ticks; 3],
    distances: &Distances,
) -> Result<Vec<ThinPart>, IbmError> {
    let dim = velocity.dim();
    let mut surveys: Vec<Survey> = (0..bodies.n_bodies()).map(|_| Survey::default()).collect();
    for near in distances.near.iter().filter(|near| near.distance >= 0.0) {
        let (body, pose) = (near.body(), bodies.pose(near.body()));
        let solid = bodies.solid(body);
        let gaps = Vector::from_fn(|a, _| if a < dim { corners[a].gap(near.node[a] as usize) } else { 0.0 });
        if near.distance >= gaps.max() {
            continue;
        }
        let at = |arm: Vector| Point::from(pose.orientation.inverse_transform_vector(&arm));
        // Shapes need not have a normal exactly on their surface, where differences of the distance have.
        let normal = match near.distance > 0.0 {
            true => solid.normal(at(near.arm), distances.band),
            false => ByDistance(solid).normal(at(near.arm), distances.band),
        };
        let normal = pose.orientation * normal;
        let width = (1.0 - ROUND) * normal.abs().component_mul(&gaps).max();
        if near.distance >= width {
            continue;
        }
        let survey = &mut surveys[body.0];
        let area = gaps.iter().take(dim).product::<f64>() / width;
        survey.area += area;
        let foot = near.arm - near.distance * normal;
        let distance =
            |depth: f64| solid.signed_distance(at(foot - depth * normal), distances.band.max(width));
        // A ball of this size fits in.
        if distance(0.5 * width) <= (ROUND - 0.5) * width {
            continue;
        }
        let neighbours = survey.neighbours.get_or_insert_with(|| {
            let (mut found, all) = (Vec::new(), (0..bodies.n_bodies()).map(BodyId));
            Neighbour::list(velocity.lattice(0), bodies, body, 1.0, all, &mut found);
            found
        });
        let in_the_box = |x: Point| {
            (0..dim).all(|a| corners[a].ends().is_none_or(|[low, high]| low < x[a] && x[a] < high))
        };
        let is_fluid = |depth: f64| {
            let x = pose.position + foot - depth * normal;
            distance(depth) > 0.0 && in_the_box(x) && !neighbours.iter().any(|n| n.holds(bodies, x, 0.0))
        };
        if let Some(thickness) = chord(width, is_fluid) {
            survey.thin_area += area;
            let place = pose.position + foot;
            let part = ThinPart { body: body.0, share: 0.0, thickness, needed: width, place };
            match &survey.thinnest {
                Some(thinnest) if thinnest.thickness * width <= thickness * thinnest.needed => {}
                _ => survey.thinnest = Some(part),
            }
        }
    }
    let part = |survey: Survey| {
        survey.thinnest.map(|part| ThinPart { share: survey.thin_area / survey.area, ..part })
    };
    let parts: Vec<ThinPart> = surveys.into_iter().filter_map(part).collect();
    match parts.iter().find(|part| part.share > MOST) {
        Some(&part) => Err(IbmError::Thin { part }),
        None => Ok(parts),
    }
}

/// Share of a body's surface beyond which the body itself is thin, not a part of it.
const MOST: f64 = 0.5;

/// Round-off, as a share of a length.
const ROUND: f64 = 1e-6;

/// Samples of a chord.
const SAMPLES: usize = 16;

/// A solid that is known by its distances alone.
struct ByDistance<'a>(&'a dyn Solid);

impl Solid for ByDistance<'_> {
    fn signed_distance(&self, x: Point, band: f64) -> f64 {
        self.0.signed_distance(x, band)
    }
    fn aabb(&self) -> Aabb {
        self.0.aabb()
    }
}

/// Surface of one body.
#[derive(Default)]
struct Survey {
    area: f64,
    thin_area: f64,
    thinnest: Option<ThinPart>,
    /// Bodies that may touch it, listed when first needed.
    neighbours: Option<Vec<Neighbour>>,
}

/// Depth at which the solid ends, if it does before `width`: the first of the samples in the fluid, by bisection.
fn chord(width: f64, is_fluid: impl Fn(f64) -> bool) -> Option<f64> {
    let depth = |k: usize| width * k as f64 / SAMPLES as f64;
    let first = (1..=SAMPLES).find(|&k| is_fluid(depth(k)))?;
    let (mut low, mut high) = (depth(first - 1), depth(first));
    while high - low > 1e-3 * width {
        let middle = 0.5 * (low + high);
        if is_fluid(middle) { high = middle } else { low = middle }
    }
    Some(high)
}

#[cfg(test)]
mod tests;
