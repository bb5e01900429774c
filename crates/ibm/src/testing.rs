//! Bodies and lattices for the unit tests.
mod faceted;

pub(crate) use faceted::Faceted;

use interfaces::{
    Aabb, Bodies, BodyId, Freedom, Inertia, Kinematics, Lattice, Nodes, Point, Pose, Solid, SurfaceElement,
    Twist, Vector, VelocityField,
};
use std::f64::consts::{PI, TAU};

/// A disc (2D) or sphere (3D).
pub(crate) struct Ball {
    pub(crate) dim: usize,
    pub(crate) radius: f64,
}

impl Solid for Ball {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        x.coords.norm() - self.radius
    }
    fn aabb(&self) -> Aabb {
        let r = self.radius;
        Aabb::around(Point::origin(), Vector::new(r, r, if self.dim == 2 { 0.0 } else { r }))
    }
    fn surface(&self, spacing: f64, offset: f64) -> Option<Vec<SurfaceElement>> {
        let r = self.radius + offset;
        let n = (TAU * r / spacing).round() as usize;
        let at = |i: usize| (i as f64 / n as f64 * TAU).sin_cos();
        let ring = (0..n).map(|i| {
            let normal = Vector::new(at(i).1, at(i).0, 0.0);
            SurfaceElement { point: Point::from(r * normal), normal, area: TAU * r / n as f64 }
        });
        (self.dim == 2).then(|| ring.collect())
    }
}

/// A ball that tells its distances only.
pub(crate) struct Plain(pub(crate) Ball);

impl Solid for Plain {
    fn signed_distance(&self, x: Point, band: f64) -> f64 {
        self.0.signed_distance(x, band)
    }
    fn aabb(&self) -> Aabb {
        self.0.aabb()
    }
}

/// A box of these half-widths; a rectangle where the last is 0.
pub(crate) struct Brick(pub(crate) [f64; 3]);

impl Solid for Brick {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        let flat = self.0[2] == 0.0;
        let q =
            Vector::from_fn(|a, _| if a == 2 && flat { f64::NEG_INFINITY } else { x[a].abs() - self.0[a] });
        q.map(|q| q.max(0.0)).norm() + q.max().min(0.0)
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), self.0.into())
    }
}

/// Bodies of one shape (balls, unless told) that move as they are told.
pub(crate) struct Balls {
    solid: Box<dyn Solid>,
    volume: f64,
    pub(crate) poses: Vec<Pose>,
    pub(crate) twists: Vec<Twist>,
    /// Of all surfaces, besides.
    pub(crate) motion: Option<Box<dyn Fn(Vector) -> Vector + Sync>>,
}

impl Balls {
    pub(crate) fn new(dim: usize, radius: f64, centres: Vec<[f64; 3]>) -> Self {
        let volume = if dim == 2 { PI * radius * radius } else { 4.0 / 3.0 * PI * radius.powi(3) };
        Self::of(Ball { dim, radius }, volume, centres.into_iter().map(Pose::at).collect())
    }
    pub(crate) fn of(solid: impl Solid + 'static, volume: f64, poses: Vec<Pose>) -> Self {
        Self::boxed(Box::new(solid), volume, poses)
    }
    pub(crate) fn boxed(solid: Box<dyn Solid>, volume: f64, poses: Vec<Pose>) -> Self {
        let twists = vec![Twist::default(); poses.len()];
        Self { solid, volume, poses, twists, motion: None }
    }
    pub(crate) fn shift(&mut self, b: usize, by: Vector) {
        self.poses[b].position += by;
    }
}

impl Kinematics for Balls {
    fn n_bodies(&self) -> usize {
        self.poses.len()
    }
    fn pose(&self, b: BodyId) -> Pose {
        self.poses[b.0]
    }
    fn twist(&self, b: BodyId) -> Twist {
        self.twists[b.0]
    }
    fn surface_motion(&self, _: BodyId, arm: Vector) -> Option<Vector> {
        self.motion.as_ref().map(|motion| motion(arm))
    }
}

impl Bodies for Balls {
    fn solid(&self, _: BodyId) -> &dyn Solid {
        &*self.solid
    }
    fn inertia(&self, _: BodyId) -> Inertia {
        let volume = self.volume;
        Inertia { mass: volume, volume, tensor: nalgebra::Matrix3::identity() }
    }
    fn freedom(&self, _: BodyId) -> Freedom {
        Freedom::FREE
    }
}

/// A periodic lattice of cell centres of about this spacing in a box of edge `length`.
pub(crate) fn lattice(dim: usize, spacing: [f64; 3], length: f64) -> Lattice {
    let axis = |a: usize| {
        let n = (length / spacing[a]).round();
        let h = length / n;
        Nodes::uniform(0.5 * h, h, n as usize, true)
    };
    let (x, y, z) = (axis(0), axis(1), axis(2));
    let stride = [1, x.len(), x.len() * y.len()];
    if dim == 2 {
        Lattice::new([x, y], 0, [stride[0], stride[1]])
    } else {
        Lattice::new([x, y, z], 0, stride)
    }
}

/// A collocated velocity field on one lattice.
pub(crate) struct Collocated {
    pub(crate) lattice: Lattice,
    pub(crate) values: Vec<Vec<f64>>,
}

impl Collocated {
    pub(crate) fn new(lattice: Lattice, u: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        let [nx, ny, nz] = lattice.shape();
        let cells = (0..nx * ny * nz).map(|c| [c % nx, c / nx % ny, c / (nx * ny)].map(|i| i as isize));
        let points: Vec<_> = cells.map(|i| u(lattice.position(i))).collect();
        let values = (0..lattice.dim).map(|c| points.iter().map(|u| u[c]).collect()).collect();
        Self { lattice, values }
    }
}

impl VelocityField for Collocated {
    fn dim(&self) -> usize {
        self.values.len()
    }
    fn lattice(&self, _: usize) -> &Lattice {
        &self.lattice
    }
    fn component(&self, c: usize) -> &[f64] {
        &self.values[c]
    }
    fn component_mut(&mut self, c: usize) -> &mut [f64] {
        &mut self.values[c]
    }
}

/// A periodic staggered velocity field: component c on the lower faces along axis c of cells of width `h`.
pub(crate) struct Staggered {
    lattices: Vec<Lattice>,
    pub(crate) values: Vec<Vec<f64>>,
}

impl Staggered {
    pub(crate) fn new<const D: usize>(cells: [usize; D], h: f64, origin: [f64; D]) -> Self {
        let mut stride = [1; D];
        for a in 1..D {
            stride[a] = stride[a - 1] * cells[a - 1];
        }
        let lattice = |c: usize| {
            let axis =
                |a: usize| Nodes::uniform(origin[a] + if a == c { 0.0 } else { 0.5 * h }, h, cells[a], true);
            Lattice::new(std::array::from_fn::<_, D, _>(axis), 0, stride)
        };
        Self { lattices: (0..D).map(lattice).collect(), values: vec![vec![0.0; cells.iter().product()]; D] }
    }
    /// Between bounded sides: component c on the faces inside, between the cells that these `sides` bound along each axis.
    pub(crate) fn between<const D: usize>(sides: [&[f64]; D]) -> Self {
        let lattice = |c: usize| {
            let axes: [Nodes; D] = std::array::from_fn(|a| match a == c {
                true => Nodes::faces(sides[a], false),
                false => Nodes::centres(sides[a], false),
            });
            let mut stride = [1; D];
            for a in 1..D {
                stride[a] = stride[a - 1] * axes[a - 1].len();
            }
            Lattice::new(axes, 0, stride)
        };
        let lattices: Vec<Lattice> = (0..D).map(lattice).collect();
        let values = lattices.iter().map(|l| vec![0.0; l.shape().iter().product()]).collect();
        Self { lattices, values }
    }
    /// The lattice of the cells' centres, if it is periodic.
    pub(crate) fn cells(&self) -> Lattice {
        let mut cells = self.lattices[0].clone();
        cells.axes[0] = self.lattices[1].axes[0].clone();
        cells
    }
    /// Sets every component to `u` at its nodes.
    pub(crate) fn set(&mut self, u: impl Fn([f64; 3]) -> [f64; 3]) {
        for (c, (lattice, values)) in self.lattices.iter().zip(&mut self.values).enumerate() {
            for (index, value) in values.iter_mut().enumerate() {
                *value = u(lattice.position(lattice.node(index)))[c];
            }
        }
    }
}

impl VelocityField for Staggered {
    fn dim(&self) -> usize {
        self.values.len()
    }
    fn lattice(&self, c: usize) -> &Lattice {
        &self.lattices[c]
    }
    fn component(&self, c: usize) -> &[f64] {
        &self.values[c]
    }
    fn component_mut(&mut self, c: usize) -> &mut [f64] {
        &mut self.values[c]
    }
}
