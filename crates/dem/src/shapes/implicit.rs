//! Shapes from a signed distance.
use crate::overlap::tree::grow::{Exhausted, Goal, NONE, Tree};
use crate::overlap::tree::seen::Seen;
use crate::{DemError, Shape};
use interfaces::{Aabb, Inertia, Point, Pose, Solid, SurfaceElement, Vector};
use nalgebra::Matrix3;
use std::sync::Mutex;

/// A shape of any type that is a [`Solid`]: mass properties from its signed distance, by the tree of boxes that overlaps are
/// computed with. It is moved so that its centre of mass is at the origin.
///
/// ```
/// use dem::{Implicit, Shape};
/// use dem::{Aabb, Point, Solid, Vector};
///
/// struct Torus;
/// impl Solid for Torus {
///     fn signed_distance(&self, x: Point, _band: f64) -> f64 {
///         (x.x.hypot(x.y) - 0.7).hypot(x.z) - 0.3
///     }
///     fn aabb(&self) -> Aabb {
///         Aabb::around(Point::origin(), Vector::new(1.0, 1.0, 0.3))
///     }
/// }
/// let torus = Implicit::new("torus", Torus, 1e-4)?;
/// let exact = 2.0 * std::f64::consts::PI.powi(2) * 0.7 * 0.3_f64.powi(2);
/// assert!((torus.inertia(1.0).volume / exact - 1.0).abs() < 1e-4);
/// # Ok::<(), dem::DemError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Implicit<S> {
    name: &'static str,
    solid: S,
    centre: Vector,
    bounds: Aabb,
    radius: f64,
    volume: f64,
    /// Per density.
    tensor: Matrix3<f64>,
}

impl<S: Solid> Implicit<S> {
    /// The body that `solid` tells the distances of, called `name` in messages; its volume is known but for a share of about
    /// `tolerance`, 1e-8 to 1, and so are its moments.
    ///
    /// # Errors
    /// [`DemError::Refinement`] for another tolerance, [`DemError::Bounds`] if the solid's box is flat or not finite,
    /// [`DemError::Distance`] if a distance is not finite, [`DemError::Empty`] if nothing is found inside,
    /// [`DemError::Boxes`] if the tolerance takes too many boxes.
    pub fn new(name: &'static str, solid: S, tolerance: f64) -> Result<Self, DemError> {
        crate::Refinement::Tolerance(tolerance).check()?;
        let bounds = solid.aabb();
        let extent = bounds.extent();
        if !extent.iter().all(|e| *e > 0.0 && e.is_finite()) {
            return Err(DemError::Bounds { name, extent: extent.into() });
        }
        let watched = Watched { solid: &solid, odd: Mutex::new(None) };
        let middle = nalgebra::center(&bounds.min, &bounds.max);
        let bodies = [Seen::new(&watched, &Pose::at([0.0; 3]), middle.coords)];
        let goal = Goal { tolerance, moments: true };
        let mut tree = Tree::default();
        let mut spent = None;
        if tree.plant(&bodies, 0.5 * extent, goal) {
            spent = tree.refine(&bodies, goal, tolerance).err();
        }
        if let Some((point, value)) = watched.odd.into_inner().unwrap_or_default() {
            return Err(DemError::Distance { name, point, value });
        }
        if let Some(Exhausted { boxes, error }) = spent {
            return Err(DemError::Boxes { what: format!("the {name}"), boxes, error });
        }
        let (mut volume, mut first, mut second) = (0.0, Vector::zeros(), [0.0; 6]);
        let leaves = || tree.nodes.iter().filter(|n| n.leaf != NONE);
        for node in leaves() {
            let content = &tree.leaves[node.leaf as usize].content;
            volume += content.sums.volume;
            first += content.sums.first;
            for (sum, part) in second.iter_mut().zip(content.second) {
                *sum += part;
            }
        }
        if volume <= 0.0 {
            return Err(DemError::Empty { name, extent: extent.into() });
        }
        let away = first / volume;
        let about = |a: usize, b: usize, sum: f64| sum - volume * away[a] * away[b];
        let [xx, yy, zz] = [0, 1, 2].map(|a| about(a, a, second[a]));
        let [yz, xz, xy] = [(1, 2, 3), (0, 2, 4), (0, 1, 5)].map(|(a, b, i)| about(a, b, second[i]));
        let tensor = Matrix3::new(yy + zz, -xy, -xz, -xy, xx + zz, -yz, -xz, -yz, xx + yy);
        let corner =
            |n: &crate::overlap::tree::grow::Node| ((n.centre - away).abs() + tree.half_at(n.level)).norm();
        let full = leaves().filter(|n| tree.leaves[n.leaf as usize].content.sums.volume > 0.0);
        let radius = full.map(corner).fold(0.0, f64::max);
        let centre = middle.coords + away;
        let bounds = Aabb { min: bounds.min - centre, max: bounds.max - centre };
        Ok(Self { name, solid, centre, bounds, radius, volume, tensor })
    }

    /// Where the centre of mass is in the solid's own coordinates \[m\].
    pub fn centre(&self) -> Point {
        Point::from(self.centre)
    }
    /// What the distances come from.
    pub fn solid(&self) -> &S {
        &self.solid
    }
}

/// Notes the first distance that is not finite, and where.
struct Watched<'a, S> {
    solid: &'a S,
    odd: Mutex<Option<([f64; 3], f64)>>,
}

impl<S: Solid> Solid for Watched<'_, S> {
    fn signed_distance(&self, x: Point, band: f64) -> f64 {
        let value = self.solid.signed_distance(x, band);
        if !value.is_finite() {
            if let Ok(mut odd) = self.odd.lock() {
                odd.get_or_insert((x.into(), value));
            }
            // Ends the search.
            return f64::MAX;
        }
        value
    }
    fn aabb(&self) -> Aabb {
        self.solid.aabb()
    }
}

impl<S: Solid> Shape for Implicit<S> {
    fn name(&self) -> &'static str {
        self.name
    }
    fn inertia(&self, density: f64) -> Inertia {
        Inertia { mass: density * self.volume, volume: self.volume, tensor: density * self.tensor }
    }
    fn bounding_radius(&self) -> f64 {
        self.radius
    }
}

impl<S: Solid> Solid for Implicit<S> {
    fn signed_distance(&self, x: Point, band: f64) -> f64 {
        self.solid.signed_distance(x + self.centre, band)
    }
    fn signed_distances(&self, points: &[Point], band: f64, out: &mut [f64]) {
        const BLOCK: usize = 16;
        for (points, out) in points.chunks(BLOCK).zip(out.chunks_mut(BLOCK)) {
            let mut moved = [Point::origin(); BLOCK];
            for (to, from) in moved.iter_mut().zip(points) {
                *to = from + self.centre;
            }
            self.solid.signed_distances(&moved[..points.len()], band, out);
        }
    }
    fn aabb(&self) -> Aabb {
        self.bounds
    }
    fn normal(&self, x: Point, band: f64) -> Vector {
        self.solid.normal(x + self.centre, band)
    }
    fn curvature(&self, x: Point, band: f64) -> f64 {
        self.solid.curvature(x + self.centre, band)
    }
    fn surface(&self, spacing: f64, offset: f64) -> Option<Vec<SurfaceElement>> {
        let mut elements = self.solid.surface(spacing, offset)?;
        elements.iter_mut().for_each(|e| e.point -= self.centre);
        Some(elements)
    }
}

#[cfg(test)]
mod tests;
