//! Flat-faced bodies and plane walls.
use super::Overlap;
use super::facets::Groups;
use crate::HalfSpace;
use crate::shapes::{Facets, WIDTH};
use interfaces::{Point, Pose, Vector};

/// Cuts closed surfaces of triangles at a plane; keeps the memory that this takes.
///
/// Sums are taken about a point of the plane, so that the cut face itself adds nothing to them. Every edge is cut once for both its
/// faces, by the signs of its ends, so surfaces stay closed however these are rounded.
#[derive(Clone, Debug, Default)]
pub(crate) struct HalfSpaceOverlap {
    faces: Vec<u32>,
    /// Heights above the plane, of vertices that were looked at in this run.
    heights: Vec<(u32, f64)>,
    run: u32,
    /// Groups of vertices behind the plane.
    numbers: Vec<u32>,
    behind: Vec<u32>,
    groups: Groups,
    stack: Vec<u32>,
}

impl HalfSpaceOverlap {
    /// Whether [`Overlap::pivot`] is requested.
    pub(crate) fn set_pivots(&mut self, pivots: bool) {
        self.groups.pivots = pivots;
    }

    /// One patch per connected region that the body shares with the wall.
    pub(crate) fn overlap(&mut self, body: &Facets, at: &Pose, wall: &HalfSpace, out: &mut Vec<Overlap>) {
        let to_body = |v: Vector| at.orientation.inverse_transform_vector(&v);
        let normal = to_body(wall.normal());
        let offset = -wall.signed_distance(at.position);
        if offset < -body.radius {
            return;
        }
        self.find(body, normal, offset);
        if self.behind.is_empty() {
            return;
        }
        // In the middle of what is behind the plane, but on it.
        let middle =
            self.behind.iter().map(|&v| body.vertices[v as usize]).sum::<Vector>() / self.behind.len() as f64;
        let reference = middle - normal * (normal.dot(&middle) - offset);
        self.groups.start_sums();
        for i in 0..self.faces.len() {
            let f = self.faces[i];
            self.add(body, f, reference);
        }
        let to_world = |x: Vector| (at.to_world(Point::from(reference + x)), at.orientation * x);
        let patches = self.groups.patches(1e-14 * body.radius.powi(3));
        let own = patches.iter().filter(|r| r.sums.volume > 0.0);
        out.extend(own.map(|r| r.sums.overlap(&r.outline, to_world, wall.normal())));
    }

    /// Lists the faces and vertices that lie behind the plane, at least in part, and numbers what hangs together.
    fn find(&mut self, body: &Facets, normal: Vector, offset: f64) {
        self.run = self.run.wrapping_add(1);
        if self.run == 0 {
            let pivots = self.groups.pivots;
            *self = Self { run: 1, ..Self::default() };
            self.set_pivots(pivots);
        }
        if self.heights.len() < body.vertices.len() {
            self.heights.resize(body.vertices.len(), (0, 0.0));
            self.numbers.resize(body.vertices.len(), 0);
        }
        self.groups.restart();
        self.faces.clear();
        self.behind.clear();
        self.stack.clear();
        self.stack.push(0);
        while let Some(n) = self.stack.pop() {
            let node = &body.tree[n as usize];
            for slot in 0..WIDTH {
                // The box's corner deepest in the wall; of an empty box it is at infinity.
                let side = |a: usize| if normal[a] > 0.0 { node.low[a][slot] } else { node.high[a][slot] };
                let deepest: f64 =
                    (0..3).map(|a| if normal[a] == 0.0 { 0.0 } else { normal[a] * f64::from(side(a)) }).sum();
                let empty = node.low[0][slot] > node.high[0][slot];
                if empty || deepest.is_nan() || deepest > offset {
                    continue;
                }
                if !node.is_leaf {
                    self.stack.push(node.children[slot]);
                    continue;
                }
                let f = node.children[slot] + slot as u32;
                let corners = body.faces[f as usize].corners;
                let mut first = None;
                for v in corners {
                    if self.height(body, v, normal, offset) <= 0.0 {
                        match first {
                            None => first = Some(self.numbers[v as usize]),
                            Some(first) => self.groups.join(first, self.numbers[v as usize]),
                        }
                    }
                }
                if first.is_some() {
                    self.faces.push(f);
                }
            }
        }
    }

    fn height(&mut self, body: &Facets, v: u32, normal: Vector, offset: f64) -> f64 {
        let known = self.heights[v as usize];
        if known.0 == self.run {
            return known.1;
        }
        let height = normal.dot(&body.vertices[v as usize]) - offset;
        self.heights[v as usize] = (self.run, height);
        if height <= 0.0 {
            self.behind.push(v);
            self.numbers[v as usize] = self.groups.add();
        }
        height
    }

    /// Adds what of a face lies behind the plane.
    fn add(&mut self, body: &Facets, f: u32, reference: Vector) {
        let corners = body.faces[f as usize].corners;
        let heights = corners.map(|v| self.heights[v as usize].1);
        let arms = corners.map(|v| body.vertices[v as usize] - reference);
        let Some(inner) = (0..3).find(|&i| heights[i] <= 0.0) else { return };
        let group = self.numbers[corners[inner] as usize];
        let sums = self.groups.sums(group);
        if heights.iter().all(|h| *h <= 0.0) {
            sums.add_face(arms[0], arms[1], arms[2]);
            return;
        }
        // Always from the end behind the plane, so that both faces of an edge find the same.
        let cut =
            |i: usize, o: usize| arms[i] + (arms[o] - arms[i]) * (heights[i] / (heights[i] - heights[o]));
        let [mut enters, mut leaves] = [Vector::zeros(); 2];
        for i in 0..3 {
            let next = (i + 1) % 3;
            match [heights[i] <= 0.0, heights[next] <= 0.0] {
                [true, false] => leaves = cut(i, next),
                [false, true] => enters = cut(next, i),
                _ => {}
            }
        }
        for i in (0..3).filter(|&i| heights[i] <= 0.0) {
            let next = (i + 1) % 3;
            if heights[next] <= 0.0 {
                // Two corners behind: a quadrangle.
                sums.add_face(enters, arms[i], arms[next]);
                sums.add_face(enters, arms[next], leaves);
            } else if heights[(i + 2) % 3] > 0.0 {
                sums.add_face(enters, arms[i], leaves);
            }
        }
        self.groups.add_curve(group, leaves, enters);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::overlap::overlap;
    use crate::{Cuboid, Shape};
    use approx::assert_relative_eq;
    use interfaces::Rotation;
    use proptest::prelude::*;

    fn floor() -> HalfSpace {
        HalfSpace::new(Point::new(0.3, 0.1, 0.0), Vector::z()).unwrap()
    }

    #[test]
    fn a_box_on_the_floor() {
        let cuboid = Cuboid::new([1.0, 2.0, 3.0]).unwrap();
        let still = Pose::at([0.0; 3]);
        for depth in [1e-9, 0.1, 1.5, 2.9, 3.0, 7.0] {
            let patches = overlap(&cuboid, &Pose::at([5.0, 7.0, 1.5 - depth]), &floor(), &still).unwrap();
            let (o, part) = (&patches[0], f64::min(depth, 3.0));
            assert_eq!(patches.len(), 1);
            assert_relative_eq!(o.volume, 2.0 * part, max_relative = 1e-6, epsilon = 1e-15);
            let z = 0.5 * (part - 2.0 * depth.min(1e300));
            assert_relative_eq!(o.centroid, Point::new(5.0, 7.0, z), epsilon = 1e-12);
            assert_relative_eq!(o.normal, Vector::z());
            if depth < 3.0 {
                assert_relative_eq!(o.gradient, Vector::new(0.0, 0.0, -2.0), epsilon = 1e-12);
            }
        }
        assert!(overlap(&cuboid, &Pose::at([0.0, 0.0, 1.6]), &floor(), &still).unwrap().is_empty());
        // The wall first: as the wall sees it.
        let o = overlap(&floor(), &still, &cuboid, &Pose::at([0.0, 0.0, 1.4])).unwrap()[0];
        assert_relative_eq!(o.normal, -Vector::z());
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

        /// As much as a huge box in the place of the wall; both sides of the wall together are the body; derivatives.
        #[test]
        fn as_a_huge_box(place in prop::array::uniform3(-1.0..1.0f64), turn in prop::array::uniform3(-3.0..3.0f64)) {
            let cuboid = Cuboid::new([1.0, 2.0, 1.5]).unwrap();
            let at = Pose { position: place.into(), orientation: Rotation::from_scaled_axis(turn.into()) };
            let huge = Cuboid::new([100.0; 3]).unwrap();
            let still = Pose::at([0.0; 3]);
            let volume_at = |at: &Pose| overlap(&cuboid, at, &floor(), &still).unwrap().first().map_or(0.0, |o| o.volume);
            let back = HalfSpace::new(Point::origin(), -Vector::z()).unwrap();
            let other = overlap(&cuboid, &at, &back, &still).unwrap().first().map_or(0.0, |o| o.volume);
            assert_relative_eq!(volume_at(&at) + other, cuboid.inertia(1.0).volume, epsilon = 1e-12);
            let one = overlap(&cuboid, &at, &floor(), &still).unwrap();
            let two = overlap(&cuboid, &at, &huge, &Pose::at([0.0, 0.0, -50.0])).unwrap();
            prop_assert_eq!(one.len(), two.len());
            if let (Some(one), Some(two)) = (one.first(), two.first()) {
                assert_relative_eq!(one.volume, two.volume, epsilon = 1e-11);
                prop_assume!(one.volume > 1e-6);
                assert_relative_eq!(one.centroid, two.centroid, epsilon = 1e-6);
                assert_relative_eq!(one.gradient, two.gradient, epsilon = 1e-10);
                assert_relative_eq!(one.moment, two.moment, epsilon = 1e-6);
                let h = 1e-5;
                let turned = |sign: f64| {
                    let turn = Rotation::from_scaled_axis(Vector::new(sign * h, 0.0, 0.0));
                    let arm = at.position - one.centroid;
                    volume_at(&Pose { position: one.centroid + turn * arm, orientation: turn * at.orientation })
                };
                assert_relative_eq!((turned(1.0) - turned(-1.0)) / (2.0 * h), one.moment.x, epsilon = 2e-4);
            }
        }
    }
}
