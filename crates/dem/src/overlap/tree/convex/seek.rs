//! A place in both of two convex bodies, however small what they share is.
use super::super::deepest::{Deepest, Search};
use super::polytope::{Polytope, Side};
use interfaces::Vector;

/// Most planes for the search, and as many more to go deeper.
const MOST: usize = 70;
const DEEPER: usize = 8;

impl Polytope {
    /// The centroid, and the volume.
    fn centroid(&self) -> Option<(Vector, f64)> {
        // About a corner: far from the origin sums lose their digits.
        let about = self.corners.iter().find(|c| c.kept)?.x;
        let (mut volume, mut first) = (0.0, Vector::zeros());
        for side in self.alive() {
            let x = |c: usize| self.corners[c].x - about;
            let mut edges = side.edges();
            let [start, ..] = edges.next()?;
            for [i, j, _] in edges {
                let own = x(start).dot(&x(i).cross(&x(j))) / 6.0;
                volume += own;
                first += (0.25 * own) * (x(start) + x(i) + x(j));
            }
        }
        (volume > 0.0).then(|| (about + first / volume, volume))
    }
}

/// Where both bodies are, by the centroids of ever smaller polyhedra (Levin 1965, Dokl. Akad. Nauk SSSR 160, 1244): what a plane
/// through the nearest point of a body, or through the centroid, leaves is at most 1 − 1/e of the volume. Convexity is not looked
/// at; what is found is in both.
pub(super) fn seek(polytope: &mut Polytope, search: &Search<'_>) -> Option<Deepest> {
    let half = 1.001 * search.half;
    polytope.begin(-half, half);
    let mut best: Option<(Vector, [f64; 2])> = None;
    let level = |d: [f64; 2]| d[0].max(d[1]);
    let mut deeper = 0;
    let mut whole = 0.0;
    for _ in 0..MOST {
        let Some((x, volume)) = polytope.centroid() else { break };
        whole = f64::max(whole, volume);
        if volume < 1e-24 * whole {
            break;
        }
        let d = search.distances(x);
        if best.is_none_or(|(_, other)| level(d) < level(other)) && level(d) < 0.0 {
            best = Some((x, d));
        }
        deeper += usize::from(best.is_some());
        if deeper > DEEPER {
            break;
        }
        let body = usize::from(d[1] > d[0]);
        let step = 1e-6 * volume.cbrt();
        let slope = search.slope(body, x, d[body], step);
        let Some(normal) = slope.try_normalize(1e-9) else { break };
        // What is no deeper than the best so far is cut off.
        let before = best.map_or(0.0, |(_, other)| level(other));
        let ahead = (d[body] - before).max(0.0) / slope.norm();
        let side = Side::new(normal, x - ahead * normal, slope.norm(), Some(body));
        polytope.look(&side);
        if polytope.cut(side, 0.0).is_none() {
            break;
        }
    }
    search.stay(best?.0)
}
