//! One of the two bodies, and the marks that an overlap leaves on it.
use crate::shapes::{Facets, Patches, Places, moved};
use interfaces::Vector;
use nalgebra::Matrix3;

/// Marks on vertices, faces and edges. They count for one overlap only, told by its number: nothing has to be cleared.
#[derive(Clone, Debug, Default)]
pub(super) struct Marks {
    run: u32,
    patches: Vec<Marked<Patches>>,
    leaves: Vec<Marked<Places>>,
    /// Of a body that is moved, where the corners of these leaves are.
    places: Vec<Vector>,
    edges: Vec<Marked<Crossed>>,
    /// Of faces that the other body's surface crosses: where they are in `cut`.
    faces: Vec<Marked<u32>>,
    /// Of vertices at which crossed edges end.
    crossed_at: Vec<u32>,
    /// Of vertices in the other body: the group.
    inside: Vec<Marked<u32>>,
    /// The faces that the other body's surface crosses.
    pub(super) cut: Vec<Cut>,
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

/// A face that the other body's surface crosses.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut {
    pub(super) face: u32,
    /// The point of its plane nearest to the reference point, from there.
    pub(super) foot: Vector,
}

/// The plane of a face that is cut.
#[derive(Clone, Copy)]
pub(super) struct Plane {
    pub(super) face: u32,
    /// Its number among the cut ones.
    pub(super) number: u32,
    pub(super) corner: Vector,
    /// Not of unit length.
    pub(super) normal: Vector,
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
        fit(&mut self.inside, facets.vertices.len());
        fit(&mut self.crossed_at, facets.vertices.len());
        fit(&mut self.faces, facets.faces.len());
        fit(&mut self.edges, facets.edges.len());
        fit(&mut self.patches, facets.patches.len());
        fit(&mut self.leaves, facets.leaves.len());
        fit(&mut self.places, facets.vertices.len());
        self.cut.clear();
        self.found.clear();
        self.known.clear();
        self.known.resize(facets.shells.len(), false);
    }
}

/// A body in the frame in which both are worked on.
pub(super) struct Body<'a> {
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
    pub(super) fn place(&self, v: u32) -> Vector {
        let x = self.facets.vertices[v as usize];
        let Some((turn, shift)) = &self.moved else { return x };
        let along = |a: usize| moved(&[turn[(a, 0)], turn[(a, 1)], turn[(a, 2)]], shift[a], [x.x, x.y, x.z]);
        Vector::new(along(0), along(1), along(2))
    }
    /// Where a vertex is, from the reference point.
    #[inline]
    pub(super) fn arm(&self, v: u32) -> Vector {
        self.place(v) - self.reference
    }
    #[inline]
    pub(super) fn corners(&self, f: u32) -> [Vector; 3] {
        self.facets.faces[f as usize].corners.map(|v| self.place(v))
    }
    /// Sees to it that [`patches`](Self::patches) can be asked for.
    #[inline(always)]
    pub(super) fn prepare_patches(&mut self, n: u32) {
        let Some((turn, shift)) = &self.moved else { return };
        let own = &mut self.marks.patches[n as usize];
        if own.run != self.marks.run {
            own.run = self.marks.run;
            own.value.move_from(&self.facets.patches[n as usize], turn, shift, self.facets.radius);
        }
    }
    /// Boxes along the surface, in the common frame.
    #[inline(always)]
    pub(super) fn patches(&self, n: u32) -> &Patches {
        if self.moved.is_some() {
            &self.marks.patches[n as usize].value
        } else {
            &self.facets.patches[n as usize]
        }
    }
    /// Sees to it that [`places`](Self::places), and of its vertices [`prepared`](Self::prepared) can be asked for.
    #[inline(always)]
    pub(super) fn prepare_leaf(&mut self, n: u32) {
        let Some((turn, shift)) = &self.moved else { return };
        let extent = self.extent();
        let own = &mut self.marks.leaves[n as usize];
        if own.run != self.marks.run {
            own.run = self.marks.run;
            let leaf = &self.facets.leaves[n as usize];
            own.value.move_from(&leaf.places, turn, shift, extent);
            for v in leaf.vertices() {
                self.marks.places[*v as usize] = self.place(*v);
            }
        }
    }
    /// Where eight faces are, in the common frame, in single precision.
    #[inline(always)]
    pub(super) fn places(&self, n: u32) -> &Places {
        if self.moved.is_some() {
            &self.marks.leaves[n as usize].value
        } else {
            &self.facets.leaves[n as usize].places
        }
    }
    /// Where a vertex of a leaf is that was prepared.
    #[inline(always)]
    pub(super) fn prepared(&self, v: u32) -> Vector {
        let places = if self.moved.is_some() { &self.marks.places } else { &self.facets.vertices };
        places[v as usize]
    }
    /// No coordinate in the common frame exceeds this.
    #[inline]
    pub(super) fn extent(&self) -> f64 {
        self.facets.radius + self.moved.map_or(0.0, |(_, shift)| shift.norm())
    }
    /// The plane of face `f`, which is cut, with these corners.
    #[inline]
    pub(super) fn cut(&mut self, f: u32, [a, b, c]: &[Vector; 3]) -> Plane {
        let normal = (b - a).cross(&(c - a));
        let mark = &mut self.marks.faces[f as usize];
        if mark.run != self.marks.run {
            *mark = Marked { run: self.marks.run, value: self.marks.cut.len() as u32 };
            let square = normal.norm_squared();
            let height = normal.dot(&(a - self.reference));
            let foot = if square > 0.0 { normal * (height / square) } else { Vector::zeros() };
            self.marks.cut.push(Cut { face: f, foot });
        }
        Plane { face: f, number: mark.value, corner: *a, normal }
    }
    /// The foot of a face that is cut.
    #[inline]
    pub(super) fn foot(&self, f: u32) -> Vector {
        let mark = &self.marks.faces[f as usize];
        if mark.run == self.marks.run { self.marks.cut[mark.value as usize].foot } else { Vector::zeros() }
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
        let edge = &self.facets.edges[e as usize];
        for v in [edge.from, edge.to] {
            self.marks.crossed_at[v as usize] = self.marks.run;
        }
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
    #[inline]
    pub(super) fn is_cut(&self, f: u32) -> bool {
        self.marks.faces[f as usize].run == self.marks.run
    }
    /// Do crossed edges end in a vertex?
    #[inline]
    pub(super) fn has_crossed(&self, v: u32) -> bool {
        self.marks.crossed_at[v as usize] == self.marks.run
    }
}
