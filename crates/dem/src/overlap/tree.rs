//! Everything with a signed distance or facets: polyhedra around convex regions with edges, lenses where contacts are smooth,
//! rays across the contact where they are neither, adaptive trees of boxes where rays do not see it as one.
//!
//! `scan.rs` looks for places where both bodies are, `deepest.rs` goes down from them. Convex regions with edges are enclosed by
//! planes that touch the bodies (`convex.rs`); what is like a lens, between two pieces of surface that meet at one rim, is summed
//! along lines (`lens.rs`); what rays across the contact enter once is summed over them (`rays.rs`); all else is left to the trees.
//!
//! A box outside either body is dropped, one inside both is added, one that a surface cuts is divided into eight or, in
//! the end, closed: the distance of each body is taken to second order, c + g·ξ + ½ ξᵀHξ from fifteen points of the box,
//! and what is behind the surfaces of both models is summed over columns (`columns.rs`). Slope and curvature so enter
//! alike, and what is left out is of third order in the box's size.
mod around;
mod closest;
pub(crate) mod columns;
mod convex;
mod cut;
mod deepest;
#[cfg(feature = "mesh")]
mod facet_index;
mod gjk;
pub(crate) mod grow;
mod lens;
mod patches;
pub(crate) mod quadric;
mod rays;
mod roots;
mod scan;
pub(crate) mod seen;
mod sub_box;
#[cfg(test)]
mod tests;

#[cfg(feature = "mesh")]
pub use facet_index::FacetIndex;
pub use sub_box::{BoxKind, SubBox};

use super::Overlap;
use crate::{DemError, Shape};
pub(crate) use around::Oriented;
pub(crate) use closest::{Closest, closest};
use columns::Sums;
use convex::{Circumscribed, Which};
pub(crate) use cut::Surfaces;
use deepest::{Deepest, Search};
pub(crate) use grow::Exhausted;
use grow::{Goal, Tree};
use interfaces::{Point, Pose, Rotation, Vector};
use lens::Lenses;
use nalgebra::{Matrix3, SymmetricEigen};
use patches::Patches;
use rays::Rays;
use roots::{Region, Root, merge};
use scan::Scan;
use seen::{Seen, shared};

/// How far the adaptive tree goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refinement {
    /// As Isoz et al. (2023), section 4: boxes along the world's axes, from what the two bodies' own boxes share; all that
    /// a surface cuts are divided, this many times, 1 to 8.
    Levels(u8),
    /// To a relative error of the volume of about this, from 1e-8 to 1. A region between two pieces of surface that meet at one rim
    /// is summed along lines, a convex one with edges is enclosed by planes that touch the bodies, exactly if their faces are flat;
    /// neither has boxes, nor has one that rays across the contact enter once. Any other one is divided into boxes along the contact, those with the largest errors first.
    ///
    /// Regions are looked for in boxes, down to a 32nd of what the bodies' own boxes share along each axis. A box is left out where a
    /// distance is larger than it reaches, which is a proof as distances change by no more than the way gone, or where
    /// weighted means of both distances, linear but for what nine points in the box tell, are positive all over it, which is none: a
    /// bump that all nine points miss may be missed. So may regions smaller than the last boxes, and those as near as this to
    /// another one. Between convex bodies one is found however small.
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

/// Computes overlaps by planes, lenses and trees and keeps the memory of it.
#[derive(Clone, Debug, Default)]
pub(crate) struct AdaptiveTree {
    pub(crate) refinement: Refinement,
    pub(crate) normal: Normal,
    scan: Scan,
    starts: Vec<Vector>,
    lenses: Lenses,
    convex: Circumscribed,
    rays: Rays,
    roots: Vec<Root>,
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

    /// Adds the patches of a pair.
    ///
    /// # Errors
    /// If boxes do not suffice for the tolerance.
    pub(crate) fn overlap(
        &mut self,
        a: &dyn Shape,
        at_a: &Pose,
        b: &dyn Shape,
        at_b: &Pose,
        out: &mut Vec<Overlap>,
    ) -> Result<(), Exhausted> {
        self.roots.clear();
        self.convex.clear();
        // Around the first body, so that places far from the world's origin lose no digits.
        let apart = at_b.position - at_a.position;
        match self.refinement {
            Refinement::Levels(levels) => {
                let Some((bodies, half)) = self.frame(a, at_a, b, at_b, Rotation::identity()) else {
                    return Ok(());
                };
                let root = Oriented { centre: Vector::zeros(), axes: Matrix3::identity(), half };
                self.roots.push(Root::boxed(root, Vector::zeros()));
                self.room();
                self.trees[0].grow_levels(&bodies, half, levels, &Surfaces { shapes: [a, b] });
            }
            Refinement::Tolerance(tolerance) => {
                // Along the world or a body, whatever makes the shared box smallest; none, and they are apart.
                let mut least = (f64::INFINITY, Rotation::identity());
                for turn in [Rotation::identity(), at_a.orientation, at_b.orientation] {
                    let Some((_, half)) = self.frame(a, at_a, b, at_b, turn) else { return Ok(()) };
                    if half.product() < 0.99 * least.0 {
                        least = (half.product(), turn);
                    }
                }
                let Some((bodies, half)) = self.frame(a, at_a, b, at_b, least.1) else { return Ok(()) };
                self.align(&Search { bodies, half }, tolerance)?;
                let turn = least.1.to_rotation_matrix();
                self.roots.iter_mut().for_each(|root| root.turn(turn.matrix()));
            }
        }
        let between = (-apart).try_normalize(0.0).unwrap_or(Vector::x());
        for number in 0..self.roots.len() {
            match &self.roots[number].region {
                Some(region) => out.push(region.overlap(self.origin, between)),
                None => self.collect(number, between, out),
            }
        }
        Ok(())
    }

    /// Both bodies as a frame turned by `turn` sees them, from the middle of what their boxes share along its axes, and the
    /// half-widths of this; the middle becomes the origin.
    fn frame<'a>(
        &mut self,
        a: &'a dyn Shape,
        at_a: &Pose,
        b: &'a dyn Shape,
        at_b: &Pose,
        turn: Rotation,
    ) -> Option<([Seen<'a>; 2], Vector)> {
        let back = turn.inverse();
        let [near_a, near_b] = [at_a, at_b].map(|at| Pose {
            position: Point::from(back * (at.position - at_a.position)),
            orientation: back * at.orientation,
        });
        let both = shared(&a.aabb().posed(&near_a), &b.aabb().posed(&near_b))?;
        let middle = nalgebra::center(&both.min, &both.max).coords;
        self.origin = at_a.position + turn * middle;
        Some(([Seen::new(a, &near_a, middle), Seen::new(b, &near_b, middle)], 0.5 * both.extent()))
    }

    /// One tree per root.
    fn room(&mut self) {
        let most = self.trees.len().max(self.roots.len());
        self.trees.resize_with(most, Tree::default);
    }

    /// Finds all regions and measures them.
    fn align(&mut self, search: &Search<'_>, tolerance: f64) -> Result<(), Exhausted> {
        let step = self.scan.begin(search, &mut self.starts);
        for i in 0..self.starts.len() {
            self.look(search, self.starts[i], step, tolerance);
        }
        // Regions that no start led to.
        loop {
            let (roots, planes) = (&self.roots, &self.convex.planes);
            let known =
                |x: Vector, reach: f64, last| roots.iter().any(|root| root.knows(x, reach, last, planes));
            let Some(start) = self.scan.next(search, known) else { break };
            self.look(search, start, step, tolerance);
        }
        if self.roots.is_empty()
            && let Some(deepest) = self.convex.seek(search)
        {
            self.add(search, &deepest, tolerance);
        }
        self.grow(search, tolerance)
    }

    /// A root for the region that `start` leads to, if it is a new one.
    fn look(&mut self, search: &Search<'_>, start: Vector, step: f64, tolerance: f64) {
        let planes = &self.convex.planes;
        let known = |x: Vector| self.roots.iter().any(|root| root.holds(x, planes) || root.sees(search, x));
        if self.roots.len() == MOST_ROOTS || known(start) {
            return;
        }
        let Some(deepest) = search.descend(start, step).filter(|deepest| !known(deepest.at)) else { return };
        self.add(search, &deepest, tolerance);
    }

    /// A root for the region around a deepest place.
    fn add(&mut self, search: &Search<'_>, deepest: &Deepest, tolerance: f64) {
        let region = match self.normal {
            Normal::Gradient => {
                // Lenses are for what is smooth.
                let convex = self.convex.measure(search, deepest, tolerance, Which::WithEdges);
                let lens = || self.lenses.measure(search, deepest, tolerance).map(Region::Lens);
                let mut found = convex.map(Region::Convex).or_else(lens);
                if found.is_none() {
                    let mut round = |d: &Deepest| self.convex.measure(search, d, tolerance, Which::All);
                    found = round(deepest).map(Region::Convex);
                }
                if found.is_none() && self.roots.is_empty() {
                    let other = self.convex.seek(search);
                    let other = other.and_then(|o| self.convex.measure(search, &o, tolerance, Which::All));
                    found = other.map(Region::Convex);
                }
                found.or_else(|| self.rays.measure(search, deepest, tolerance).map(Region::Bundle))
            }
            Normal::PlaneFit => None,
        };
        if let Some(Region::Bundle(bundle)) = &region {
            // All that is in its box is counted.
            self.roots.retain(|root| !root.is_in(bundle));
        }
        self.roots.push(region.map_or_else(|| Root::boxed(search.around(deepest), deepest.at), Root::of));
    }

    /// Grows a tree in every root that is not a lens, and roots where what they hold comes to their sides.
    fn grow(&mut self, search: &Search<'_>, tolerance: f64) -> Result<(), Exhausted> {
        let goal = Goal { tolerance, moments: false };
        for round in 1..=ROUNDS {
            self.room();
            merge(&mut self.roots, &mut self.trees);
            let mut widened = false;
            for (root, tree) in self.roots.iter_mut().zip(&mut self.trees).filter(|(root, _)| !root.done) {
                let bounds = &mut root.bounds;
                let bodies = search.bodies.map(|b| b.within(&bounds.axes, bounds.centre));
                root.done = true;
                if tree.plant(&bodies, bounds.half, goal) {
                    // Roughly first, so that little is lost if the root is too small.
                    for tolerance in [tolerance.max(0.1), tolerance] {
                        tree.refine(&bodies, goal, tolerance)?;
                        if round < ROUNDS && bounds.widen(tree, search.half) {
                            (root.done, widened) = (false, true);
                            break;
                        }
                    }
                }
            }
            if !widened {
                break;
            }
        }
        Ok(())
    }

    /// The patches in one root.
    fn collect(&mut self, number: usize, between: Vector, out: &mut Vec<Overlap>) {
        let (root, tree) = (&self.roots[number].bounds, &self.trees[number]);
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
        let trees = self.roots.iter().zip(&self.trees).filter(|(root, _)| root.region.is_none());
        trees.flat_map(move |(root, tree)| {
            let kept = tree.nodes.iter().filter(|n| n.leaf != grow::NONE);
            kept.map(move |node| SubBox::new(node, tree, &root.bounds, self.origin))
        })
    }
}

impl Oriented {
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
            pivot: Matrix3::zeros(),
        }
    }
}
