//! What a plane cuts out of a body.
use nalgebra::Vector2;

/// Coordinates in the plane of a slice.
pub(super) type Place = Vector2<f64>;

/// A corner and its change with the height.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub(super) x: Place,
    pub(super) dx: Place,
}

/// A straight line; the body is where normal·x ≤ offset.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    pub(super) normal: Place,
    pub(super) offset: f64,
    /// The part of the surface's normal along that of the slices, over the part in the slice: −∂offset/∂h.
    pub(super) slope: f64,
    pub(super) tag: Tag,
}

/// Which piece of which body's surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Tag(u32);

impl Tag {
    /// A line that only divides a region.
    pub(super) const INNER: Self = Self(u32::MAX);
    /// The piece of this `number` of the first or second body.
    pub(super) fn new(body: usize, number: u32) -> Self {
        Self(number << 1 | body as u32)
    }
    /// The body, if it is one's surface.
    pub(super) fn body(self) -> Option<usize> {
        (self != Self::INNER).then_some((self.0 & 1) as usize)
    }
    /// Numbers whose sums tell apart which pieces were there.
    pub(super) fn mark(self) -> u64 {
        let x = (u64::from(self.0) + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        (x ^ x >> 31).wrapping_mul(0xbf58_476d_1ce4_e5b9)
    }
}

/// All within a radius of a core: of a point, a straight line or, with no radius, of a convex polygon.
#[derive(Clone, Debug, Default)]
pub(super) struct Slice {
    /// Of the core, counter-clockwise.
    pub(super) corners: Vec<Corner>,
    /// Of a polygon; side k runs from corner k to the next.
    pub(super) sides: Vec<Side>,
    pub(super) radius: f64,
    /// −∂radius/∂h.
    pub(super) slope: f64,
    /// 0 or 1.
    pub(super) body: usize,
}

impl Slice {
    pub(super) fn is_polygon(&self) -> bool {
        !self.sides.is_empty()
    }
    /// Makes it a rectangle around a centre, with half its length along a direction and half its width, where −∂width/∂h is
    /// this `slope`.
    pub(super) fn rectangle(&mut self, centre: Place, along: Place, [length, width]: [f64; 2], slope: f64) {
        self.corners.clear();
        self.sides.clear();
        (self.radius, self.slope) = (0.0, 0.0);
        let left = Place::new(-along.y, along.x);
        let (a, out, change) = (along * length, left * width, left * -slope);
        let corner = |x, dx| Corner { x, dx };
        self.corners.extend([
            corner(centre - a - out, -change),
            corner(centre + a - out, -change),
            corner(centre + a + out, change),
            corner(centre - a + out, change),
        ]);
        let body = self.body;
        let side = |normal: Place, reach, slope, number| Side {
            normal,
            offset: normal.dot(&centre) + reach,
            slope,
            tag: Tag::new(body, number),
        };
        self.sides.extend([
            side(-left, width, slope, 0),
            side(along, length, 0.0, 1),
            side(left, width, slope, 2),
            side(-along, length, 0.0, 3),
        ]);
    }
    /// Both ends of a core that is no polygon.
    pub(super) fn ends(&self) -> [Place; 2] {
        [self.corners[0].x, self.corners[self.corners.len() - 1].x]
    }
    /// Where arcs and sides of a rounded core are counted: arc at end 0, at end 1, sides.
    pub(super) fn arc(&self, end: usize) -> Tag {
        Tag::new(self.body, end as u32)
    }
    /// The sides of the strip between the ends of a straight core, from end 0 to end 1 and back, then the lines that end it
    /// there; `None` of a point.
    pub(super) fn strip(&self) -> Option<[Side; 4]> {
        let [p, q] = self.ends();
        let along = (q - p).try_normalize(0.0)?;
        let right = Place::new(along.y, -along.x);
        let side = |normal: Place, number| Side {
            normal,
            offset: normal.dot(&p) + self.radius,
            slope: self.slope,
            tag: Tag::new(self.body, number),
        };
        let end =
            |normal: Place, at: &Place| Side { normal, offset: normal.dot(at), slope: 0.0, tag: Tag::INNER };
        Some([side(right, 2), side(-right, 3), end(-along, &p), end(along, &q)])
    }
}

impl Side {
    /// The other side of it.
    pub(super) fn flipped(&self) -> Self {
        Self { normal: -self.normal, offset: -self.offset, slope: -self.slope, ..*self }
    }
}

/// z of the cross product.
#[inline]
pub(super) fn cross(a: Place, b: Place) -> f64 {
    a.x * b.y - a.y * b.x
}
