//! A few neighbouring triangles and a box around them.
use super::oriented_box::OrientedBox;
use crate::shapes::triangle::{Part, Triangle};
use interfaces::{Point, Vector};
use std::ops::Range;

/// At most so many triangles go into a cluster.
const MOST: usize = 8;

/// Neighbouring triangles in a box along their mean normal. They are nearly plane, so the distance to this box is
/// nearly theirs: few clusters have to be opened to find the nearest of all triangles.
#[derive(Clone, Debug)]
pub(crate) struct Cluster {
    around: OrientedBox,
    pub(crate) faces: Range<u32>,
}

impl Cluster {
    /// Around the triangles with these numbers.
    pub(crate) fn new(triangles: &[Triangle], faces: Range<u32>) -> Self {
        let own = || &triangles[faces.start as usize..faces.end as usize];
        let normal: Vector = own().iter().map(Triangle::cross).sum();
        let normal = normal.try_normalize(0.0).unwrap_or_else(Vector::z);
        // Along the surface: towards the corner farthest from the first.
        let corners = || own().iter().flat_map(|t| t.corners());
        let start = own()[0].corners()[0];
        let level = |v: Vector| v - normal * normal.dot(&v);
        let far = |a: &Vector, b: &Vector| a.norm_squared().total_cmp(&b.norm_squared());
        let along = corners().map(|c| level(c - start)).max_by(far).and_then(|v| v.try_normalize(0.0));
        let along = along.unwrap_or_else(|| level(Vector::x()));
        Self { around: OrientedBox::along([along, normal.cross(&along), normal], corners()), faces }
    }

    /// The triangle nearest to `x`, if any is nearer than the root of `most`: the distance squared, and the
    /// triangle's number, x − point and where the point lies.
    #[inline]
    pub(crate) fn nearest(&self, triangles: &[Triangle], x: Point, most: f64) -> Option<(f64, Found)> {
        if self.around.square_distance(x.coords) >= most {
            return None;
        }
        let mut best = (most, None);
        for face in self.faces.clone() {
            let (away, part) = triangles[face as usize].nearest(x.coords);
            let square = away.norm_squared();
            if square < best.0 {
                best = (square, Some(Found { face, away, part }));
            }
        }
        best.1.map(|found| (best.0, found))
    }
}

/// The nearest point of a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Found {
    pub(crate) face: u32,
    /// From the point to where it was looked for from.
    pub(crate) away: Vector,
    pub(crate) part: Part,
}

/// Sorts faces by place and cuts them into clusters: the numbers of the triangles in each.
pub(crate) fn sort(faces: &mut [[u32; 3]], centre: &impl Fn(&[u32; 3]) -> Vector) -> Vec<Range<u32>> {
    let mut clusters = Vec::new();
    halve(faces, 0, centre, &mut clusters);
    clusters
}

fn halve(
    faces: &mut [[u32; 3]],
    first: u32,
    centre: &impl Fn(&[u32; 3]) -> Vector,
    out: &mut Vec<Range<u32>>,
) {
    if faces.len() <= MOST {
        out.push(first..first + faces.len() as u32);
        return;
    }
    let start = (Vector::repeat(f64::INFINITY), Vector::repeat(f64::NEG_INFINITY));
    let (low, high) = faces.iter().map(centre).fold(start, |(l, h), c| (l.inf(&c), h.sup(&c)));
    let axis = (high - low).imax();
    let middle = faces.len() / 2;
    faces.select_nth_unstable_by(middle, |a, b| centre(a)[axis].total_cmp(&centre(b)[axis]));
    let (below, above) = faces.split_at_mut(middle);
    halve(below, first, centre, out);
    halve(above, first + middle as u32, centre, out);
}
