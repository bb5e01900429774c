//! Motions of bodies.
use super::{Context, shapes, surfaces, tables};
use crate::expression::Expression;
use crate::problem::Problem;
use crate::reader::Reader;
use dem::PrescribedMotion;
use interfaces::{Freedom, Point, Vector};
use nalgebra::Unit;

/// What moves a body.
#[derive(Clone, Debug)]
pub(crate) enum Motion {
    /// The flow, gravity and contacts, as far as it is free.
    Free(Freedom),
    Fixed,
    Prescribed(Box<Prescribed>),
}

/// Motion by functions of the time.
#[derive(Clone, Debug)]
pub(crate) struct Prescribed {
    /// Displacement \[m\], or velocity \[m/s\].
    shift: Option<[Expression; 3]>,
    velocity: Option<[Expression; 3]>,
    /// Angle \[rad\] about an axis through the pivot, or the centre of mass without one.
    turn: Option<(Expression, Unit<Vector>)>,
    /// Angular velocity about the centre of mass \[rad/s\].
    spin: Option<[Expression; 3]>,
    pivot: Option<Point>,
}

impl Motion {
    /// The motion by functions of time of a body whose centre of mass is here at the start, if it is
    /// one.
    pub(crate) fn prescribed(&self, centre: Point) -> Option<PrescribedMotion> {
        let Self::Prescribed(prescribed) = self else { return None };
        let Prescribed { shift, velocity, turn, spin, pivot } = (**prescribed).clone();
        let mut motion = PrescribedMotion::default().with_pivot(pivot.unwrap_or(centre), centre);
        let vector = |f: [Expression; 3]| move |t: f64| Vector::from(f.each_ref().map(|f| f.at(&[t])));
        if let Some(shift) = shift {
            motion = motion.with_shift(vector(shift));
        }
        if let Some(velocity) = velocity {
            motion = motion.with_velocity(vector(velocity));
        }
        if let Some(spin) = spin {
            motion = motion.with_spin(vector(spin));
        }
        if let Some((angle, axis)) = turn {
            motion = motion.with_turn(axis, move |t| angle.at(&[t]));
        }
        Some(motion)
    }
    /// Notes whether the functions have a value at `t` \[s\].
    pub(crate) fn try_at(&self, t: f64) {
        if let Self::Prescribed(prescribed) = self {
            let Prescribed { shift, velocity, turn, spin, .. } = &**prescribed;
            let vectors = [shift, velocity, spin].into_iter().flatten().flatten();
            vectors.chain(turn.iter().map(|(angle, _)| angle)).for_each(|f| {
                f.needed(&[t]);
            });
        }
    }
}

/// What a body is free to do in a scene of so many dimensions.
pub(super) fn freedom(dim: usize) -> Freedom {
    if dim == 2 { Freedom::PLANAR } else { Freedom::FREE }
}

/// The key `motion` of the body in `t`.
pub(super) fn read(t: &Reader<'_>, context: &Context<'_>) -> Result<Motion, Problem> {
    let dim = context.dim;
    let Some((kind, motion)) = t.choice("motion", "type") else { return Ok(Motion::Free(freedom(dim))) };
    Ok(match kind {
        "fixed" => Motion::Fixed,
        "planar" => Motion::Free(Freedom::PLANAR),
        "axes" => {
            let all = freedom(dim);
            let both = |a: [bool; 3], b: [bool; 3]| std::array::from_fn(|i| a[i] && b[i]);
            let linear = both(motion.flags("linear").unwrap_or_default(), all.linear);
            let angular = both(motion.flags("angular").unwrap_or_default(), all.angular);
            Motion::Free(Freedom { linear, angular })
        }
        "prescribed" => by_formulas(&motion, dim)?,
        "table" => {
            let [x, y, z, turn] = tables::read(&motion, "file", context, ["x", "y", "z", "angle"], 0)?;
            if dim == 2 && z.is_some() {
                return Err(motion.fail("file", "a plane scene has no axis z; leave out that column"));
            }
            let shift = [x, y, z].map(|column| column.unwrap_or(Expression::constant(0.0)));
            prescribed(&motion, dim, [Some(shift), None, None], turn)?
        }
        _ => Motion::Free(freedom(dim)),
    })
}

/// The motion by formulas of the table `t`.
fn by_formulas(t: &Reader<'_>, dim: usize) -> Result<Motion, Problem> {
    for [one, other] in [["shift", "velocity"], ["angle", "spin"]] {
        if t.has(one) && t.has(other) {
            let message = format!("`{one}` is given already; leave out one of the two");
            return Err(t.fail(other, message));
        }
    }
    let turn = t.formula("angle", &["t"])?;
    let spin = surfaces::spin(t, "spin", dim)?;
    let shift = t.formulas("shift", &["t"], dim)?;
    let velocity = t.formulas("velocity", &["t"], dim)?;
    if shift.is_none() && velocity.is_none() && turn.is_none() && spin.is_none() {
        return Err(t.fail_here(
            "how does it move? Give `shift`, `velocity`, `angle` or `spin`, or make it \"fixed\"",
        ));
    }
    prescribed(t, dim, [shift, velocity, spin], turn)
}

/// The motion by functions of time of the table `t`, about its axis and pivot.
fn prescribed(
    t: &Reader<'_>,
    dim: usize,
    [shift, velocity, spin]: [Option<[Expression; 3]>; 3],
    turn: Option<Expression>,
) -> Result<Motion, Problem> {
    let axis = shapes::axis(t, "axis")?;
    if dim == 2 && (axis.x != 0.0 || axis.y != 0.0) {
        return Err(t.fail("axis", "bodies of a plane scene turn about z only; leave this out"));
    }
    let pivot = t.point_of("pivot", dim)?;
    if pivot.is_some() && turn.is_none() {
        return Err(t.fail("pivot", "nothing turns about it; give `angle`, or leave this out"));
    }
    let turn = turn.map(|angle| (angle, axis));
    Ok(Motion::Prescribed(Box::new(Prescribed { shift, velocity, turn, spin, pivot })))
}
