//! What is compared.
use siltflow::dem::{
    Capsule, Cuboid, Cylinder, Ellipsoid, Implicit, Normal, OverlapSolver, Refinement, Route, Shape, Sphere,
    TriangleMesh,
};
use siltflow::interfaces::{Aabb, Point, Solid, Vector};
use validation::Outcome;

/// What the normals from edge boxes are called.
pub(crate) const PLANE_FIT: &str = "tree, plane fit";

/// A way to the overlap of a pair.
pub(crate) struct Way {
    pub(crate) label: &'static str,
    pub(crate) setting: String,
    pub(crate) solver: OverlapSolver,
}

/// A pair of bodies.
pub(crate) struct Case {
    pub(crate) name: &'static str,
    pub(crate) a: Box<dyn Shape>,
    pub(crate) b: Box<dyn Shape>,
    /// What they share, of the smaller one.
    pub(crate) share: f64,
    /// What errors are taken against.
    pub(crate) reference: OverlapSolver,
    /// What finds the poses.
    pub(crate) posing: OverlapSolver,
    pub(crate) ways: Vec<Way>,
}

impl Case {
    fn new<S: Shape + Clone + 'static>(name: &'static str, shape: S, share: f64) -> Self {
        let solver = OverlapSolver::new();
        Self {
            name,
            a: Box::new(shape.clone()),
            b: Box::new(shape),
            share,
            reference: solver.clone(),
            posing: solver,
            ways: Vec::new(),
        }
    }
    /// An exact route.
    fn exact(mut self, label: &'static str, route: Route) -> Self {
        let solver = OverlapSolver::new().with_route(Some(route));
        self.ways.push(Way { label, setting: "exact".into(), solver });
        self
    }
    /// A route that goes by a tolerance.
    fn converging(mut self, label: &'static str, route: Route) -> Self {
        for tolerance in [1e-3, 1e-5, 1e-7, 1e-9] {
            let solver = OverlapSolver::new().with_route(Some(route)).with_tolerance(tolerance);
            self.ways.push(Way { label, setting: format!("{tolerance:.0e}"), solver });
        }
        self
    }
    /// The adaptive tree, by tolerance and by level.
    fn tree(mut self) -> Self {
        let by = |refinement| OverlapSolver::new().with_route(Some(Route::Tree)).with_refinement(refinement);
        for tolerance in [1e-1, 1e-2, 1e-3, 1e-4] {
            let solver = by(Refinement::Tolerance(tolerance));
            self.ways.push(Way { label: "tree, by tolerance", setting: format!("{tolerance:.0e}"), solver });
        }
        for level in 1..=5 {
            let solver = by(Refinement::Levels(level));
            self.ways.push(Way { label: "tree, by level", setting: format!("level {level}"), solver });
        }
        for level in [3, 5] {
            let solver = by(Refinement::Levels(level)).with_normal(Normal::PlaneFit);
            self.ways.push(Way { label: PLANE_FIT, setting: format!("level {level}"), solver });
        }
        self
    }
}

/// A ring of circular section.
#[derive(Clone, Copy)]
struct Torus;

impl Solid for Torus {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        let out = (x.x * x.x + x.y * x.y).sqrt() - 0.7;
        (out * out + x.z * x.z).sqrt() - 0.3
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), Vector::new(1.0, 1.0, 0.3))
    }
}

/// Bulges and hollows: not convex.
fn rock(times: u32) -> Outcome<TriangleMesh> {
    let ball = TriangleMesh::sphere(1.0, times)?;
    let radius = |n: Vector| {
        1.0 + 0.12 * (5.0 * n.x + 1.0).sin() * (4.0 * n.y).cos() + 0.1 * (6.0 * n.z + 2.0 * n.x).sin()
    };
    let vertices: Vec<[f64; 3]> =
        ball.vertices().iter().map(|v| (v.coords * radius(v.coords)).into()).collect();
    Ok(TriangleMesh::new(&vertices, ball.faces())?)
}

pub(crate) fn all() -> Outcome<Vec<Case>> {
    let fine = |route| OverlapSolver::new().with_route(Some(route)).with_tolerance(1e-10);
    let torus = Implicit::new("torus", Torus, 1e-4)?;
    let tree =
        |t| OverlapSolver::new().with_route(Some(Route::Tree)).with_refinement(Refinement::Tolerance(t));
    Ok(vec![
        Case::new("spheres", Sphere::new(1.0)?, 0.02).exact("closed form", Route::ClosedForm).tree(),
        Case::new("cubes", Cuboid::new([1.0; 3])?, 0.02)
            .exact("clipping", Route::Clip)
            .exact("crossings", Route::Crossings)
            .tree(),
        Case {
            reference: fine(Route::Curve),
            ..Case::new("ellipsoids 1 : 1.5 : 2", Ellipsoid::new([0.5, 0.75, 1.0])?, 0.02)
        }
        .converging("curve", Route::Curve)
        .converging("columns", Route::Columns)
        .tree(),
        Case {
            reference: fine(Route::Slices),
            ..Case::new("cylinders, as long as wide", Cylinder::new(0.5, 1.0)?, 0.02)
        }
        .converging("slices", Route::Slices)
        .converging("columns", Route::Columns)
        .tree(),
        Case {
            a: Box::new(Capsule::new(0.3, 1.0)?),
            ..Case::new("capsule and cube", Cuboid::new([1.0; 3])?, 0.02)
        }
        .exact("closed form", Route::ClosedForm)
        .tree(),
        Case::new("rocks of 1280 triangles", rock(3)?, 0.02).exact("crossings", Route::Crossings).tree(),
        Case { reference: tree(1e-6), posing: tree(1e-2), ..Case::new("tori, by distances", torus, 0.02) }
            .tree(),
    ])
}
