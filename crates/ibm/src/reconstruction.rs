//! Values in surface cells, from the surface and the fluid (figure 3).
use crate::vicinity::Vicinity;
use crate::{Given, Profile, SolidFraction, SolidNode};
use interfaces::{Bodies, BodyId, Lattice, Point, Vector};

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
    bodies: Vec<Vec<SurfaceCell>>,
    covered: Vec<bool>,
    vicinity: Vicinity,
    lowered: u64,
}

/// A cell that a surface cuts.
#[derive(Clone, Debug)]
pub struct SurfaceCell {
    /// The cell.
    pub node: SolidNode,
    /// Its signed distance to the surface \[m\].
    pub distance: f64,
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
        self.bodies.get(b.0).map_or(&[], |cells| cells)
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
        let mut vicinity = std::mem::take(&mut self.vicinity);
        if vicinity.follow(lattice, bodies, fraction) {
            self.covered.resize(storage, false);
            self.bodies.resize_with(fraction.n_bodies(), Vec::new);
            let mark = |covered: &mut [bool], to| {
                let nodes = vicinity.seen.iter().flat_map(|&b| fraction.nodes(BodyId(b)));
                nodes.for_each(|node| covered[node.index] = to);
            };
            mark(&mut self.covered, true);
            for &b in &vicinity.work {
                self.place_body(lattice, bodies, BodyId(b), fraction);
            }
            mark(&mut self.covered, false);
        }
        self.vicinity = vicinity;
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
        let (nodes, rows) = (fraction.nodes(b), &mut all[b.0]);
        rows.clear();
        // Twice what is there now, so that a moving body allocates nothing.
        if rows.capacity() < nodes.len() {
            rows.reserve(2 * nodes.len());
        }
        for node in nodes.iter().filter(|n| n.fraction < 1.0) {
            let band = node.volume.powf(root);
            let x = pose.to_body(pose.position + node.arm);
            // No farther than half a diagonal: the surface cuts it.
            let widths = lattice.widths(lattice.node(node.index));
            let diagonal = widths[..lattice.dim].iter().map(|w| w * w).sum::<f64>().sqrt();
            let distance = solid.signed_distance(x, 0.51 * diagonal);
            let normal = pose.orientation * solid.normal(x, band);
            let h = cell_edge(lattice, lattice.node(node.index), normal);
            let foot = node.arm - normal * distance;
            let seen = fluid_points(lattice, pose.position + foot, normal, h, covered);
            let points = seen.map(|p| p.map(|p| p.distance));
            *lowered += u64::from(points.iter().flatten().count() < profile.points(*given));
            let at = if *extrapolates { distance } else { distance.max(0.0) };
            let weights = profile.weights(*given, at, points[0], points[1]);
            let mut fluid = [(lattice.base, 0.0); 16];
            for (p, point) in seen.iter().enumerate() {
                let weight = weights.map_or(0.0, |w| w.points[p]);
                for (at, (i, w)) in point.iter().flat_map(|point| &point.stencil).enumerate() {
                    fluid[8 * p + at] = (*i, w * weight);
                }
            }
            rows.push(SurfaceCell {
                node: *node,
                distance,
                foot,
                normal,
                points,
                surface: weights.map(|w| w.surface),
                fluid,
            });
        }
    }
}

/// A point in the fluid on a body's normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FluidPoint {
    /// Distance from the surface \[m\].
    pub distance: f64,
    /// Storage indices and weights of the nodes that it sees.
    pub stencil: [(usize, f64); 8],
}

impl FluidPoint {
    /// What it sees of a `field`.
    pub fn value(&self, field: &[f64]) -> f64 {
        self.stencil.iter().map(|&(i, w)| w * field[i]).sum()
    }
}

/// How wide the cell of `node` is along `normal` \[m\]: √Σ(nₐhₐ)², its edge wherever its edges are equal.
pub(crate) fn cell_edge(lattice: &Lattice, node: [isize; 3], normal: Vector) -> f64 {
    let widths = lattice.widths(node);
    (0..lattice.dim).map(|a| (normal[a] * widths[a]).powi(2)).sum::<f64>().sqrt()
}

/// P₁ and P₂ on the `normal` through the point `surface`, for cells of edge `h` and nodes that are `covered`.
pub(crate) fn fluid_points(
    lattice: &Lattice,
    surface: Point,
    normal: Vector,
    h: f64,
    covered: &[bool],
) -> [Option<FluidPoint>; 2] {
    // A shape may have no normal there.
    if h <= 0.0 {
        return [None; 2];
    }
    // The first point on the normal that sees free fluid only.
    let free = |distance: f64| {
        let mut stencil = interpolation(lattice, surface + normal * distance)?;
        let free = stencil.iter().all(|&(i, w)| w == 0.0 || !covered[i]);
        // What has no weight is not looked at: it may be no number.
        let (some, _) = *stencil.iter().find(|(_, w)| *w > 0.0)?;
        stencil.iter_mut().filter(|(_, w)| *w == 0.0).for_each(|(i, _)| *i = some);
        free.then_some(FluidPoint { distance, stencil })
    };
    let first = FIRST.into_iter().find_map(|i| free(0.25 * h * f64::from(i)));
    [first, first.and_then(|p| free(p.distance + h))]
}

/// Multilinear interpolation at `x`: up to eight (index, weight) pairs, or `None` outside a
/// bounded side.
fn interpolation(lattice: &Lattice, x: Point) -> Option<[(usize, f64); 8]> {
    let mut out = [(lattice.base, 0.0); 8];
    for (slot, (index, weight)) in out.iter_mut().zip(corners(lattice, x)) {
        *slot = (index?, weight);
    }
    Some(out)
}

/// The nodes around `x`, `None` outside a bounded side, and their weights in multilinear interpolation.
pub(crate) fn corners(lattice: &Lattice, x: Point) -> impl Iterator<Item = (Option<usize>, f64)> {
    let (first, part) = lattice.locate(x);
    (0..1_usize << lattice.dim).map(move |corner| {
        let up = [corner & 1, (corner >> 1) & 1, (corner >> 2) & 1];
        let index = lattice.index(std::array::from_fn(|a| first[a] + up[a] as isize));
        (index, (0..lattice.dim).map(|a| if up[a] == 1 { part[a] } else { 1.0 - part[a] }).product())
    })
}

#[cfg(test)]
mod tests;
