//! Cells cut by edges, corners and thin parts: ever smaller ones.
use crate::plane_fraction;
use interfaces::{Point, Rotation, Solid, Vector};

/// How often a cell is halved. An edge of 20° that is taken for a plane in the parts leaves out 0.02 of their
/// size squared per length; those of an icosahedron or a cube ten cells wide then stay below 0.05 % of its volume.
const TIMES: usize = 3;

/// A cell, as it is seen from the body's centre of mass.
pub(crate) struct Cell<'a> {
    pub(crate) solid: &'a dyn Solid,
    pub(crate) to_body: Rotation,
    pub(crate) dim: usize,
    /// From the centre of mass, in the world \[m\].
    pub(crate) centre: Vector,
    /// Edge lengths \[m\]; 0 along z in the plane.
    pub(crate) edges: Vector,
}

impl Cell<'_> {
    /// The solid share: the cell is halved along every axis, and so are its parts as long as the
    /// surface cuts them; the last ones are cut by planes.
    pub(crate) fn solid_share(&self) -> f64 {
        self.halve(self.centre, self.edges, 1)
    }

    fn halve(&self, centre: Vector, edges: Vector, times: usize) -> f64 {
        let parts = 1_usize << self.dim;
        let half = 0.5 * edges;
        let reach = 0.5 * half.norm();
        let corner = |p: usize| Vector::from_fn(|a, _| if p >> a & 1 == 1 { 0.5 } else { -0.5 });
        let place = |p: usize| centre + half.component_mul(&corner(p));
        let mut points = [Point::origin(); 8];
        for (p, x) in points[..parts].iter_mut().enumerate() {
            *x = Point::from(self.to_body * place(p));
        }
        let mut distances = [0.0; 8];
        let distances = &mut distances[..parts];
        // The last ones also have to be exact where they belong to the normal of one that is cut.
        let band = if times < TIMES { 1.01 * reach } else { 1.01 * (reach + half.norm()) };
        self.solid.signed_distances(&points[..parts], band, distances);
        let mut normal = Vector::zeros();
        if times == TIMES {
            for (p, d) in distances.iter().enumerate() {
                normal += corner(p) * *d;
            }
            normal = normal.zip_map(&edges, |sum, edge| if edge > 0.0 { sum / edge } else { 0.0 });
        }
        let normal = normal.try_normalize(0.0);
        let share = |(p, &d): (usize, &f64)| match normal {
            _ if d >= reach => 0.0,
            _ if d <= -reach => 1.0,
            _ if times < TIMES => self.halve(place(p), half, times + 1),
            Some(normal) => plane_fraction(d, normal, half),
            // Something thinner than the last parts: as much as its distance tells.
            None => 0.5 - 0.5 * d / reach,
        };
        distances.iter().enumerate().map(share).sum::<f64>() / parts as f64
    }
}
