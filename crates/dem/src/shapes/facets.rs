//! A closed surface of triangles, as overlaps need it.
mod eight;
mod leaf;
mod patches;
mod tree;

pub(crate) use eight::{Words, parts};
pub(crate) use leaf::{Leaf, Places, moved, slack};
pub(crate) use patches::Patches;
use tree::Node;
pub(crate) use tree::WIDTH;

use super::Moments;
use interfaces::Vector;
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
    /// Boxes along the surface around the tree's nodes.
    pub(crate) patches: Vec<Patches>,
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

impl Facets {
    /// Of triangles, every edge of which belongs to two of them, once in each direction. Vertices of none are dropped.
    ///
    /// # Errors
    /// A face that breaks this rule.
    pub(crate) fn new(mut vertices: Vec<Vector>, mut corners: Vec<[u32; 3]>) -> Result<Self, usize> {
        let (tree, patches) = tree::build(&vertices, &mut corners);
        number_by_use(&mut vertices, &mut corners);
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
        let leaves = faces.chunks(WIDTH).map(|eight| Leaf::new(eight, &vertices, radius)).collect();
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
            patches,
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

    /// Calls `visit` with the faces whose boxes meet the box of half edges `reach` around a point,
    /// and perhaps with others.
    pub(crate) fn visit_near(&self, x: Vector, reach: Vector, mut visit: impl FnMut(u32)) {
        let sides = [x - reach, x + reach].map(|v| [v.x, v.y, v.z].map(|c| c as f32));
        // Rounding to single precision.
        let slack = 1e-6 * (self.radius + reach.max()) as f32;
        if !self.tree.is_empty() {
            self.visit_below(0, sides[0].map(|s| s - slack), sides[1].map(|s| s + slack), &mut visit);
        }
    }
    fn visit_below(&self, n: u32, low: [f32; 3], high: [f32; 3], visit: &mut impl FnMut(u32)) {
        let node = &self.tree[n as usize];
        for slot in 0..WIDTH {
            if (0..3).all(|a| node.low[a][slot] <= high[a] && node.high[a][slot] >= low[a]) {
                let child = node.children[slot];
                if node.is_leaf {
                    visit(child + slot as u32);
                } else {
                    self.visit_below(child, low, high, visit);
                }
            }
        }
    }
    /// Area of the largest flat part of the surface, of one triangle or of neighbours in one plane (to 1e-6 rad) \[m²\].
    pub(crate) fn largest_flat(&self) -> f64 {
        let normals: Vec<Vector> = self.faces.iter().map(|f| self.twice_area(f)).collect();
        let mut root: Vec<u32> = (0..self.faces.len() as u32).collect();
        let find = |root: &mut [u32], mut f: u32| {
            while root[f as usize] != f {
                root[f as usize] = root[root[f as usize] as usize];
                f = root[f as usize];
            }
            f
        };
        for edge in &self.edges {
            let [m, n] = [edge.left, edge.right].map(|f| normals[f as usize]);
            if m.dot(&n) > 0.0 && m.cross(&n).norm() <= 1e-6 * m.norm() * n.norm() {
                let [p, q] = [edge.left, edge.right].map(|f| find(&mut root, f));
                root[p as usize] = q;
            }
        }
        let mut areas = vec![0.0; self.faces.len()];
        for f in 0..self.faces.len() {
            areas[find(&mut root, f as u32) as usize] += 0.5 * normals[f].norm();
        }
        areas.into_iter().fold(0.0, f64::max)
    }

    fn twice_area(&self, face: &Face) -> Vector {
        let [a, b, c] = face.corners.map(|v| self.vertices[v as usize]);
        (b - a).cross(&(c - a))
    }

    pub(crate) fn moments(&self) -> Moments {
        Moments::of(&self.vertices, self.faces.iter().map(|f| f.corners))
    }
}

/// Numbers vertices as faces come upon them, and drops those of none: what is near in space, and asked for together, is near in
/// memory.
fn number_by_use(vertices: &mut Vec<Vector>, corners: &mut [[u32; 3]]) {
    let mut numbers = vec![u32::MAX; vertices.len()];
    let mut sorted = Vec::with_capacity(vertices.len());
    for v in corners.as_flattened_mut() {
        let number = &mut numbers[*v as usize];
        if *number == u32::MAX {
            *number = sorted.len() as u32;
            sorted.push(vertices[*v as usize]);
        }
        *v = *number;
    }
    *vertices = sorted;
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
