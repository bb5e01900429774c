//! A rock.
use crate::Outcome;
use dem::TriangleMesh;
use interfaces::{Aabb, Point, Solid, Vector};
use std::fmt::Write;

/// A ball whose radius changes with the direction: 1 + Σ a sin(k·n + φ) over some waves.
pub struct Rock {
    waves: Vec<(Vector, f64, f64)>,
}

impl Rock {
    /// The one that grows from this seed.
    pub fn new(seed: u64) -> Self {
        let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
        let mut draw = move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let wave = |_| {
            let wave = Vector::new(draw() - 0.5, draw() - 0.5, draw() - 0.5).normalize();
            let k = 2.0 + 4.0 * draw();
            (k * wave, 0.2 / k, 6.3 * draw())
        };
        Self { waves: (0..7).map(wave).collect() }
    }
    fn radius(&self, direction: Vector) -> f64 {
        1.0 + self.waves.iter().map(|(k, a, phase)| a * (k.dot(&direction) + phase).sin()).sum::<f64>()
    }
    /// Most by which the radius differs from 1, and how fast it changes with the direction.
    fn limits(&self) -> (f64, f64) {
        let rough: f64 = self.waves.iter().map(|w| w.1).sum();
        (rough, self.waves.iter().map(|w| w.1 * w.0.norm()).sum())
    }

    /// Its surface as the faces of an icosahedron halved `times` times.
    ///
    /// # Errors
    /// Those of the mesh.
    pub fn mesh(&self, times: u32) -> Outcome<TriangleMesh> {
        let ball = TriangleMesh::sphere(1.0, times)?;
        let outward = |p: &Point| (self.radius(p.coords.normalize()) * p.coords.normalize()).into();
        let vertices: Vec<[f64; 3]> = ball.vertices().iter().map(outward).collect();
        Ok(TriangleMesh::new(&vertices, ball.faces())?)
    }
}

/// A mesh as the text of an STL file, its lengths times `scale`.
pub fn stl(mesh: &TriangleMesh, scale: f64) -> String {
    let mut text = String::from("solid rock\n");
    for face in mesh.faces() {
        text += "facet normal 0 0 0\nouter loop\n";
        for &corner in face {
            let p = scale * mesh.vertices()[corner as usize].coords;
            let _ = writeln!(text, "vertex {:e} {:e} {:e}", p.x, p.y, p.z);
        }
        text += "endloop\nendfacet\n";
    }
    text + "endsolid rock\n"
}

impl Solid for Rock {
    /// A bound of it: what the radius is short of, less steep than the distance.
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        let (rough, slope) = self.limits();
        let direction = x.coords.try_normalize(1e-9).unwrap_or(Vector::x());
        (x.coords.norm() - self.radius(direction)) / (1.0 + slope / (1.0 - rough))
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), Vector::repeat(1.0 + self.limits().0))
    }
}
