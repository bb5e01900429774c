//! Convex regions, with edges and corners or without, and those that a few planes part into such: polyhedra around them.
//!
//! From a box, planes that touch one of the bodies are cut off, one after the other: rays from the deepest place to the corner
//! that is farthest out tell where. Flat faces are found at once and for good, so regions between bodies with flat faces come out
//! exactly. What is missing between a side and a curved surface below it is summed over rays to the side, on which the surface
//! falls away from the plane as a quadratic form; this leaves an error of the square of the number of sides. The gradient of the
//! volume and the moment follow from the rim, S = ½∮x × dx and −½∮|x|² dx (Feng 2021, Comput. Methods Appl. Mech. Eng. 373,
//! 113495).
//!
//! That the region is convex is held against every corner that is cut off: the distance of a convex body there is no less than
//! that of the plane, d(x) ≥ d(p) + ∇d(p)·(x − p). Where a flat face at an inward edge breaks this, the region is parted along
//! it (`parted.rs`).
mod flaw;
mod parted;
mod polytope;
mod rim;
mod seek;
mod view;

use super::around::Oriented;
use super::deepest::{Deepest, Search};
use crate::Overlap;
use flaw::Flaw;
use interfaces::{Point, Vector};
use nalgebra::Matrix3;
use parted::{Face, Piece};
use polytope::{Polytope, Side};
use rim::Rims;
use view::View;

/// Half-widths of the box at the beginning, in those that the region is guessed to have; no more than what the bodies' boxes share.
const WIDENED: [f64; 4] = [1.5, 4.0, 16.0, f64::INFINITY];
/// The number of sides at which volumes are compared.
const STAGES: [usize; 9] = [12, 17, 24, 34, 48, 66, 90, 122, 160];
/// Corners that stand out by less than this and cannot be cut off are left, too.
const SLIVER: f64 = 1e-3;
/// Corners that stand out by less than this share of the tolerance are left.
const LEFT: f64 = 0.03;

/// What was found of a region that is convex or parted into convex pieces, in the frame that it was looked for in.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Convex {
    /// A box around it.
    pub(crate) root: Oriented,
    /// A place in it.
    pub(crate) centre: Vector,
    totals: Totals,
    /// The sides of its pieces, among all that are kept.
    planes: [usize; 2],
}

/// Volume, its centroid, gradient and moment about the centroid.
#[derive(Clone, Copy, Debug, Default)]
struct Totals {
    volume: f64,
    centroid: Vector,
    gradient: Vector,
    moment: Vector,
}

impl Totals {
    /// Is the rim well known?
    fn is_known(&self) -> bool {
        self.gradient.x.is_finite()
    }
    /// As a frame sees it in which the axes of this one are the columns of `axes`, its origin is at `centre`.
    fn turn(&mut self, axes: &Matrix3<f64>, centre: Vector) {
        self.centroid = axes * self.centroid + centre;
        self.gradient = axes * self.gradient;
        self.moment = axes * self.moment;
    }
    fn add(&mut self, o: &Self) {
        let volume = self.volume + o.volume;
        let centroid = (self.volume * self.centroid + o.volume * o.centroid) / volume;
        let about = |t: &Self| t.moment + (t.centroid - centroid).cross(&t.gradient);
        let moment = about(self) + about(o);
        *self = Self { volume, centroid, gradient: self.gradient + o.gradient, moment };
    }
}

/// A side of a piece: n·x ≤ h.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    normal: Vector,
    height: f64,
    /// Is it the piece's last one?
    last: bool,
}

/// How far a place is from all pieces of these sides, no more than that; negative within.
fn outside(x: Vector, planes: &[Plane]) -> f64 {
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for plane in planes {
        most = most.max(plane.normal.dot(&x) - plane.height);
        if plane.last {
            least = least.min(most);
            most = f64::NEG_INFINITY;
        }
    }
    least
}

impl Convex {
    /// How far a place is from it, no more than that; negative within.
    pub(crate) fn outside(&self, x: Vector, planes: &[Plane]) -> f64 {
        outside(x, &planes[self.planes[0]..self.planes[1]])
    }
    /// As a frame sees it in which this one's axes are the columns of `axes`.
    pub(crate) fn turn(&mut self, axes: &Matrix3<f64>) {
        self.centre = axes * self.centre;
        self.root.turn(axes);
        self.totals.turn(axes, Vector::zeros());
    }
    /// As the world sees it, whose place `origin` is that of the search's frame.
    pub(crate) fn overlap(&self, origin: Point, between: Vector) -> Overlap {
        let Totals { volume, centroid, gradient, moment } = self.totals;
        let normal = (-gradient).try_normalize(0.0).unwrap_or(between);
        Overlap {
            volume,
            centroid: origin + centroid,
            normal,
            gradient,
            moment,
            pivot: nalgebra::Matrix3::zeros(),
        }
    }
}

/// Which regions are measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Which {
    /// Those between flat faces, and those with edges.
    WithEdges,
    All,
}

/// Why there is no answer.
enum Failure {
    /// The box at the beginning is too small.
    Small,
    /// This flat face of a body has a part of the body in front of it.
    Inward(Face),
    /// It is not convex, or too much for so few sides.
    Other,
}
const OTHER: Failure = Failure::Other;

/// A side that is no side of a convex region.
fn inward(view: &View<'_>, side: &Side) -> Failure {
    let face = side.body.map(|body| Face { body, normal: side.normal, foot: side.foot });
    face.filter(|face| view.is_flat(face)).map_or(OTHER, Failure::Inward)
}

/// Measures convex regions and keeps the memory of it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Circumscribed {
    polytope: Polytope,
    rims: Rims,
    /// Of all regions of a pair.
    pub(crate) planes: Vec<Plane>,
    pieces: Vec<Piece>,
    /// Along which regions are parted.
    faces: Vec<Face>,
}

impl Circumscribed {
    /// A place in both bodies if these are convex and share anything.
    pub(crate) fn seek(&mut self, search: &Search<'_>) -> Option<Deepest> {
        seek::seek(&mut self.polytope, search)
    }

    /// The region around a deepest place, if it is convex.
    fn piece(
        &mut self,
        search: &Search<'_>,
        deepest: &Deepest,
        tolerance: f64,
        which: Which,
    ) -> Result<Piece, Failure> {
        let around = search.around(deepest);
        let whole = Oriented { centre: Vector::zeros(), axes: Matrix3::identity(), half: 1.1 * search.half };
        let offset = around.axes.transpose() * (around.centre - deepest.at);
        let most = around.reach(&whole);
        for widened in WIDENED {
            let view = View::new(search, deepest, &around, tolerance);
            let half = widened * around.half;
            let ends = [offset + most[0].sup(&-half), offset + most[1].inf(&half)];
            match self.cut(&view, ends, tolerance, which) {
                Ok(totals) => return Ok(self.keep(deepest.at, around.axes, totals)),
                Err(Failure::Small) => {}
                Err(Failure::Inward(face)) => {
                    return Err(Failure::Inward(face.seen(&around.axes, deepest.at)));
                }
                Err(Failure::Other) => return Err(OTHER),
            }
        }
        Err(OTHER)
    }

    fn cut(
        &mut self,
        view: &View<'_>,
        [low, high]: [Vector; 2],
        tolerance: f64,
        which: Which,
    ) -> Result<Totals, Failure> {
        self.polytope.begin(low, high);
        let bound = |x: Vector| (0..3).any(|a| x[a] == low[a] || x[a] == high[a]);
        let mut fresh = 0;
        let mut last: Option<Totals> = None;
        let mut stage = 0;
        loop {
            for corner in &mut self.polytope.corners[fresh..] {
                corner.distances = view.distances(corner.x);
                corner.gap = view.gap(corner.distances);
                if corner.gap < -1e-3 {
                    return Err(if bound(corner.x) { Failure::Small } else { OTHER });
                }
            }
            let kept = self.polytope.corners.iter().enumerate().filter(|(_, c)| c.kept);
            let (worst, corner) = kept.max_by(|p, q| p.1.gap.total_cmp(&q.1.gap)).ok_or(OTHER)?;
            let (gap, target) = (corner.gap, *corner);
            let sides = self.polytope.sides.len();
            // What is left is no more than three times this.
            let exact = 3.0 * gap <= LEFT * tolerance;
            if exact || sides >= STAGES[stage] {
                if self.reaches_out(view, exact) {
                    return Err(Failure::Small);
                }
                if which == Which::WithEdges && !exact && stage == 0 && !self.has_edges(view) {
                    return Err(OTHER);
                }
                let totals = self.totals(view, exact)?;
                if exact && totals.is_known() {
                    return match self.polytope.flaw(view) {
                        None => Ok(totals),
                        Some(flaw) => Err(self.inward(view, flaw)),
                    };
                }
                if let Some(last) = last
                    && totals.is_known()
                    && self.polytope.alive().all(|s| s.body.is_some())
                    && (totals.volume - last.volume).abs() <= self.share(view) * tolerance * totals.volume
                    && (totals.gradient - last.gradient).norm()
                        <= 5.0 * tolerance * totals.gradient.norm().max(1e-3 * view.area)
                {
                    return Ok(totals);
                }
                last = Some(totals).filter(Totals::is_known);
                stage += 1;
                if exact || stage == STAGES.len() {
                    return Err(OTHER);
                }
            }
            let (mut worst, mut gap, mut target) = (worst, gap, target);
            if stage > 0
                && let Some(corner) = self.bound()
            {
                // What is left of the box at the beginning goes first; if it cannot be cut off, the region reaches there.
                target = self.polytope.corners[corner];
                (worst, gap) = (corner, target.gap);
                if gap <= SLIVER {
                    return Err(Failure::Small);
                }
            }
            fresh = match self.touch(view, worst, target.x, target.distances) {
                Ok(corners) => corners,
                // Beside an edge that is found already.
                Err(Failure::Other) if gap < SLIVER => {
                    self.polytope.corners[worst].gap = 0.0;
                    self.polytope.corners.len()
                }
                Err(failure) => return Err(failure),
            };
        }
    }

    /// Cuts off a corner; answers how many corners there were before.
    fn touch(
        &mut self,
        view: &View<'_>,
        corner: usize,
        mut to: Vector,
        mut d: [f64; 2],
    ) -> Result<usize, Failure> {
        // Still outside.
        let step = (0.3 * self.polytope.corners[corner].gap).min(0.04);
        for attempt in 1..5 {
            if let Some(side) = view.exit(to, d).and_then(|(body, x, d)| view.tangent(body, x, d)) {
                let slack = view.slack;
                let heights = self.polytope.look(&side);
                if heights[corner] > slack {
                    let body = side.body.ok_or(OTHER)?;
                    for (c, height) in self.polytope.corners.iter().zip(self.polytope.heights()) {
                        let least = side.slope * (0.98 * height - 1e-4 * (c.x - side.foot).norm());
                        if c.kept && *height > slack && c.distances[body] < least {
                            return Err(inward(view, &side));
                        }
                    }
                    return self.polytope.cut(side, slack).ok_or(OTHER);
                }
            }
            // Beside an edge of a body, or at the height of rounding: somewhat beside it.
            let corners = self.polytope.corners.iter().filter(|c| c.kept);
            let beside = corners.clone().nth(attempt * 7 % corners.clone().count()).ok_or(OTHER)?;
            to = to.lerp(&beside.x, step);
            d = view.distances(to);
        }
        Err(OTHER)
    }

    /// What becomes of a flaw.
    fn inward(&self, view: &View<'_>, flaw: Flaw) -> Failure {
        let side = match flaw {
            Flaw::Notch(x, d) => view.exit(x, d).and_then(|(body, x, d)| view.tangent(body, x, d)),
            Flaw::Beyond(number) => Some(self.polytope.sides[number]),
        };
        side.map_or(OTHER, |side| inward(view, &side))
    }

    /// The corner on a side of the box at the beginning that is farthest out.
    fn bound(&self) -> Option<usize> {
        let corners = &self.polytope.corners;
        let bounds = self.polytope.alive().filter(|s| s.body.is_none());
        let on = bounds.flat_map(|s| s.ring().iter().map(|c| usize::from(c[0])));
        on.max_by(|p, q| corners[*p].gap.total_cmp(&corners[*q].gap))
    }

    /// Does the region come to a side of the box at the beginning? It does if one is `left` of them in the end.
    fn reaches_out(&self, view: &View<'_>, left: bool) -> bool {
        self.polytope.alive().filter(|s| s.body.is_none()).any(|side| {
            let middle: Vector = side.ring().iter().map(|c| self.polytope.corners[usize::from(c[0])].x).sum();
            let [a, b] = view.distances(middle / side.ring().len() as f64);
            left || a.max(b) < 0.0
        })
    }

    /// Of the tolerance, by how much volumes may differ: where all is smooth they fall slowly.
    fn share(&self, view: &View<'_>) -> f64 {
        if self.has_edges(view) { 0.15 } else { 0.06 }
    }

    /// Are there edges of a body in the region's surface? There sides meet at an angle and on the surface.
    fn has_edges(&self, view: &View<'_>) -> bool {
        let Polytope { corners, sides, .. } = &self.polytope;
        self.polytope.alive().any(|side| {
            side.body.is_some_and(|body| {
                let near = |c: usize| corners[c].distances[body].abs() <= view.slack;
                side.edges().any(|[from, to, across]| {
                    let other = &sides[across];
                    let bends = other.body == Some(body) && other.normal.dot(&side.normal) < 0.98;
                    bends && near(from) && near(to)
                })
            })
        })
    }

    fn totals(&mut self, view: &View<'_>, flat: bool) -> Result<Totals, Failure> {
        let mut totals = Totals::default();
        let mut first = Vector::zeros();
        let Polytope { corners, sides, .. } = &mut self.polytope;
        for side in sides.iter_mut().filter(|s| !s.ring().is_empty()) {
            let x = |c: usize| corners[c].x - side.foot;
            let (mut area, mut centre) = (0.0, Vector::zeros());
            for [i, j, _] in side.edges() {
                let own = 0.5 * x(i).cross(&x(j)).dot(&side.normal);
                area += own;
                centre += own / 3.0 * (x(i) + x(j));
            }
            if side.changed && !flat {
                (side.deficit, side.first) = view.deficit(side, corners).ok_or(OTHER)?;
                side.changed = false;
            }
            let (deficit, off) = if flat { (0.0, Vector::zeros()) } else { (side.deficit, side.first) };
            let third = side.height / 3.0;
            totals.volume += third * (area - deficit);
            first += third * (0.75 * (area * side.foot + centre) - off);
        }
        if totals.volume.is_nan() || totals.volume <= 0.0 {
            return Err(OTHER);
        }
        totals.centroid = first / totals.volume;
        let unknown = (Vector::repeat(f64::NAN), Vector::zeros());
        let (gradient, moment) = self.rims.around(view, &self.polytope).unwrap_or(unknown);
        totals.gradient = gradient;
        totals.moment = moment - totals.centroid.cross(&gradient);
        Ok(totals)
    }

    /// What was cut out around `centre`, along `axes`, as the search's frame sees it; its sides are kept.
    fn keep(&mut self, centre: Vector, axes: Matrix3<f64>, mut totals: Totals) -> Piece {
        let plane = |s: &Side| {
            let normal = axes * s.normal;
            Plane { normal, height: s.height + normal.dot(&centre), last: false }
        };
        self.planes.extend(self.polytope.alive().map(plane));
        if let Some(plane) = self.planes.last_mut() {
            plane.last = true;
        }
        let kept = || self.polytope.corners.iter().filter(|c| c.kept).map(|c| c.x);
        let low = kept().fold(Vector::repeat(f64::INFINITY), |l, x| l.inf(&x));
        let high = kept().fold(Vector::repeat(f64::NEG_INFINITY), |h, x| h.sup(&x));
        let root = Oriented { centre: centre + axes * (0.5 * (low + high)), axes, half: 0.5 * (high - low) };
        totals.turn(&axes, centre);
        Piece { root, totals }
    }
}
