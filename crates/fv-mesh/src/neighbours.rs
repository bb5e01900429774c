//! The cells around one.
use crate::grid::GHOSTS;
use crate::operators::Operators;

/// The neighbour of a cell along an axis, around the end of a periodic one.
pub(crate) fn neighbour<const D: usize>(
    ops: &Operators<D>,
    mut at: [usize; D],
    axis: usize,
    up: bool,
) -> Option<usize> {
    let (n, periodic) = (ops.grid().cells()[axis], ops.metrics().periodic[axis]);
    let i = at[axis] + n + 2 * usize::from(up) - 1;
    at[axis] = i % n;
    (periodic || (n..2 * n).contains(&i)).then(|| ops.grid().index(at))
}

/// The cells that share a corner with a cell, and the way to their centres; the same more than once on periodic axes of one or two cells.
pub(crate) fn around<const D: usize>(
    ops: &Operators<D>,
    cell: usize,
) -> impl Iterator<Item = (usize, [f64; D])> {
    let at = ops.grid().cell(cell);
    (0..3_usize.pow(D as u32)).filter_map(move |turn| {
        let (mut other, mut step, mut rest) = (cell, [0.0; D], turn);
        for a in 0..D {
            if rest % 3 != 1 {
                let up = rest % 3 == 2;
                other = neighbour(ops, ops.grid().cell(other), a, up)?;
                let gap = 1.0 / ops.metrics().axes[a].centres.inv_gap[GHOSTS + at[a] + usize::from(up)];
                step[a] = if up { gap } else { -gap };
            }
            rest /= 3;
        }
        (other != cell).then_some((other, step))
    })
}
