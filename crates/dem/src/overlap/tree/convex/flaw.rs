//! Where a polyhedron around a region is more or less than the region.
//!
//! All corners of a polyhedron may be the region's, and the region may yet have a notch between them, or go on through a side.
//! On the sides all is near it; beside them, distances are held against those that a convex region would have; where they are less, the way to what is so
//! near is followed.
use super::polytope::{Polytope, Side};
use super::view::View;
use interfaces::Vector;

/// How far from a side it is looked, as a share of the way to the centre.
const BESIDE: f64 = 0.2;
/// How often a triangle of a side is divided, if it is larger than what its middle tells of.
const LEVELS: u32 = 2;
/// Distances so much less than those of a convex region are held for what they are.
const LESS: f64 = 0.25;
/// Steps along a way.
const STEPS: usize = 12;

impl Polytope {
    /// How it is not the region, if places on its sides and beside them tell.
    pub(super) fn flaw(&self, view: &View<'_>) -> Option<Flaw> {
        self.sides.iter().enumerate().filter(|(_, side)| !side.ring().is_empty()).find_map(
            |(number, side)| {
                let place = |c: usize| self.corners[c].x;
                let sum: Vector = side.edges().map(|[from, ..]| place(from)).sum();
                let middle = sum / side.ring().len() as f64;
                side.edges().find_map(|[from, to, over]| {
                    let triangle = [middle, place(from), place(to)];
                    // Once for both sides.
                    let on_edge = (number < over).then(|| on(view, place(from).lerp(&place(to), 0.5)));
                    let notch = on_edge.flatten().or_else(|| self.below(view, triangle, LEVELS));
                    let notch = notch.map(|(x, d)| Flaw::Notch(x, d));
                    notch.or_else(|| above(view, side, triangle, LEVELS).then_some(Flaw::Beyond(number)))
                })
            },
        )
    }

    /// How far a place within is from the surface, and how deep it is by distances that grow as they do across the sides.
    fn depth(&self, x: Vector) -> [f64; 2] {
        self.alive().fold([f64::INFINITY; 2], |[way, depth], side| {
            let height = side.height - side.normal.dot(&x);
            [way.min(height), depth.min(side.slope * height)]
        })
    }

    /// A place that is outside the region below a triangle of a side, and both distances there.
    fn below(&self, view: &View<'_>, triangle: [Vector; 3], levels: u32) -> Option<(Vector, [f64; 2])> {
        if let Some(found) = on(view, middle(triangle)) {
            return Some(found);
        }
        let y = (1.0 - BESIDE) * middle(triangle);
        let [reach, depth] = self.depth(y);
        let here = view.distances(y);
        let level = here[0].max(here[1]);
        if -level < (1.0 - LESS) * depth
            && let Some(found) = self.out(view, y, here)
        {
            return Some(found);
        }
        let parts = parts(triangle, levels, reach)?;
        parts.into_iter().find_map(|part| self.below(view, part, levels - 1))
    }

    /// Towards what is near a place: out of the region, still deep in the polyhedron.
    fn out(&self, view: &View<'_>, mut x: Vector, mut d: [f64; 2]) -> Option<(Vector, [f64; 2])> {
        let body = usize::from(d[1] > d[0]);
        let way = view.slope(body, x, d[body]).try_normalize(1e-9)?;
        let [reach, _] = self.depth(x);
        for _ in 0..STEPS {
            if d[body] > view.slack {
                return Some((x, d));
            }
            x += (1.05 * d[body].abs()).max(0.02 * reach) * way;
            if self.depth(x)[0] < 0.05 * reach {
                return None;
            }
            d = view.distances(x);
        }
        None
    }
}

/// Where a polyhedron is not the region.
pub(super) enum Flaw {
    /// A place that is outside the region, and the distances there.
    Notch(Vector, [f64; 2]),
    /// The region goes on beyond this side.
    Beyond(usize),
}

/// A place of a side that is outside the region.
fn on(view: &View<'_>, x: Vector) -> Option<(Vector, [f64; 2])> {
    let d = view.distances(x);
    (d[0].max(d[1]) > view.small).then_some((x, d))
}

/// Is any of the region above a triangle of a side?
fn above(view: &View<'_>, side: &Side, triangle: [Vector; 3], levels: u32) -> bool {
    let Some(body) = side.body else { return false };
    let reach = BESIDE * side.height;
    let y = middle(triangle) + reach * side.normal;
    let d = view.distance(body, y);
    (d < (1.0 - LESS) * side.slope * reach && into(view, side, body, y, d))
        || parts(triangle, levels, reach)
            .is_some_and(|parts| parts.into_iter().any(|part| above(view, side, part, levels - 1)))
}

/// Towards what of a body is near a place above a side: is it a part of the region?
fn into(view: &View<'_>, side: &Side, body: usize, mut x: Vector, mut d: f64) -> bool {
    let Some(way) = (-view.slope(body, x, d)).try_normalize(1e-9) else { return false };
    for _ in 0..STEPS {
        if d < -view.slack {
            return side.normal.dot(&x) - side.height > view.slack
                && view.distance(1 - body, x) < -view.slack;
        }
        x += (1.05 * d / side.slope).max(0.02 * BESIDE * side.height) * way;
        d = view.distance(body, x);
    }
    false
}

fn middle([a, b, c]: [Vector; 3]) -> Vector {
    (a + b + c) / 3.0
}

/// Its quarters, if what is known within `reach` of its middle says too little of it.
fn parts([a, b, c]: [Vector; 3], levels: u32, reach: f64) -> Option<[[Vector; 3]; 4]> {
    let size = (a - b).norm_squared().max((b - c).norm_squared()).max((c - a).norm_squared());
    let [p, q, r] = [0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)];
    (levels > 0 && size > 4.0 * reach * reach).then_some([[a, p, r], [p, b, q], [r, q, c], [p, q, r]])
}
