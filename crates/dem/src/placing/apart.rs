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
        self.boxes.clear();
        self.boxes.push((bounds.min + half, half));
        let mut seen = 0;
        while let Some((centre, half)) = self.boxes.pop() {
            let reach = half.norm();
            let d = depth(centre, reach);
            if d >= reach {
                continue;
            }
            seen += 1;
            if d < 0.0 || reach < finest || seen > MOST {
                return false;
            }
            let axis = half.imax();
            let mut inner = half;
            inner[axis] *= 0.5;
            for side in [-1.0, 1.0] {
                let mut middle = centre;
                middle[axis] += side * inner[axis];
                self.boxes.push((middle, inner));
            }
        }
        true
    }
}
