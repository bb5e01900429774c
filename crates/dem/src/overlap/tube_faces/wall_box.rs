//! Plane walls as faces.
use super::UnitTube;
use crate::HalfSpace;
use crate::overlap::ball_faces::Faces;
use interfaces::{Point, Vector};

/// A wall as a closed box, larger than the tube, whose upper side is the wall.
pub(crate) struct WallBox {
    corners: [Point; 8],
    wall: HalfSpace,
}

impl WallBox {
    pub(crate) fn new(a: &UnitTube<'_>, wall: &HalfSpace) -> Self {
        let n = wall.normal();
        let size = 4.0 * (a.half + 1.0) * a.radius;
        let u = n.cross(&Vector::ith(n.iamin(), 1.0)).normalize();
        let v = n.cross(&u);
        let foot = a.at.position - n * wall.signed_distance(a.at.position);
        let corners = std::array::from_fn(|i| {
            let side = |bit: usize| if i >> bit & 1 == 0 { -size } else { size };
            let depth = if i & 4 == 0 { -2.0 * size } else { 0.0 };
            foot + u * side(0) + v * side(1) + n * depth
        });
        Self { corners, wall: *wall }
    }
}

impl Faces for WallBox {
    fn n_corners(&self) -> usize {
        self.corners.len()
    }
    fn corner(&self, i: u32) -> Point {
        self.corners[i as usize]
    }
    fn each(&self, visit: impl FnMut(&[u32])) {
        const LOOPS: [[u32; 4]; 6] =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        LOOPS.iter().map(|l| l.as_slice()).for_each(visit);
    }
    fn convex(&self) -> bool {
        true
    }
    fn holds(&self, x: Point) -> bool {
        self.wall.signed_distance(x) <= 0.0
    }
}
