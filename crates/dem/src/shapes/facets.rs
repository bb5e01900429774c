//! A closed surface of triangles, as overlaps need it.
mod leaf;
mod tree;

pub(crate) use leaf::{Leaf, moved};
pub(crate) use tree::{Node, WIDTH};

use interfaces::Vector;
use nalgebra::Matrix3;
use std::collections::HashMap;

/// The triangles of a closed surface, how they hang together, and a tree of boxes around them.
#[derive(Clone, Debug)]
pub struct Facets {
    pub(crate) vertices: Vec<Vector>,
    pub(crate) faces: Vec<Face>,
    pub(crate) edges: Vec<Edge>,
    /// Edges at every vertex, and their other ends: those of vertex v are `spokes[hubs[v]..hubs[v + 1]]`.
    pub(crate) spokes: Vec<[u32; 2]>,
    pub(crate) hubs: Vec<u32>,
    /// Faces by their first corner: those of vertex v are `fans[first_fans[v]..first_fans[v + 1]]`.
    pub(crate) fans: Vec<u32>,
    pub(crate) first_fans: Vec<u32>,
    /// A vertex of every connected shell.
    pub(crate) shells: Vec<u32>,
    /// The shell of every vertex.
    pub(crate) shell_of: Vec<u32>,
    pub(crate) tree: Vec<Node>,
    /// The faces, eight by eight.
    pub(crate) leaves: Vec<Leaf>,
    /// The box around all, as [low, high].
    pub(crate) bounds: [Vector; 2],
    /// Largest distance of a vertex from the origin.
    pub(crate) radius: f64,
}

/// A triangle, its corners counter-clockwise seen from outside.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Face {
    pub(crate) corners: [u32; 3],
    /// Edge i runs from corner i to corner i + 1, or back.
    pub(crate) edges: [u32; 3],
}

/// An edge; its direction is that in which the face `left` has it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge {
    pub(crate) from: u32,
    pub(crate) to: u32,
    pub(crate) left: u32,
    pub(crate) right: u32,
}

/// Moments of a body of density one.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Moments {
    /// ∫ dV.
    pub(crate) volume: f64,
    /// ∫ x dV.
    pub(crate) first: Vector,
    /// ∫ x xᵀ dV.
    pub(crate) second: Matrix3<f64>,
}

impl Facets {
    /// Of triangles, every edge of which belongs to two of them, once in each direction.
    ///
    /// # Errors
    /// A face that breaks this rule.
    pub(crate) fn new(vertices: Vec<Vector>, mut corners: Vec<[u32; 3]>) -> Result<Self, usize> {
        let tree = tree::build(&vertices, &mut corners);
        let mut edges = Vec::with_capacity(corners.len() * 3 / 2);
        let mut faces: Vec<Face> = corners.iter().map(|c| Face { corners: *c, edges: [0; 3] }).collect();
        let mut open: HashMap<(u32, u32), u32> = HashMap::with_capacity(corners.len() * 3 / 2);
        for (f, face) in faces.iter_mut().enumerate() {
            for i in 0..3 {
                let (from, to) = (face.corners[i], face.corners[(i + 1) % 3]);
                if let Some(e) = open.remove(&(to, from)) {
                    let edge: &mut Edge = &mut edges[e as usize];
                    edge.right = f as u32;
                    face.edges[i] = e;
                } else {
                    face.edges[i] = edges.len() as u32;
                    edges.push(Edge { from, to, left: f as u32, right: u32::MAX });
                    if open.insert((from, to), face.edges[i]).is_some() {
                        return Err(f);
                    }
                }
            }
        }
        if let Some(&e) = open.values().next() {
            return Err(edges[e as usize].left as usize);
        }
        let ends =
            (0..).zip(&edges).flat_map(|(e, edge)| [(edge.from, [e, edge.to]), (edge.to, [e, edge.from])]);
        let (spokes, hubs) = by_vertex(ends, vertices.len());
        let first_corners = (0..).zip(&faces).map(|(f, face)| (face.corners[0], f));
        let (fans, first_fans) = by_vertex(first_corners, vertices.len());
        let start = [Vector::repeat(f64::INFINITY), Vector::repeat(f64::NEG_INFINITY)];
        let bounds = vertices.iter().fold(start, |[low, high], v| [low.inf(v), high.sup(v)]);
        let radius = vertices.iter().map(|v| v.norm()).fold(0.0, f64::max);
        let (shells, shell_of) = (Vec::new(), vec![u32::MAX; vertices.len()]);
        let triangle = |f: &Face| f.corners.map(|v| vertices[v as usize]);
        let leaves = faces.chunks(WIDTH).map(|c| Leaf::new(c.iter().map(triangle))).collect();
        let mut all = Self {
            vertices,
            faces,
            edges,
            spokes,
            hubs,
            fans,
            first_fans,
            shells,
            shell_of,
            tree,
            leaves,
            bounds,
            radius,
        };
        all.find_shells();
        Ok(all)
    }

    /// Numbers the connected parts of the surface.
    fn find_shells(&mut self) {
        let mut todo = Vec::new();
        for start in 0..self.vertices.len() as u32 {
            if self.shell_of[start as usize] != u32::MAX || self.spokes_of(start).is_empty() {
                continue;
            }
            let shell = self.shells.len() as u32;
            self.shells.push(start);
            self.shell_of[start as usize] = shell;
            todo.push(start);
            while let Some(v) = todo.pop() {
                for i in self.hubs[v as usize]..self.hubs[v as usize + 1] {
                    let [_, other] = self.spokes[i as usize];
                    if self.shell_of[other as usize] == u32::MAX {
                        self.shell_of[other as usize] = shell;
                        todo.push(other);
                    }
                }
            }
        }
    }

    /// The edges that meet in a vertex, and their other ends.
    #[inline]
    pub(crate) fn spokes_of(&self, v: u32) -> &[[u32; 2]] {
        &self.spokes[self.hubs[v as usize] as usize..self.hubs[v as usize + 1] as usize]
    }
    /// The faces whose first corner is vertex `v`.
    #[inline]
    pub(crate) fn fan(&self, v: u32) -> &[u32] {
        &self.fans[self.first_fans[v as usize] as usize..self.first_fans[v as usize + 1] as usize]
    }

    /// By the divergence theorem. Of a tetrahedron with the corners 0, a, b, c and the volume V = a·(b × c)/6:
    /// ∫ x dV = V s/4 and ∫ x xᵀ dV = V (a aᵀ + b bᵀ + c cᵀ + s sᵀ)/20 with s = a + b + c.
    pub(crate) fn moments(&self) -> Moments {
        let mut sum = Moments::default();
        for face in &self.faces {
            let [a, b, c] = face.corners.map(|v| self.vertices[v as usize]);
            let (v, s) = (a.dot(&b.cross(&c)) / 6.0, a + b + c);
            sum.volume += v;
            sum.first += s * (v / 4.0);
            let squares = a * a.transpose() + b * b.transpose() + c * c.transpose() + s * s.transpose();
            sum.second += squares * (v / 20.0);
        }
        sum
    }
}

impl Moments {
    /// ∫ (|x|² 1 − x xᵀ) dV.
    pub(crate) fn inertia(&self) -> Matrix3<f64> {
        Matrix3::from_diagonal_element(self.second.trace()) - self.second
    }
}

/// Sorts items by vertex: those of vertex v are at `starts[v]..starts[v + 1]`.
fn by_vertex<T: Copy + Default>(
    items: impl Iterator<Item = (u32, T)> + Clone,
    n: usize,
) -> (Vec<T>, Vec<u32>) {
    let mut starts = vec![0_u32; n + 1];
    items.clone().for_each(|(v, _)| starts[v as usize + 1] += 1);
    for v in 0..n {
        starts[v + 1] += starts[v];
    }
    let mut next = starts.clone();
    let mut sorted = vec![T::default(); starts[n] as usize];
    for (v, item) in items {
        sorted[next[v as usize] as usize] = item;
        next[v as usize] += 1;
    }
    (sorted, starts)
}
