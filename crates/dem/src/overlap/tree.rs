//! Adaptive trees of boxes, for everything with a signed distance or facets.
//!
//! A box outside either body is dropped, one inside both is added, one that a surface cuts is divided into eight or, in
//! the end, closed: the distance of each body is taken to second order, c + g·ξ + ½ ξᵀHξ from fifteen points of the box,
//! and what is behind the surfaces of both models is summed over columns (`columns.rs`). Slope and curvature so enter
//! alike, and what is left out is of third order in the box's size.
pub(crate) mod columns;
mod deepest;
#[cfg(feature = "mesh")]
mod facet_index;
pub(crate) mod grow;
mod patches;
pub(crate) mod quadric;
pub(crate) mod seen;
mod sub_box;
#[cfg(test)]
mod tests;

#[cfg(feature = "mesh")]
pub use facet_index::FacetIndex;
pub use sub_box::{BoxKind, SubBox};

use super::Overlap;
use crate::{DemError, Shape};
use columns::Sums;
pub(crate) use deepest::Oriented;
use deepest::{Deepest, Search};
use grow::{Cut, Goal, Side, Tree, by_distance};
use interfaces::{Point, Pose, Vector};
use nalgebra::{Matrix3, SymmetricEigen};
use patches::Patches;
use seen::{Seen, shared};

/// How far the adaptive tree goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refinement {
    /// As Isoz et al. (2023), section 4: boxes along the world's axes, from what the two bodies' own boxes share; all that
    /// a surface cuts are divided, this many times, 1 to 8.
    Levels(u8),
    /// Boxes along the contact, those with the largest errors divided first until the relative error of the volume is
    /// about this, from 1e-8 to 1.
    Tolerance(f64),
}

impl Refinement {
    /// Is it within its limits?
    ///
    /// # Errors
    /// [`DemError::Refinement`].
    pub(crate) fn check(self) -> Result<(), DemError> {
        match self {
            Self::Levels(1..=8) => Ok(()),
            Self::Tolerance(t) if (1e-8..=1.0).contains(&t) => Ok(()),
            _ => Err(DemError::Refinement { refinement: self }),
        }
    }
}

impl Default for Refinement {
    fn default() -> Self {
        Self::Tolerance(1e-3)
    }
}

/// What the normal of a contact is taken from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Normal {
    /// The gradient of the volume, −S/|S|.
    #[default]
    Gradient,
    /// The plane through the boxes that both surfaces cut, by least squares (Isoz et al. 2023, figure 6). Known to the
    /// adaptive tree only; a few degrees off for bodies with corners, however far the tree goes. The gradient where fewer than
    /// three boxes, or boxes in a line, are found.
    PlaneFit,
}

/// Computes overlaps by trees and keeps the memory of it.
#[derive(Clone, Debug, Default)]
pub(crate) struct AdaptiveTree {
    pub(crate) refinement: Refinement,
    pub(crate) normal: Normal,
    deepest: Vec<Deepest>,
    starts: Vec<Vector>,
    roots: Vec<Oriented>,
    /// Of the last pair, one tree per root.
    trees: Vec<Tree>,
    patches: Patches,
    sums: Vec<Sums>,
    /// Place of the frame of the roots in the world.
    origin: Point,
}

/// A patch with less than this share of the volume in its root is a splinter that the boxes' edges make.
const SPLINTER: f64 = 1e-3;

/// How often a root may be found too small.
const ROUNDS: usize = 12;
/// As many regions are looked for.
const MOST_ROOTS: usize = 64;

impl AdaptiveTree {
    /// Can it do these?
    pub(crate) fn supports(a: &dyn Shape, b: &dyn Shape) -> bool {
        let extents = [a.aabb().extent(), b.aabb().extent()];
        let finite = |e: &Vector| e.max() < 1e99;
        extents.iter().all(|e| e.z > 0.0) && extents.iter().any(finite)
    }

    pub(crate) fn overlap(
        &mut self,
        a: &dyn Shape,
        at_a: &Pose,
        b: &dyn Shape,
        at_b: &Pose,
        out: &mut Vec<Overlap>,
    ) {
        self.roots.clear();
        // Around the first body, so that places far from the world's origin lose no digits.
        let apart = at_b.position - at_a.position;
        let near_a = Pose { position: Point::origin(), ..*at_a };
        let near_b = Pose { position: Point::from(apart), ..*at_b };
        let Some(both) = shared(&a.aabb().posed(&near_a), &b.aabb().posed(&near_b)) else { return };
        let middle = nalgebra::center(&both.min, &both.max).coords;
        self.origin = at_a.position + middle;
        let bodies = [Seen::new(a, &near_a, middle), Seen::new(b, &near_b, middle)];
        let half = 0.5 * both.extent();
        match self.refinement {
            Refinement::Levels(levels) => {
                let root = Oriented { centre: Vector::zeros(), axes: Matrix3::identity(), half };
                self.roots.push(root);
                self.room();
                self.trees[0].grow_levels(&bodies, half, levels, &Surfaces { shapes: [a, b] });
            }
            Refinement::Tolerance(tolerance) => self.align(&Search { bodies, half }, tolerance),
        }
        let between = (-apart).try_normalize(0.0).unwrap_or(Vector::x());
        for root in 0..self.roots.len() {
            self.collect(root, between, out);
        }
    }

    /// One tree per root.
    fn room(&mut self) {
        let most = self.trees.len().max(self.roots.len());
        self.trees.resize_with(most, Tree::default);
    }

    /// Finds a root for every region and grows a tree in it.
    fn align(&mut self, search: &Search<'_>, tolerance: f64) {
        search.deepest(&mut self.deepest);
        for deepest in &self.deepest {
            if !self.roots.iter().any(|root| root.holds(deepest.at)) {
                self.roots.push(search.around(deepest));
            }
        }
        loop {
            self.grow(search, tolerance);
            // Regions that no start led to: places there are in no root.
            self.starts.clear();
            let (roots, starts) = (&self.roots, &mut self.starts);
            let known = |x: Vector, reach: f64| roots.iter().any(|root| root.holds_ball(x, reach));
            search.scan(known, &mut |x, reach| {
                if !starts.iter().any(|start| (x - start).norm() < 3.0 * reach) {
                    starts.push(x);
                }
            });
            let before = self.roots.len();
            for start in &self.starts {
                let Some(deepest) = search.descend(*start) else { continue };
                let held = self.roots.iter().any(|root| root.holds(deepest.at));
                if !held && self.roots.len() < MOST_ROOTS {
                    self.roots.push(search.around(&deepest));
                }
            }
            if self.roots.len() == before {
                break;
            }
        }
    }

    /// Grows a tree in every root, and roots where what they hold comes to their sides.
    fn grow(&mut self, search: &Search<'_>, tolerance: f64) {
        let goal = Goal { tolerance, moments: false };
        for round in 1..=ROUNDS {
            merge(&mut self.roots);
            self.room();
            let mut widened = false;
            for (root, tree) in self.roots.iter_mut().zip(&mut self.trees) {
                let bodies = search.bodies.map(|b| b.within(&root.axes, root.centre));
                if tree.plant(&bodies, root.half, goal) {
                    // Roughly first, so that little is lost if the root is too small.
                    for tolerance in [tolerance.max(0.1), tolerance] {
                        tree.refine(&bodies, goal, tolerance);
                        if round < ROUNDS && root.widen(tree, search.half) {
                            widened = true;
                            break;
                        }
                    }
                }
            }
            if !widened {
                break;
            }
        }
    }

    /// The patches in one root.
    fn collect(&mut self, number: usize, between: Vector, out: &mut Vec<Overlap>) {
        let (root, tree) = (&self.roots[number], &self.trees[number]);
        self.patches.find(tree);
        self.sums.clear();
        self.sums.resize(tree.leaves.len(), Sums::default());
        let mut whole = 0.0;
        for node in tree.nodes.iter().filter(|n| n.leaf != grow::NONE) {
            let sums = &tree.leaves[node.leaf as usize].content.sums;
            whole += sums.volume;
            self.sums[self.patches.of(node.leaf) as usize].add(sums);
        }
        let by_volume = |a: &usize, b: &usize| self.sums[*a].volume.total_cmp(&self.sums[*b].volume);
        let Some(largest) = (0..self.sums.len()).max_by(by_volume) else { return };
        for i in 0..self.sums.len() {
            if i != largest && self.sums[i].volume < SPLINTER * whole {
                let splinter = std::mem::take(&mut self.sums[i]);
                self.sums[largest].add(&splinter);
            }
        }
        for i in 0..self.sums.len() {
            if self.sums[i].volume > 0.0 {
                let mut overlap = root.overlap(&self.sums[i], self.origin, between);
                if self.normal == Normal::PlaneFit
                    && let Some(normal) = root.plane(tree, &mut self.patches, i as u32)
                {
                    overlap.normal = if normal.dot(&overlap.normal) < 0.0 { -normal } else { normal };
                }
                out.push(overlap);
            }
        }
    }

    /// The boxes of the last pair.
    pub(crate) fn boxes(&self) -> impl Iterator<Item = SubBox> + '_ {
        self.roots.iter().zip(&self.trees).flat_map(move |(root, tree)| {
            let kept = tree.nodes.iter().filter(|n| n.leaf != grow::NONE);
            kept.map(move |node| SubBox::new(node, tree, root, self.origin))
        })
    }
}

/// Decides by facets of bodies that have them, by distance else.
pub(crate) struct Surfaces<'a> {
    pub(crate) shapes: [&'a dyn Shape; 2],
}

impl Cut for Surfaces<'_> {
    fn side(&self, i: usize, body: &Seen<'_>, centre: Vector, half: Vector) -> Side {
        #[cfg(feature = "mesh")]
        if let Some(facets) = self.shapes[i].facet_index() {
            let place = Point::from(body.turn * centre + body.shift);
            return if facets.cut(place, &body.turn, half) {
                Side::Cut
            } else if body.distance(centre, half.norm()) < 0.0 {
                Side::Inside
            } else {
                Side::Outside
            };
        }
        let _ = (i, self.shapes);
        by_distance(body, centre, half)
    }
}

impl Oriented {
    fn local(&self, x: Vector) -> Vector {
        self.axes.transpose() * (x - self.centre)
    }
    fn holds(&self, x: Vector) -> bool {
        self.holds_ball(x, 0.0)
    }
    /// Does it hold all that is within `reach` of `x`?
    fn holds_ball(&self, x: Vector, reach: f64) -> bool {
        let x = self.local(x);
        (0..3).all(|a| x[a].abs() + reach <= self.half[a])
    }
    /// Lower and upper corner, in this box's frame, of all of the other one.
    fn reach(&self, o: &Self) -> [Vector; 2] {
        let (middle, half) = (self.local(o.centre), (self.axes.transpose() * o.axes).abs() * o.half);
        [middle - half, middle + half]
    }
    fn may_meet(&self, o: &Self) -> bool {
        let meets = |a: &Self, b: &Self| {
            let [low, high] = a.reach(b);
            (0..3).all(|i| low[i] <= a.half[i] && high[i] >= -a.half[i])
        };
        meets(self, o) && meets(o, self)
    }
    fn set(&mut self, low: Vector, high: Vector) {
        self.centre += self.axes * (0.5 * (low + high));
        self.half = 0.5 * (high - low);
    }

    /// Half as large again where what it holds comes to its sides, but no larger than what holds all, of half-widths
    /// `limit` around the origin; tells whether it was.
    fn widen(&mut self, tree: &Tree, limit: Vector) -> bool {
        let mut touched = [[false; 2]; 3];
        for node in tree.nodes.iter().filter(|n| n.leaf != grow::NONE) {
            let (leaf, half) = (&tree.leaves[node.leaf as usize], tree.half_at(node.level));
            for (a, touched) in touched.iter_mut().enumerate() {
                let edge = (1.0 - 1e-9) * self.half[a] - half[a];
                for (end, sign) in [-1.0, 1.0].into_iter().enumerate() {
                    touched[end] |= sign * node.centre[a] > edge && leaf.reaches(a, sign);
                }
            }
        }
        let whole = Self { centre: Vector::zeros(), axes: Matrix3::identity(), half: (1.0 + 1e-9) * limit };
        let [least, most] = self.reach(&whole);
        let (mut low, mut high) = (-self.half, self.half);
        for a in 0..3 {
            if touched[a][0] {
                low[a] = (-2.0 * self.half[a]).max(least[a]).min(low[a]);
            }
            if touched[a][1] {
                high[a] = (2.0 * self.half[a]).min(most[a]).max(high[a]);
            }
        }
        let widened = low != -self.half || high != self.half;
        if widened {
            self.set(low, high);
        }
        widened
    }

    /// The normal of the plane through the edge boxes of a patch, if they have one.
    fn plane(&self, tree: &Tree, patches: &mut Patches, patch: u32) -> Option<Vector> {
        let (mut n, mut first, mut second) = (0.0, Vector::zeros(), Matrix3::zeros());
        for node in tree.nodes.iter().filter(|n| n.leaf != grow::NONE) {
            if tree.leaves[node.leaf as usize].is_edge() && patches.of(node.leaf) == patch {
                n += 1.0;
                first += node.centre;
                second += node.centre * node.centre.transpose();
            }
        }
        if n < 3.0 {
            return None;
        }
        let eigen = SymmetricEigen::new(second / n - first * first.transpose() / (n * n));
        let least = eigen.eigenvalues.imin();
        let mut sorted: [f64; 3] = eigen.eigenvalues.into();
        sorted.sort_by(f64::total_cmp);
        // Not in a line, nor all around.
        let plane = sorted[1] > 1e-9 * sorted[2] && sorted[0] < 0.9 * sorted[1];
        plane.then(|| self.axes * eigen.eigenvectors.column(least))
    }

    /// What the sums in this frame say in the world.
    pub(crate) fn overlap(&self, sums: &Sums, origin: Point, between: Vector) -> Overlap {
        let centroid = sums.first / sums.volume;
        let (mut gradient, mut moment) = (Vector::zeros(), Vector::zeros());
        if sums.area.iter().all(|a| *a > 0.0) {
            // The surfaces of both enclose the region, so either gives the same but for the error.
            gradient = 0.5 * (sums.flux[0] - sums.flux[1]);
            moment = 0.5 * (sums.turn[0] - sums.turn[1]) - centroid.cross(&gradient);
        }
        let gradient = self.axes * gradient;
        Overlap {
            volume: sums.volume,
            centroid: origin + (self.centre + self.axes * centroid),
            normal: (-gradient).try_normalize(0.0).unwrap_or(between),
            gradient,
            moment: self.axes * moment,
        }
    }
}

/// Makes one of roots that may meet.
fn merge(roots: &mut Vec<Oriented>) {
    'again: loop {
        for j in 1..roots.len() {
            for i in 0..j {
                if roots[i].may_meet(&roots[j]) {
                    let other = roots.swap_remove(j);
                    let root = &mut roots[i];
                    let [low, high] = root.reach(&other);
                    root.set(low.inf(&-root.half), high.sup(&root.half));
                    continue 'again;
                }
            }
        }
        return;
    }
}
