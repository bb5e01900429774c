//! Two ellipsoids: integrals along the curve where their surfaces cross.
mod cap;
mod common_point;
mod meridian;

use super::{Overlap, doubling::Doubling};
use cap::Cap;
use common_point::{CommonPoint, Meeting, Nearer, nearer, towards};
use interfaces::{Point, Pose, Vector};
use meridian::{MOST, Quadric};
use nalgebra::Matrix3;
use std::f64::consts::TAU;

/// Azimuths to begin with.
const FIRST: usize = 4;

/// A posed ellipsoid: f(x) = |E⁻¹ Rᵀ(x − c)|² − 1 < 0 inside.
#[derive(Clone, Copy)]
pub(super) struct Posed {
    semi_axes: Vector,
    /// From the body's frame to the world.
    turn: Matrix3<f64>,
    position: Point,
    /// Centre, as seen from the first body's.
    centre: Vector,
}

impl Posed {
    pub(super) fn new(semi_axes: Vector, at: &Pose, origin: Point) -> Self {
        let turn = at.orientation.to_rotation_matrix().into_inner();
        Self { semi_axes, turn, position: at.position, centre: at.position - origin }
    }
    /// To the frame in which the body is the unit ball.
    fn to_ball(self) -> Matrix3<f64> {
        Matrix3::from_diagonal(&self.semi_axes.map(|e| 1.0 / e)) * self.turn.transpose()
    }
    fn ball_to_world(self) -> Matrix3<f64> {
        self.turn * Matrix3::from_diagonal(&self.semi_axes)
    }
    fn whole(&self, direction: Vector) -> Overlap {
        Overlap::whole(2.0 / 3.0 * TAU * self.semi_axes.product(), self.position, direction)
    }
}

/// What the curve says.
pub(super) enum Found {
    /// The overlap, if there is one.
    Overlap(Option<Overlap>),
    /// More than one curve, or one that turns back: this is for another route.
    Tangled,
}

/// The overlap of two ellipsoids to a share of `tolerance` of its volume.
///
/// The point p where max(f_A, f_B) is least (Perram & Wertheim 1985, J. Comput. Phys. 58, 409) minimises some
/// G = λf_A + (1 − λ)f_B as well. So the curve, where both are zero, lies on the ellipsoid G = 0 about p, which is made the
/// unit sphere; on it A is the nearer body where D = f_A − f_B > 0. Volume and first moment are sums over both bodies of
/// what lies between p and the nearer one's surface, each an integral along the curve ([`Cap`]) that loses no digits in shallow
/// overlaps; S = ½∮x × dx, and the moment is −½∮|x|²dx.
pub(super) fn overlap(a: Posed, b: Posed, tolerance: f64) -> Found {
    let common = match common_point::find(&a, &b) {
        Meeting::Apart => return Found::Overlap(None),
        Meeting::Unclear => return Found::Tangled,
        Meeting::At(common) => common,
    };
    // Where D has different signs at both poles, one curve about the pole is likely.
    if common.quadric[(2, 2)].abs() < 2.0 * common.lean
        && let Some(found) = Sweep::new(a, b, &common, Vector::z()).integrate(tolerance)
    {
        return Found::Overlap(found);
    }
    let upwards = common.axes.column(2).normalize();
    match nearer(common.lean, &common.quadric) {
        Nearer::Always(0) => Found::Overlap(Some(a.whole(-upwards))),
        Nearer::Always(_) => Found::Overlap(Some(b.whole(-upwards))),
        Nearer::Either(axes) => {
            for axis in axes {
                if let Some(found) = Sweep::new(a, b, &common, axis).integrate(tolerance) {
                    return Found::Overlap(found);
                }
            }
            Found::Tangled
        }
    }
}

/// The curve, followed around an axis.
struct Sweep {
    a: Posed,
    b: Posed,
    point: Vector,
    axes: Matrix3<f64>,
    quadric: Quadric,
    sums: Sums,
}

/// Integrals along the curve.
struct Sums {
    caps: [Cap; 2],
    /// S, and −½∮|x|²dx.
    area: Vector,
    moment: Vector,
}

impl Sums {
    fn add(&mut self, axes: &Matrix3<f64>, w: Vector, dw: Vector) {
        self.caps.iter_mut().for_each(|cap| cap.add(w, dw));
        let (x, dx) = (axes * w, axes * dw);
        self.area += 0.5 * x.cross(&dx);
        self.moment -= 0.5 * x.norm_squared() * dx;
    }
}

impl Sweep {
    fn new(a: Posed, b: Posed, common: &CommonPoint, axis: Vector) -> Self {
        let turn = towards(axis);
        let axes = common.axes * turn;
        let lean = turn.row(2).transpose() * common.lean;
        let quadric = Quadric { lean, form: turn.tr_mul(&(common.quadric * turn)) };
        let point = common.point;
        let caps = [Cap::new(&a, point, &axes), Cap::new(&b, point, &axes)];
        let sums = Sums { caps, area: Vector::zeros(), moment: Vector::zeros() };
        Self { a, b, point, axes, quadric, sums }
    }
    /// The integrals over N azimuths, doubled until the volume has settled; `None` unless the curve crosses each
    /// meridian equally often.
    fn integrate(mut self, tolerance: f64) -> Option<Option<Overlap>> {
        let mut taus = [0.0; MOST];
        // Where the curve is far from a great circle, few azimuths may miss what lies between them.
        let enough = if self.quadric.form.norm() < 0.5 * self.quadric.lean.z { 2 * FIRST } else { 8 * FIRST };
        let mut doubling = Doubling::new(tolerance);
        let (mut around, mut crossings) = (FIRST, None);
        loop {
            let stride = MOST / around;
            let (start, step) = if around == FIRST { (0, stride) } else { (stride, 2 * stride) };
            // Where to see the caps from is known after the first ring only.
            let (mut first, mut kept) = ([[Vector::zeros(); 2]; 4 * FIRST], 0);
            for k in (start..MOST).step_by(step) {
                let meridian = self.quadric.meridian(TAU * k as f64 / MOST as f64);
                let guess = if around > FIRST {
                    0.5 * (taus[k - stride] + taus[(k + stride) % MOST])
                } else {
                    meridian.guess()
                };
                let mut count = 0;
                taus[k] = meridian.crossings(guess, &mut |w, dw| {
                    count += 1;
                    if around > FIRST {
                        self.sums.add(&self.axes, w, dw);
                    } else if kept < first.len() {
                        first[kept] = [w, dw];
                        kept += 1;
                    }
                })?;
                if count == 0 || *crossings.get_or_insert(count) != count {
                    return None;
                }
            }
            if around == FIRST {
                let middle = first[..kept].iter().map(|[w, _]| w).sum::<Vector>() / kept as f64;
                self.sums.caps[0].aim(middle, &self.b);
                self.sums.caps[1].aim(middle, &self.a);
                first[..kept].iter().for_each(|[w, dw]| self.sums.add(&self.axes, *w, *dw));
            }
            let weight = TAU / around as f64;
            let caps = &self.sums.caps;
            let volume = caps[0].volume(weight) + caps[1].volume(-weight);
            if doubling.settled(volume, self.sums.area.norm() * weight)
                && (around >= enough || doubling.still())
            {
                let gradient = self.sums.area * weight;
                let middle = (caps[0].first(weight) + caps[1].first(-weight)) / volume;
                return Some((volume > 0.0).then(|| Overlap {
                    volume,
                    centroid: self.a.position + (self.point + middle),
                    normal: (-gradient).try_normalize(0.0).unwrap_or(-self.axes.column(2).normalize()),
                    gradient,
                    moment: self.sums.moment * weight - middle.cross(&gradient),
                }));
            }
            if around == MOST {
                return None;
            }
            around *= 2;
        }
    }
}
