//! Velocities of walls and of bodies' surfaces.
use super::motions::Motion;
use crate::expression::Expression;
use crate::problem::Problem;
use crate::reader::Reader;
use dem::Shape;
use fv_mesh::Side;
use interfaces::{Point, Solid, Vector};
use std::sync::Arc;

/// Variables of the velocity of a wall or of a body's surface.
const PLACE_TIME: [&str; 4] = ["x", "y", "z", "t"];

/// The wall with the velocity `velocity` of the table `t`, steady without it.
pub(super) fn wall(t: &Reader<'_>, dim: usize) -> Result<Side, Problem> {
    let Some(u) = t.formulas("velocity", &PLACE_TIME, dim)? else { return Ok(Side::WALL) };
    if let [Some(x), Some(y), Some(z)] = u.each_ref().map(Expression::fixed) {
        return Ok(Side::Wall([x, y, z]));
    }
    Ok(Side::moving_wall(move |x, t| u.each_ref().map(|u| u.needed(&[x[0], x[1], x[2], t]))))
}

/// Angular velocity at `key` as formulas of the time: about z, or a vector.
pub(super) fn spin(t: &Reader<'_>, key: &str, dim: usize) -> Result<Option<[Expression; 3]>, Problem> {
    let about_z = |rate| [Expression::constant(0.0), Expression::constant(0.0), rate];
    let spin = match t.formulas(key, &["t"], 3)? {
        Some(spin) => Some(spin),
        None => t.formula(key, &["t"])?.map(about_z),
    };
    let about = |a: usize| spin.as_ref().is_some_and(|spin| spin[a].fixed() != Some(0.0));
    if dim == 2 && (about(0) || about(1)) {
        return Err(t.fail(key, "bodies of a plane scene turn about z only; give a number"));
    }
    Ok(spin)
}

/// Velocity of a body's surface besides that of the body, in the body's frame: formulas of place and time, and a spin about the
/// centre of mass.
#[derive(Clone, Debug)]
pub(crate) struct SurfaceVelocity {
    linear: Option<[Expression; 3]>,
    spin: Option<[Expression; 3]>,
}

impl SurfaceVelocity {
    /// The keys `surface_velocity` and `surface_spin` of the body in `t`.
    pub(super) fn read(t: &Reader<'_>, motion: &Motion, dim: usize) -> Result<Option<Self>, Problem> {
        let linear = t.formulas("surface_velocity", &PLACE_TIME, dim)?;
        let spin = spin(t, "surface_spin", dim)?;
        let Some(key) = [("surface_velocity", linear.is_some()), ("surface_spin", spin.is_some())]
            .into_iter()
            .find_map(|(key, given)| given.then_some(key))
        else {
            return Ok(None);
        };
        if matches!(motion, Motion::Free(_)) {
            return Err(t.fail(
                key,
                "a surface that moves by itself is for bodies that are held; give motion \"fixed\" or \"prescribed\", or leave this out",
            ));
        }
        Ok(Some(Self { linear, spin }))
    }

    /// The velocity \[m/s\] at a place on or near the surface of `shape` and a time: its part along the surface.
    pub(crate) fn along(&self, shape: Arc<dyn Shape>) -> impl Fn(Point, f64) -> Vector + Send + Sync + use<> {
        let Self { linear, spin } = self.clone();
        let band = shape.bounding_radius();
        move |x, t| {
            let mut velocity = Vector::zeros();
            if let Some(u) = &linear {
                velocity += Vector::from(u.each_ref().map(|u| u.needed(&[x.x, x.y, x.z, t])));
            }
            if let Some(spin) = &spin {
                velocity += Vector::from(spin.each_ref().map(|s| s.needed(&[t]))).cross(&x.coords);
            }
            let normal = shape.normal(x, band);
            velocity - normal * normal.dot(&velocity)
        }
    }

    /// The largest speed \[m/s\] on `shape` at the ends of its axes at `time` \[s\].
    pub(crate) fn speed(&self, shape: &Arc<dyn Shape>, time: f64) -> f64 {
        let (along, bounds) = (self.along(shape.clone()), shape.aabb());
        let middle = nalgebra::center(&bounds.min, &bounds.max);
        let ends = (0..3).flat_map(|a| {
            [bounds.min, bounds.max].map(|end| {
                let mut x = middle;
                x[a] = end[a];
                x
            })
        });
        ends.map(|x| along(x, time).norm()).fold(0.0, f64::max)
    }
}
