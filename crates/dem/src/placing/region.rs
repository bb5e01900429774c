//! Where bodies may be.
use super::error::PlacingError;
use crate::{Cylinder, Disc, Shape, Sphere};
use interfaces::{Aabb, Point, Pose, Solid, Vector};

/// Where bodies may be placed; they are wholly inside.
///
/// ```
/// use dem::placing::Region;
/// use dem::{Aabb, Pose};
///
/// // A channel that repeats along x, with walls along y and z.
/// let bounds = Aabb { min: [0.0; 3].into(), max: [0.4, 0.1, 0.1].into() };
/// let channel = Region::cuboid(bounds, [true, false, false])?;
/// assert!((channel.volume() - 4e-3).abs() < 1e-15);
/// // A drum along z.
/// let drum = Region::cylinder(0.1, 0.2, Pose::at([0.0; 3]))?;
/// assert!((drum.volume() - 6.283e-3).abs() < 1e-6);
/// # Ok::<(), dem::placing::PlacingError>(())
/// ```
#[derive(Clone)]
pub struct Region<'a> {
    bounds: Aabb,
    periodic: [bool; 3],
    container: Option<(Container<'a>, Pose)>,
}

#[derive(Clone)]
enum Container<'a> {
    Sphere(Sphere),
    Cylinder(Cylinder),
    Disc(Disc),
    Solid(&'a dyn Solid),
}

impl Container<'_> {
    fn solid(&self) -> &dyn Solid {
        match self {
            Self::Sphere(sphere) => sphere,
            Self::Cylinder(cylinder) => cylinder,
            Self::Disc(disc) => disc,
            Self::Solid(solid) => *solid,
        }
    }
}

/// Samples along the longest edge when the volume of a solid is measured.
const SAMPLES: f64 = 64.0;

impl<'a> Region<'a> {
    /// A box with walls, or without along axes that are `periodic`. One without extent along z, at z = 0, is a plane scene.
    ///
    /// # Errors
    /// [`PlacingError::Region`] unless its corners are finite and the upper one is above the lower one.
    pub fn cuboid(bounds: Aabb, periodic: [bool; 3]) -> Result<Self, PlacingError> {
        let (min, max) = (bounds.min, bounds.max);
        let extent = bounds.extent();
        let plane = min.z == 0.0 && max.z == 0.0;
        // Corners so far apart that their difference is infinite are no box either.
        let sound = extent.x > 0.0 && extent.y > 0.0 && (extent.z > 0.0 || plane);
        if !(sound && extent.iter().chain(min.iter()).all(|c| c.is_finite())) {
            return Err(PlacingError::Region { min: min.into(), max: max.into() });
        }
        Ok(Self { bounds, periodic, container: None })
    }
    /// Within a sphere.
    ///
    /// # Errors
    /// [`PlacingError::Shape`] unless the radius is positive and finite, [`PlacingError::Region`] if its place is not finite.
    pub fn sphere(radius: f64, centre: Point) -> Result<Self, PlacingError> {
        Self::within(Container::Sphere(Sphere::new(radius)?), Pose::at(centre.into()))
    }
    /// Within a cylinder, its axis along z in its own frame.
    ///
    /// # Errors
    /// [`PlacingError::Shape`] unless radius and length are positive and finite, [`PlacingError::Region`] if its pose is not finite.
    pub fn cylinder(radius: f64, length: f64, at: Pose) -> Result<Self, PlacingError> {
        Self::within(Container::Cylinder(Cylinder::new(radius, length)?), at)
    }
    /// Within a circle of the plane z = 0.
    ///
    /// # Errors
    /// [`PlacingError::Shape`] unless the radius is positive and finite, [`PlacingError::Region`] if its place is not finite or not at z = 0.
    pub fn disc(radius: f64, centre: Point) -> Result<Self, PlacingError> {
        Self::within(Container::Disc(Disc::new(radius)?), Pose::at(centre.into()))
    }
    /// Within any solid, by its signed distance.
    ///
    /// # Errors
    /// [`PlacingError::Region`] if its pose or its box is not finite, or a plane one is not at z = 0.
    pub fn solid(solid: &'a dyn Solid, at: Pose) -> Result<Self, PlacingError> {
        Self::within(Container::Solid(solid), at)
    }
    fn within(container: Container<'a>, at: Pose) -> Result<Self, PlacingError> {
        let bounds = container.solid().aabb().posed(&at);
        let region = Self::cuboid(bounds, [false; 3])?;
        Ok(Self { container: Some((container, at)), ..region })
    }

    /// The box around it.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }
    /// Which axes repeat.
    pub fn periodic(&self) -> [bool; 3] {
        self.periodic
    }
    /// Whether it is in the plane z = 0.
    pub fn is_plane(&self) -> bool {
        self.bounds.extent().z == 0.0
    }
    /// Its volume \[m³\], the area \[m²\] of a plane one. Of a solid without triangles it is measured on a grid of 64 samples along its
    /// longest edge, to about 1e-3.
    pub fn volume(&self) -> f64 {
        match &self.container {
            None => {
                let e = self.bounds.extent();
                e.x * e.y * if self.is_plane() { 1.0 } else { e.z }
            }
            Some((Container::Sphere(shape), _)) => shape.inertia(1.0).volume,
            Some((Container::Cylinder(shape), _)) => shape.inertia(1.0).volume,
            Some((Container::Disc(shape), _)) => shape.inertia(1.0).volume,
            Some((Container::Solid(solid), _)) => match solid.polyhedron() {
                Some(surface) => {
                    let corner = |i: u32| surface.vertices[i as usize].coords;
                    let six = |f: &[u32; 3]| corner(f[0]).dot(&corner(f[1]).cross(&corner(f[2])));
                    surface.faces.iter().map(six).sum::<f64>() / 6.0
                }
                None => sampled_volume(*solid),
            },
        }
    }

    /// Signed distance to the walls, negative inside; exact inside where it is below `band`.
    pub(super) fn signed_distance(&self, x: Point, band: f64) -> f64 {
        match &self.container {
            Some((container, at)) => container.solid().signed_distance(at.to_body(x), band),
            None => {
                let axes = if self.is_plane() { 2 } else { 3 };
                let beyond = |a: usize| (self.bounds.min[a] - x[a]).max(x[a] - self.bounds.max[a]);
                (0..axes).filter(|&a| !self.periodic[a]).map(beyond).fold(f64::NEG_INFINITY, f64::max)
            }
        }
    }
    /// Whether it is the box itself.
    pub(super) fn is_box(&self) -> bool {
        self.container.is_none()
    }
    /// The box around it, less `margin` at all walls.
    pub(super) fn shrunk(&self, margin: f64) -> Aabb {
        let mut out = self.bounds;
        for a in (0..if self.is_plane() { 2 } else { 3 }).filter(|&a| !self.periodic[a]) {
            out.min[a] += margin;
            out.max[a] -= margin;
        }
        out
    }
    /// Periods; zero where there is none.
    pub(super) fn periods(&self) -> Vector {
        let extent = self.bounds.extent();
        Vector::from_fn(|a, _| if self.periodic[a] { extent[a] } else { 0.0 })
    }
}

/// Midpoints of small cubes; those near the surface count by how deep they are.
fn sampled_volume(solid: &dyn Solid) -> f64 {
    let bounds = solid.aabb();
    let extent = bounds.extent();
    let n = extent.map(|e| (e / extent.max() * SAMPLES).ceil().max(1.0));
    let h = extent.component_div(&n);
    let (edge, plane) = (h.max(), extent.z == 0.0);
    let mut sum = 0.0;
    for k in 0..n.z as usize {
        for j in 0..n.y as usize {
            for i in 0..n.x as usize {
                let middle = Vector::new(i as f64 + 0.5, j as f64 + 0.5, k as f64 + 0.5);
                let d = solid.signed_distance(bounds.min + middle.component_mul(&h), edge);
                sum += (0.5 - d / edge).clamp(0.0, 1.0);
            }
        }
    }
    sum * h.x * h.y * if plane { 1.0 } else { h.z }
}
