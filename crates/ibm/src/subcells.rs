//! Cells cut by edges, corners and thin parts: ever smaller ones.
use crate::plane_fraction;
use interfaces::{Point, Rotation, Solid, Vector};

/// How often a cell is halved at least: an edge between the outermost centres of the parts and the cell's
/// sides does not show in their distances, so the parts must be small.
const LEAST: usize = 2;

/// How often a cell is halved at most.
const DEEPEST: usize = 4;

/// Where the differences of the distances at the 2^D centres of the parts make a gradient with a square
/// above this, the surface is taken as plane in them.
const PLANE: f64 = 0.96;

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

/// Measures the solid share of cells by halving them along every axis, again and again where the
/// surface cuts them and is not plane.
#[derive(Clone, Debug, Default)]
pub(crate) struct Subcells {}

impl Subcells {
    /// The solid share of the cell.
    pub(crate) fn fraction(&mut self, cell: &Cell<'_>) -> f64 {
        self.halve(cell, cell.centre, cell.edges, 1)
    }

    fn halve(&mut self, cell: &Cell<'_>, centre: Vector, edges: Vector, depth: usize) -> f64 {
        let parts = 1_usize << cell.dim;
        let half = 0.5 * edges;
        let reach = 0.5 * half.norm();
        let corner = |p: usize| Vector::from_fn(|a, _| if p >> a & 1 == 1 { 0.5 } else { -0.5 });
        let place = |p: usize| centre + half.component_mul(&corner(p));
        let mut points = [Point::origin(); 8];
        for (p, x) in points[..parts].iter_mut().enumerate() {
            *x = Point::from(cell.to_body * place(p));
        }
        let mut distances = [0.0; 8];
        // Wide enough for the differences to be exact wherever a part is cut.
        let band = 1.01 * (reach + half.norm());
        cell.solid.signed_distances(&points[..parts], band, &mut distances[..parts]);

        let distances = &distances[..parts];
        let mut gradient = Vector::zeros();
        for (p, d) in distances.iter().enumerate() {
            gradient += corner(p) * *d;
        }
        for a in 0..3 {
            gradient[a] *= if a < cell.dim { 8.0 / (parts as f64 * edges[a]) } else { 0.0 };
        }
        let square = gradient.norm_squared();
        if depth < LEAST || (square < PLANE && depth < DEEPEST) {
            let sum: f64 = (0..parts)
                .map(|p| match distances[p] {
                    d if d >= reach => 0.0,
                    d if d <= -reach => 1.0,
                    _ => self.halve(cell, place(p), half, depth + 1),
                })
                .sum();
            return sum / parts as f64;
        }
        let sum: f64 = distances
            .iter()
            .map(|&d| match gradient.try_normalize(1e-9) {
                Some(normal) => plane_fraction(d, normal, half),
                // Something thinner than the smallest part: as much as its distance tells.
                None => (0.5 - 0.5 * d / reach).clamp(0.0, 1.0),
            })
            .sum();
        sum / parts as f64
    }
}
