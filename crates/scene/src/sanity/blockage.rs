//! The share of a section that bodies block.
use crate::setup::{BodySetup, Motion, Setup};
use fv_mesh::Axis;
use interfaces::{Aabb, Point};

/// Planes across the stream between the ends of the bodies, besides those through their centres.
const PLANES: usize = 33;
/// Signed distances that are computed for one axis, about.
const SAMPLES: usize = 200_000;
/// Samples along each axis of a body's box: no fewer, no more.
const ALONG: [usize; 2] = [8, 256];

/// The share of a plane that bodies block, where it is, and how many bodies it is of.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Blockage {
    pub(super) share: f64,
    pub(super) at: f64,
    pub(super) bodies: usize,
}

/// A body within the box, and its bounds.
struct Held<'a> {
    body: &'a BodySetup,
    bounds: Aabb,
}

impl Held<'_> {
    /// Area of its section with the plane at `x` along axis `a`, from `n` samples along each other axis \[m²; m\].
    fn section(&self, a: usize, x: f64, n: usize, dim: usize) -> f64 {
        let (min, extent) = (self.bounds.min, self.bounds.extent());
        if !(min[a]..=self.bounds.max[a]).contains(&x) {
            return 0.0;
        }
        let others: Vec<usize> = (0..dim).filter(|&c| c != a).collect();
        let total = n.pow(others.len() as u32);
        let inside = |mut k: usize| {
            let mut at = Point::origin();
            at[a] = x;
            for &c in &others {
                at[c] = min[c] + extent[c] * ((k % n) as f64 + 0.5) / n as f64;
                k /= n;
            }
            self.body.shape.signed_distance(self.body.pose.to_body(at), 0.0) < 0.0
        };
        let share = (0..total).filter(|&k| inside(k)).count() as f64 / total as f64;
        share * others.iter().map(|&c| extent[c]).product::<f64>()
    }
}

impl Setup {
    /// The largest share of a plane normal to axis `a` that lies in bodies, and where: all that stay where they are together, or a free one. Bodies that
    /// reach beyond the box are its walls.
    pub(super) fn blockage(&self, a: usize) -> Blockage {
        let dim = self.dim();
        let section: f64 = (0..dim).filter(|&c| c != a).map(|c| Axis::length(&self.axes[c])).product();
        let (mut free, mut fixed) = (Vec::new(), Vec::new());
        for body in self.bodies.list.iter().filter(|b| self.holds(b)) {
            let held = Held { body, bounds: body.shape.aabb().posed(&body.pose) };
            if matches!(body.motion, Motion::Free(_)) { &mut free } else { &mut fixed }.push(held);
        }
        // The largest is enough of bodies that move one by one.
        let size = |h: &Held<'_>| (0..dim).filter(|&c| c != a).map(|c| h.bounds.extent()[c]).product::<f64>();
        let largest = free.into_iter().max_by(|x, y| size(x).total_cmp(&size(y)));
        let groups = [fixed, largest.into_iter().collect()];
        let mut most = Blockage::default();
        for group in groups.iter().filter(|group| !group.is_empty()) {
            let ends = |h: &Held<'_>| [h.bounds.min[a], h.bounds.max[a]];
            let low = group.iter().map(|h| ends(h)[0]).fold(f64::INFINITY, f64::min);
            let high = group.iter().map(|h| ends(h)[1]).fold(f64::NEG_INFINITY, f64::max);
            let between = (0..PLANES).map(|k| low + (high - low) * (k as f64 + 0.5) / PLANES as f64);
            let centres = group.iter().take(PLANES).map(|h| 0.5 * (ends(h)[0] + ends(h)[1]));
            let planes: Vec<f64> = between.chain(centres).collect();
            let crossings: usize = planes
                .iter()
                .map(|x| group.iter().filter(|h| (ends(h)[0]..=ends(h)[1]).contains(x)).count())
                .sum();
            let each = (SAMPLES / crossings.max(1)) as f64;
            let n = (each.powf(1.0 / (dim as f64 - 1.0)) as usize).clamp(ALONG[0], ALONG[1]);
            for x in planes {
                let blocked = group.iter().map(|h| h.section(a, x, n, dim)).sum::<f64>() / section;
                if blocked > most.share {
                    most = Blockage { share: blocked, at: x, bodies: group.len() };
                }
            }
        }
        most
    }
}
