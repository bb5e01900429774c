//! Ghost values beyond walls and inlets.
use crate::CartesianGrid;

/// Ghost value half a cell beyond a side where u_w is given, by the parabola through the side and the two nodes before it:
/// wall·u_w + first·u₀ + second·u₁. (The straight line would make an error of order 1 in the second difference.)
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extrapolation {
    pub(crate) wall: f64,
    pub(crate) first: f64,
    pub(crate) second: f64,
}

impl Extrapolation {
    /// Beyond a side of axis `a`.
    pub(crate) fn beyond<const D: usize>(grid: &CartesianGrid<D>, a: usize, upper: bool) -> Self {
        let (axis, n) = (grid.axis(a), grid.cells()[a]);
        let cell = |k: usize| if upper { n - 1 - k.min(n - 1) } else { k.min(n - 1) };
        Self::new(n, [axis.width(cell(0)), axis.width(cell(1))])
    }

    /// For the first two of `n` cells from the side, `widths` wide; a straight line if there is only one.
    fn new(n: usize, widths: [f64; 2]) -> Self {
        if n < 2 {
            return Self { wall: 2.0, first: -1.0, second: 0.0 };
        }
        let (a, b) = (0.5 * widths[0], widths[0] + 0.5 * widths[1]);
        Self { wall: 2.0 * (a + b) / b, first: -(a + b) / (b - a), second: 2.0 * a * a / (b * (b - a)) }
    }
}
