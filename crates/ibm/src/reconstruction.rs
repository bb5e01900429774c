//! Values in surface cells, from the surface and the fluid (figure 3).
use crate::{Given, Profile, SolidFraction, SolidNode};
use interfaces::{Aabb, Bodies, BodyId, Lattice, Point, Vector};

/// Values of a scalar (or of one component of a vector) in the cells that a body's surface cuts
/// (Isoz et al. 2023, figure 3, for "any intensive tensorial property").
///
/// P is the cell's centre, S its foot on the surface, P₁ and P₂ lie on the outward normal through S: P₁ is the
/// first point, of those a quarter of a cell apart from ½ to 3 cells from S, whose multilinear
/// interpolation uses no cell that any body covers; P₂ is one cell further. Where a neighbour or a wall is in the
/// way of one of them, the profile does with the others, and the cell is counted
/// ([`lowered`](Self::lowered)).
///
/// Where P is inside the body it gets the value at S, unless told ([`extrapolating`](Self::extrapolating)): profiles have to extrapolate
/// there, which makes free bodies unstable as the step shrinks (two discs, 15 cells per diameter: diverged at dt ≤ 1.25e-4 s;
/// without: stable down to 5e-5 s).
#[derive(Clone, Debug, Default)]
pub struct Reconstruction {
    profile: Profile,
    given: Given,
    extrapolates: bool,
    bodies: Vec<Rows>,
    covered: Vec<bool>,
    scratch: Scratch,
    lowered: u64,
}

/// Lists that a placement makes, kept so that the next one allocates nothing.
#[derive(Clone, Debug, Default)]
struct Scratch {
    /// Boxes of all bodies where they are now.
    now: Vec<Aabb>,
    /// Boxes that were left or entered.
    changed: Vec<Aabb>,
    /// Bodies to work on.
    work: Vec<usize>,
    /// Bodies that those may see.
    seen: Vec<usize>,
}

/// What is known of one body.
#[derive(Clone, Debug, Default)]
struct Rows {
    rows: Vec<SurfaceCell>,
    stamp: u64,
    bounds: Option<Aabb>,
}

/// A cell that a surface cuts.
#[derive(Clone, Debug)]
pub struct SurfaceCell {
    /// The cell.
    pub node: SolidNode,
    /// The surface point S, from the body's centre of mass \[m\].
    pub foot: Vector,
    /// Outward unit normal there.
    pub normal: Vector,
    /// Distances of P₁ and P₂ from S \[m\], if there is room for them.
    pub points: [Option<f64>; 2],
    /// Weight of what is given at the surface; `None` where nothing is known of the value.
    pub surface: Option<f64>,
    /// Storage indices and weights of what P₁ and P₂ see; weight 0 where there is nothing.
    pub fluid: [(usize, f64); 16],
}

impl SurfaceCell {
    /// The cell's value: from what is `given` at S and from the `field`; where nothing is known, the one
    /// it has.
    pub fn value(&self, given: f64, field: &[f64]) -> f64 {
        match self.surface {
            Some(weight) => weight * given + self.fluid.iter().map(|&(i, w)| w * field[i]).sum::<f64>(),
            None => field[self.node.index],
        }
    }
}

/// P₁ is looked for between these distances from S, in quarters of a cell.
const FIRST: std::ops::RangeInclusive<u32> = 2..=12;
/// Bodies farther apart than so many cells see nothing of one another: three to P₁, one to P₂, one for
/// the cells around it, one that the surface cuts.
const REACH: f64 = 6.0;

impl Reconstruction {
    /// With this profile and kind of condition.
    pub fn new(profile: Profile, given: Given) -> Self {
        Self { profile, given, ..Self::default() }
    }
    /// The same with the profile's own value where P is inside the body.
    #[must_use]
    pub fn extrapolating(mut self) -> Self {
        self.extrapolates = true;
        self
    }
    /// How many surface cells had to do with fewer fluid points than their profile takes, so far.
    pub fn lowered(&self) -> u64 {
        self.lowered
    }
    /// The surface cells of body `b`.
    pub fn cells(&self, b: BodyId) -> &[SurfaceCell] {
        self.bodies.get(b.0).map_or(&[], |body| &body.rows)
    }

    /// Sets the cells of body `b` in `field` to what follows from `given` at (S, normal), both from the centre
    /// of mass.
    pub fn apply(&self, b: BodyId, field: &mut [f64], given: impl Fn(Vector, Vector) -> f64) {
        for cell in self.cells(b) {
            field[cell.node.index] = cell.value(given(cell.foot, cell.normal), field);
        }
    }

    /// Follows the bodies to where `fraction` found them on `lattice`, whose fields have `storage` values.
    /// Only bodies that moved, and those that one that moved is or was near, are worked on.
    pub fn place<B: Bodies + ?Sized>(
        &mut self,
        lattice: &Lattice,
        storage: usize,
        bodies: &B,
        fraction: &SolidFraction,
    ) {
        let n = fraction.n_bodies();
        self.covered.resize(storage, false);
        let mut scratch = std::mem::take(&mut self.scratch);
        let Scratch { now, changed, work, seen } = &mut scratch;
        // Boxes that were left or entered, those of bodies that are gone first.
        changed.clear();
        changed.extend(self.bodies.drain(n.min(self.bodies.len())..).filter_map(|rows| rows.bounds));
        self.bodies.resize_with(n, Rows::default);
        for (b, rows) in self.bodies.iter().enumerate() {
            if rows.stamp != fraction.stamp(BodyId(b)) {
                changed.extend(rows.bounds);
                changed.push(bodies.aabb(BodyId(b)));
            }
        }
        if changed.is_empty() {
            self.scratch = scratch;
            return;
        }
        now.clear();
        now.extend((0..n).map(|b| bodies.aabb(BodyId(b))));
        work.clear();
        work.extend((0..n).filter(|&b| changed.iter().any(|c| near(lattice, c, &now[b]))));
        seen.clear();
        seen.extend((0..n).filter(|&b| work.iter().any(|&w| near(lattice, &now[w], &now[b]))));
        let mark = |covered: &mut [bool], to| {
            seen.iter().flat_map(|&b| fraction.nodes(BodyId(b))).for_each(|node| covered[node.index] = to);
        };
        mark(&mut self.covered, true);
        for &b in work.iter() {
            self.place_body(lattice, bodies, BodyId(b), fraction);
            let rows = &mut self.bodies[b];
            (rows.stamp, rows.bounds) = (fraction.stamp(BodyId(b)), Some(now[b]));
        }
        mark(&mut self.covered, false);
        self.scratch = scratch;
    }

    fn place_body<B: Bodies + ?Sized>(
        &mut self,
        lattice: &Lattice,
        bodies: &B,
        b: BodyId,
        fraction: &SolidFraction,
    ) {
        let (solid, pose, root) = (bodies.solid(b), bodies.pose(b), 1.0 / lattice.dim as f64);
        let Self { profile, given, extrapolates, bodies: all, covered, lowered, .. } = self;
        let (nodes, rows) = (fraction.nodes(b), &mut all[b.0].rows);
        rows.clear();
        // Twice what is there now, so that a moving body allocates nothing.
        if rows.capacity() < nodes.len() {
            rows.reserve(2 * nodes.len());
        }
        for node in nodes.iter().filter(|n| n.fraction < 1.0) {
            let h = node.volume.powf(root);
            let normal = pose.orientation * solid.normal(pose.to_body(pose.position + node.arm), h);
            let foot = node.arm - normal * node.distance;
            // The first point on the normal that sees free fluid only.
            let free = |s: f64| {
                let stencil = interpolation(lattice, pose.position + foot + normal * s)?;
                stencil.iter().all(|&(i, w)| w == 0.0 || !covered[i]).then_some((s, stencil))
            };
            let first = FIRST.into_iter().find_map(|i| free(0.25 * h * f64::from(i)));
            let second = first.and_then(|(s, _)| free(s + h));
            let points = [first.map(|p| p.0), second.map(|p| p.0)];
            *lowered += u64::from(points.iter().flatten().count() < profile.points(*given));
            let at = if *extrapolates { node.distance } else { node.distance.max(0.0) };
            let weights = profile.weights(*given, at, points[0], points[1]);
            let mut fluid = [(lattice.base, 0.0); 16];
            for (p, stencil) in [first, second].into_iter().enumerate() {
                let weight = weights.map_or(0.0, |w| w.points[p]);
                for (at, (i, w)) in stencil.iter().flat_map(|(_, stencil)| stencil).enumerate() {
                    fluid[8 * p + at] = (*i, w * weight);
                }
            }
            rows.push(SurfaceCell {
                node: *node,
                foot,
                normal,
                points,
                surface: weights.map(|w| w.surface),
                fluid,
            });
        }
    }
}

/// Are two boxes so near that what one covers may matter to the other?
fn near(lattice: &Lattice, a: &Aabb, b: &Aabb) -> bool {
    (0..lattice.dim).all(|axis| {
        let nodes = &lattice.axes[axis];
        let mut apart = 0.5 * (a.min[axis] + a.max[axis] - b.min[axis] - b.max[axis]);
        if let Some(period) = nodes.period() {
            apart -= period * (apart / period).round();
        }
        let [_, widest] = nodes.spacings(b.min[axis], b.max[axis]);
        // Twice, since cells may grow away from the body.
        apart.abs() <= 0.5 * (a.extent()[axis] + b.extent()[axis]) + 2.0 * REACH * widest
    })
}

/// Multilinear interpolation at `x`: up to eight (index, weight) pairs, or `None` outside a
/// bounded side.
fn interpolation(lattice: &Lattice, x: Point) -> Option<[(usize, f64); 8]> {
    let mut out = [(lattice.base, 0.0); 8];
    let (first, part) = lattice.locate(x);
    for corner in 0..1 << lattice.dim {
        let up = [corner & 1, (corner >> 1) & 1, (corner >> 2) & 1];
        let index = lattice.index(std::array::from_fn(|a| first[a] + up[a] as isize))?;
        let weight = (0..lattice.dim).map(|a| if up[a] == 1 { part[a] } else { 1.0 - part[a] }).product();
        out[corner] = (index, weight);
    }
    Some(out)
}

#[cfg(test)]
mod tests;
