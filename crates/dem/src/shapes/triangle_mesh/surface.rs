//! The nearest point of a mesh.
use super::cluster::{self, Cluster, Found};
use crate::shapes::triangle::{Part, Triangle};
use interfaces::{Point, Vector};
use parry3d::bounding_volume::Aabb;
use parry3d::partitioning::{Bvh, BvhBuildStrategy, BvhNode};
use std::collections::HashMap;

/// Triangles in clusters in a tree of boxes, with the pseudo-normals of their faces, edges and corners.
#[derive(Clone, Debug)]
pub(crate) struct Surface {
    triangles: Vec<Triangle>,
    normals: Vec<Normals>,
    clusters: Vec<Cluster>,
    tree: Bvh,
}

/// Unit normals of a face; sums of them weighted by angle at its edges and corners.
#[derive(Clone, Copy, Debug)]
struct Normals {
    face: Vector,
    edges: [Vector; 3],
    corners: [Vector; 3],
}

/// The nearest point of the surface.
pub(crate) struct Nearest {
    pub(crate) face: u32,
    pub(crate) point: Point,
    pub(crate) distance: f64,
    pub(crate) outside: bool,
    /// Pseudo-normal there, of unit length.
    pub(crate) normal: Vector,
}

impl Surface {
    pub(crate) fn new(points: Vec<Vector>, mut faces: Vec<[u32; 3]>) -> Self {
        let centre = |f: &[u32; 3]| f.map(|v| points[v as usize]).iter().sum::<Vector>() / 3.0;
        let ranges = cluster::sort(&mut faces, &centre);
        let triangle = |f: &[u32; 3]| {
            let [a, b, c] = f.map(|v| points[v as usize]);
            Triangle::new(a, b, c)
        };
        let triangles: Vec<Triangle> = faces.iter().map(triangle).collect();
        let clusters: Vec<Cluster> = ranges.into_iter().map(|r| Cluster::new(&triangles, r)).collect();
        let mut corners = vec![Vector::zeros(); points.len()];
        let mut edges: HashMap<(u32, u32), Vector> = HashMap::with_capacity(2 * faces.len());
        let units: Vec<Vector> = triangles.iter().map(|t| t.cross().normalize()).collect();
        let edge = |f: &[u32; 3], i: usize| {
            let (from, to) = (f[i], f[(i + 1) % 3]);
            (from.min(to), from.max(to))
        };
        for ((f, t), n) in faces.iter().zip(&triangles).zip(&units) {
            for i in 0..3 {
                corners[f[i] as usize] += t.angle(i) * n;
                *edges.entry(edge(f, i)).or_default() += n;
            }
        }
        let of = |(f, face): (&[u32; 3], &Vector)| Normals {
            face: *face,
            edges: [0, 1, 2].map(|i| edges[&edge(f, i)]),
            corners: f.map(|v| corners[v as usize]),
        };
        let normals = faces.iter().zip(&units).map(of).collect();
        Self { tree: tree(&triangles, &clusters), triangles, normals, clusters }
    }

    /// The point of the surface nearest to `x`, if it is nearer than `within`; a `seed` is a face that
    /// may be near.
    pub(crate) fn nearest(&self, x: Point, within: f64, seed: Option<u32>) -> Option<Nearest> {
        let (mut most, mut best) = (within * within, None);
        if let Some(face) = seed {
            let (away, part) = self.triangles[face as usize].nearest(x.coords);
            if away.norm_squared() < most {
                (most, best) = (away.norm_squared(), Some(Found { face, away, part }));
            }
        }
        // Nearer boxes first, none that is farther than the best so far.
        let found = self.tree.find_best(
            most,
            |node: &BvhNode, _| square_distance(node, x),
            |c, most| self.clusters[c as usize].nearest(&self.triangles, x, most),
        );
        best = found.map(|(_, (_, found))| found).or(best);
        best.map(|found| self.describe(x, found))
    }

    fn describe(&self, x: Point, Found { face, away, part }: Found) -> Nearest {
        let normals = &self.normals[face as usize];
        let normal = match part {
            Part::Inside => normals.face,
            Part::Edge(i) => normals.edges[i],
            Part::Corner(i) => normals.corners[i],
        };
        Nearest {
            face,
            point: x - away,
            distance: away.norm(),
            outside: away.dot(&normal) >= 0.0,
            normal: normal.try_normalize(0.0).unwrap_or(normals.face),
        }
    }
}

fn tree(triangles: &[Triangle], clusters: &[Cluster]) -> Bvh {
    let around = |c: &Cluster| {
        let own = &triangles[c.faces.start as usize..c.faces.end as usize];
        let corners = || own.iter().flat_map(Triangle::corners);
        let low = corners().fold(Vector::repeat(f64::INFINITY), |low, c| low.inf(&c));
        let high = corners().fold(Vector::repeat(f64::NEG_INFINITY), |high, c| high.sup(&c));
        Aabb::new(<[f64; 3]>::from(low).into(), <[f64; 3]>::from(high).into())
    };
    let boxes: Vec<Aabb> = clusters.iter().map(around).collect();
    Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes)
}

/// Square of the distance of `x` from a box.
#[inline]
fn square_distance(node: &BvhNode, x: Point) -> f64 {
    let (low, high) = (node.mins(), node.maxs());
    let gap = |x: f64, low: f64, high: f64| (low - x).max(x - high).max(0.0);
    gap(x.x, low.x, high.x).powi(2) + gap(x.y, low.y, high.y).powi(2) + gap(x.z, low.z, high.z).powi(2)
}
