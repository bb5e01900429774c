//! Surfaces of shapes known by their signed distance.
use super::polygon_surface::PolygonSurface;
use interfaces::{Point, Solid, Vector};
use std::collections::HashMap;

/// Corners of the six tetrahedra of a cube, bit a of a corner being its place along axis a; det > 0
/// (Kuhn 1960).
const TETRAHEDRA: [[usize; 4]; 6] =
    [[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]];

/// Even permutation of the corners of a tetrahedron that puts those inside first, by the bits of
/// those inside; with three inside the one outside is first.
const ORDER: [[usize; 4]; 16] = [
    [0, 1, 2, 3],
    [0, 1, 2, 3],
    [1, 0, 3, 2],
    [0, 1, 2, 3],
    [2, 0, 1, 3],
    [0, 2, 3, 1],
    [1, 2, 0, 3],
    [3, 0, 2, 1],
    [3, 0, 2, 1],
    [0, 3, 1, 2],
    [1, 3, 2, 0],
    [2, 0, 1, 3],
    [2, 3, 0, 1],
    [1, 0, 3, 2],
    [0, 1, 2, 3],
    [0, 1, 2, 3],
];

/// Closed surface where the distance, linear in tetrahedra, is zero (Doi & Koide 1991), on cubes of
/// which `cells` are as long as the longest edge of the solid's box. Parts thinner than a cube may
/// be missing. Empty for boxes that are flat or not finite.
pub(super) fn marching_tetrahedra(solid: &(impl Solid + ?Sized), cells: usize) -> PolygonSurface {
    let bounds = solid.aabb();
    let extent = bounds.extent();
    if !extent.iter().all(|e| e.is_finite() && *e > 0.0) {
        return PolygonSurface::default();
    }
    let edge = extent.max() / cells as f64;
    // One more cube at each end, whose outer nodes are outside.
    let nodes: [usize; 3] = std::array::from_fn(|a| (extent[a] / edge).ceil() as usize + 3);
    let size = Vector::from(nodes.map(|n| (n - 1) as f64 * edge));
    let corner = nalgebra::center(&bounds.min, &bounds.max) - 0.5 * size;
    let number = |i: [usize; 3]| i[0] + nodes[0] * (i[1] + nodes[1] * i[2]);
    let indices = |last: usize| {
        let ends = nodes.map(|n| n - last);
        (0..ends[2]).flat_map(move |k| (0..ends[1]).flat_map(move |j| (0..ends[0]).map(move |i| [i, j, k])))
    };
    let points: Vec<Point> = indices(0).map(|i| corner + Vector::from(i.map(|i| i as f64 * edge))).collect();
    // Nodes of an edge that crosses the surface are within √3 edges of it.
    let band = 2.0 * edge;
    let mut distances = vec![0.0; points.len()];
    solid.signed_distances(&points, band, &mut distances);
    for (i, distance) in indices(0).zip(&mut distances) {
        let outer = (0..3).any(|a| i[a] == 0 || i[a] + 1 == nodes[a]);
        *distance = if outer || distance.is_nan() { band } else { distance.clamp(-band, band) };
    }

    let mut surface = PolygonSurface::default();
    let mut crossings = HashMap::new();
    let mut crossing = |surface: &mut PolygonSurface, a: usize, b: usize| {
        *crossings.entry([a.min(b), a.max(b)]).or_insert_with_key(|&[a, b]| {
            let share = distances[a] / (distances[a] - distances[b]);
            surface.points.push(points[a] + share * (points[b] - points[a]));
            surface.points.len() - 1
        })
    };
    for cube in indices(1) {
        let corners: [usize; 8] =
            std::array::from_fn(|c| number(std::array::from_fn(|a| cube[a] + (c >> a & 1))));
        for tetrahedron in TETRAHEDRA {
            let tetrahedron = tetrahedron.map(|c| corners[c]);
            let inside = (0..4).filter(|&v| distances[tetrahedron[v]] < 0.0);
            let mask = inside.fold(0, |mask, v| mask | 1 << v);
            let [i, j, k, l] = ORDER[mask].map(|v| tetrahedron[v]);
            let edges: &[[usize; 2]] = match mask.count_ones() {
                1 => &[[i, j], [i, k], [i, l]],
                2 => &[[i, k], [i, l], [j, l], [j, k]],
                3 => &[[i, j], [i, l], [i, k]],
                _ => continue,
            };
            let polygon: Vec<usize> = edges.iter().map(|[a, b]| crossing(&mut surface, *a, *b)).collect();
            surface.push_polygon(polygon);
        }
    }
    surface
}
