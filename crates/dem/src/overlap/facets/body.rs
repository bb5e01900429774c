//! One of the two bodies, and the marks that an overlap leaves on it.
use super::signs::Side;
use crate::shapes::Facets;
use interfaces::Vector;
use nalgebra::Matrix3;

/// Marks on vertices, faces and edges. They count for one overlap only, told by its number: nothing has to be cleared.
#[derive(Clone, Debug, Default)]
pub(super) struct Marks {
    run: u32,
    places: Vec<Marked<Vector>>,
    planes: Vec<Marked<Plane>>,
    edges: Vec<Marked<Crossed>>,
    inside: Vec<Marked<u32>>,
    /// The vertices that lie in the other body.
    pub(super) found: Vec<u32>,
    /// Is it known of a shell's vertices which of them do?
    pub(super) known: Vec<bool>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Marked<T> {
    run: u32,
    value: T,
}

/// The plane of a face.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Plane {
    /// (b − a) × (c − a) \[m²\].
    pub(super) normal: Vector,
    /// Its point nearest to the reference point, from there \[m\].
    pub(super) foot: Vector,
}

/// What crosses an edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossed {
    /// Is the end inside the other body (1), or the start (−1), or both or neither (0)?
    pub(super) net: i32,
    /// The first of its crossings; each knows the next.
    pub(super) first: u32,
}

/// No crossing.
pub(super) const NONE: u32 = u32::MAX;

impl Default for Crossed {
    fn default() -> Self {
        Self { net: 0, first: NONE }
    }
}

impl Marks {
    /// Makes room for marks on a surface and forgets all earlier ones.
    pub(super) fn start(&mut self, facets: &Facets) {
        self.run = self.run.wrapping_add(1);
        if self.run == 0 {
            // The numbers begin anew: what is left of those before must not be taken for ours.
            *self = Self { run: 1, ..Self::default() };
        }
        fn fit<T: Default + Clone>(list: &mut Vec<T>, len: usize) {
            if list.len() < len {
                list.resize(len, T::default());
            }
        }
        fit(&mut self.places, facets.vertices.len());
        fit(&mut self.inside, facets.vertices.len());
        fit(&mut self.planes, facets.faces.len());
        fit(&mut self.edges, facets.edges.len());
        self.found.clear();
        self.known.clear();
        self.known.resize(facets.shells.len(), false);
    }
}

/// A body in the frame in which both are worked on.
pub(super) struct Body<'a> {
    pub(super) side: Side,
    pub(super) facets: &'a Facets,
    pub(super) marks: &'a mut Marks,
    /// From the body's frame: the turn and the place of its origin; none if the frames are the same.
    pub(super) moved: Option<(Matrix3<f64>, Vector)>,
    /// Sums are taken about this point.
    pub(super) reference: Vector,
}

impl Body<'_> {
    /// Where a vertex is.
    #[inline]
    pub(super) fn place(&mut self, v: u32) -> Vector {
        let v = v as usize;
        let Some((turn, shift)) = &self.moved else { return self.facets.vertices[v] };
        let mark = &mut self.marks.places[v];
        if mark.run != self.marks.run {
            *mark = Marked { run: self.marks.run, value: turn * self.facets.vertices[v] + shift };
        }
        mark.value
    }
    /// Where a vertex is, from the reference point.
    #[inline]
    pub(super) fn arm(&mut self, v: u32) -> Vector {
        self.place(v) - self.reference
    }
    #[inline]
    pub(super) fn corners(&mut self, f: u32) -> [Vector; 3] {
        let [a, b, c] = self.facets.faces[f as usize].corners;
        [self.place(a), self.place(b), self.place(c)]
    }
    /// The plane of a face.
    #[inline]
    pub(super) fn plane(&mut self, f: u32) -> Plane {
        let mark = self.marks.planes[f as usize];
        if mark.run == self.marks.run {
            return mark.value;
        }
        let [a, b, c] = self.corners(f);
        let normal = (b - a).cross(&(c - a));
        let square = normal.norm_squared();
        let height = normal.dot(&(a - self.reference));
        let foot = if square > 0.0 { normal * (height / square) } else { Vector::zeros() };
        let value = Plane { normal, foot };
        self.marks.planes[f as usize] = Marked { run: self.marks.run, value };
        value
    }
    /// What crosses an edge.
    #[inline]
    pub(super) fn crossed(&self, e: u32) -> Crossed {
        let mark = &self.marks.edges[e as usize];
        if mark.run == self.marks.run { mark.value } else { Crossed::default() }
    }
    #[inline]
    pub(super) fn cross(&mut self, e: u32, crossed: Crossed) {
        self.marks.edges[e as usize] = Marked { run: self.marks.run, value: crossed };
    }
    /// The group of a vertex that is known to lie in the other body.
    #[inline]
    pub(super) fn group(&self, v: u32) -> Option<u32> {
        let mark = self.marks.inside[v as usize];
        (mark.run == self.marks.run).then_some(mark.value)
    }
    #[inline]
    pub(super) fn set_group(&mut self, v: u32, group: u32) {
        self.marks.inside[v as usize] = Marked { run: self.marks.run, value: group };
        self.marks.found.push(v);
    }
    /// Is a face whole within the other body, as far as its corners and edges tell?
    #[inline]
    pub(super) fn is_whole(&self, f: u32) -> bool {
        let face = &self.facets.faces[f as usize];
        face.corners.iter().all(|&v| self.group(v).is_some())
            && face.edges.iter().all(|&e| self.crossed(e).first == NONE)
    }
}
