//! One of the two bodies, and the marks that an overlap leaves on it.
use super::signs::{Side, is_behind};
use crate::shapes::{Facets, Node, WIDTH};
use interfaces::Vector;
use nalgebra::Matrix3;

/// Marks on vertices, faces and edges. They count for one overlap only, told by its number: nothing has to be cleared.
#[derive(Clone, Debug, Default)]
pub(super) struct Marks {
    run: u32,
    places: Vec<Marked<Vector>>,
    planes: Vec<Marked<Plane>>,
    nodes: Vec<Marked<Node>>,
    edges: Vec<Marked<Crossed>>,
    inside: Vec<Marked<u32>>,
    /// Faces that the other body's surface crosses.
    cut: Vec<Marked<()>>,
    /// Those faces, each once.
    pub(super) cut_faces: Vec<u32>,
    /// Vertices at which crossed edges end.
    crossed_at: Vec<Marked<()>>,
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
    /// normal·(x − a) has the right sign where it is beyond this times the largest component of x − a.
    round_off: f64,
}

impl Plane {
    /// Which of three corners `p` of the body `of` lie behind the face with these `corners`, a bit for each.
    #[inline]
    pub(super) fn behind(&self, of: Side, p: &[Vector; 3], corners: &[Vector; 3]) -> u32 {
        let mut behind = 0;
        for i in 0..3 {
            let d = p[i] - corners[0];
            let (height, size) = (self.normal.dot(&d), d.x.abs().max(d.y.abs()).max(d.z.abs()));
            let is_behind = if height.abs() > self.round_off * size {
                height < 0.0
            } else {
                is_behind(of, p[i], *corners)
            };
            behind |= u32::from(is_behind) << i;
        }
        behind
    }
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
        fit(&mut self.nodes, facets.tree.len());
        fit(&mut self.cut, facets.faces.len());
        fit(&mut self.crossed_at, facets.vertices.len());
        self.cut_faces.clear();
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
    /// A node of the tree, its boxes in the common frame.
    #[inline(always)]
    pub(super) fn node(&mut self, n: u32) -> &Node {
        let at = n as usize;
        if self.moved.is_none() {
            return &self.facets.tree[at];
        }
        if self.marks.nodes[at].run != self.marks.run {
            let value = self.turned_node(at);
            self.marks.nodes[at] = Marked { run: self.marks.run, value };
        }
        &self.marks.nodes[at].value
    }
    #[inline(always)]
    fn turned_node(&mut self, at: usize) -> Node {
        let node = &self.facets.tree[at];
        let mut turned = Node { children: node.children, is_leaf: node.is_leaf, ..Node::default() };
        if node.is_leaf {
            let first = node.children[0];
            let count = WIDTH.min(self.facets.faces.len() - first as usize);
            for slot in 0..count {
                if node.low[0][slot] <= node.high[0][slot] {
                    let [a, b, c] = self.corners(first + slot as u32);
                    turned.set(slot, a.inf(&b).inf(&c), a.sup(&b).sup(&c));
                }
            }
        } else if let Some((turn, shift)) = &self.moved {
            let turn = turn.map(|x| x as f32);
            let shift = shift.map(|x| x as f32);
            // For rounding to single precision.
            let slack = 1e-6 * (self.facets.radius as f32 + shift.amax());
            for i in 0..3 {
                for slot in 0..WIDTH {
                    let (mut centre, mut half) = (shift[i], slack);
                    for k in 0..3 {
                        centre += turn[(i, k)] * 0.5 * (node.high[k][slot] + node.low[k][slot]);
                        half += turn[(i, k)].abs() * 0.5 * (node.high[k][slot] - node.low[k][slot]);
                    }
                    // Of an empty box the half is −∞ and the centre no number.
                    let filled = half > 0.0;
                    turned.low[i][slot] = if filled { centre - half } else { f32::INFINITY };
                    turned.high[i][slot] = if filled { centre + half } else { f32::NEG_INFINITY };
                }
            }
        }
        turned
    }
    /// The plane of a face.
    #[inline]
    pub(super) fn plane(&mut self, f: u32) -> Plane {
        let mark = self.marks.planes[f as usize];
        if mark.run == self.marks.run {
            return mark.value;
        }
        let [a, b, c] = self.corners(f);
        let (u, v) = (b - a, c - a);
        let normal = u.cross(&v);
        // With sums and products rounded by ε each, 48 ε |u| |v| at most.
        let round_off = 64.0 * f64::EPSILON * u.amax() * v.amax();
        let square = normal.norm_squared();
        let height = normal.dot(&(a - self.reference));
        let foot = if square > 0.0 { normal * (height / square) } else { Vector::zeros() };
        let value = Plane { normal, foot, round_off };
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
        let edge = &self.facets.edges[e as usize];
        for v in [edge.from, edge.to] {
            self.marks.crossed_at[v as usize].run = self.marks.run;
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
    /// Marks a face that the other body's surface crosses.
    #[inline]
    pub(super) fn cut(&mut self, f: u32) {
        let mark = &mut self.marks.cut[f as usize];
        if mark.run != self.marks.run {
            mark.run = self.marks.run;
            self.marks.cut_faces.push(f);
        }
    }
    #[inline]
    pub(super) fn is_cut(&self, f: u32) -> bool {
        self.marks.cut[f as usize].run == self.marks.run
    }
    /// Do crossed edges end in a vertex?
    #[inline]
    pub(super) fn has_crossed(&self, v: u32) -> bool {
        self.marks.crossed_at[v as usize].run == self.marks.run
    }
}
