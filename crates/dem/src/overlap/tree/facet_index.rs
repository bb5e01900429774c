//! Which boxes the facets of a body cut.
use interfaces::{Point, Polyhedron, Vector};
use nalgebra::Matrix3;
use rstar::{AABB, RTree, RTreeObject};

/// The facets of a closed surface in an R-tree, in the body's frame, so that it outlives every move of the body.
///
/// A shape that has facets builds it once and hands it out by [`Shape::facet_index`](crate::Shape::facet_index).
#[derive(Clone, Debug)]
pub struct FacetIndex {
    tree: RTree<Facet>,
}

#[derive(Clone, Copy, Debug)]
struct Facet([Vector; 3]);

impl RTreeObject for Facet {
    type Envelope = AABB<[f64; 3]>;
    fn envelope(&self) -> Self::Envelope {
        let [a, b, c] = self.0;
        AABB::from_corners(a.inf(&b).inf(&c).into(), a.sup(&b).sup(&c).into())
    }
}

impl FacetIndex {
    /// Those of `surface`.
    pub fn new(surface: Polyhedron<'_>) -> Self {
        let place = |v: u32| surface.vertices[v as usize].coords;
        let facets = surface.faces.iter().map(|face| Facet(face.map(place))).collect();
        Self { tree: RTree::bulk_load(facets) }
    }
    /// How many.
    pub fn len(&self) -> usize {
        self.tree.size()
    }
    /// Are there none?
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Does one of them come into the box of half-widths `half` around `centre`, along the columns of `axes`?
    pub fn cut(&self, centre: Point, axes: &Matrix3<f64>, half: Vector) -> bool {
        let around = axes.abs() * half;
        let (low, high) = (centre - around, centre + around);
        let envelope = AABB::from_corners(low.coords.into(), high.coords.into());
        let back = axes.transpose();
        self.tree
            .locate_in_envelope_intersecting(envelope)
            .any(|f| meets(&f.0.map(|v| back * (v - centre.coords)), half))
    }
}

/// Does a triangle meet the box of half-widths `half` around the origin? Separating axes: the box's, the triangle's
/// normal, and the products of their edges.
fn meets(t: &[Vector; 3], half: Vector) -> bool {
    let apart = |axis: Vector| {
        let p = t.map(|v| axis.dot(&v));
        let reach = axis.abs().dot(&half);
        p[0].min(p[1]).min(p[2]) > reach || p[0].max(p[1]).max(p[2]) < -reach
    };
    let edges = [t[1] - t[0], t[2] - t[1], t[0] - t[2]];
    let sides = [Vector::x(), Vector::y(), Vector::z()];
    let crossed = || edges.iter().flat_map(|e| sides.iter().map(move |s| s.cross(e)));
    !(sides.iter().any(|s| apart(*s)) || apart(edges[0].cross(&edges[1])) || crossed().any(apart))
}
