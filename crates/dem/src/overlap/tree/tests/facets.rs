//! Bodies with facets.
use super::*;
use crate::FacetIndex;
use interfaces::Polyhedron;

/// The unit cube as twelve triangles.
struct Triangles {
    vertices: Vec<Point>,
    faces: Vec<[u32; 3]>,
    facets: FacetIndex,
}

impl Triangles {
    fn new() -> Self {
        let corner = |i: usize| Point::from([i & 1, i >> 1 & 1, i >> 2 & 1].map(|c| c as f64 - 0.5));
        let vertices: Vec<Point> = (0..8).map(corner).collect();
        let faces = vec![
            [0, 2, 1],
            [1, 2, 3],
            [4, 5, 6],
            [5, 7, 6],
            [0, 1, 4],
            [1, 5, 4],
            [2, 6, 3],
            [3, 6, 7],
            [0, 4, 2],
            [2, 4, 6],
            [1, 3, 5],
            [3, 7, 5],
        ];
        let facets = FacetIndex::new(Polyhedron { vertices: &vertices, faces: &faces });
        Self { vertices, faces, facets }
    }
}
impl Solid for Triangles {
    fn signed_distance(&self, x: Point, band: f64) -> f64 {
        CUBE.signed_distance(x, band)
    }
    fn aabb(&self) -> Aabb {
        CUBE.aabb()
    }
    fn polyhedron(&self) -> Option<Polyhedron<'_>> {
        Some(Polyhedron { vertices: &self.vertices, faces: &self.faces })
    }
}
impl Shape for Triangles {
    fn name(&self) -> &'static str {
        "triangles"
    }
    fn inertia(&self, density: f64) -> Inertia {
        CUBE.inertia(density)
    }
    fn bounding_radius(&self) -> f64 {
        0.75_f64.sqrt()
    }
    fn facet_index(&self) -> Option<&FacetIndex> {
        Some(&self.facets)
    }
}

/// Facets tell which boxes are cut exactly, so fewer are than by the distance of their centres; the sum is the same.
#[test]
fn facets_decide_which_boxes_are_cut() {
    let (cube, b) = (Triangles::new(), turned(at(0.7, 0.4, 0.3), [0.3, 0.2, 0.5]));
    assert_eq!(cube.facets.len(), 12);
    let count = |shape: &dyn Shape| {
        let mut solver = solver(Refinement::Levels(4));
        let o = one(solver.solve(shape, &at(0.0, 0.0, 0.0), shape, &b).unwrap());
        (o.volume, solver.boxes().filter(|b| b.kind != BoxKind::Inside).count())
    };
    let ((by_facets, few), (by_distance, many)) = (count(&cube), count(&CUBE));
    assert!(few < many, "{few} {many}");
    assert!((by_facets / by_distance - 1.0).abs() < 1e-3, "{by_facets} {by_distance}");
    let exact = one(tolerance(1e-4).solve(&CUBE, &at(0.0, 0.0, 0.0), &CUBE, &b).unwrap()).volume;
    assert!((by_facets / exact - 1.0).abs() < 5e-3, "{by_facets} {exact}");
}

#[test]
fn a_box_and_a_triangle() {
    let vertices = [Point::new(0.0, 0.0, 0.0), Point::new(1.0, 0.0, 0.0), Point::new(0.0, 1.0, 0.0)];
    let facets = FacetIndex::new(Polyhedron { vertices: &vertices, faces: &[[0, 1, 2]] });
    let turn =
        |angle: f64| *Rotation::from_axis_angle(&Vector::z_axis(), angle).to_rotation_matrix().matrix();
    let cut = |x, y, z, angle| facets.cut(Point::new(x, y, z), &turn(angle), Vector::repeat(0.1));
    assert!(cut(0.3, 0.3, 0.05, 0.0) && !cut(0.3, 0.3, 0.11, 0.0));
    // Before the long side: corner first, or side first.
    assert!(cut(0.59, 0.59, 0.0, 0.0) && !cut(0.61, 0.61, 0.0, 0.0));
    assert!(cut(0.57, 0.57, 0.0, PI / 4.0) && !cut(0.59, 0.59, 0.0, PI / 4.0));
    assert!(!facets.is_empty());
}
