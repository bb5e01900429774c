//! The λ field, body by body.
use crate::IbmError;
use crate::projection::Projector;
use interfaces::{Aabb, Bodies, BodyId, Lattice, Pose, Renumbering, Vector, is_longer};

/// A node with something solid in its control volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidNode {
    /// Storage index of the node.
    pub index: usize,
    /// Solid fraction λ, in (0, 1].
    pub fraction: f64,
    /// Place of the node from the body's centre of mass \[m\].
    pub arm: Vector,
    /// Its control volume \[m³\]; area in a plane lattice.
    pub volume: f64,
}

/// What λ is in a cell that the surface cuts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FractionRule {
    /// The share of its volume that is solid: Σ λ V is the body's volume (see [`SolidFraction`]).
    #[default]
    CutVolume,
    /// The paper's: from the signed distance d of the cell's centroid, λ = ½ (1 − tanh(d/V^{1/D}))
    /// (Isoz et al. 2022; openHFDIB-DEM with intSpan = 1, D = 3).
    Centroid,
}

impl FractionRule {
    /// λ of a cell of volume `volume` in `dim` dimensions whose centroid is at `distance`, and whose
    /// solid share is `cut`. Both rules agree on which cells are cut, of shapes that are no polyhedra.
    pub fn fraction(self, cut: f64, distance: f64, volume: f64, dim: usize) -> f64 {
        if self == Self::CutVolume || cut <= 0.0 || cut >= 1.0 {
            return cut;
        }
        let edge = if dim == 2 { volume.sqrt() } else { volume.cbrt() };
        0.5 * (1.0 - (distance / edge).tanh())
    }
}

/// The solid fraction of every body on one lattice.
///
/// Only bodies whose pose (or shape's box) changed are worked on, and of those only the nodes that
/// their box reaches. Signed distances are asked for in batches, in a band of the nodes that the
/// surface is near. A cut cell's share follows from distance, normal and curvature
/// ([`cell_fraction`](crate::cell_fraction)), which are differences of the distances at the node and
/// its neighbours; where these tell of an edge, a corner or something thinner than a cell, the cell is
/// cut into ever smaller ones. Σ λ V is the volume within 0.1 % at ten cells per diameter. In space λ of bodies made of triangles
/// ([`Solid::polyhedron`](interfaces::Solid::polyhedron)) follows from these instead, and is exact.
#[derive(Clone, Debug, Default)]
pub struct SolidFraction {
    rule: FractionRule,
    /// The axis along the only layer of nodes that counts, and its number on it.
    layer: Option<(usize, usize)>,
    lattice: Option<Lattice>,
    bodies: Vec<Cover>,
    projector: Projector,
    updates: u64,
}

/// What one body covers.
#[derive(Clone, Debug, Default)]
struct Cover {
    at: Option<(Pose, Aabb)>,
    /// Which update found it there, counted over all bodies.
    stamp: u64,
    nodes: Vec<SolidNode>,
}

impl SolidFraction {
    /// No bodies yet.
    pub fn new() -> Self {
        Self::default()
    }
    /// Another λ in cut cells.
    #[must_use]
    pub fn with_rule(mut self, rule: FractionRule) -> Self {
        self.rule = rule;
        self
    }

    /// From here on of the nodes of one layer only, those with this number along this axis, or of all. Each λ is as of all nodes.
    pub fn set_layer(&mut self, layer: Option<(usize, usize)>) {
        if self.layer != layer {
            self.layer = layer;
            self.bodies.clear();
        }
    }

    /// Brings λ up to date with the bodies' poses.
    ///
    /// # Errors
    /// [`IbmError::Lost`] for a body whose position is not finite, [`IbmError::TooLarge`] for one that
    /// is longer than a period of the lattice by more than a cell.
    pub fn update<B: Bodies + ?Sized>(&mut self, lattice: &Lattice, bodies: &B) -> Result<(), IbmError> {
        self.resize(lattice, bodies.n_bodies());
        for body in (0..bodies.n_bodies()).map(BodyId) {
            if self.bodies[body.0].at != at(bodies, body) {
                check(lattice, bodies, body)?;
                self.cover(lattice, bodies, body);
            }
        }
        Ok(())
    }

    /// Bodies were taken away: λ of the others goes by their new numbers. Without being told, it is found anew.
    pub(crate) fn renumber(&mut self, numbers: &Renumbering) {
        numbers.apply(&mut self.bodies);
    }

    /// Makes room for so many bodies on this lattice; true if there was another one.
    pub(crate) fn resize(&mut self, lattice: &Lattice, n_bodies: usize) -> bool {
        let other = self.lattice.as_ref() != Some(lattice);
        if other {
            self.lattice = Some(lattice.clone());
            self.bodies.clear();
        }
        self.bodies.resize_with(n_bodies, Cover::default);
        other
    }

    /// Brings λ of one body up to date, which [`check`] has passed.
    pub(crate) fn cover<B: Bodies + ?Sized>(&mut self, lattice: &Lattice, bodies: &B, body: BodyId) {
        let Some(cover) = self.bodies.get_mut(body.0) else { return };
        let at = at(bodies, body);
        if cover.at != at {
            self.projector.project(lattice, bodies, body, (self.rule, self.layer), &mut cover.nodes);
            if cover.nodes.is_empty() {
                cover.nodes = Vec::new();
            }
            if closes(lattice, bodies, body) {
                join(&mut cover.nodes);
            }
            cover.at = at;
            self.updates += 1;
            cover.stamp = self.updates;
        }
    }

    /// How often a body's λ was computed: a body at rest counts once.
    pub fn updates(&self) -> u64 {
        self.updates
    }

    /// How many bodies there were at the last update.
    pub fn n_bodies(&self) -> usize {
        self.bodies.len()
    }

    /// A number that changes whenever λ of body `b` was computed; 0 before.
    pub fn stamp(&self, b: BodyId) -> u64 {
        self.bodies.get(b.0).map_or(0, |cover| cover.stamp)
    }

    /// The nodes that body `b` covers at least in part.
    pub fn nodes(&self, b: BodyId) -> &[SolidNode] {
        self.bodies.get(b.0).map_or(&[], |cover| &cover.nodes)
    }

    /// λ of all bodies added to a dense field, x fastest; where bodies share a cell it stays ≤ 1.
    pub fn add_to_dense(&self, lattice: &Lattice, out: &mut [f64]) {
        let [nx, ny, _] = lattice.shape();
        for node in self.bodies.iter().flat_map(|cover| &cover.nodes) {
            let [i, j, k] = lattice.node(node.index).map(|i| i as usize);
            let cell = &mut out[i + nx * (j + ny * k)];
            *cell = (*cell + node.fraction).min(1.0);
        }
    }
}

fn at<B: Bodies + ?Sized>(bodies: &B, body: BodyId) -> Option<(Pose, Aabb)> {
    Some((bodies.pose(body), bodies.solid(body).aabb()))
}

/// Whether a node may be in the body and in its periodic image.
fn closes<B: Bodies + ?Sized>(lattice: &Lattice, bodies: &B, body: BodyId) -> bool {
    let extent = bodies.aabb(body).extent();
    let long = |a: usize| lattice.axes[a].period().is_some_and(|p| extent[a] + 2.0 * widest(lattice, a) > p);
    (0..lattice.dim).any(long)
}

/// The widest cell along `axis` \[m\].
fn widest(lattice: &Lattice, axis: usize) -> f64 {
    let nodes = &lattice.axes[axis];
    nodes.spacings(nodes.place(0), nodes.place(nodes.len() as isize))[1]
}

/// Makes one of nodes that are listed more than once, with the sum of their λ, at most 1: solid
/// from a seam with the body's own image up to its other side.
fn join(nodes: &mut Vec<SolidNode>) {
    nodes.sort_unstable_by_key(|node| node.index);
    nodes.dedup_by(|node, first| {
        let same = node.index == first.index;
        if same {
            first.fraction = (first.fraction + node.fraction).min(1.0);
        }
        same
    });
}

/// Can λ of a body be computed?
pub(crate) fn check<B: Bodies + ?Sized>(lattice: &Lattice, bodies: &B, body: BodyId) -> Result<(), IbmError> {
    let pose = bodies.pose(body);
    let turned = pose.orientation.coords.iter().all(|q| q.is_finite());
    if !(turned && pose.position.iter().all(|x| x.is_finite())) {
        return Err(IbmError::Lost { body, position: pose.position.into() });
    }
    let extent = bodies.aabb(body).extent();
    for axis in 0..lattice.dim {
        if let Some(period) = lattice.axes[axis].period()
            && is_longer(extent[axis], period + widest(lattice, axis))
        {
            return Err(IbmError::TooLarge { body, axis, size: extent[axis], period });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
