//! Where the edges of one body pass through the faces of the other.
use super::body::{Body, Crossed, Plane};
use interfaces::Vector;

/// An edge of one body in a face of the other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    pub(super) edge: u32,
    pub(super) face: u32,
    /// The next one on the same edge.
    pub(super) next: u32,
    /// Is the edge the first body's?
    pub(super) of_first: bool,
    /// Does the edge leave the other body here?
    pub(super) leaves: bool,
    /// How far along the edge, 0 to 1.
    pub(super) along: f64,
    /// Where, from the reference point.
    pub(super) arm: Vector,
}

/// The line in which two faces cross, from `ends[0]` to `ends[1]`: with the first body's part in the second on its left, on the
/// first body's face, seen from outside. The faces are given by their numbers among the cut ones.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    pub(super) first: u32,
    pub(super) second: u32,
    pub(super) ends: [u32; 2],
}

/// An edge of a face that crosses the plane of another: its number, and its ends, that behind the plane first.
#[derive(Clone, Copy)]
pub(super) struct Straddling {
    pub(super) edge: u32,
    pub(super) behind: Vector,
    pub(super) ahead: Vector,
    /// Does it leave, in the direction of [`Edge`](crate::shapes::Edge)?
    pub(super) leaves: bool,
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
    #[inline]
    pub(super) fn of(&self, crossed: Crossed) -> impl Iterator<Item = (u32, &Crossing)> {
        let mut next = crossed.first;
        std::iter::from_fn(move || {
            let here = self.all.get(next as usize)?;
            let number = std::mem::replace(&mut next, here.next);
            Some((number, here))
        })
    }

    /// The number of the crossing of an edge of `own` with a face of the other body.
    #[inline]
    pub(super) fn get(&mut self, own: &mut Body<'_>, edge: &Straddling, other: &Plane) -> u32 {
        let mut crossed = own.crossed(edge.edge);
        let known = self.of(crossed).find(|(_, c)| c.face == other.face).map(|(number, _)| number);
        if let Some(number) = known {
            return number;
        }
        let number = self.all.len() as u32;
        let leaves = edge.leaves;
        let (from, to) = if leaves { (edge.behind, edge.ahead) } else { (edge.ahead, edge.behind) };
        let (start, end) = (other.normal.dot(&(from - other.corner)), other.normal.dot(&(to - other.corner)));
        let along = start / (start - end);
        // Both ends in the plane, but for round-off: anywhere.
        let along = if along.is_finite() { along.clamp(0.0, 1.0) } else { 0.5 };
        let arm = (from - own.reference) + (to - from) * along;
        let next = std::mem::replace(&mut crossed.first, number);
        let of_first = own.moved.is_some();
        self.all.push(Crossing { edge: edge.edge, face: other.face, next, of_first, leaves, along, arm });
        crossed.net += if leaves { -1 } else { 1 };
        own.cross(edge.edge, crossed);
        number
    }
}
