//! The nearest surface along every ray.
use super::{Camera, Form, Shape};
use interfaces::{Point, Polyhedron, Pose, Solid, Vector};
use nalgebra::Matrix3;

/// Depth (towards the eye), normal and owner of what each ray meets first.
pub(super) struct Buffer {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) depth: Vec<f32>,
    pub(super) normal: Vec<[f32; 3]>,
    pub(super) owner: Vec<u32>,
}

/// Steps along a ray towards a surface that is known by its distance.
const STEPS: usize = 80;

impl Buffer {
    pub(super) fn new(width: usize, height: usize) -> Self {
        let n = width * height;
        let depth = vec![f32::NEG_INFINITY; n];
        Self { width, height, depth, normal: vec![[0.0; 3]; n], owner: vec![u32::MAX; n] }
    }
    #[cfg(test)]
    pub(super) fn depth_at(&self, x: usize, y: usize) -> f32 {
        self.depth[y * self.width + x]
    }

    #[inline]
    fn put(&mut self, x: usize, y: usize, depth: f64, normal: Vector, owner: u32) {
        let at = y * self.width + x;
        if depth as f32 > self.depth[at] {
            self.depth[at] = depth as f32;
            self.normal[at] = [normal.x as f32, normal.y as f32, normal.z as f32];
            self.owner[at] = owner;
        }
    }

    /// The pixels whose centres lie between two numbers.
    fn pixels(from: f64, to: f64, most: usize) -> std::ops::Range<usize> {
        let low = (from - 0.5).ceil().clamp(0.0, most as f64) as usize;
        let high = (to - 0.5).floor().clamp(-1.0, most as f64 - 1.0) + 1.0;
        low..high as usize
    }

    /// Draws a body. Normals are those of the camera: x right, y up, z towards the eye.
    pub(super) fn add(&mut self, camera: &Camera, shape: &Shape<'_>, pose: &Pose, owner: u32) {
        match &shape.form {
            Form::Union(parts) => {
                for (part, place) in parts {
                    self.add(camera, part, &pose.of(place), owner);
                }
            }
            Form::Ellipsoid(semi_axes) => self.ellipsoid(camera, *semi_axes, pose, owner),
            Form::Solid(solid) => match solid.polyhedron() {
                Some(surface) => self.triangles(camera, &surface, pose, owner),
                None => self.trace(camera, *solid, shape.bounding_radius, pose, owner),
            },
        }
    }

    /// dᵀMd = 1 with M = R diag(1/e²) Rᵀ: a quadratic equation along each ray.
    fn ellipsoid(&mut self, camera: &Camera, semi_axes: Vector, pose: &Pose, owner: u32) {
        let centre = camera.at(pose.position);
        let turn = camera.turn * pose.orientation.to_rotation_matrix().matrix();
        let of = |f: fn(f64) -> f64| {
            turn * Matrix3::from_diagonal(&semi_axes.map(|e| f(e * camera.scale))) * turn.transpose()
        };
        let (m, spread) = (of(|e| 1.0 / (e * e)), of(|e| e * e));
        let (reach_x, reach_y) = (spread[(0, 0)].sqrt(), spread[(1, 1)].sqrt());
        for y in Self::pixels(centre.y - reach_y, centre.y + reach_y, self.height) {
            let dy = centre.y - (y as f64 + 0.5);
            for x in Self::pixels(centre.x - reach_x, centre.x + reach_x, self.width) {
                let dx = x as f64 + 0.5 - centre.x;
                let b = m[(0, 2)] * dx + m[(1, 2)] * dy;
                let c = m[(0, 0)] * dx * dx + 2.0 * m[(0, 1)] * dx * dy + m[(1, 1)] * dy * dy - 1.0;
                let root = b * b - m[(2, 2)] * c;
                if root > 0.0 {
                    let z = (root.sqrt() - b) / m[(2, 2)];
                    self.put(x, y, centre.z + z, (m * Vector::new(dx, dy, z)).normalize(), owner);
                }
            }
        }
    }

    /// Flat triangles; those that face away are left out.
    fn triangles(&mut self, camera: &Camera, surface: &Polyhedron<'_>, pose: &Pose, owner: u32) {
        for face in surface.faces {
            let [a, b, c] = face.map(|v| camera.at(pose.to_world(surface.vertices[v as usize])));
            let (u, v) = (b - a, c - a);
            // y is downwards: the third component has the other sign.
            let area = v.x * u.y - u.x * v.y;
            if area <= 0.0 {
                continue;
            }
            let (p, q) = (Vector::new(u.x, -u.y, u.z), Vector::new(v.x, -v.y, v.z));
            let normal = p.cross(&q).normalize();
            let (low, high) = (a.inf(&b).inf(&c), a.sup(&b).sup(&c));
            for y in Self::pixels(low.y, high.y, self.height) {
                for x in Self::pixels(low.x, high.x, self.width) {
                    let (dx, dy) = (x as f64 + 0.5 - a.x, y as f64 + 0.5 - a.y);
                    let s = (v.x * dy - dx * v.y) / area;
                    let t = (dx * u.y - u.x * dy) / area;
                    if s >= -1e-9 && t >= -1e-9 && s + t <= 1.0 + 1e-9 {
                        self.put(x, y, a.z + s * u.z + t * v.z, normal, owner);
                    }
                }
            }
        }
    }

    /// Anything else, by its signed distance: a ray goes as far as nothing can be in its way.
    fn trace(&mut self, camera: &Camera, shape: &dyn Solid, radius: f64, pose: &Pose, owner: u32) {
        let centre = camera.at(pose.position);
        let reach = radius * camera.scale;
        // Where rays come from and go, in the body's frame.
        let to_body = |v: Vector| pose.orientation.inverse_transform_vector(&(camera.turn.transpose() * v));
        let (right, up, back) = (to_body(Vector::x()), to_body(Vector::y()), to_body(Vector::z()));
        let near = 0.2 / camera.scale;
        for y in Self::pixels(centre.y - reach, centre.y + reach, self.height) {
            let dy = (centre.y - (y as f64 + 0.5)) / camera.scale;
            for x in Self::pixels(centre.x - reach, centre.x + reach, self.width) {
                let dx = (x as f64 + 0.5 - centre.x) / camera.scale;
                let inside = radius * radius - dx * dx - dy * dy;
                if inside <= 0.0 {
                    continue;
                }
                let last = -inside.sqrt();
                let mut z = -last;
                for _ in 0..STEPS {
                    let at = Point::from(right * dx + up * dy + back * z);
                    let d = shape.signed_distance(at, 4.0 * radius);
                    if d < near {
                        let n = shape.normal(at, 1e-2 * radius);
                        let normal = Vector::new(n.dot(&right), n.dot(&up), n.dot(&back));
                        self.put(x, y, centre.z + z * camera.scale, normal, owner);
                        break;
                    }
                    z -= d;
                    if z < last {
                        break;
                    }
                }
            }
        }
    }
}
