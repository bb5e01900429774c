//! What the fluid does to a body's surface, from the fields beside it.
use crate::neighbour::{Neighbour, inside};
use crate::polynomial::{Fit, Sample, fit};
use crate::solid_fraction::check;
use crate::{IbmError, surface_elements};
use interfaces::{Bodies, BodyId, Lattice, Point, SurfaceElement, Vector, VelocityField, Wrench};
use nalgebra::Matrix3;
use rayon::prelude::*;

/// Pressure and viscous stress on the surfaces of bodies:
///
/// ```text
/// t = −p n + μ (∇u + ∇uᵀ)·n,   F = ∮ t dA,   T = ∮ r × t dA
/// ```
///
/// a second way to the loads, independent of the forcing, and the only one to their distribution. At every surface element
/// polynomials of third degree are fitted (least squares) to the values at the nodes in the fluid around it; those of the
/// velocity have the surface's velocity at the element.
#[derive(Clone, Copy)]
pub struct SurfaceStress<'a> {
    velocity: &'a dyn VelocityField,
    lattice: &'a Lattice,
    pressure: &'a [f64],
    viscosity: f64,
    clearance: f64,
}

/// What the fluid does to one element of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Its place from the body's centre of mass, in the world \[m\].
    pub arm: Vector,
    /// Outward unit normal.
    pub normal: Vector,
    /// Area \[m²\]; in the plane length \[m\].
    pub area: f64,
    /// Pressure \[Pa\].
    pub pressure: f64,
    /// Viscous stress μ (∇u + ∇uᵀ)·n \[Pa\].
    pub friction: Vector,
    /// Degrees of the polynomials of pressure and velocity: 3 where there is room for them.
    pub degrees: [usize; 2],
}

/// The surface of one body.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceLoads {
    /// Its elements that touch the fluid.
    pub points: Vec<SurfacePoint>,
}

impl SurfaceLoads {
    /// What the pressure does to the body \[N, N m\].
    pub fn pressure(&self) -> Wrench {
        self.sum(|p| -p.pressure * p.normal)
    }
    /// What friction does to the body \[N, N m\].
    pub fn friction(&self) -> Wrench {
        self.sum(|p| p.friction)
    }
    /// Both \[N, N m\].
    pub fn total(&self) -> Wrench {
        self.pressure() + self.friction()
    }
    /// How many elements had too few nodes beside them for the full degree.
    pub fn lowered(&self) -> usize {
        self.points.iter().filter(|p| p.degrees.iter().any(|&degree| degree < DEGREE)).count()
    }

    fn sum(&self, traction: impl Fn(&SurfacePoint) -> Vector) -> Wrench {
        let mut sum = Wrench::default();
        self.points.iter().for_each(|p| sum += Wrench::at(p.area * traction(p), p.arm));
        sum
    }
}

const DEGREE: usize = 3;
/// Nodes count up to so many cells beyond the clearance, in the plane and in space: there are about 20 and 40 of them then.
pub(crate) const REACH: [f64; 2] = [3.2, 2.7];
/// Cells whose centre is nearer to the surface than this may be cut, and have a pressure that is only of first order …
pub(crate) const PRESSED: f64 = 1.0;
/// … and velocities nearer than this tell more of the surface than of the fluid. (Spheres 12 to 24 cells wide in cut cells: 0.5 and 0
/// make the loads up to 3 % smaller.)
pub(crate) const BESIDE: f64 = 0.3;

/// Does `field` hold a value for every node?
pub(crate) fn stored(lattice: &Lattice, field: &[f64]) -> Result<(), IbmError> {
    let needed = lattice.index(lattice.shape().map(|n| n as isize - 1)).map_or(0, |last| last + 1);
    if needed == 0 || needed > field.len() {
        return Err(IbmError::Storage { needed, found: field.len() });
    }
    Ok(())
}

impl<'a> SurfaceStress<'a> {
    /// Of this velocity and of the `pressure` \[Pa\] stored at the nodes of `lattice`, in a fluid of dynamic `viscosity` \[Pa s\].
    pub fn new(
        velocity: &'a dyn VelocityField,
        lattice: &'a Lattice,
        pressure: &'a [f64],
        viscosity: f64,
    ) -> Self {
        Self { velocity, lattice, pressure, viscosity, clearance: 0.0 }
    }
    /// Leaves out nodes nearer to the surface than so many cells: the half width of the kernel, 2 to 3, for a forcing that smears
    /// the surface. Unless told, one cell for the pressure, which is bad in cut cells, and 0.3 for the velocity.
    #[must_use]
    pub fn with_clearance(mut self, cells: f64) -> Self {
        self.clearance = cells.max(0.0);
        self
    }

    /// The loads on body `b`, at elements about `spacing` \[m\] apart: a cell is a good choice. What other bodies or the sides of
    /// the box cover of the surface is left out.
    ///
    /// # Errors
    /// [`IbmError::NoSurface`] for a body without surface (or a spacing that is not positive), [`IbmError::Storage`] for a pressure that
    /// is not the lattice's; [`IbmError::Lost`] and [`IbmError::TooLarge`].
    pub fn on(&self, bodies: &dyn Bodies, b: BodyId, spacing: f64) -> Result<SurfaceLoads, IbmError> {
        check(self.lattice, bodies, b)?;
        stored(self.lattice, self.pressure)?;
        let elements = surface_elements(bodies.solid(b), spacing, 0.0);
        if elements.is_empty() {
            return Err(IbmError::NoSurface { body: b, offset: 0.0 });
        }
        let (pose, dim) = (bodies.pose(b), self.velocity.dim());
        let arms: Vec<Vector> = elements.iter().map(|e| pose.orientation * e.point.coords).collect();
        let cells = self.clearance.max(PRESSED) + REACH[dim - 2];
        let mut others = Vec::new();
        let all = (0..bodies.n_bodies()).map(BodyId);
        Neighbour::list(self.lattice, bodies, b, cells, all, &mut others);
        let clear = [self.clearance.max(PRESSED), self.clearance.max(BESIDE)];
        let pressure = Nearby::new(self.lattice, self.pressure, bodies, b, &others, clear[0], &[]);
        let components: Vec<Nearby> = (0..dim)
            .map(|c| {
                let (lattice, values) = (self.velocity.lattice(c), self.velocity.component(c));
                let wall: Vec<_> =
                    arms.iter().map(|arm| (*arm, bodies.surface_velocity(b, *arm)[c])).collect();
                Nearby::new(lattice, values, bodies, b, &others, clear[1], &wall)
            })
            .collect();
        let stressed = |(element, &arm): (&SurfaceElement, &Vector)| {
            let normal = pose.orientation * element.normal;
            if others.iter().any(|o| o.distance(bodies, pose.position + arm, spacing) < 0.0)
                || !inside(self.lattice, pose.position + arm)
            {
                return None;
            }
            let p = pressure.fit(arm, None)?;
            let wall = bodies.surface_velocity(b, arm);
            let (mut gradient, mut degree) = (Matrix3::zeros(), DEGREE);
            for (c, nearby) in components.iter().enumerate() {
                let u = nearby.fit(arm, Some(wall[c]))?;
                gradient.set_row(c, &u.gradient.transpose());
                degree = degree.min(u.degree);
            }
            let friction = self.viscosity * (gradient + gradient.transpose()) * normal;
            let degrees = [p.degree, degree];
            Some(SurfacePoint { arm, normal, area: element.area, pressure: p.value, friction, degrees })
        };
        Ok(SurfaceLoads { points: elements.par_iter().zip(&arms).filter_map(stressed).collect() })
    }
}

/// The nodes of one lattice in the fluid around a body.
struct Nearby {
    dim: usize,
    reach: f64,
    /// Place from the body's centre of mass, edges of the control volume, value.
    nodes: Vec<(Vector, Vector, f64)>,
    /// Their bins: `first` is the place of the lowest corner, `edge` the bins' edges.
    first: Vector,
    edge: Vector,
    bins: [usize; 3],
    starts: Vec<usize>,
}

impl Nearby {
    /// Those at least `clear` cells from body `b` and all others, and values on the `wall`.
    fn new(
        lattice: &Lattice,
        values: &[f64],
        bodies: &dyn Bodies,
        b: BodyId,
        others: &[Neighbour],
        clear: f64,
        wall: &[(Vector, f64)],
    ) -> Self {
        let (solid, pose, bounds) = (bodies.solid(b), bodies.pose(b), bodies.aabb(b));
        let reach = clear + REACH[lattice.dim - 2];
        let mut edge = Vector::repeat(1.0);
        for a in 0..lattice.dim {
            let [_, inner] = lattice.axes[a].spacings(bounds.min[a], bounds.max[a]);
            let margin = reach * inner;
            let [_, widest] = lattice.axes[a].spacings(bounds.min[a] - margin, bounds.max[a] + margin);
            edge[a] = reach * widest;
        }
        let range = |a: usize| lattice.range(a, bounds.min[a] - edge[a], bounds.max[a] + edge[a]);
        let ranges = [range(0), range(1), range(2)];
        let mut places = Vec::new();
        for k in ranges[2].clone() {
            for j in ranges[1].clone() {
                for i in ranges[0].clone() {
                    if let Some(index) = lattice.index([i, j, k]) {
                        let [x, widths] = [lattice.position([i, j, k]), lattice.widths([i, j, k])];
                        places.push((Point::from(x), Vector::from(widths), values[index]));
                    }
                }
            }
        }
        let size = |widths: &Vector| {
            (0..lattice.dim).map(|a| widths[a]).product::<f64>().powf(1.0 / lattice.dim as f64)
        };
        let widest = places.iter().map(|p| size(&p.1)).fold(0.0, f64::max);
        let band = (clear + 0.1) * widest;
        let queries: Vec<Point> = places.iter().map(|p| pose.to_body(p.0)).collect();
        let mut distances = vec![0.0; queries.len()];
        solid.signed_distances(&queries, band, &mut distances);
        let first = bounds.min.coords - edge - pose.position.coords;
        let bins: [usize; 3] = std::array::from_fn(|a| {
            if a < lattice.dim { (bounds.extent()[a] / edge[a]).ceil() as usize + 2 } else { 1 }
        });
        let mut binned: Vec<(usize, (Vector, Vector, f64))> = places
            .into_iter()
            .zip(distances)
            .filter(|((x, widths, _), distance)| {
                let clear = clear * size(widths);
                *distance > clear && others.iter().all(|o| o.distance(bodies, *x, band) > clear)
            })
            .map(|((x, widths, value), _)| (x - pose.position, widths, value))
            .chain(wall.iter().map(|&(arm, value)| {
                let node = lattice.locate(pose.position + arm).0;
                (arm, Vector::from(lattice.widths(node)), value)
            }))
            .map(|node| {
                let at = bin(node.0 - first, &edge, bins);
                (at[0] + bins[0] * (at[1] + bins[1] * at[2]), node)
            })
            .collect();
        binned.sort_by_key(|n| n.0);
        let starts = (0..=bins.iter().product()).map(|at| binned.partition_point(|n| n.0 < at)).collect();
        let nodes = binned.into_iter().map(|n| n.1).collect();
        Self { dim: lattice.dim, reach, nodes, first, edge, bins, starts }
    }

    /// A polynomial around the place `arm`.
    fn fit(&self, arm: Vector, fixed: Option<f64>) -> Option<Fit> {
        let at = bin(arm - self.first, &self.edge, self.bins);
        let beside = |a: usize| at[a].saturating_sub(1)..=(at[a] + 1).min(self.bins[a] - 1);
        let rows = beside(2).flat_map(|k| beside(1).map(move |j| (j, k)));
        let nodes = rows.flat_map(|(j, k)| {
            let (row, along) = (self.bins[0] * (j + self.bins[1] * k), beside(0));
            &self.nodes[self.starts[row + along.start()]..self.starts[row + along.end() + 1]]
        });
        let around = nodes.map(|&(place, widths, value)| (place - arm, widths, value));
        fit_around(around, self.reach, self.dim, fixed)
    }
}

/// The polynomial at the origin through the values of `nodes` within `reach` cells of it (place, edges of the control volume, value), which count
/// (1 − r²/reach²)², r their distance in cells.
pub(crate) fn fit_around(
    nodes: impl Iterator<Item = (Vector, Vector, f64)>,
    reach: f64,
    dim: usize,
    fixed: Option<f64>,
) -> Option<Fit> {
    let mut samples = Vec::new();
    let mut scale = Vector::zeros();
    for (away, widths, value) in nodes {
        let cells: f64 = (0..dim).map(|a| (away[a] / widths[a]).powi(2)).sum();
        let near = 1.0 - cells / (reach * reach);
        if near > 0.0 {
            samples.push(Sample { at: away, weight: near * near, value });
            scale += widths;
        }
    }
    // The polynomial's variables are lengths over the reach.
    scale *= reach / samples.len().max(1) as f64;
    for sample in &mut samples {
        for a in 0..dim {
            sample.at[a] /= scale[a];
        }
    }
    let mut found = fit(&samples, dim, DEGREE, fixed)?;
    for a in 0..dim {
        found.gradient[a] /= if scale[a] > 0.0 { scale[a] } else { 1.0 };
    }
    Some(found)
}

fn bin(from: Vector, edge: &Vector, bins: [usize; 3]) -> [usize; 3] {
    std::array::from_fn(|a| ((from[a] / edge[a]).max(0.0) as usize).min(bins[a] - 1))
}

#[cfg(test)]
mod tests;
