//! Small polyhedra.
use super::Faces;
use interfaces::{Point, Polyhedron};

/// A triangle mesh.
#[derive(Clone, Debug)]
pub(super) struct Body {
    pub(super) vertices: Vec<Point>,
    pub(super) faces: Vec<[u32; 3]>,
    pub(super) convex: bool,
}

impl Faces for Body {
    fn n_corners(&self) -> usize {
        self.vertices.len()
    }
    fn corner(&self, i: u32) -> Point {
        self.vertices[i as usize]
    }
    fn each(&self, visit: impl FnMut(&[u32])) {
        Polyhedron { vertices: &self.vertices, faces: &self.faces }.each(visit);
    }
    fn convex(&self) -> bool {
        self.convex
    }
}

/// A box whose faces are rectangles.
pub(super) struct Quads(pub(super) Vec<Point>);

impl Faces for Quads {
    fn n_corners(&self) -> usize {
        self.0.len()
    }
    fn corner(&self, i: u32) -> Point {
        self.0[i as usize]
    }
    fn each(&self, mut visit: impl FnMut(&[u32])) {
        QUADS.iter().for_each(|f| visit(f));
    }
    fn convex(&self) -> bool {
        true
    }
}

/// Corner i of a box has bit 0 of i along x and so on.
const QUADS: [[u32; 4]; 6] =
    [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];

fn corners(low: [f64; 3], high: [f64; 3]) -> Vec<Point> {
    (0..8).map(|i| Point::from([0, 1, 2].map(|a| if i >> a & 1 == 1 { high[a] } else { low[a] }))).collect()
}

pub(super) fn quads(low: [f64; 3], high: [f64; 3]) -> Quads {
    Quads(corners(low, high))
}

pub(super) fn cuboid(low: [f64; 3], high: [f64; 3]) -> Body {
    let faces = QUADS.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Body { vertices: corners(low, high), faces, convex: true }
}
/// With edges of 2 around the origin.
pub(super) fn cube() -> Body {
    cuboid([-1.0; 3], [1.0; 3])
}

/// Its volume is that of the corners' triple product over 6.
pub(super) fn tetrahedron(corners: [[f64; 3]; 4]) -> Body {
    let vertices: Vec<Point> = corners.map(Point::from).into();
    let edge = |i: usize| vertices[i] - vertices[0];
    let faces = if edge(1).dot(&edge(2).cross(&edge(3))) > 0.0 {
        vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
    } else {
        vec![[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]
    };
    Body { vertices, faces, convex: true }
}

/// A tessellated sphere of radius `r`.
pub(super) fn icosphere(r: f64, times: u32) -> Body {
    let (vertices, faces) = crate::shapes::icosphere(r, times);
    Body { vertices: vertices.into_iter().map(Point::from).collect(), faces, convex: true }
}

/// A polygon in the plane z = 0, counter-clockwise, and triangles that fill it, pulled out to z = `height`.
pub(super) fn prism(outline: &[[f64; 2]], triangles: &[[u32; 3]], height: f64) -> Body {
    let n = outline.len() as u32;
    let level = |z: f64| outline.iter().map(move |p| Point::new(p[0], p[1], z));
    let vertices = level(0.0).chain(level(height)).collect();
    let mut faces = Vec::new();
    for &[p, q, s] in triangles {
        faces.extend([[p, s, q], [p + n, q + n, s + n]]);
    }
    for i in 0..n {
        let j = (i + 1) % n;
        faces.extend([[i, j, j + n], [i, j + n, i + n]]);
    }
    Body { vertices, faces, convex: false }
}
/// 2 × 2 × 1 without the quarter x, y > 1.
pub(super) fn l_block() -> Body {
    let outline = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    prism(&outline, &[[0, 1, 3], [1, 2, 3], [0, 3, 5], [3, 4, 5]], 1.0)
}
/// 3 × 2 × 1 with a slot 1 < x < 2, y > 1.
pub(super) fn u_block() -> Body {
    let outline =
        [[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [2.0, 2.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    prism(&outline, &[[0, 5, 7], [5, 6, 7], [0, 4, 5], [0, 1, 4], [1, 3, 4], [1, 2, 3]], 1.0)
}

impl Body {
    /// Both, the second turned inside out if it is to be a hole.
    pub(super) fn with(mut self, other: &Self, hole: bool) -> Self {
        let n = self.vertices.len() as u32;
        self.vertices.extend(&other.vertices);
        self.faces.extend(
            other.faces.iter().map(
                |&[p, q, s]| {
                    if hole { [p + n, s + n, q + n] } else { [p + n, q + n, s + n] }
                },
            ),
        );
        self.convex = false;
        self
    }
    pub(super) fn mapped(mut self, map: impl Fn(Point) -> Point) -> Self {
        self.vertices.iter_mut().for_each(|x| *x = map(*x));
        self
    }
}
