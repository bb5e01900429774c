//! Mean velocity over a cut face (3D), relative to the wall, from the distances at its node and corners.
use super::profile::Support;
use interfaces::CutFace;

/// Distances from the wall over a rectangular face: linear on the four triangles between the corners and the node in the middle, less what
/// that exceeds the mean of a distance that bends (Simpson's rule), so they are continuous in each of the five, and of their signs where the wall touches the face.
pub(super) struct FaceDistances {
    triangles: [[f64; 3]; 4],
    own: f64,
    least: f64,
    /// Increase from side to side along both axes of the face.
    pub(super) rise: [f64; 2],
}

/// Increases below this share of the distances over a face are round-off.
const FLAT: f64 = 1e-9;

impl FaceDistances {
    /// From those of the corners, the first axis fastest, and of the node.
    pub(super) fn new(d: [f64; 4], own: f64) -> Self {
        let [least, most] = [f64::min, f64::max].map(|best| d.iter().fold(own, |end: f64, &d| best(end, d)));
        // The mean over the triangles exceeds that of a quadratic (Simpson) by this much; less of it counts where the wall only touches the face.
        let bend = (d.iter().sum::<f64>() - 4.0 * own) / 12.0;
        let depth = most.min(-least).max(0.0);
        let bend = if depth > 0.0 { bend * depth / (depth + bend.abs()) } else { 0.0 };
        let triangles = [[0, 1], [1, 3], [3, 2], [2, 0]].map(|[i, j]| [d[i], d[j], own].map(|d| d - bend));
        let rise = [0.5 * (d[1] + d[3] - d[0] - d[2]), 0.5 * (d[2] + d[3] - d[0] - d[1])];
        let least = least - bend;
        Self { triangles, own, least, rise }
    }

    /// Share of the face where the distance is positive.
    pub(super) fn open(&self) -> f64 {
        self.moments(0.0)[0]
    }

    /// Means over the face of 1, d and d² where d is positive, d being the distance less `level`.
    fn moments(&self, level: f64) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for triangle in &self.triangles {
            let part = positive_part(triangle.map(|d| d - level));
            (0..3).for_each(|m| sum[m] += 0.25 * part[m]);
        }
        sum
    }

    /// Adds the weights of the node and of its `neighbours` along both axes, towards which the distance increases by so much (the share of each is
    /// that of its axis in the square of the gradient).
    ///
    /// The velocity is a function of the distance: (1 − θ) E + θ Q, as for edges ([`super::profile`]), with θ = d/(d − d_min) of the distance d of the
    /// node and the least of a corner. E is linear from the wall to the node and on to the neighbours, from the wall to them where
    /// the node is inside; Q = α M₁ + β M₂ is the parabola αd + βd² through node and neighbours, with the moments M of the open part less what
    /// the curvature of the wall adds to those of a whole face, and less open u″/24 along both axes.
    pub(super) fn weights(&self, neighbours: [(Support, f64); 2], face: &mut CutFace) {
        let d = self.own;
        let square: f64 = self.rise.iter().map(|rise| rise * rise).sum();
        let size = self.triangles.iter().flatten().fold(0.0, |most: f64, d| most.max(d.abs()));
        let known = |(k, &(next, further)): (usize, &(Support, f64))| {
            let share = self.rise[k] * self.rise[k] / square;
            let used = self.rise[k].abs() > FLAT * size && !matches!(next, Support::None);
            used.then_some((next, further, share))
        };
        let mut neighbours: Vec<_> = neighbours.iter().enumerate().filter_map(known).collect();
        if d <= 0.0 {
            // A neighbour counts the less, the nearer it is to the wall.
            neighbours.iter_mut().for_each(|n| n.2 *= ((d + n.1) / n.1).max(0.0));
        }
        let shares: f64 = neighbours.iter().map(|n| n.2).sum();
        neighbours.iter_mut().filter(|n| n.2 > 0.0).for_each(|n| n.2 /= shares);
        let [open, whole, second] = self.moments(0.0);
        let mut own = 0.0;
        let mut terms = 1;
        let mut add = |next: Support, weight: f64| {
            if let Support::Node(index) = next {
                face.terms[terms] = (index, weight);
                terms += 1;
            }
        };
        if d <= 0.0 {
            for (next, further, share) in neighbours {
                add(next, share * whole / (d + further).max(whole));
            }
            return;
        }
        let rest = self.moments(d)[1];
        let theta = d / (d - self.least.min(0.0));
        // Moments of the whole face, the parts inside included.
        let mean = |f: &dyn Fn([f64; 3]) -> f64| self.triangles.iter().map(|&t| 0.25 * f(t)).sum::<f64>();
        let full = mean(&|t| t.iter().sum::<f64>() / 3.0);
        let full_second =
            mean(&|t| (t.iter().sum::<f64>().powi(2) + t.iter().map(|d| d * d).sum::<f64>()) / 12.0);
        let m1 = whole - open * (full - d);
        let m2 = second - open * (full_second - d * d);
        // α = u₀/d − β d, β = (u₁/(d + further) − u₀/d)/further.
        let (alpha, beta) = (m1 / d, m2 - d * m1);
        own += (1.0 - theta) * (whole - rest) / d + theta * alpha;
        for (next, further, share) in neighbours {
            let outer = (1.0 - theta) * share * rest / further.max(rest);
            let bent = theta * share * beta / further;
            own -= outer + bent / d;
            add(next, outer + bent / (d + further));
        }
        face.terms[0].1 = own;
    }
}

/// ∫ 1, d and d² over the part of a triangle of area 1 where the linear function d with these values at its corners is positive.
fn positive_part(d: [f64; 3]) -> [f64; 3] {
    let whole = |[a, b, c]: [f64; 3]| {
        let (sum, squares) = (a + b + c, a * a + b * b + c * c);
        [1.0, sum / 3.0, (sum * sum + squares) / 12.0]
    };
    let inside = d.iter().filter(|&&d| d > 0.0).count();
    // The corner on its own side of the line of zeros, and the shares of both edges up to it.
    let cap = |i: usize| {
        let (a, b, c) = (d[i], d[(i + 1) % 3], d[(i + 2) % 3]);
        let area = a / (a - b) * (a / (a - c));
        whole([a, 0.0, 0.0]).map(|m| area * m)
    };
    match inside {
        0 => [0.0; 3],
        3 => whole(d),
        1 => (0..3).find(|&i| d[i] > 0.0).map_or([0.0; 3], cap),
        _ => {
            let (all, cap) = (whole(d), (0..3).find(|&i| d[i] <= 0.0).map_or([0.0; 3], cap));
            std::array::from_fn(|m| all[m] - cap[m])
        }
    }
}

#[cfg(test)]
mod tests;
