//! Fields at other places than the centres of their cells.
use super::axis::{Axis, Side};
use super::spline::MARGIN;
use super::{Grid, Interpolation};
use interfaces::Point;

/// Values of fields anywhere, by polynomials or splines along each axis.
pub(super) struct Gatherer {
    grid: Grid,
    interpolation: Interpolation,
    axes: [Axis; 3],
}

/// What a value takes along an axis.
struct Part {
    at: [usize; 6],
    weights: [f64; 6],
    n: usize,
}

impl Gatherer {
    /// Phases do not tell values anywhere: [`Interpolation::Spectral`] becomes the quintic spline.
    pub(super) fn new(grid: Grid, interpolation: Interpolation) -> Self {
        let interpolation = match interpolation {
            Interpolation::Spectral => Interpolation::QuinticSpline,
            other => other,
        };
        let axis = |a: usize| Axis::new(grid.cells()[a], grid.periodic()[a], interpolation);
        Self { axes: [0, 1, 2].map(axis), grid, interpolation }
    }

    /// q at `place` of each centre, or the transpose of that.
    pub(super) fn gather(&self, place: &dyn Fn(Point) -> Point, side: Side, fields: &mut [f64]) {
        let cells = self.grid.cells();
        let thick: Vec<usize> = (0..3).filter(|&a| cells[a] > 1).collect();
        let m = [0, 1, 2].map(|a| if cells[a] > 1 { self.axes[a].n_coefficients() } else { 1 });
        let (n_cells, n_coefficients) = (self.grid.n_cells(), m.iter().product::<usize>());
        let inner = |a: usize| m[..a].iter().product::<usize>();
        let mut data;
        match side {
            Side::Operator => {
                data = fields.to_vec();
                thick.iter().for_each(|&a| self.axes[a].coefficients(inner(a), &mut data));
            }
            Side::Transpose => data = vec![0.0; fields.len() / n_cells * n_coefficients],
        }
        for cell in 0..n_cells {
            let parts = self.parts(place(self.grid.centre(cell)));
            let n_fields = fields.len() / n_cells;
            for f in 0..n_fields {
                let (value, data) =
                    (&mut fields[f * n_cells + cell], &mut data[f * n_coefficients..][..n_coefficients]);
                let mut sum = 0.0;
                let [x, y, z] = &parts;
                for k in 0..z.n {
                    for j in 0..y.n {
                        let row = m[0] * (y.at[j] + m[1] * z.at[k]);
                        let w = y.weights[j] * z.weights[k];
                        let line = x.at[..x.n].iter().zip(&x.weights);
                        match side {
                            Side::Operator => {
                                sum += w * line.map(|(at, wx)| wx * data[row + at]).sum::<f64>()
                            }
                            Side::Transpose => line.for_each(|(at, wx)| data[row + at] += w * wx * *value),
                        }
                    }
                }
                if side == Side::Operator {
                    *value = sum;
                }
            }
        }
        if side == Side::Transpose {
            for &a in thick.iter().rev() {
                self.axes[a].coefficients_transposed(inner(a), &mut data);
            }
            fields.copy_from_slice(&data);
        }
    }

    fn parts(&self, place: Point) -> [Part; 3] {
        [0, 1, 2].map(|a| {
            let n = self.grid.cells()[a];
            let mut part = Part { at: [0; 6], weights: [1.0; 6], n: 1 };
            if n > 1 {
                let way = (place[a] - self.grid.first()[a]) / self.grid.spacing()[a];
                let limit = (n + MARGIN) as f64;
                let way =
                    if self.grid.periodic()[a] { way.rem_euclid(n as f64) } else { way.clamp(-limit, limit) };
                let (below, reach) = (way.floor(), self.interpolation.reach());
                part.n = 2 * reach;
                part.weights = self.interpolation.weights(way - below);
                let first = below as isize + 1 - reach as isize;
                for (l, at) in part.at[..2 * reach].iter_mut().enumerate() {
                    *at = self.axes[a].coefficient(first + l as isize);
                }
            }
            part
        })
    }
}
