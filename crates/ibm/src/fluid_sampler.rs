//! Values of fields at points near bodies, from the fluid's side.
use crate::IbmError;
use crate::surface_stress::{BESIDE, PRESSED, REACH, fit_around, stored};
use interfaces::{Bodies, BodyId, Lattice, Point, Vector, VelocityField};

/// Samples the pressure and the velocity of a flow at points on surfaces of bodies that are walls and near them, where interpolation between the
/// nodes around a point would use nodes inside bodies and cells that are cut.
///
/// The value is that of a polynomial of at most third degree, by weighted least squares through nodes in the fluid within about four cells, as for
/// [`SurfaceStress`](crate::SurfaceStress); for a velocity also through the wall at the foot points of nodes near it. The pressure is extrapolated along the
/// normal, from nodes in an ellipsoid half as wide as deep: on surfaces with a radius of five cells it varies more along them than a polynomial
/// follows over four cells on either side. Nodes behind a body, to which a straight line
/// from the point goes through it deeper than a quarter of a cell, are left out. Points deeper than half a cell in a body have no value.
#[derive(Clone, Copy)]
pub struct FluidSampler<'a> {
    bodies: &'a dyn Bodies,
    clearance: f64,
}

/// Points deeper than this many cells in a body are not in the fluid next to it.
const DEEP: f64 = 0.5;
/// Lines of sight may go that many cells deep through a body: over the horizon of round bodies, not through plates of half a cell.
const SHALLOW: f64 = 0.25;

/// Cells along the normal over which the pressure is extrapolated, beyond those that are left out.
const DEPTH: f64 = 4.2;
/// Depth over width of the region that the pressure is extrapolated from.
const SLENDER: f64 = 2.0;

/// Nodes of which a field is fitted.
enum Region {
    /// Velocity component, known on walls too, within this many cells.
    Component(usize, f64),
    /// Pressure within this many cells along the normal.
    Pressure(f64),
}

impl Region {
    fn reach(&self) -> f64 {
        match *self {
            Self::Component(_, reach) | Self::Pressure(reach) => reach,
        }
    }
}

/// One body, or an image of it, near a point.
struct Image {
    body: BodyId,
    /// From the body to its image.
    shift: Vector,
}

/// Bodies near a point, and the nodes around it.
struct Vicinity<'a> {
    bodies: &'a dyn Bodies,
    images: Vec<Image>,
    band: f64,
    x: Point,
}

impl<'a> FluidSampler<'a> {
    /// Sampler of fields around these bodies.
    pub fn new(bodies: &'a dyn Bodies) -> Self {
        Self { bodies, clearance: 0.0 }
    }

    /// Leaves out nodes nearer to a surface than so many cells: the half width of the kernel for a forcing that smears it. The default is one cell for the
    /// pressure, which is of first order in cut cells, and 0.3 for the velocity.
    #[must_use]
    pub fn with_clearance(mut self, cells: f64) -> Self {
        self.clearance = cells.max(0.0);
        self
    }

    /// The field with these `values` at the nodes of `lattice` at `x`; `None` where no body is near, so that interpolation between the nodes around `x`
    /// is good, and deep inside a body.
    ///
    /// # Errors
    /// [`IbmError::Storage`] for a field that is not the lattice's.
    pub fn pressure(&self, lattice: &Lattice, values: &[f64], x: Point) -> Result<Option<f64>, IbmError> {
        stored(lattice, values)?;
        let clear = self.clearance.max(PRESSED);
        let region = Region::Pressure(clear + DEPTH);
        let Some(near) = self.near(lattice, x, clear, &region) else { return Ok(None) };
        Ok(near.fit(lattice, values, clear, &region))
    }

    /// The velocity \[m/s\] at `x`, as [`pressure`](Self::pressure); on a surface that of the surface.
    ///
    /// # Errors
    /// [`IbmError::Storage`] for values that are not those of their lattice.
    pub fn velocity(&self, velocity: &dyn VelocityField, x: Point) -> Result<Option<Vector>, IbmError> {
        let clear = self.clearance.max(BESIDE);
        let mut out = Vector::zeros();
        for c in 0..velocity.dim() {
            let (lattice, values) = (velocity.lattice(c), velocity.component(c));
            stored(lattice, values)?;
            let region = Region::Component(c, clear + REACH[lattice.dim - 2]);
            let Some(near) = self.near(lattice, x, clear, &region) else { return Ok(None) };
            let Some(u) = near.fit(lattice, values, clear, &region) else { return Ok(None) };
            out[c] = u;
        }
        Ok(Some(out))
    }

    /// The bodies near `x`, unless all nodes around it are `clear` cells from them or `x` is deep inside one.
    fn near(&self, lattice: &Lattice, x: Point, clear: f64, region: &Region) -> Option<Vicinity<'a>> {
        let (node, _) = lattice.locate(x);
        let reach = region.reach() + 1.0;
        let margin = Vector::from_fn(|a, _| {
            let [_, widest] = lattice.axes[a].spacings(x[a], x[a]);
            if a < lattice.dim { reach * widest } else { 0.0 }
        });
        let mut images = Vec::new();
        for body in (0..self.bodies.n_bodies()).map(BodyId) {
            let bounds = self.bodies.aabb(body);
            let turns = [0, 1, 2].map(|a| {
                let [low, high] = [x[a] - margin[a] - bounds.max[a], x[a] + margin[a] - bounds.min[a]];
                match lattice.axes[a].period() {
                    _ if a >= lattice.dim => 0..=0,
                    Some(period) => (low / period).ceil() as i64..=(high / period).floor() as i64,
                    None => i64::from(low > 0.0)..=-i64::from(high < 0.0),
                }
            });
            for (i, j, k) in turns[0].clone().flat_map(|i| {
                let (turns, inner) = (&turns, turns[2].clone());
                turns[1].clone().flat_map(move |j| inner.clone().map(move |k| (i, j, k)))
            }) {
                let turn = [i, j, k];
                let shift = Vector::from_fn(|a, _| turn[a] as f64 * lattice.axes[a].period().unwrap_or(0.0));
                images.push(Image { body, shift });
            }
        }
        let vicinity = Vicinity { bodies: self.bodies, images, band: 2.0 * margin.norm(), x };
        let size = size(lattice, node);
        let cut = (0..1_usize << lattice.dim).any(|corner| {
            let at = [0, 1, 2].map(|a| node[a] + (corner >> a & 1) as isize);
            vicinity.distance(Point::from(lattice.position(at))) <= clear * size
        });
        (cut && vicinity.distance(x) >= -DEEP * size).then_some(vicinity)
    }
}

/// Edge of a cube as large as the control volume of a node \[m\].
fn size(lattice: &Lattice, node: [isize; 3]) -> f64 {
    let widths = lattice.widths(node);
    widths[..lattice.dim].iter().product::<f64>().powf(1.0 / lattice.dim as f64)
}

impl Vicinity<'_> {
    fn distance(&self, x: Point) -> f64 {
        self.nearest(x).map_or(f64::INFINITY, |(distance, _)| distance)
    }

    fn nearest(&self, x: Point) -> Option<(f64, &Image)> {
        let distance = |image: &Image| {
            let at = self.bodies.pose(image.body).to_body(x - image.shift);
            self.bodies.solid(image.body).signed_distance(at, self.band)
        };
        self.images.iter().map(|image| (distance(image), image)).min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Unit normal of a body at `x`, into the fluid.
    fn normal(&self, image: &Image, x: Point) -> Vector {
        let pose = self.bodies.pose(image.body);
        pose.orientation * self.bodies.solid(image.body).normal(pose.to_body(x - image.shift), self.band)
    }

    /// Foot point on the nearest surface, and the velocity of that surface there.
    fn wall(&self, x: Point) -> Option<(Point, Vector)> {
        let (distance, image) = self.nearest(x)?;
        let foot = x - distance * self.normal(image, x);
        let arm = foot - image.shift - self.bodies.pose(image.body).position;
        Some((foot, self.bodies.surface_velocity(image.body, arm)))
    }

    /// Whether a straight line from the point to `there` stays out of bodies, but for `deep`: parts of it are halved until their ends, with slopes of the
    /// distance of at most 1, tell.
    fn sees(&self, there: Point, deep: f64) -> bool {
        let mut parts = vec![[(self.x, self.distance(self.x)), (there, self.distance(there))]];
        while let Some([a, b]) = parts.pop() {
            let length = (b.0 - a.0).norm();
            if 0.5 * (a.1 + b.1 - length) > -deep || length < 0.2 * deep {
                continue;
            }
            let middle = nalgebra::center(&a.0, &b.0);
            let middle = (middle, self.distance(middle));
            if middle.1 <= -deep {
                return false;
            }
            parts.extend([[a, middle], [middle, b]]);
        }
        true
    }

    /// The polynomial through the nodes in the fluid, and for a velocity through the wall, at the point.
    fn fit(&self, lattice: &Lattice, values: &[f64], clear: f64, region: &Region) -> Option<f64> {
        let reach = region.reach();
        let (node, _) = lattice.locate(self.x);
        let (distance, image) = self.nearest(self.x)?;
        let (component, normal) = match *region {
            Region::Component(c, _) if distance.abs() <= 1e-6 * size(lattice, node) => {
                return self.wall(self.x).map(|(_, velocity)| velocity[c]);
            }
            Region::Component(c, _) => (Some(c), Vector::zeros()),
            Region::Pressure(_) => (None, self.normal(image, self.x)),
        };
        let span = |a: usize| {
            let cells = if a < lattice.dim { reach.ceil() as isize + 1 } else { 0 };
            node[a] - cells..=node[a] + cells
        };
        let mut nodes = Vec::new();
        for k in span(2) {
            for j in span(1) {
                for i in span(0) {
                    let Some(index) = lattice.index([i, j, k]) else { continue };
                    let place = Point::from(lattice.position([i, j, k]));
                    let widths = Vector::from(lattice.widths([i, j, k]));
                    let mut away = place - self.x;
                    if component.is_none() {
                        // Widened across the normal the ellipsoid is a ball, and polynomials stay polynomials.
                        let along = normal * normal.dot(&away);
                        away = along + SLENDER * (away - along);
                    }
                    let cells: f64 = (0..lattice.dim).map(|a| (away[a] / widths[a]).powi(2)).sum();
                    if cells >= reach * reach {
                        continue;
                    }
                    let (size, distance) = (size(lattice, [i, j, k]), self.distance(place));
                    if distance > clear * size && self.sees(place, SHALLOW * size) {
                        nodes.push((away, widths, values[index]));
                    }
                    if let Some(c) = component
                        && distance.abs() <= size
                        && let Some((foot, velocity)) = self.wall(place)
                        && self.sees(foot, SHALLOW * size)
                    {
                        nodes.push((foot - self.x, widths, velocity[c]));
                    }
                }
            }
        }
        fit_around(nodes.iter().copied(), reach, lattice.dim, None).map(|fit| fit.value)
    }
}

#[cfg(test)]
mod tests;
