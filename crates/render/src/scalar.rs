//! Field on a plane grid, and its pixels.
use crate::canvas::{Canvas, Rect};
use crate::colour::Colour;

/// Field at the cell centres of a uniform plane grid: x runs fastest, y upwards.
#[derive(Clone, Copy, Debug)]
pub struct Scalar<'a> {
    /// Cells along x.
    pub nx: usize,
    /// Cells along y.
    pub ny: usize,
    /// Value of each cell.
    pub values: &'a [f64],
}

/// Places of the pixels of one direction between cell centres: lower cell, upper cell, share of the
/// upper.
fn lattice(pixels: usize, cells: usize, periodic: bool, flip: bool) -> Vec<(usize, usize, f64)> {
    let last = cells as isize - 1;
    let cell = |i: isize| (if periodic { i.rem_euclid(last + 1) } else { i.clamp(0, last) }) as usize;
    let place = |pixel: usize| {
        let pixel = if flip { pixels - 1 - pixel } else { pixel };
        let place = (pixel as f64 + 0.5) * cells as f64 / pixels as f64 - 0.5;
        (cell(place.floor() as isize), cell(place.floor() as isize + 1), place - place.floor())
    };
    (0..pixels).map(place).collect()
}

/// Paints `rect` pixel by pixel from a field, linearly between its cell centres.
pub(crate) fn paint(
    canvas: &mut Canvas,
    rect: Rect,
    periodic: [bool; 2],
    field: &Scalar<'_>,
    colour: impl Fn(f64) -> Colour,
) {
    let Scalar { nx, ny, values } = *field;
    let columns = lattice(rect.width as usize, nx, periodic[0], false);
    let rows = lattice(rect.height as usize, ny, periodic[1], true);
    let (left, top) = (rect.left as usize, rect.top as usize);
    for (y, &(low, high, up)) in rows.iter().enumerate() {
        let row = canvas.row(top + y, left, left + columns.len());
        for (pixel, &(west, east, across)) in row.chunks_exact_mut(3).zip(&columns) {
            let at = |row: usize| {
                let line = &values[row * nx..(row + 1) * nx];
                line[west] + across * (line[east] - line[west])
            };
            let below = at(low);
            pixel.copy_from_slice(&colour(below + up * (at(high) - below)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_wrap_in_a_periodic_direction_only() {
        assert_eq!(lattice(4, 2, true, false)[0], (1, 0, 0.75));
        assert_eq!(lattice(4, 2, false, false)[0], (0, 0, 0.75));
        assert_eq!(lattice(4, 2, true, true)[0], lattice(4, 2, true, false)[3]);
    }
}
