//! Signed distances on the nodes of a grid.
use interfaces::{Bodies, BodyId, Nodes, Point, Vector};

/// The places of nodes along one axis.
#[derive(Clone, Debug)]
pub(crate) struct Ticks {
    places: Vec<f64>,
    period: Option<f64>,
}

impl Ticks {
    /// The nodes themselves.
    pub(crate) fn nodes(nodes: &Nodes) -> Self {
        let places = (0..nodes.len() as isize).map(|i| nodes.place(i)).collect();
        Self { places, period: nodes.period() }
    }
    /// With those on the sides of a bounded axis.
    pub(crate) fn faces(nodes: &Nodes) -> Self {
        let outside = isize::from(!nodes.is_periodic());
        let places = (-outside..nodes.len() as isize + outside).map(|i| nodes.place(i)).collect();
        Self { places, period: nodes.period() }
    }
    pub(crate) fn len(&self) -> usize {
        self.places.len()
    }
    /// Largest distance of neighbours.
    pub(crate) fn widest(&self) -> f64 {
        (0..self.len()).map(|i| self.gap(i)).fold(0.0, f64::max)
    }
    /// Smallest distance of neighbours; infinite without neighbours.
    fn narrowest(&self) -> f64 {
        let wrap = self.period.map(|period| self.places[0] + period - self.places[self.len() - 1]);
        let gaps = self.places.windows(2).map(|w| w[1] - w[0]);
        gaps.chain(wrap).filter(|&gap| gap > 0.0).fold(f64::INFINITY, f64::min)
    }
    /// Distance of node `i` from the farther of its neighbours; 0 without neighbours.
    pub(crate) fn gap(&self, i: usize) -> f64 {
        let last = self.len() - 1;
        let wrap = |period: f64| self.places[0] + period - self.places[last];
        let above = if i < last { Some(self.places[i + 1] - self.places[i]) } else { self.period.map(wrap) };
        let below = if i > 0 { Some(self.places[i] - self.places[i - 1]) } else { self.period.map(wrap) };
        above.into_iter().chain(below).fold(0.0, f64::max)
    }
    /// First and last node of a bounded axis.
    pub(crate) fn ends(&self) -> Option<[f64; 2]> {
        let ends = self.places.first().zip(self.places.last());
        ends.filter(|_| self.period.is_none()).map(|(&first, &last)| [first, last])
    }
    /// The nodes that lie in [low, high], wrapped, and their places, not wrapped.
    fn within(&self, low: f64, high: f64) -> Vec<(usize, f64)> {
        let turns = match self.period {
            None => 0..=0,
            Some(period) => {
                let turn = |x: f64| ((x - self.places[0]) / period).floor() as isize;
                turn(low)..=turn(high)
            }
        };
        let mut out = Vec::new();
        for turn in turns {
            let shift = turn as f64 * self.period.unwrap_or(0.0);
            let first = self.places.partition_point(|&x| x + shift < low);
            let end = self.places.partition_point(|&x| x + shift <= high);
            out.extend((first..end).map(|i| (i, self.places[i] + shift)));
        }
        out
    }
}

/// What is known of a node near a surface, or inside one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Near {
    /// Its number along each axis.
    pub(crate) node: [u32; 3],
    /// Signed distance to the nearest body (only its sign is exact beyond the band); 0 for a node on its surface.
    pub(crate) distance: f64,
    /// That body.
    pub(crate) body: u32,
    /// From that body's centre of mass \[m\].
    pub(crate) arm: Vector,
}

/// Signed distances to the nearest body, on a product of axes.
pub(crate) struct Distances {
    shape: [usize; 3],
    periodic: [bool; 3],
    /// Per node, x fastest: its place in `near`, or `FAR`.
    slots: Vec<u32>,
    /// The nodes within reach of a body, in order of their numbers.
    pub(crate) near: Vec<Near>,
    /// Distances below this are exact \[m\].
    pub(crate) band: f64,
    /// Largest distance of neighbours along an axis \[m\].
    pub(crate) widest: f64,
    /// Bodies without a node inside.
    pub(crate) unseen: Vec<BodyId>,
}

const FAR: u32 = u32::MAX;

/// Nodes nearer to a surface than this share of the narrowest spacing are on it, which is inside: far above the round-off of signed
/// distances, so bodies that are symmetric to the grid are cut symmetrically. Cuts are continuous where a node comes to lie on a
/// surface, so loads change by no more than this share times their change over a cell.
pub(crate) const ON: f64 = 1e-6;

impl Near {
    pub(crate) fn body(&self) -> BodyId {
        BodyId(self.body as usize)
    }
}

impl Distances {
    pub(crate) fn new<B: Bodies + ?Sized>(axes: [Ticks; 3], dim: usize, bodies: &B) -> Self {
        let shape = axes.each_ref().map(Ticks::len);
        let widest = Vector::from_fn(|a, _| if a < dim { axes[a].widest() } else { 0.0 });
        // What is cut, its corners and its neighbours are no farther from the surface than a diagonal.
        let band = 1.01 * widest.norm();
        let tie = ON * axes[..dim].iter().map(Ticks::narrowest).fold(f64::INFINITY, f64::min);
        let mut slots = vec![FAR; shape.iter().product()];
        let mut near: Vec<Near> = Vec::new();
        let (mut points, mut found, mut unseen) = (Vec::new(), Vec::new(), Vec::new());
        for b in 0..bodies.n_bodies() {
            let (pose, solid, bounds) =
                (bodies.pose(BodyId(b)), bodies.solid(BodyId(b)), bodies.aabb(BodyId(b)));
            let columns = [0, 1, 2].map(|a| match a < dim {
                true => {
                    // Beyond half a period another image of the body is nearer.
                    let reach = axes[a].period.map_or(band, |period| band.min(0.5 * period));
                    axes[a].within(bounds.min[a] - reach, bounds.max[a] + reach)
                }
                false => vec![(0, pose.position[a])],
            });
            if columns.iter().any(Vec::is_empty) {
                unseen.push(BodyId(b));
                continue;
            }
            let mut seen = false;
            let arms =
                [0, 1, 2].map(|a| columns[a].iter().map(|&(_, x)| x - pose.position[a]).collect::<Vec<_>>());
            let to_body = pose.orientation.inverse().to_rotation_matrix();
            let [ex, ey, ez] = [0, 1, 2].map(|a| to_body.matrix().column(a).into_owned());
            near.reserve(columns.iter().map(Vec::len).product());
            for (&(k, _), z) in columns[2].iter().zip(&arms[2]) {
                points.clear();
                for y in &arms[1] {
                    let side = ey * *y + ez * *z;
                    points.extend(arms[0].iter().map(|x| Point::from(side + ex * *x)));
                }
                found.resize(points.len(), 0.0);
                solid.signed_distances(&points, band, &mut found);
                for ((&(j, _), y), found) in columns[1].iter().zip(&arms[1]).zip(found.chunks(arms[0].len()))
                {
                    for ((&(i, _), x), &distance) in columns[0].iter().zip(&arms[0]).zip(found) {
                        if distance >= band {
                            continue;
                        }
                        let distance = if distance.abs() <= tie { 0.0 } else { distance };
                        seen |= distance < 0.0;
                        let arm = Vector::new(*x, *y, *z);
                        let this = Near { node: [i, j, k].map(|i| i as u32), distance, body: b as u32, arm };
                        let slot = &mut slots[i + shape[0] * (j + shape[1] * k)];
                        match *slot {
                            FAR => {
                                *slot = near.len() as u32;
                                near.push(this);
                            }
                            at if near[at as usize].distance > distance => near[at as usize] = this,
                            _ => {}
                        }
                    }
                }
            }
            if !seen {
                unseen.push(BodyId(b));
            }
        }
        let periodic = axes.each_ref().map(|axis| axis.period.is_some());
        let mut out = Self { shape, periodic, slots, near, band, widest: widest.max(), unseen };
        out.sort();
        out
    }

    /// Puts `near` in order, whatever the order of the bodies.
    fn sort(&mut self) {
        let shape = self.shape;
        let number = |node: [u32; 3]| {
            let [i, j, k] = node.map(|i| i as usize);
            i + shape[0] * (j + shape[1] * k)
        };
        self.near.sort_by_key(|near| number(near.node));
        for (slot, near) in self.near.iter().enumerate() {
            self.slots[number(near.node)] = slot as u32;
        }
    }

    /// What is known of this node, wrapped along periodic axes; `None` outside and far from all bodies.
    pub(crate) fn at(&self, node: [isize; 3]) -> Option<&Near> {
        let mut number = 0;
        for a in (0..3).rev() {
            let n = self.shape[a] as isize;
            let mut i = node[a];
            if !(0..n).contains(&i) {
                if !self.periodic[a] {
                    return None;
                }
                i = i.rem_euclid(n);
            }
            number = number * self.shape[a] + i as usize;
        }
        self.near.get(self.slots[number] as usize)
    }

    /// Is this node inside a body?
    pub(crate) fn solid(&self, node: [isize; 3]) -> Option<&Near> {
        self.at(node).filter(|near| near.distance <= 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Balls;
    use std::time::{Duration, Instant};

    /// One cell as wide as a million periods of the other axis: only the nearest images of a body
    /// matter.
    #[test]
    fn wide_cells_need_no_far_images() {
        let ticks =
            [Nodes::uniform(0.0, 1e6, 4, false), Nodes::uniform(0.0, 0.1, 8, true)].map(|n| Ticks::nodes(&n));
        let [x, y] = ticks;
        let bodies = Balls::new(2, 0.2, vec![[1.0, 0.33, 0.0]]);
        let start = Instant::now();
        let z = Ticks { places: vec![0.0], period: None };
        let distances = Distances::new([x, y, z], 2, &bodies);
        assert!(start.elapsed() < Duration::from_millis(200), "{:?}", start.elapsed());
        for j in 0..8 {
            let way = (0.1 * j as f64 - 0.33 + 0.4_f64).rem_euclid(0.8) - 0.4;
            let found = distances.at([0, j, 0]).map(|near| near.distance);
            let expected = 1.0_f64.hypot(way) - 0.2;
            assert!(found.is_some_and(|d| (d - expected).abs() < 1e-12), "{j}: {found:?} {expected}");
        }
    }
}
