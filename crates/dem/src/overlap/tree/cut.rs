//! Which boxes the surface of a body cuts.
use super::seen::Seen;
use crate::Shape;
use interfaces::Vector;

/// Where a box is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Outside,
    Inside,
    Cut,
}

/// Decides whether the surface of body `i` cuts a box.
pub(crate) trait Cut {
    fn side(&self, i: usize, body: &Seen<'_>, centre: Vector, half: Vector) -> Side;
}

/// By the distance of the centre, which no point of the box is farther from than half the diagonal.
pub(crate) fn by_distance(body: &Seen<'_>, centre: Vector, half: Vector) -> Side {
    let band = half.norm();
    match body.distance(centre, band) {
        d if d >= band => Side::Outside,
        d if d <= -band => Side::Inside,
        _ => Side::Cut,
    }
}

/// Decides by facets of bodies that have them, by distance else.
pub(crate) struct Surfaces<'a> {
    pub(crate) shapes: [&'a dyn Shape; 2],
}

impl Cut for Surfaces<'_> {
    fn side(&self, i: usize, body: &Seen<'_>, centre: Vector, half: Vector) -> Side {
        #[cfg(feature = "mesh")]
        if let Some(facets) = self.shapes[i].facet_index() {
            let place = interfaces::Point::from(body.turn * centre + body.shift);
            return if facets.cut(place, &body.turn, half) {
                Side::Cut
            } else if body.distance(centre, half.norm()) < 0.0 {
                Side::Inside
            } else {
                Side::Outside
            };
        }
        let _ = (i, self.shapes);
        by_distance(body, centre, half)
    }
}
