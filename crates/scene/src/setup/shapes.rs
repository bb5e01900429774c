//! Shapes.
use super::Context;
use crate::problem::Problem;
use crate::reader::Reader;
use dem::{
    Capsule, ConvexPolyhedron, Cuboid, Cylinder, Disc, Ellipsoid, Part, Shape, Sphere, TriangleMesh, Union,
};
use interfaces::{Pose, Rotation, Vector};
use nalgebra::Unit;
use std::sync::Arc;

/// A shape that can be made in any size.
pub(crate) type Recipe<'a> = Box<dyn Fn(f64) -> Result<Arc<dyn Shape>, Problem> + 'a>;

/// The shape in `key`, to be enlarged by a factor.
pub(super) fn recipe<'a>(body: &'a Reader<'a>, key: &'static str, context: &'a Context<'_>) -> Recipe<'a> {
    Box::new(move |factor| shape(body, key, context, factor))
}

/// The shape in `key`, enlarged by `factor`.
pub(super) fn shape(
    body: &Reader<'_>,
    key: &str,
    context: &Context<'_>,
    factor: f64,
) -> Result<Arc<dyn Shape>, Problem> {
    let Some((kind, t)) = body.choice(key, "type") else {
        return Err(body.fail(key, "the shape is missing"));
    };
    let length = |key: &str| factor * t.number(key).unwrap_or(0.0);
    let fail = |e: &dyn std::fmt::Display| body.fail(key, e);
    let triple = |key: &str| -> [f64; 3] { (factor * t.vector(key).unwrap_or_default()).into() };
    fn arc<E: std::fmt::Display>(
        shape: Result<impl Shape + 'static, E>,
        fail: impl Fn(&dyn std::fmt::Display) -> Problem,
    ) -> Result<Arc<dyn Shape>, Problem> {
        match shape {
            Ok(shape) => Ok(Arc::new(shape)),
            Err(e) => Err(fail(&e)),
        }
    }
    match kind {
        "disc" if context.dim == 3 => {
            Err(fail(&"a disc is for plane scenes; take a sphere or a cylinder in space"))
        }
        "disc" => arc(Disc::new(length("radius")), fail),
        "sphere" if context.dim == 2 => {
            Err(fail(&"a sphere is for scenes in space; take a disc in the plane"))
        }
        "sphere" => arc(Sphere::new(length("radius")), fail),
        "ellipsoid" => arc(Ellipsoid::new(triple("semi_axes")), fail),
        "capsule" => arc(Capsule::new(length("radius"), length("length")), fail),
        "cylinder" => arc(Cylinder::new(length("radius"), length("length")), fail),
        "box" => {
            t.has_dim("edges", context.dim)?;
            let mut edges = triple("edges");
            if context.dim == 2 {
                // Far enough along z that only the sides count in the plane.
                edges[2] = 100.0 * (edges[0] + edges[1]);
            }
            arc(Cuboid::new(edges), fail)
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
            let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
            let told = |e: &dyn std::fmt::Display| t.fail("file", format!("{}: {e}", path.display()));
            match extension.as_deref() {
                Some("stl") => arc(TriangleMesh::from_stl(&path, unit), told),
                Some("obj") => arc(TriangleMesh::from_obj(&path, unit), told),
                _ => Err(told(&"which format? The name has to end in .stl or .obj")),
            }
        }
        _ => {
            let part = |t: &Reader<'_>| -> Result<Part, Problem> {
                let position = factor * t.vector_of("position", context.dim)?.unwrap_or_default();
                let pose = Pose { position: position.into(), orientation: orientation(t)? };
                Ok(Part { shape: shape(t, "shape", context, factor)?, pose })
            };
            arc(Union::new(t.tables("parts").iter().map(part).collect::<Result<_, _>>()?), fail)
        }
    }
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
