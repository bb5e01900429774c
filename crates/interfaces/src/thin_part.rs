//! Parts of bodies that a grid does not resolve.
use crate::Point;

/// Part of a body that is too thin for the grid: fluid on one side of it is a neighbour of fluid on the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinPart {
    /// Number of the body.
    pub body: usize,
    /// Share of the body's surface inside the box that bounds the part, in (0, 1].
    pub share: f64,
    /// Thickness of the solid along the normal where it is least compared with `needed` \[m\].
    pub thickness: f64,
    /// Thickness that the grid needs there \[m\].
    pub needed: f64,
    /// Place of it on the surface \[m\].
    pub place: Point,
}

impl ThinPart {
    /// The place as text: its coordinates, three digits each.
    pub fn place_text(&self) -> String {
        self.place.iter().map(|x| format!("{x:.3e}")).collect::<Vec<_>>().join(", ")
    }
}
