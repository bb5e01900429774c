//! Distance from the walls of the box.
use crate::{CartesianGrid, Patch, Side, Sides};

/// A rectangle: lower and upper corner, the same along the axis it is normal to.
#[derive(Clone, Copy, Debug)]
struct Rectangle<const D: usize> {
    lower: [f64; D],
    upper: [f64; D],
}

impl<const D: usize> Rectangle<D> {
    /// What `other` leaves of this, both normal to axis `a`, as disjoint rectangles.
    fn without(self, other: &Self, a: usize, left: &mut Vec<Self>) {
        let across = || (0..D).filter(|&b| b != a);
        if across().any(|b| other.upper[b] <= self.lower[b] || other.lower[b] >= self.upper[b]) {
            left.push(self);
            return;
        }
        let mut rest = self;
        for b in across() {
            if other.lower[b] > rest.lower[b] {
                let mut piece = rest;
                piece.upper[b] = other.lower[b];
                left.push(piece);
                rest.lower[b] = other.lower[b];
            }
            if other.upper[b] < rest.upper[b] {
                let mut piece = rest;
                piece.lower[b] = other.upper[b];
                left.push(piece);
                rest.upper[b] = other.upper[b];
            }
        }
    }

    /// Square of the distance, the nearest of the images along periodic axes.
    fn distance_squared(&self, x: [f64; D], periods: [Option<f64>; D]) -> f64 {
        (0..D)
            .map(|b| {
                let gap = |x: f64| (self.lower[b] - x).max(x - self.upper[b]).max(0.0);
                let gap = match periods[b] {
                    Some(period) => gap(x[b]).min(gap(x[b] - period)).min(gap(x[b] + period)),
                    None => gap(x[b]),
                };
                gap * gap
            })
            .sum()
    }
}

/// The walls of a side: of a patch what those before it leave.
fn walls_of<const D: usize>(
    grid: &CartesianGrid<D>,
    side: &Side,
    a: usize,
    upper: bool,
    walls: &mut Vec<Rectangle<D>>,
) {
    let at = if upper { grid.axis(a).upper() } else { grid.axis(a).lower() };
    let clip =
        |x: [f64; 3]| -> [f64; D] {
            std::array::from_fn(|b| {
                if b == a { at } else { x[b].clamp(grid.axis(b).lower(), grid.axis(b).upper()) }
            })
        };
    let whole = [Patch { lower: [f64::NEG_INFINITY; 3], upper: [f64::INFINITY; 3], side: side.clone() }];
    let patches = match side {
        Side::Patches(patches) => patches.as_slice(),
        _ => &whole,
    };
    let rectangle = |p: &Patch| Rectangle { lower: clip(p.lower), upper: clip(p.upper) };
    for (k, patch) in patches.iter().enumerate().filter(|(_, p)| p.side.is_wall()) {
        let own = rectangle(patch);
        if (0..D).any(|b| b != a && own.upper[b] <= own.lower[b]) {
            continue;
        }
        let mut parts = vec![own];
        for before in &patches[..k] {
            let mut left = Vec::new();
            parts.into_iter().for_each(|part| part.without(&rectangle(before), a, &mut left));
            parts = left;
        }
        walls.extend(parts);
    }
}

/// Distance of every cell's centre from the nearest wall \[m\], exact for patches as they are given; infinite without
/// walls.
pub(super) fn wall_distance<const D: usize>(grid: &CartesianGrid<D>, sides: &Sides<D>) -> Vec<f64> {
    let mut walls = Vec::new();
    for a in 0..D {
        for (k, side) in sides.of(a).iter().enumerate() {
            walls_of(grid, side, a, k == 1, &mut walls);
        }
    }
    let periods = std::array::from_fn(|b| sides.periodic(b).then(|| grid.axis(b).length()));
    (0..grid.n_cells())
        .map(|i| {
            let x = grid.centre(grid.cell(i));
            let nearest = walls.iter().map(|w| w.distance_squared(x, periods)).fold(f64::INFINITY, f64::min);
            nearest.sqrt()
        })
        .collect()
}
