//! A body made of triangles, as λ needs it.
use interfaces::{Aabb, Point, Polyhedron, Solid, Vector};
use std::collections::HashMap;
use std::f64::consts::PI;

/// A closed surface of triangles, counter-clockwise seen from outside, the centre of mass at the origin. Its distances are
/// found by asking every triangle.
#[derive(Clone)]
pub(crate) struct Faceted {
    vertices: Vec<Point>,
    faces: Vec<[u32; 3]>,
}

impl Faceted {
    pub(crate) fn new(vertices: Vec<Point>, faces: Vec<[u32; 3]>) -> Self {
        Self { vertices, faces }
    }
    /// An icosahedron whose faces are quartered `times` times, its vertices on a sphere of `radius`.
    pub(crate) fn sphere(radius: f64, times: u32) -> Self {
        let (golden, r) = (0.5 * (1.0 + 5.0_f64.sqrt()), radius);
        let mut vertices = Vec::new();
        for (a, b) in [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)] {
            vertices.extend([[a, b, 0.0], [0.0, a, b], [b, 0.0, a]].map(|p| Vector::from(p).normalize() * r));
        }
        let mut faces: Vec<[u32; 3]> = Vec::new();
        let near = |i: usize, j: usize| vertices[i].dot(&vertices[j]) > 0.4 * r * r;
        for (i, j, k) in (0..12).flat_map(|i| (0..i).flat_map(move |j| (0..j).map(move |k| (i, j, k)))) {
            if near(i, j) && near(j, k) && near(k, i) {
                let outward = vertices[i].dot(&vertices[j].cross(&vertices[k])) > 0.0;
                faces.push(if outward { [i, j, k] } else { [i, k, j] }.map(|v| v as u32));
            }
        }
        for _ in 0..times {
            let mut middles = HashMap::new();
            let quarters = |[a, b, c]: [u32; 3]| {
                let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(p, q)| {
                    *middles.entry((p.min(q), p.max(q))).or_insert_with(|| {
                        vertices.push((vertices[p as usize] + vertices[q as usize]).normalize() * r);
                        vertices.len() as u32 - 1
                    })
                });
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            };
            faces = faces.into_iter().flat_map(quarters).collect();
        }
        Self::new(vertices.into_iter().map(Point::from).collect(), faces)
    }
    pub(crate) fn volume(&self) -> f64 {
        self.corners(Point::origin()).map(|[a, b, c]| a.dot(&b.cross(&c)) / 6.0).sum()
    }
    /// Of every face, from `x`.
    fn corners(&self, x: Point) -> impl Iterator<Item = [Vector; 3]> {
        self.faces.iter().map(move |f| f.map(|v| self.vertices[v as usize] - x))
    }
}

/// Distance of the origin from a triangle.
fn distance([a, b, c]: [Vector; 3]) -> f64 {
    let normal = (b - a).cross(&(c - a)).normalize();
    let foot = normal * normal.dot(&a);
    let edges = [(a, b), (b, c), (c, a)];
    if edges.iter().all(|(p, q)| normal.dot(&(q - p).cross(&(foot - p))) >= 0.0) {
        return foot.norm();
    }
    let edge = |(p, q): (Vector, Vector)| {
        let t = (p.dot(&(p - q)) / (q - p).norm_squared()).clamp(0.0, 1.0);
        (p + (q - p) * t).norm()
    };
    edges.map(edge).into_iter().fold(f64::INFINITY, f64::min)
}

/// The solid angle at which the origin sees a triangle (Van Oosterom & Strackee 1983).
fn solid_angle([a, b, c]: [Vector; 3]) -> f64 {
    let [p, q, r] = [a, b, c].map(|v| v.norm());
    let below = p * q * r + a.dot(&b) * r + b.dot(&c) * p + c.dot(&a) * q;
    2.0 * a.dot(&b.cross(&c)).atan2(below)
}

impl Solid for Faceted {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        let far = self.corners(x).map(distance).fold(f64::INFINITY, f64::min);
        let around: f64 = self.corners(x).map(solid_angle).sum();
        if around > 2.0 * PI { -far } else { far }
    }
    fn aabb(&self) -> Aabb {
        let mut bounds = Aabb::around(Point::origin(), Vector::zeros());
        for v in &self.vertices {
            bounds = Aabb { min: bounds.min.inf(v), max: bounds.max.sup(v) };
        }
        bounds
    }
    fn polyhedron(&self) -> Option<Polyhedron<'_>> {
        Some(Polyhedron { vertices: &self.vertices, faces: &self.faces })
    }
}
