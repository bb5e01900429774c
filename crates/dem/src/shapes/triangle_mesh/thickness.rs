//! Where a body or a gap in it is thinnest.
use super::crossings::FaceTree;
use crate::shapes::triangle::Triangle;
use interfaces::{Point, Vector};

/// Least cosine between the way across and the other face's normal: 60°.
const FACING: f64 = 0.5;
/// Cosine of the angle by which the nearest point of a face may be beside the way straight ahead, 26°.
const BESIDE: f64 = 0.9;

/// A wall or gap between two faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thinnest {
    /// How thick \[m\].
    pub thickness: f64,
    /// A face on either side.
    pub faces: [usize; 2],
    /// Its place on the first face, in the coordinates that the vertices were given in \[m\].
    pub at: Point,
}

/// Where from, and which way, something opposite is looked for.
struct Look<'a> {
    from: Point,
    /// Unit vector.
    along: Vector,
    /// Faces that have one of these vertices are not opposite.
    own: &'a [u32],
    /// Whether it is looked for through the body (1) or outside (−1).
    through: f64,
}

/// Faces below a node of a tree.
#[derive(Clone, Copy)]
struct Below {
    /// Least and largest components of their normals.
    normals: [Vector; 2],
    /// A vertex that all have.
    hub: Option<u32>,
}

impl Below {
    fn join(self, other: Self) -> Self {
        let [[a, b], [c, d]] = [self.normals, other.normals];
        Self { normals: [a.inf(&c), b.sup(&d)], hub: self.hub.filter(|_| self.hub == other.hub) }
    }
}

/// Faces as the search needs them.
pub(crate) struct Thickness<'a> {
    pub(crate) faces: &'a [[u32; 3]],
    pub(crate) number: &'a [usize],
    pub(crate) tree: &'a FaceTree,
    triangles: Vec<Triangle>,
    normals: Vec<Vector>,
    /// Summaries of all nodes of the tree.
    below: Vec<Below>,
}

impl<'a> Thickness<'a> {
    /// Of faces with vertices `at` these places; `outward` is −1 if they look inward.
    pub(crate) fn new(
        faces: &'a [[u32; 3]],
        number: &'a [usize],
        tree: &'a FaceTree,
        at: impl Fn(u32) -> Point,
        outward: f64,
    ) -> Self {
        let triangles: Vec<Triangle> = faces
            .iter()
            .map(|f| {
                let [a, b, c] = f.map(|v| at(v).coords);
                Triangle::new(a, b, c)
            })
            .collect();
        let normals: Vec<Vector> =
            triangles.iter().map(|t| t.cross().try_normalize(0.0).unwrap_or_default() * outward).collect();
        let own = |f: u32| Below { normals: [normals[f as usize]; 2], hub: Some(tree.hubs[f as usize]) };
        let below = tree.tree.sums(own, Below::join);
        Self { faces, number, tree, triangles, normals, below }
    }

    /// The thinnest wall and the thinnest gap. From every vertex and every centroid rays go inward and outward along the normal
    /// to the next face that looks back (within 60°) and is no neighbour; its nearest point counts, if that is not far
    /// beside the ray (26°).
    pub(crate) fn thinnest(&self, n_vertices: usize) -> [Option<Thinnest>; 2] {
        let mut sums = vec![Vector::zeros(); n_vertices];
        for ((face, triangle), normal) in self.faces.iter().zip(&self.triangles).zip(&self.normals) {
            for i in 0..3 {
                sums[face[i] as usize] += triangle.angle(i) * normal;
            }
        }
        let mut seen = vec![false; n_vertices];
        let mut best = [None; 2];
        for (f, face) in self.faces.iter().enumerate() {
            let corners = self.triangles[f].corners();
            self.look(f, (corners[0] + corners[1] + corners[2]) / 3.0, self.normals[f], face, &mut best);
            for i in 0..3 {
                let v = face[i] as usize;
                if !std::mem::replace(&mut seen[v], true)
                    && let Some(n) = sums[v].try_normalize(0.0)
                {
                    self.look(f, corners[i], n, &face[i..=i], &mut best);
                }
            }
        }
        best
    }

    /// From a point of face `f`, both ways.
    fn look(&self, f: usize, from: Vector, normal: Vector, own: &[u32], best: &mut [Option<Thinnest>; 2]) {
        for (best, through) in best.iter_mut().zip([1.0, -1.0]) {
            let look = Look { from: from.into(), along: -through * normal, own, through };
            let most = best.map_or(f64::INFINITY, |b: Thinnest| b.thickness);
            let found = self.tree.tree.first_ahead(
                from,
                look.along,
                most,
                |n| look.may_face(&self.below[n]),
                |g| {
                    look.facing(&self.triangles[g as usize], self.normals[g as usize], self.faces[g as usize])
                },
            );
            if let Some((g, thickness)) = found {
                let faces = [self.number[f], self.number[g as usize]];
                *best = Some(Thinnest { thickness, faces, at: from.into() });
            }
        }
    }
}

impl Look<'_> {
    /// Whether one of these faces may be opposite.
    fn may_face(&self, below: &Below) -> bool {
        let along = self.through * self.along;
        let [least, most] = below.normals;
        let facing: f64 = (0..3).map(|a| (along[a] * least[a]).max(along[a] * most[a])).sum();
        // But for round-off.
        facing >= FACING - 1e-12 && !below.hub.is_some_and(|v| self.own.contains(&v))
    }
    /// How far the triangle is, if the ray meets it and it is opposite.
    fn facing(&self, triangle: &Triangle, normal: Vector, vertices: [u32; 3]) -> Option<f64> {
        let opposite = self.through * normal.dot(&self.along) >= FACING
            && !vertices.iter().any(|v| self.own.contains(v));
        let ahead = opposite.then(|| triangle.ahead(self.from.coords, self.along)).flatten()?;
        let (away, _) = triangle.nearest(self.from.coords);
        let distance = away.norm();
        Some(if -away.dot(&self.along) >= BESIDE * distance { distance } else { ahead })
    }
}
