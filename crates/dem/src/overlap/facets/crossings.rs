//! Where the edges of one body pass through the faces of the other.
use super::body::{Body, Crossed};
use super::signs::Side;
use interfaces::Vector;

/// An edge of one body in a face of the other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    /// Whose edge.
    pub(super) side: Side,
    pub(super) edge: u32,
    pub(super) face: u32,
    /// The next one on the same edge.
    pub(super) next: u32,
    /// Does the edge leave the other body here?
    pub(super) leaves: bool,
    /// How far along the edge, 0 to 1.
    pub(super) along: f64,
    /// Where, from the reference point.
    pub(super) arm: Vector,
}

/// The line in which two faces cross, from `ends[0]` to `ends[1]`: with the first body's part in the second on its left, on the
/// first body's face, seen from outside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    pub(super) first: u32,
    pub(super) second: u32,
    pub(super) ends: [u32; 2],
}

#[derive(Clone, Debug, Default)]
pub(super) struct Crossings {
    pub(super) all: Vec<Crossing>,
    pub(super) segments: Vec<Segment>,
}

impl Crossings {
    pub(super) fn clear(&mut self) {
        self.all.clear();
        self.segments.clear();
    }

    /// Those of an edge.
    pub(super) fn of(&self, crossed: Crossed) -> impl Iterator<Item = (u32, &Crossing)> {
        let mut next = crossed.first;
        std::iter::from_fn(move || {
            let here = self.all.get(next as usize)?;
            let number = std::mem::replace(&mut next, here.next);
            Some((number, here))
        })
    }

    /// The number of the crossing of `edge` of `own` with `face` of `other`; `leaves` tells whether the edge leaves there.
    #[inline]
    pub(super) fn get(&mut self, own: &mut Body<'_>, other: &mut Body<'_>, edge: u32, face: u32, leaves: bool) -> u32 {
        let mut crossed = own.crossed(edge);
        let known = self.of(crossed).find(|(_, c)| c.face == face).map(|(number, _)| number);
        if let Some(number) = known {
            return number;
        }
        let number = self.all.len() as u32;
        let ends = &own.facets.edges[edge as usize];
        let (from, to) = (own.arm(ends.from), own.arm(ends.to));
        let plane = other.plane(face);
        let corner = other.arm(other.facets.faces[face as usize].corners[0]);
        let (start, end) = (plane.normal.dot(&(from - corner)), plane.normal.dot(&(to - corner)));
        let along = start / (start - end);
        // Both ends in the plane, but for round-off: anywhere.
        let along = if along.is_finite() { along.clamp(0.0, 1.0) } else { 0.5 };
        let arm = from + (to - from) * along;
        let next = std::mem::replace(&mut crossed.first, number);
        self.all.push(Crossing { side: own.side, edge, face, next, leaves, along, arm });
        crossed.net += if leaves { -1 } else { 1 };
        own.cross(edge, crossed);
        number
    }
}
