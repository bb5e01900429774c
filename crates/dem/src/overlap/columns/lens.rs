//! Overlaps like lenses: columns from the second body's surface up to the first's.
use super::pair::View;
use super::rules::{RADIAL, Radial};
use crate::overlap::doubling::Doubling;
use crate::overlap::integrals::Integrals;
use interfaces::Vector;
use std::f64::consts::TAU;

/// Meridians to begin with, and at most.
const FIRST: usize = 4;
const MOST: usize = 32;
/// Newton steps to the edge at most.
const STEPS: usize = 12;
/// Change of the edge that ends Newton's method, which squares it.
const EDGE: f64 = 1e-6;
/// The slope at the edge that the columns of a half-plane suggest may be wrong by this share of the thickness, for an error
/// of 1e-5 with 2, 4, 6 points.
const SLOPE: [f64; 3] = [0.004, 0.02, 0.05];

/// A place on the edge of the lens.
#[derive(Clone, Copy, Default)]
struct Edge {
    s: f64,
    z: f64,
}

/// Where the surfaces of both cross in the half-plane at an azimuth: the edge, its change with the azimuth, and the slope
/// of the thickness there.
struct Crossing {
    edge: Edge,
    change: Edge,
    slope: f64,
}

/// Five places of the edge, by Newton's method in as many half-planes.
pub(super) fn edge(views: &[View; 2]) -> Option<[Vector; 5]> {
    let mut places = [Vector::zeros(); 5];
    let mut guess = Edge { s: 1.0, z: 0.0 };
    for (k, place) in places.iter_mut().enumerate() {
        let (sin, cos) = (TAU * k as f64 / 5.0).sin_cos();
        guess = HalfPlane::new(views, cos, sin).crossing(guess)?.edge;
        *place = Vector::new(guess.s * cos, guess.s * sin, guess.z);
    }
    Some(places)
}

/// The lens between the bodies seen by `views`, in coordinates in which its edge is about the unit circle, to a share of
/// `tolerance` of its volume; `lengths` are those of the axes. `None` where it is no lens, or one too crooked for this.
///
/// In half-planes at N azimuths, doubled until the volume stays, Newton's method finds the edge. Gauss-Lobatto points
/// between the axis and the edge carry columns; thickness at the axis and the zero at the edge come free. The
/// integrals over the azimuth are trapezoidal and converge exponentially; S = ½∮x × dx and the moment −½∮|x|²dx are
/// integrals along the edge.
pub(super) fn lens(views: &[View; 2], lengths: [f64; 3], tolerance: f64) -> Option<Integrals> {
    let columns = Columns::new(views, lengths)?;
    let mut edges = [Edge::default(); MOST];
    let mut rule = 0;
    loop {
        match columns.around(views, &mut edges, rule, tolerance)? {
            Around::Done(sums) => return Some(sums),
            Around::Crooked => rule += 1,
        }
        if rule == RADIAL.len() {
            return None;
        }
    }
}

/// How the integral over the azimuth ended.
enum Around {
    Done(Integrals),
    /// More points are needed between the axis and the edge.
    Crooked,
}

/// Both bodies in the half-plane at an azimuth.
struct HalfPlane<'a> {
    views: &'a [View<'a>; 2],
    cos: f64,
    sin: f64,
    /// Its direction across, in each body's frame.
    out: [Vector; 2],
}

impl<'a> HalfPlane<'a> {
    fn new(views: &'a [View<'a>; 2], cos: f64, sin: f64) -> Self {
        Self { views, cos, sin, out: views.each_ref().map(|v| v.across(cos, sin)) }
    }
    /// Newton's method for both level functions at once.
    fn crossing(&self, guess: Edge) -> Option<Crossing> {
        let Edge { mut s, mut z } = guess;
        for _ in 0..STEPS {
            // Value, slope along s, along z, and along the azimuth.
            let [a, b] = [0, 1].map(|i| {
                let v = &self.views[i];
                let (f, g) = v.shape.level(v.origin + self.out[i] * s + v.axes[2] * z);
                let around = v.axes[1] * self.cos - v.axes[0] * self.sin;
                [f, g.dot(&self.out[i]), g.dot(&v.axes[2]), s * g.dot(&around)]
            });
            let det = a[1] * b[2] - a[2] * b[1];
            let (ds, dz) = ((a[2] * b[0] - b[2] * a[0]) / det, (b[1] * a[0] - a[1] * b[0]) / det);
            s += ds;
            z += dz;
            // Also catches what is not a number.
            if !(s > 0.0 && s < 1e3 && z.abs() < 1e3) {
                return None;
            }
            if ds.abs() + dz.abs() < EDGE {
                // The first is above, the second below, both surfaces lead outwards to the edge.
                if !(a[2] > 0.0 && b[2] < 0.0) {
                    return None;
                }
                let change =
                    Edge { s: (a[2] * b[3] - b[2] * a[3]) / det, z: (b[1] * a[3] - a[1] * b[3]) / det };
                let slope = s * (b[1] / b[2] - a[1] / a[2]);
                return Some(Crossing { edge: Edge { s, z }, change, slope });
            }
        }
        None
    }
    /// The column from the second body's surface up to the first's at the distance `s`, if nothing else bounds it.
    fn column(&self, s: f64) -> Option<[f64; 2]> {
        let [a, b] = [0, 1].map(|i| {
            let v = &self.views[i];
            v.shape.chord(v.origin + self.out[i] * s, v.axes[2])
        });
        let (a, b) = (a?, b?);
        (a[0] <= b[0] && a[1] <= b[1] && b[0] < a[1]).then_some([b[0], a[1]])
    }
}

/// What all half-planes share.
struct Columns {
    /// The column on the axis.
    axis: [f64; 2],
    lengths: [f64; 3],
}

impl Columns {
    fn new(views: &[View; 2], lengths: [f64; 3]) -> Option<Self> {
        Some(Self { axis: HalfPlane::new(views, 1.0, 0.0).column(0.0)?, lengths })
    }
    /// The integrals over all azimuths by the radial rule of this number; `None` where they do not settle.
    fn around(
        &self,
        views: &[View; 2],
        edges: &mut [Edge; MOST],
        rule: usize,
        tolerance: f64,
    ) -> Option<Around> {
        let (mut sums, mut doubling) = (Integrals::default(), Doubling::new(tolerance));
        let crooked = SLOPE[rule] * (tolerance / 1e-5).min(1.0).powf(0.4);
        let mut around = FIRST;
        while around <= MOST {
            let stride = MOST / around;
            // What was there before the doubling stays.
            let (start, step) = if around == FIRST { (0, stride) } else { (stride, 2 * stride) };
            for k in (start..MOST).step_by(step) {
                let guess = if around > FIRST {
                    let (low, high) = (edges[k - stride], edges[(k + stride) % MOST]);
                    Edge { s: 0.5 * (low.s + high.s), z: 0.5 * (low.z + high.z) }
                } else if k > 0 {
                    edges[k - stride]
                } else {
                    Edge { s: 1.0, z: 0.0 }
                };
                let (sin, cos) = (TAU * k as f64 / MOST as f64).sin_cos();
                let plane = HalfPlane::new(views, cos, sin);
                let crossing = plane.crossing(guess)?;
                let (part, miss) = self.meridian(&plane, &crossing, &RADIAL[rule])?;
                if miss > crooked {
                    return Some(Around::Crooked);
                }
                edges[k] = crossing.edge;
                sums = sums + part;
            }
            let mean = sums * (1.0 / around as f64);
            if doubling.settled(mean.volume, mean.area.z) {
                return Some(Around::Done(sums * (TAU / around as f64)));
            }
            around *= 2;
        }
        None
    }
    /// The integrals over a half-plane, and by how much the slope at the edge that they suggest is wrong.
    fn meridian(&self, plane: &HalfPlane, crossing: &Crossing, rule: &Radial) -> Option<(Integrals, f64)> {
        let Crossing { edge: Edge { s, z }, change, slope } = crossing;
        let [low, high] = self.axis;
        let thick = high - low;
        let mut volume = rule.at_zero * thick;
        let mut outward = 0.0;
        let mut upward = rule.at_zero * 0.5 * (high * high - low * low);
        let mut suggested = rule.slope_zero * thick;
        for [at, weight, part] in rule.points {
            let [low, high] = plane.column(s * at)?;
            let h = high - low;
            volume += weight * h;
            outward += weight * at * h;
            upward += weight * 0.5 * h * (high + low);
            suggested += part * h;
        }
        let (cos, sin, s2) = (plane.cos, plane.sin, s * s);
        let x = Vector::new(s * cos, s * sin, *z);
        let dx = Vector::new(change.s * cos - s * sin, change.s * sin + s * cos, change.z);
        let lengths = Vector::from(self.lengths);
        let square = x.component_mul(&lengths).norm_squared();
        let sums = Integrals {
            volume: s2 * volume,
            first: s2 * Vector::new(s * cos * outward, s * sin * outward, upward),
            area: 0.5 * x.cross(&dx),
            moment: -0.5 * square * dx.component_mul(&lengths),
        };
        Some((sums, (suggested - slope).abs() / thick))
    }
}
