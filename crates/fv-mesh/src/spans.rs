//! The part of every row of cells in which something happens.
use std::ops::Range;
use std::sync::Arc;

/// So many cells beyond the last one with fluid are computed, too: what is interpolated, differentiated or carried beside walls
/// reaches no farther.
const MARGIN: usize = 3;
/// Spans begin at multiples of this, so that sums in lanes add up what they did without spans.
const LANES: usize = 4;

/// From where to where something happens in every row along x; without a list everywhere. Kernels leave alone what is outside:
/// in boxes that walls fill for a good part that is most of what there is to do.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Spans {
    rows: Option<Arc<[Range<usize>]>>,
}

impl Spans {
    /// All cells `active`, by dense numbers, and those next to them.
    pub(crate) fn around<const D: usize>(
        cells: [usize; D],
        periodic: [bool; D],
        active: impl Fn(usize) -> bool,
    ) -> Self {
        let n = cells[0];
        let count: usize = cells[1..].iter().product();
        // Rows as they are, then what the neighbours along the other axes add.
        let own = |r: usize| {
            let mut inside = (0..n).filter(|&i| active(r * n + i));
            let first = inside.next()?;
            Some((first, inside.last().unwrap_or(first) + 1))
        };
        let mut hulls: Vec<Option<(usize, usize)>> = (0..count).map(own).collect();
        let join = |a: Option<(usize, usize)>, b: Option<(usize, usize)>| match (a, b) {
            (Some(a), Some(b)) => Some((a.0.min(b.0), a.1.max(b.1))),
            (a, b) => a.or(b),
        };
        let mut stride = 1;
        for axis in 1..D {
            let before = hulls.clone();
            for (r, hull) in hulls.iter_mut().enumerate() {
                let at = (r / stride % cells[axis]) as isize;
                for step in -(MARGIN as isize)..=MARGIN as isize {
                    let to = at + step;
                    let there = if periodic[axis] { to.rem_euclid(cells[axis] as isize) } else { to };
                    if (0..cells[axis] as isize).contains(&there) {
                        let other = (r as isize + (there - at) * stride as isize) as usize;
                        *hull = join(*hull, before[other]);
                    }
                }
            }
            stride *= cells[axis];
        }
        let widened = |hull: Option<(usize, usize)>| {
            let Some((first, end)) = hull else { return 0..0 };
            let seam = periodic[0] && (first < MARGIN || end + MARGIN > n);
            if seam {
                return 0..n;
            }
            first.saturating_sub(MARGIN) / LANES * LANES..(end + MARGIN).min(n)
        };
        let rows: Vec<_> = hulls.into_iter().map(widened).collect();
        if rows.iter().all(|row| row.len() == n) { Self::default() } else { Self { rows: Some(rows.into()) } }
    }

    /// That of row `r` of `n` cells.
    #[inline(always)]
    pub(crate) fn of(&self, r: usize, n: usize) -> Range<usize> {
        self.rows.as_ref().map_or(0..n, |rows| rows[r].clone())
    }

    /// The dense numbers of all that is inside, row by row, of so many rows of `n` cells.
    pub(crate) fn rows(&self, n: usize, count: usize) -> impl Iterator<Item = Range<usize>> + '_ {
        (0..count).map(move |r| {
            let row = self.of(r, n);
            r * n + row.start..r * n + row.end
        })
    }

    pub(crate) fn contains(&self, n: usize, cell: usize) -> bool {
        self.of(cell / n, n).contains(&(cell % n))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_hold_all_that_is_active_and_its_neighbours() {
        let cells = [40, 20, 9];
        let of = |cell: usize| [cell % 40, cell / 40 % 20, cell / 800];
        let active = |cell: usize| {
            let [x, y, z] = of(cell);
            (11..=14).contains(&x) && y == 5 && z == 8
        };
        let spans = Spans::around(cells, [true, false, true], active);
        for cell in 0..40 * 20 * 9 {
            let [x, y, z] = of(cell);
            // z is periodic.
            let near = (2..=8).contains(&y) && (z >= 5 || z <= 2);
            assert_eq!(spans.contains(40, cell), near && (8..=17).contains(&x), "{x} {y} {z}");
        }
        let listed: usize = spans.rows(40, 180).map(|range| range.len()).sum();
        assert_eq!(listed, 10 * 7 * 7);
    }

    #[test]
    fn a_row_that_reaches_a_periodic_seam_is_whole() {
        let spans = Spans::around([40, 1], [true, false], |cell| cell == 2);
        assert_eq!(spans, Spans::default());
        assert!(spans.rows(40, 1).eq(std::iter::once(0..40)));
        let spans = Spans::around([40, 1], [false, false], |cell| cell == 2);
        assert_eq!(spans.of(0, 40), 0..6);
    }
}
