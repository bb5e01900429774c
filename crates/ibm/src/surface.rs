//! Elements of any body's surface.
use interfaces::{Aabb, Point, Solid, SurfaceElement, Vector};

/// Elements of the level surface of `solid` at signed distance `offset` \[m\], about `spacing` \[m\] apart, in the body's
/// frame: those of [`Solid::surface`], or, from shapes that do not tell, found with their signed distances alone.
///
/// Those are read at the corners of cells of a quarter of `spacing`; in each of the simplices that fill a cell (Kuhn 1960) the
/// surface is where their linear interpolation is `offset`. The pieces in cubes of `spacing` with about the same normal make
/// one element. Area and place are of second order in the size of the small cells: a sphere 10 `spacing` wide has its area
/// within 0.1 %. Edges are cut off by about half a small cell; nothing is left of a body that is thinner than twice −`offset`.
///
/// A `spacing` that is not positive and finite has no elements.
pub fn surface_elements(solid: &dyn Solid, spacing: f64, offset: f64) -> Vec<SurfaceElement> {
    if !(spacing > 0.0 && spacing.is_finite() && offset.is_finite()) {
        return Vec::new();
    }
    solid.surface(spacing, offset).unwrap_or_else(|| Marcher::new(solid, spacing, offset).elements())
}

/// Small cells along the edge of a cube.
const PARTS: usize = 4;
/// Pieces whose normals make a smaller angle than 60° are of one element.
const ALIKE: f64 = 0.5;

struct Marcher<'a> {
    solid: &'a dyn Solid,
    spacing: f64,
    offset: f64,
    /// 3, or 2 for shapes without extent along z.
    dim: usize,
    /// Distances are exact within it \[m\].
    band: f64,
    cubes: [usize; 3],
    low: Point,
}

/// Pieces of the surface with about the same normal; sums are weighted with the area.
#[derive(Clone, Copy, Debug)]
struct Cluster {
    area: f64,
    point: Vector,
    normal: Vector,
}

impl<'a> Marcher<'a> {
    fn new(solid: &'a dyn Solid, spacing: f64, offset: f64) -> Self {
        let Aabb { min, max } = solid.aabb();
        let extent = max - min;
        let dim = if extent.z == 0.0 { 2 } else { 3 };
        let wide = |a: usize| extent[a] + 2.0 * offset.max(0.0);
        // The cubes reach beyond the shape on both sides.
        let cubes = [0, 1, 2].map(|a| if a < dim { (wide(a) / spacing + 0.3).ceil() as usize } else { 1 });
        let half = Vector::from_fn(|a, _| if a < dim { 0.5 * cubes[a] as f64 * spacing } else { 0.0 });
        let band = offset.abs() + (dim as f64).sqrt() * spacing;
        Self { solid, spacing, offset, dim, band, cubes, low: nalgebra::center(&min, &max) - half }
    }

    fn elements(&self) -> Vec<SurfaceElement> {
        let half = 0.5 * self.spacing * (self.dim as f64).sqrt();
        let [nx, ny, nz] = self.cubes;
        let corners: Vec<Point> = (0..nx * ny * nz)
            .map(|i| self.place([i % nx, i / nx % ny, i / (nx * ny)], self.spacing))
            .collect();
        let middle = Vector::from_fn(|a, _| if a < self.dim { 0.5 * self.spacing } else { 0.0 });
        let centres: Vec<Point> = corners.iter().map(|corner| corner + middle).collect();
        let mut distances = vec![0.0; centres.len()];
        self.solid.signed_distances(&centres, self.band, &mut distances);
        let near = distances.iter().map(|d| (d - self.offset).abs() <= half);
        corners
            .iter()
            .zip(near)
            .filter(|(_, near)| *near)
            .flat_map(|(corner, _)| self.cube(*corner))
            .collect()
    }

    /// Corner `at` of cubes of this edge.
    fn place(&self, at: [usize; 3], edge: f64) -> Point {
        self.low + Vector::from_fn(|a, _| at[a] as f64 * edge)
    }

    /// The elements in the cube above `corner`.
    fn cube(&self, corner: Point) -> impl Iterator<Item = SurfaceElement> + use<'_> {
        let (edge, side) = (self.spacing / PARTS as f64, PARTS + 1);
        let shift = corner - self.low;
        let layers = if self.dim == 3 { side } else { 1 };
        let points: Vec<Point> = (0..side * side * layers)
            .map(|i| self.place([i % side, i / side % side, i / (side * side)], edge) + shift)
            .collect();
        let mut values = vec![0.0; points.len()];
        self.solid.signed_distances(&points, self.band, &mut values);
        values.iter_mut().for_each(|d| *d -= self.offset);
        let strides = [1, side, side * side];
        let mut clusters: Vec<Cluster> = Vec::new();
        for cell in 0..PARTS.pow(self.dim as u32) {
            let at = [cell % PARTS, cell / PARTS % PARTS, cell / (PARTS * PARTS)];
            let first: usize = (0..3).map(|a| at[a] * strides[a]).sum();
            for path in paths(self.dim) {
                let mut vertices = [first; 4];
                for (step, &axis) in path.iter().enumerate() {
                    vertices[step + 1] = vertices[step] + strides[axis];
                }
                let vertices = vertices.map(|v| (points[v], values[v]));
                if let Some(piece) = piece(&vertices[..=self.dim]) {
                    join(&mut clusters, piece);
                }
            }
        }
        clusters.into_iter().filter_map(|cluster| self.element(cluster))
    }

    fn element(&self, Cluster { area, point, normal }: Cluster) -> Option<SurfaceElement> {
        // Pieces that touch the cube in a corner are round-off.
        if area < 1e-9 * self.spacing.powi(self.dim as i32 - 1) {
            return None;
        }
        let normal = normal.try_normalize(0.0)?;
        let middle = Point::from(point / area);
        // The middle of a bent piece is a little behind the surface.
        let behind = self.solid.signed_distance(middle, self.band) - self.offset;
        let farthest = 0.25 * self.spacing;
        Some(SurfaceElement { point: middle - normal * behind.clamp(-farthest, farthest), normal, area })
    }
}

/// The ways along the edges of a square or cube from its lowest to its highest corner: one per simplex.
fn paths(dim: usize) -> &'static [&'static [usize]] {
    match dim {
        2 => &[&[0, 1], &[1, 0]],
        _ => &[&[0, 1, 2], &[0, 2, 1], &[1, 0, 2], &[1, 2, 0], &[2, 0, 1], &[2, 1, 0]],
    }
}

/// Where the linear interpolation in a triangle or tetrahedron is zero.
fn piece(vertices: &[(Point, f64)]) -> Option<Cluster> {
    let (inside, outside): (Vec<_>, Vec<_>) = vertices.iter().partition(|v| v.1 < 0.0);
    let cut = |a: &(Point, f64), b: &(Point, f64)| a.0 + (b.0 - a.0) * (a.1 / (a.1 - b.1));
    let ring: Vec<Point> = match (inside.as_slice(), outside.as_slice()) {
        ([a, b], [c, d]) => vec![cut(a, c), cut(a, d), cut(b, d), cut(b, c)],
        (few, many) => few.iter().flat_map(|a| many.iter().map(|b| cut(a, b))).collect(),
    };
    let (mut area, mut point, mut normal) = (0.0, Vector::zeros(), Vector::zeros());
    let mut add = |part: Vector, middle: Vector| {
        area += part.norm();
        point += part.norm() * middle;
        normal += part;
    };
    match ring.as_slice() {
        [] => return None,
        [a, b] => add(Vector::new(b.y - a.y, a.x - b.x, 0.0), 0.5 * (a.coords + b.coords)),
        [a, rest @ ..] => {
            for pair in rest.windows(2) {
                let part = 0.5 * (pair[0] - a).cross(&(pair[1] - a));
                add(part, (a.coords + pair[0].coords + pair[1].coords) / 3.0);
            }
        }
    }
    let outward = outside.iter().map(|v| v.0.coords).sum::<Vector>() / outside.len() as f64
        - inside.iter().map(|v| v.0.coords).sum::<Vector>() / inside.len() as f64;
    Some(Cluster { area, point, normal: normal * normal.dot(&outward).signum() })
}

/// Adds a piece to the first cluster with about its normal.
fn join(clusters: &mut Vec<Cluster>, piece: Cluster) {
    let alike =
        |c: &&mut Cluster| c.normal.dot(&piece.normal) > ALIKE * c.normal.norm() * piece.normal.norm();
    match clusters.iter_mut().find(alike) {
        Some(cluster) => {
            cluster.area += piece.area;
            cluster.point += piece.point;
            cluster.normal += piece.normal;
        }
        None => clusters.push(piece),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Ball, Brick, Plain};
    use std::f64::consts::PI;

    fn total(elements: &[SurfaceElement]) -> f64 {
        elements.iter().map(|e| e.area).sum()
    }

    #[test]
    fn balls_have_their_area_where_they_are() {
        for (dim, offset) in [(2, 0.0), (2, -0.04), (3, 0.0), (3, -0.04), (3, 0.05)] {
            let r = 0.5 + offset;
            let area = if dim == 2 { 2.0 * PI * r } else { 4.0 * PI * r * r };
            let errors = [0.1, 0.05].map(|spacing| {
                let elements = surface_elements(&Plain(Ball { dim, radius: 0.5 }), spacing, offset);
                for e in &elements {
                    assert!((e.point.coords.norm() - r).abs() < 1e-6 * r, "{e:?}");
                    assert!((e.normal - e.point.coords / r).norm() < 0.3 * spacing / r, "{e:?}");
                }
                // ∮ x·n dA is dim times what they enclose, ∮ n dA is nothing.
                let flux: f64 = elements.iter().map(|e| e.area * e.point.coords.dot(&e.normal)).sum();
                assert!((flux / (area * r) - 1.0).abs() < 0.004);
                assert!(elements.iter().map(|e| e.area * e.normal).sum::<Vector>().norm() < 1e-3 * area);
                (total(&elements) / area - 1.0).abs()
            });
            assert!(errors[0] < 1e-3 && errors[1] < 0.35 * errors[0], "{dim} {offset} {errors:?}");
        }
    }

    #[test]
    fn faces_of_a_brick_are_exact_and_its_edges_keep_their_elements_apart() {
        let elements = surface_elements(&Brick([0.5, 0.2, 0.3]), 0.1, 0.0);
        let faces = 8.0 * (0.5 * 0.2 + 0.2 * 0.3 + 0.3 * 0.5);
        // Edges are cut off: 8 m of them by 0.6 · 0.5 small cells, 2.5 %.
        let found = total(&elements) / faces;
        assert!((0.97..1.0).contains(&found), "{found}");
        let flat = elements.iter().filter(|e| e.normal.abs().max() > 0.999).map(|e| e.area).sum::<f64>();
        assert!(flat > 0.8 * faces, "{}", flat / faces);
        // A plate thinner than a cube: both faces are there.
        let plate = surface_elements(&Brick([0.5, 0.03, 0.5]), 0.1, 0.0);
        let side = |sign: f64| plate.iter().filter(|e| e.normal.y * sign > 0.9).map(|e| e.area).sum::<f64>();
        for sign in [-1.0, 1.0] {
            assert!((side(sign) - 1.0).abs() < 0.1, "{}", side(sign));
        }
        // Nothing is left of it beyond its middle.
        assert!(surface_elements(&Brick([0.5, 0.03, 0.5]), 0.1, -0.031).is_empty());
    }
}
