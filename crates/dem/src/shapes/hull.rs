//! The convex hull of points.
mod facets;
mod quickhull;
#[cfg(test)]
mod tests;

use crate::DemError;
use interfaces::{Point, Vector};

/// Coplanar up to this share of the size, facets are one.
const FLAT: f64 = 1e-12;
/// No coordinate may be larger \[m\]: products of three are finite.
const LARGEST: f64 = 1e50;

/// The convex hull of `points` \[m\]: its corners and its faces, each a loop of corners, counter-clockwise seen from outside.
///
/// Found by quickhull (Barber, Dobkin & Huhdanpaa 1996, ACM Trans. Math. Softw. 22, 469) with exact predicates: whatever
/// the points, no face is missed and none is turned. What is plane up to 1e-12 of the size is one face, and points on
/// its inside or within its edges, up to as much, are no corners.
///
/// # Errors
/// [`DemError::TooFewPoints`], [`DemError::PointNotFinite`], [`DemError::PointsOnLine`] (also those at one place) and
/// [`DemError::PointsOnPlane`].
pub(crate) fn hull(points: &[[f64; 3]]) -> Result<(Vec<Point>, Vec<Vec<u32>>), DemError> {
    if points.len() < 4 {
        return Err(DemError::TooFewPoints { points: points.len() });
    }
    if let Some(point) = points.iter().position(|p| !p.iter().all(|x| x.abs() <= LARGEST)) {
        return Err(DemError::PointNotFinite { point, position: points[point] });
    }
    let largest = points.as_flattened().iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    // By a power of two, which commits no rounding.
    let scale = 2.0_f64.powi(-largest.max(1e-300).log2().ceil() as i32);
    let scaled: Vec<[f64; 3]> = points.iter().map(|p| p.map(|x| predicate(x * scale))).collect();
    let (start, size) = start(&scaled, scale)?;
    let triangles = quickhull::quickhull(&scaled, start);
    // Coordinates have round-off themselves.
    let flat = FLAT * size + 4.0 * f64::EPSILON;
    let faces = facets::merged(&scaled, &triangles, flat)
        .unwrap_or_else(|| triangles.iter().map(|t| t.to_vec()).collect());
    // Corners are counted in the order in which the points were given.
    let mut used: Vec<u32> = faces.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    let number = |v: u32| used.partition_point(|u| *u < v) as u32;
    let faces = faces.iter().map(|f| f.iter().map(|v| number(*v)).collect()).collect();
    Ok((used.iter().map(|v| Point::from(points[*v as usize])).collect(), faces))
}

/// A coordinate, no larger than 1, as exact predicates take it: products of three that are not 0 do not underflow.
pub(crate) fn predicate(x: f64) -> f64 {
    if x.abs() < 1e-60 { 0.0 } else { x }
}

/// Four points that are not on a plane, far apart, and the largest extent. `scale` is what the points were multiplied by.
fn start(points: &[[f64; 3]], scale: f64) -> Result<([u32; 4], f64), DemError> {
    let at = |i: usize| Vector::from(points[i]);
    let farthest = |far: &dyn Fn(Vector) -> f64| {
        let distances = points.iter().map(|p| far(Vector::from(*p)));
        distances.enumerate().fold((0, -1.0), |best, (i, d)| if d > best.1 { (i, d) } else { best })
    };
    let low = points.iter().fold(Vector::repeat(f64::INFINITY), |low, p| low.inf(&Vector::from(*p)));
    let high = points.iter().fold(Vector::repeat(f64::NEG_INFINITY), |high, p| high.sup(&Vector::from(*p)));
    let (axis, size) = ((high - low).imax(), (high - low).max());
    let flat = FLAT * size + 4.0 * f64::EPSILON;
    let a = farthest(&|p| high[axis] - p[axis]).0;
    let (b, length) = farthest(&|p| (p - at(a)).norm());
    let along = (at(b) - at(a)) / length;
    let (c, width) = farthest(&|p| along.cross(&(p - at(a))).norm());
    // −1 where the length is 0.
    if width <= flat {
        return Err(DemError::PointsOnLine { width: width.max(0.0) / scale, size: size / scale });
    }
    let normal = along.cross(&(at(c) - at(a))) / width;
    let (d, height) = farthest(&|p| normal.dot(&(p - at(a))).abs());
    if height <= flat {
        return Err(DemError::PointsOnPlane { height: height.max(0.0) / scale, size: size / scale });
    }
    Ok(([a, b, c, d].map(|i| i as u32), size))
}
