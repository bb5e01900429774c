//! Shapes.
use super::{Context, of_file};
use crate::expression::Expression;
use crate::problem::Problem;
use crate::reader::Reader;
use dem::{
    Capsule, ConvexPolyhedron, Cuboid, Cylinder, Disc, Ellipsoid, Implicit, Part, Polygon, Shape, Sphere,
    TriangleMesh, TriangleSoup, Union,
};
use interfaces::{Aabb, Point, Pose, Rotation, Solid, Vector};
use nalgebra::Unit;
use std::sync::Arc;

/// A solid by the formula of its signed distance.
struct ByFormula {
    distance: Expression,
    /// By how much it is enlarged.
    factor: f64,
    bounds: Aabb,
    plane: bool,
}

/// Corners of a polygon that stands for an ellipse.
const ELLIPSE_CORNERS: usize = 180;
/// How well volume and moments of a formula's solid have to be known.
const VOLUME_TOLERANCE: f64 = 1e-3;

impl Solid for ByFormula {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        let own = [x.x, x.y, if self.plane { 0.0 } else { x.z }].map(|c| c / self.factor);
        let mut distance = self.factor * self.distance.at(&own);
        // Nothing of it is outside its box.
        for a in 0..if self.plane { 2 } else { 3 } {
            distance = distance.max(self.bounds.min[a] - x[a]).max(x[a] - self.bounds.max[a]);
        }
        if self.plane { distance.max(x.z.abs() - self.bounds.max.z) } else { distance }
    }
    fn aabb(&self) -> Aabb {
        self.bounds
    }
}

/// A shape with the point that places it and about which it is turned, the reference point: the
/// origin of a formula's coordinates, the one that `placement` chooses of a mesh, the centre of
/// mass of all others.
#[derive(Clone)]
pub(crate) struct PlacedShape {
    pub(crate) shape: Arc<dyn Shape>,
    /// Centre of mass from the reference point \[m\].
    centre: Vector,
}

impl PlacedShape {
    fn by_centre(shape: Arc<dyn Shape>) -> Self {
        Self { shape, centre: Vector::zeros() }
    }
    /// Pose of the centre of mass if the reference point has this one.
    pub(crate) fn pose(&self, reference: Pose) -> Pose {
        Pose { position: reference.to_world(self.centre.into()), orientation: reference.orientation }
    }
    /// Radius of a ball around the reference point that holds the body however it is turned \[m\].
    pub(crate) fn reach(&self) -> f64 {
        self.centre.norm() + self.shape.bounding_radius()
    }
}

/// Values of `placement`.
#[derive(Clone, Copy)]
enum Placement {
    CentreOfMass,
    Box,
    File,
}

impl Placement {
    fn read(t: &Reader<'_>) -> Self {
        match t.text("placement") {
            Some("box") => Self::Box,
            Some("file") => Self::File,
            Some("centre of mass") | None => Self::CentreOfMass,
            Some(word) => unreachable!("placement \"{word}\" is not in the schema"),
        }
    }
    /// The centre of mass of a mesh from its reference point \[m\].
    fn centre(self, mesh: &TriangleMesh) -> Vector {
        let bounds = mesh.aabb();
        match self {
            Self::CentreOfMass => Vector::zeros(),
            Self::Box => -nalgebra::center(&bounds.min, &bounds.max).coords,
            Self::File => mesh.origin().coords,
        }
    }
}

fn formula(
    body: &Reader<'_>,
    key: &str,
    t: &Reader<'_>,
    context: &Context<'_>,
    factor: f64,
) -> Result<Implicit<ByFormula>, Problem> {
    let corner = |key: &str| -> Result<Vector, Problem> {
        Ok(factor * t.vector_of(key, context.dim)?.unwrap_or_default())
    };
    let (mut lower, mut upper) = (corner("lower")?, corner("upper")?);
    if (0..context.dim).any(|a| lower[a] >= upper[a]) {
        return Err(t.fail("upper", "the upper corner has to be above the lower one along every axis"));
    }
    if context.dim == 2 {
        // The same at all heights.
        let height = (upper - lower).norm();
        (lower[2], upper[2]) = (-height, height);
    }
    let distance = t.formula("distance", &["x", "y", "z"])?.unwrap_or(Expression::constant(0.0));
    let bounds = Aabb { min: lower.into(), max: upper.into() };
    let solid = ByFormula { distance, factor, bounds, plane: context.dim == 2 };
    Implicit::new("formula", solid, VOLUME_TOLERANCE).map_err(|e| body.fail(key, e))
}

/// The shape in `key`, enlarged by `factor`.
pub(super) fn shape(
    body: &Reader<'_>,
    key: &str,
    context: &Context<'_>,
    factor: f64,
) -> Result<PlacedShape, Problem> {
    let Some((kind, t)) = body.choice(key, "type") else {
        return Err(body.fail(key, "the shape is missing"));
    };
    let length = |key: &str| factor * t.number(key).unwrap_or(0.0);
    let fail = |e: &dyn std::fmt::Display| body.fail(key, e);
    let triple = |key: &str| -> [f64; 3] { (factor * t.vector(key).unwrap_or_default()).into() };
    fn arc<E: std::fmt::Display>(
        shape: Result<impl Shape + 'static, E>,
        fail: impl Fn(&dyn std::fmt::Display) -> Problem,
    ) -> Result<PlacedShape, Problem> {
        match shape {
            Ok(shape) => Ok(PlacedShape::by_centre(Arc::new(shape))),
            Err(e) => Err(fail(&e)),
        }
    }
    match kind {
        "disc" if context.dim == 3 => {
            Err(fail(&"a disc is for plane scenes; take a sphere or a cylinder in space"))
        }
        "disc" => arc(Disc::new(length("radius")), fail),
        "ellipse" | "polygon" if context.dim == 3 => {
            Err(fail(&"this is for plane scenes; take an ellipsoid or a polyhedron in space"))
        }
        "ellipse" => {
            let [a, b, _] = triple("semi_axes");
            arc(Polygon::ellipse([a, b], ELLIPSE_CORNERS), fail)
        }
        "polygon" => {
            let corner = |row: &Vec<f64>| [0, 1].map(|a| factor * row.get(a).copied().unwrap_or(0.0));
            let corners: Vec<_> = t.rows("corners").iter().map(corner).collect();
            arc(Polygon::new(&corners), fail)
        }
        "sphere" if context.dim == 2 => {
            Err(fail(&"a sphere is for scenes in space; take a disc in the plane"))
        }
        "sphere" => arc(Sphere::new(length("radius")), fail),
        "ellipsoid" => arc(Ellipsoid::new(triple("semi_axes")), fail),
        "capsule" => arc(Capsule::new(length("radius"), length("length")), fail),
        "cylinder" => arc(Cylinder::new(length("radius"), length("length")), fail),
        "box" => {
            t.has_dim("edges", context.dim)?;
            let [x, y, z] = triple("edges");
            if context.dim == 2 {
                arc(Polygon::rectangle([x, y]), fail)
            } else {
                arc(Cuboid::new([x, y, z]), fail)
            }
        }
        "polyhedron" => {
            let vertices: Vec<[f64; 3]> = t
                .rows("vertices")
                .iter()
                .map(|row| std::array::from_fn(|a| factor * row.get(a).copied().unwrap_or(0.0)))
                .collect();
            let faces: Vec<Vec<u32>> =
                t.rows("faces").iter().map(|row| row.iter().map(|&v| v as u32).collect()).collect();
            if faces.is_empty() {
                return arc(ConvexPolyhedron::from_points(&vertices), fail);
            }
            if let Some(v) = faces.iter().flatten().find(|&&v| v as usize >= vertices.len()) {
                return Err(t.fail(
                    "faces",
                    format!("there is no vertex {v}; there are {}, from 0 on", vertices.len()),
                ));
            }
            arc(ConvexPolyhedron::new(&vertices, &faces), fail)
        }
        "mesh" => {
            let path = context.path(t.text("file").unwrap_or_default());
            let unit = factor * t.number("unit").unwrap_or(1.0);
            let told = |e: &dyn std::fmt::Display| t.fail("file", of_file(&path, e));
            let repair = t.flag("repair").unwrap_or(false);
            let soup = TriangleSoup::from_path(&path, unit);
            let weld = t.number("weld");
            let scaled = weld.map(|tolerance| factor * tolerance);
            let (soup, changes) = soup.and_then(|soup| soup.mended(scaled, repair)).map_err(|e| told(&e))?;
            if let Some(changes) = changes {
                // Once, whatever the sizes.
                let key = format!("{} {weld:?} {repair}", path.display());
                context.note(key, format!("{}: {changes}", path.display()));
            }
            let mesh = TriangleMesh::try_from(soup).map_err(|e| {
                let remedy = if e.is_repairable() { "; repair = true mends some such faults" } else { "" };
                told(&format!("{e}{remedy}"))
            })?;
            let centre = Placement::read(&t).centre(&mesh);
            Ok(PlacedShape { shape: Arc::new(mesh), centre })
        }
        "formula" => {
            let shape = formula(body, key, &t, context, factor)?;
            let centre = shape.centre().coords;
            Ok(PlacedShape { shape: Arc::new(shape), centre })
        }
        _ => {
            let part = |t: &Reader<'_>| -> Result<Part, Problem> {
                let position = factor * t.vector_of("position", context.dim)?.unwrap_or_default();
                let pose = Pose { position: position.into(), orientation: orientation(t)? };
                let placed = shape(t, "shape", context, factor)?;
                Ok(Part { pose: placed.pose(pose), shape: placed.shape })
            };
            arc(Union::new(t.tables("parts").iter().map(part).collect::<Result<_, _>>()?), fail)
        }
    }
}

/// The unit of length of the mesh that the shape of the body in `t` is, if it is one \[m\].
pub(super) fn unit(t: &Reader<'_>) -> Option<f64> {
    let (kind, shape) = t.choice("shape", "type")?;
    (kind == "mesh").then(|| shape.number("unit").unwrap_or(1.0))
}

/// How the body in `t` is turned.
pub(super) fn orientation(t: &Reader<'_>) -> Result<Rotation, Problem> {
    if let Some(angle) = t.number("orientation") {
        return Ok(Rotation::from_axis_angle(&Vector::z_axis(), angle.to_radians()));
    }
    let Some(turn) = t.table("orientation") else { return Ok(Rotation::identity()) };
    let axis = axis(&turn, "axis")?;
    Ok(Rotation::from_axis_angle(&axis, turn.number("angle").unwrap_or(0.0).to_radians()))
}

/// The axis in `key`, or z.
pub(super) fn axis(t: &Reader<'_>, key: &str) -> Result<Unit<Vector>, Problem> {
    let axis = t.vector(key).unwrap_or(Vector::z());
    Unit::try_new(axis, 1e-150).ok_or_else(|| t.fail(key, "an axis of no length; give a direction"))
}
