//! Whether two functions of space are ever negative together.
use interfaces::{Aabb, Point, Vector};

/// Divides boxes until it is certain. Keeps its memory.
#[derive(Clone, Debug, Default)]
pub(super) struct Apart {
    boxes: Vec<(Point, Vector)>,
}

/// After so many boxes bodies count as too near: they are parallel over a large part of their surface, and nearly touch.
const MOST: usize = 100_000;

impl Apart {
    /// Whether `depth(x, band)` is nowhere below zero within `bounds`. It must not change by more than the way that x goes where it is below
    /// `band`, and stay above `band` else: the larger one of two signed distances does so. Minima within ± `finest` count as negative.
    ///
    /// Two bodies with signed distances a and b are at least g apart if max(a, b) ≥ g/2 everywhere: midway between the two
    /// nearest points both are half their distance.
    pub(super) fn nowhere_below(
        &mut self,
        bounds: &Aabb,
        finest: f64,
        mut depth: impl FnMut(Point, f64) -> f64,
    ) -> bool {
        let half = 0.5 * bounds.extent();
        if half.min() < 0.0 {
            return true;
        }
        let middle = bounds.min + half;
        let d = depth(middle, half.norm());
        if d < 0.0 {
            return false;
        }
        self.boxes.clear();
        if d < half.norm() {
            self.boxes.push((middle, half));
        }
        let mut seen = 0;
        while let Some((centre, half)) = self.boxes.pop() {
            seen += 1;
            if half.norm() < finest || seen > MOST {
                return false;
            }
            let axis = half.imax();
            let mut inner = half;
            inner[axis] *= 0.5;
            let reach = inner.norm();
            let halves = [-1.0, 1.0].map(|side| {
                let mut middle = centre;
                middle[axis] += side * inner[axis];
                (depth(middle, reach), middle)
            });
            // The half that seems deeper is the next one.
            let deeper = usize::from(halves[1].0 < halves[0].0);
            for (d, middle) in [halves[1 - deeper], halves[deeper]] {
                if d < 0.0 {
                    return false;
                }
                if d < reach {
                    self.boxes.push((middle, inner));
                }
            }
        }
        true
    }
}
