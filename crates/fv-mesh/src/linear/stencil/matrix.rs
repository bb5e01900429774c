//! The matrix and what is done to its rows.
use super::super::error::check_length;
use super::super::matrix::{check_blend, check_fraction, smallest};
use super::super::{LinearError, LinearOperator, Matrix};
use crate::spans::Spans;
use std::ops::Range;

/// One coefficient per cell and neighbour on a box of `D` = 1, 2 or 3 axes: the row of cell P reads
/// a_P x_P + Σ_a (a_lower,a x_{P−e_a} + a_upper,a x_{P+e_a}) = b_P. Arrays are dense with x fastest.
///
/// Periodic axes wrap around; a periodic axis of one cell makes the cell its own neighbour, so that those coefficients
/// count with its diagonal. Coefficients that would reach out of the box are never used.
#[derive(Clone, Debug, PartialEq)]
pub struct StencilMatrix<const D: usize> {
    pub(super) cells: [usize; D],
    pub(super) periodic: [bool; D],
    pub(super) centre: Vec<f64>,
    pub(super) lower: [Vec<f64>; D],
    pub(super) upper: [Vec<f64>; D],
    /// A row of zeros: the coefficients of neighbours that are not there.
    pub(super) none: Vec<f64>,
    /// One and zero in turn, one longer than a row.
    pub(super) checker: Vec<f64>,
    /// Products, factors and sweeps leave alone what is outside.
    pub(super) spans: Spans,
}

/// Lower or upper neighbour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    Lower,
    Upper,
}

impl<const D: usize> StencilMatrix<D> {
    /// Zeros on a box of `cells` cells whose `periodic` axes wrap around.
    ///
    /// # Errors
    /// [`LinearError::Cells`] for an axis without cells, more than three axes or too many cells.
    pub fn new(cells: [usize; D], periodic: [bool; D]) -> Result<Self, LinearError> {
        let bytes = cells.iter().try_fold(8_usize, |n, &c| n.checked_mul(c));
        let fits = bytes.is_some_and(|b| b > 0 && b <= isize::MAX as usize);
        if !(1..=3).contains(&D) || !fits {
            return Err(LinearError::Cells { cells: cells.to_vec() });
        }
        let zeros = || vec![0.0; cells.iter().product()];
        Ok(Self {
            cells,
            periodic,
            centre: zeros(),
            lower: std::array::from_fn(|_| zeros()),
            upper: std::array::from_fn(|_| zeros()),
            none: vec![0.0; cells[0]],
            checker: (0..=cells[0]).map(|i| if i % 2 == 0 { 1.0 } else { 0.0 }).collect(),
            spans: Spans::default(),
        })
    }

    /// Cells per axis.
    pub fn cells(&self) -> [usize; D] {
        self.cells
    }
    /// Which axes wrap around.
    pub fn periodic(&self) -> [bool; D] {
        self.periodic
    }
    /// a_P, without what a periodic axis of one cell adds to it.
    pub fn centre(&self) -> &[f64] {
        &self.centre
    }
    /// Coefficients of the neighbours below along `axis`.
    ///
    /// # Panics
    /// If there is no such axis.
    pub fn lower(&self, axis: usize) -> &[f64] {
        &self.lower[axis]
    }
    /// Coefficients of the neighbours above along `axis`.
    ///
    /// # Panics
    /// If there is no such axis.
    pub fn upper(&self, axis: usize) -> &[f64] {
        &self.upper[axis]
    }
    /// Centre, lower and upper coefficients, to write.
    pub fn parts_mut(&mut self) -> (&mut [f64], [&mut [f64]; D], [&mut [f64]; D]) {
        (
            &mut self.centre,
            self.lower.each_mut().map(Vec::as_mut_slice),
            self.upper.each_mut().map(Vec::as_mut_slice),
        )
    }
    /// Sets every coefficient to zero.
    pub fn clear(&mut self) {
        let (centre, lower, upper) = self.parts_mut();
        centre.fill(0.0);
        lower.into_iter().chain(upper).for_each(|c| c.fill(0.0));
    }

    /// Outside of `spans` nothing is computed from now on: the rows there are those of the unit matrix, b and x are zero in them.
    pub(crate) fn set_spans(&mut self, spans: Spans) {
        self.clear();
        self.centre.fill(1.0);
        self.spans = spans;
    }
    /// The part of row `r` in which something is computed.
    #[inline(always)]
    pub(crate) fn span(&self, r: usize) -> Range<usize> {
        self.spans.of(r, self.cells[0])
    }

    /// Number of rows along x.
    pub(super) fn rows(&self) -> usize {
        self.cells[1..].iter().product()
    }
    /// The cell next to `cell` along `axis`.
    pub(super) fn neighbour(&self, cell: usize, axis: usize, end: End) -> Option<usize> {
        let stride: usize = self.cells[..axis].iter().product();
        step(cell, cell / stride % self.cells[axis], stride, self.cells[axis], self.periodic[axis], end)
    }
    /// The row next to row `r` along `axis` ≥ 1.
    pub(super) fn row_neighbour(&self, r: usize, axis: usize, end: End) -> Option<usize> {
        let stride: usize = self.cells[1..axis].iter().product();
        step(r, r / stride % self.cells[axis], stride, self.cells[axis], self.periodic[axis], end)
    }
    pub(super) fn coefficients(&self, axis: usize, end: End) -> &[f64] {
        match end {
            End::Lower => &self.lower[axis],
            End::Upper => &self.upper[axis],
        }
    }
    /// Axis, end and cell of the neighbours of a cell, itself included where it is its own.
    fn neighbours(&self, cell: usize) -> impl Iterator<Item = (usize, End, usize)> + '_ {
        (0..2 * D).filter_map(move |k| {
            let end = [End::Lower, End::Upper][k % 2];
            self.neighbour(cell, k / 2, end).map(|other| (k / 2, end, other))
        })
    }
    fn check_cell(&self, cell: usize) -> Result<(), LinearError> {
        if cell < self.n() {
            return Ok(());
        }
        Err(LinearError::Pattern { row: cell, col: cell, n: self.n() })
    }

    /// a_P of a cell, with what a periodic axis of one cell adds to it.
    ///
    /// # Panics
    /// If there is no such cell.
    pub fn diagonal(&self, cell: usize) -> f64 {
        let mut sum = self.centre[cell];
        for axis in self.own_axes() {
            sum += self.lower[axis][cell] + self.upper[axis][cell];
        }
        sum
    }
    /// Axes along which a cell is its own neighbour.
    pub(super) fn own_axes(&self) -> impl Iterator<Item = usize> + use<D> {
        let (cells, periodic) = (self.cells, self.periodic);
        (0..D).filter(move |&a| periodic[a] && cells[a] == 1)
    }
    /// Writes a_P of all cells.
    ///
    /// # Errors
    /// [`LinearError::Shape`].
    pub fn write_diagonal(&self, out: &mut [f64]) -> Result<(), LinearError> {
        check_length("the diagonal", self.n(), out.len())?;
        out.copy_from_slice(&self.centre);
        for axis in self.own_axes() {
            for (out, (l, u)) in out.iter_mut().zip(self.lower[axis].iter().zip(&self.upper[axis])) {
                *out += l + u;
            }
        }
        Ok(())
    }

    /// Under-relaxation (Patankar 1980): a_P becomes a_P/α and b gains (1 − α)/α a_P x, with the last x.
    ///
    /// # Errors
    /// [`LinearError::Parameter`] unless 0 < α ≤ 1; [`LinearError::Shape`].
    pub fn under_relax(&mut self, alpha: f64, x: &[f64], b: &mut [f64]) -> Result<(), LinearError> {
        check_fraction("the relaxation factor", alpha)?;
        check_length("x", self.n(), x.len())?;
        check_length("b", self.n(), b.len())?;
        let gain = (1.0 - alpha) / alpha;
        let spans = self.spans.clone();
        if self.own_axes().next().is_some() {
            for cell in spans.rows(self.cells[0], self.rows()).flatten() {
                let diagonal = self.diagonal(cell);
                b[cell] += gain * diagonal * x[cell];
                self.centre[cell] += gain * diagonal;
            }
            return Ok(());
        }
        for run in spans.rows(self.cells[0], self.rows()) {
            let b = b[run.clone()].iter_mut();
            for ((centre, x), b) in self.centre[run.clone()].iter_mut().zip(&x[run]).zip(b) {
                *b += gain * *centre * x;
                *centre /= alpha;
            }
        }
        Ok(())
    }

    /// Fixes an unknown: its row becomes a_P x_P = a_P `value`, where a_P stays unless it vanishes (then 1).
    ///
    /// # Errors
    /// [`LinearError::Pattern`] if there is no such cell; [`LinearError::NonFinite`], [`LinearError::Shape`].
    pub fn pin(&mut self, cell: usize, value: f64, b: &mut [f64]) -> Result<(), LinearError> {
        self.blend(cell, 1.0, value, b)
    }

    /// As [`pin`](Self::pin), and takes the known value out of the other rows, b_N −= a_NP `value`, so that a
    /// symmetric matrix stays symmetric.
    ///
    /// # Errors
    /// As [`pin`](Self::pin).
    pub fn pin_symmetric(&mut self, cell: usize, value: f64, b: &mut [f64]) -> Result<(), LinearError> {
        self.pin(cell, value, b)?;
        for axis in 0..D {
            for (end, back) in [(End::Lower, End::Upper), (End::Upper, End::Lower)] {
                match self.neighbour(cell, axis, end) {
                    Some(other) if other != cell => {
                        let coefficient = match back {
                            End::Lower => &mut self.lower[axis][other],
                            End::Upper => &mut self.upper[axis][other],
                        };
                        b[other] -= *coefficient * value;
                        *coefficient = 0.0;
                    }
                    _ => {}
                }
            }
        }
        Ok(())
    }

    /// Mixes a row with x_P = `value`: its neighbours and b are weighted by 1 − `weight`, and b gains
    /// `weight` a_P `value`. Weight 1 is [`pin`](Self::pin).
    ///
    /// # Errors
    /// [`LinearError::Parameter`] unless 0 ≤ weight ≤ 1; else as [`pin`](Self::pin).
    pub fn blend(&mut self, cell: usize, weight: f64, value: f64, b: &mut [f64]) -> Result<(), LinearError> {
        check_blend(weight, cell, value)?;
        check_length("b", self.n(), b.len())?;
        self.check_cell(cell)?;
        let mut diagonal = self.diagonal(cell);
        if diagonal == 0.0 && weight > 0.0 {
            diagonal = 1.0;
        }
        // What makes up the diagonal is gathered in the centre.
        self.centre[cell] = diagonal;
        for axis in 0..D {
            let kept = if self.periodic[axis] && self.cells[axis] == 1 { 0.0 } else { 1.0 - weight };
            self.lower[axis][cell] *= kept;
            self.upper[axis][cell] *= kept;
        }
        b[cell] = (1.0 - weight) * b[cell] + weight * diagonal * value;
        Ok(())
    }

    /// Smallest a_P − Σ_N |a_N| over a_P: not negative if the matrix is diagonally dominant by rows.
    /// Not finite if an entry is not or a diagonal vanishes.
    pub fn dominance(&self) -> f64 {
        (0..self.n())
            .map(|cell| {
                let others = self.neighbours(cell).filter(|n| n.2 != cell);
                let sum: f64 = others.map(|(axis, end, _)| self.coefficients(axis, end)[cell].abs()).sum();
                1.0 - sum / self.diagonal(cell).abs()
            })
            .fold(f64::INFINITY, smallest)
    }

    /// Whether a_P > 0, a_N ≤ 0 and every row is diagonally dominant to round-off: sufficient, with one row strictly
    /// so, for an M-matrix, whose solutions of positive b are positive.
    pub fn is_m_matrix(&self) -> bool {
        let signs = (0..self.n()).all(|cell| {
            let mut others = self.neighbours(cell).filter(|n| n.2 != cell);
            self.diagonal(cell) > 0.0
                && others.all(|(axis, end, _)| self.coefficients(axis, end)[cell] <= 0.0)
        });
        signs && self.dominance() >= -1e-12
    }

    /// The same matrix in compressed rows.
    ///
    /// # Errors
    /// None that can be reached from here: the errors of [`Matrix::from_pattern`].
    pub fn to_matrix(&self) -> Result<Matrix, LinearError> {
        let places = (0..self.n()).flat_map(|cell| self.neighbours(cell).map(move |n| (cell, n.2)));
        let mut matrix = Matrix::from_pattern(self.n(), places)?;
        self.write_to(&mut matrix)?;
        Ok(matrix)
    }

    /// Writes the values into compressed rows made by [`to_matrix`](Self::to_matrix).
    ///
    /// # Errors
    /// [`LinearError::Shape`], and [`LinearError::Pattern`] if the pattern lacks an entry.
    pub fn write_to(&self, matrix: &mut Matrix) -> Result<(), LinearError> {
        check_length("the matrix", self.n(), matrix.n())?;
        matrix.clear();
        for cell in 0..self.n() {
            matrix.add(cell, cell, self.centre[cell])?;
            for (axis, end, other) in self.neighbours(cell) {
                matrix.add(cell, other, self.coefficients(axis, end)[cell])?;
            }
        }
        Ok(())
    }
}

/// One step from place `at` of `n` along an axis.
fn step(index: usize, at: usize, stride: usize, n: usize, periodic: bool, end: End) -> Option<usize> {
    match end {
        End::Lower if at > 0 => Some(index - stride),
        End::Lower => periodic.then(|| index + (n - 1) * stride),
        End::Upper if at + 1 < n => Some(index + stride),
        End::Upper => periodic.then(|| index - at * stride),
    }
}
