//! Products with a matrix that stays the same, packed once.
//!
//! Both factors are packed in panels whose entries stand in the order they are used in: [`MR`] rows of
//! the left one and [`NR`] columns of the right one, in blocks of [`KC`] terms, so that a panel of the
//! matrix stays in the first cache while those of the data pass (Goto & van de Geijn 2008).
use super::super::aligned::Aligned;
use pulp::Simd;

/// Rows of a tile.
pub(super) const MR: usize = 6;
/// Columns of a tile.
pub(super) const NR: usize = 8;
/// Terms summed up in one go.
const KC: usize = 256;

/// Which factor is the matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// It acts on columns.
    Left,
    /// It acts on rows, transposed.
    Right,
}

/// A square matrix M, packed to be multiplied with data from one side: M U or U Mᵀ.
pub(super) struct Matrix {
    n: usize,
    side: Side,
    panels: Aligned<f64>,
}

/// Size of a packed factor with `lines` rows or columns of `terms` entries.
pub(super) fn packed_len(lines: usize, terms: usize, width: usize) -> usize {
    lines.next_multiple_of(width) * terms
}

/// Packs the lines of a factor: entry k of line l is `at(l, k)`.
fn pack(
    lines: usize,
    terms: usize,
    width: usize,
    panels: &mut [f64],
    mut at: impl FnMut(usize, usize) -> f64,
) {
    let mut out = panels.iter_mut();
    for start in (0..terms).step_by(KC) {
        for first in (0..lines).step_by(width) {
            for k in start..terms.min(start + KC) {
                for (l, out) in (first..first + width).zip(&mut out) {
                    *out = if l < lines { at(l, k) } else { 0.0 };
                }
            }
        }
    }
}

/// Packs rows of data, `ld` apart, as a left factor.
#[inline(always)]
pub(super) fn pack_rows(data: &[f64], ld: usize, rows: usize, terms: usize, panels: &mut [f64]) {
    let mut rest = panels;
    for start in (0..terms).step_by(KC) {
        let depth = KC.min(terms - start);
        for first in (0..rows).step_by(MR) {
            let (panel, tail) = rest.split_at_mut(depth * MR);
            rest = tail;
            // Rows past the end repeat the last one; their products are dropped.
            let row = |l: usize| &data[(first + l).min(rows - 1) * ld + start..][..depth];
            let lines: [&[f64]; MR] = std::array::from_fn(row);
            for (k, out) in panel.as_chunks_mut::<MR>().0.iter_mut().enumerate() {
                *out = std::array::from_fn(|l| lines[l][k]);
            }
        }
    }
}

/// Packs columns of data as a right factor; the rows are `ld` apart.
#[inline(always)]
pub(super) fn pack_columns(data: &[f64], ld: usize, columns: usize, terms: usize, panels: &mut [f64]) {
    let mut rest = panels;
    for start in (0..terms).step_by(KC) {
        let depth = KC.min(terms - start);
        let (block, tail) = rest.split_at_mut(depth * columns.next_multiple_of(NR));
        rest = tail;
        for k in 0..depth {
            let row = &data[(start + k) * ld..][..columns];
            let (whole, part) = row.as_chunks::<NR>();
            let mut panels = block.chunks_exact_mut(depth * NR);
            for (from, panel) in whole.iter().zip(&mut panels) {
                panel[k * NR..][..NR].copy_from_slice(from);
            }
            if let (false, Some(panel)) = (part.is_empty(), panels.next()) {
                panel[k * NR..][..NR].fill(0.0);
                panel[k * NR..][..part.len()].copy_from_slice(part);
            }
        }
    }
}

impl Matrix {
    /// Packs the matrix with entries `at(row, column)`.
    pub(super) fn new(n: usize, side: Side, at: impl Fn(usize, usize) -> f64) -> Self {
        let width = if side == Side::Left { MR } else { NR };
        let mut panels = Aligned::new(packed_len(n, n, width));
        pack(n, n, width, &mut panels, at);
        Self { n, side, panels }
    }

    /// Writes the product with `lines` packed columns (matrix on the left) or rows (on the right) to
    /// `out`, whose rows are `ld` apart.
    #[inline(always)]
    pub(super) fn multiply<S: Simd>(
        &self,
        simd: S,
        packed: &[f64],
        lines: usize,
        out: &mut [f64],
        ld: usize,
    ) {
        match NR / S::F64_LANES {
            1 => self.product::<S, 1>(simd, packed, lines, out, ld),
            2 => self.product::<S, 2>(simd, packed, lines, out, ld),
            4 => self.product::<S, 4>(simd, packed, lines, out, ld),
            _ => self.product::<S, NR>(simd, packed, lines, out, ld),
        }
    }

    #[inline(always)]
    fn product<S: Simd, const N: usize>(
        &self,
        simd: S,
        packed: &[f64],
        lines: usize,
        out: &mut [f64],
        ld: usize,
    ) {
        let left = self.side == Side::Left;
        let (rows, columns) = if left { (self.n, lines) } else { (lines, self.n) };
        let (own, other) = if left { (MR, NR) } else { (NR, MR) };
        let (mut matrix, mut data) = (&*self.panels, packed);
        for start in (0..self.n).step_by(KC) {
            let depth = KC.min(self.n - start);
            let (matrix_block, matrix_tail) = matrix.split_at(packed_len(self.n, depth, own));
            let (data_block, data_tail) = data.split_at(packed_len(lines, depth, other));
            (matrix, data) = (matrix_tail, data_tail);
            for (p, m) in matrix_block.chunks_exact(depth * own).enumerate() {
                for (q, d) in data_block.chunks_exact(depth * other).enumerate() {
                    let (a, b, i, j) = if left { (m, d, p * MR, q * NR) } else { (d, m, q * MR, p * NR) };
                    let tile = tile::<S, N>(simd, a, b);
                    let (height, width) = (MR.min(rows - i), NR.min(columns - j));
                    for (r, tile) in tile.iter().take(height).enumerate() {
                        let out = &mut out[(i + r) * ld + j..][..width];
                        store::<S, N>(simd, tile, out, start > 0);
                    }
                }
            }
        }
    }
}

/// Product of a left and a right panel.
#[inline(always)]
fn tile<S: Simd, const N: usize>(simd: S, a: &[f64], b: &[f64]) -> [[S::f64s; N]; MR] {
    let mut sum = [[simd.splat_f64s(0.0); N]; MR];
    let (a, b) = (a.as_chunks::<MR>().0, S::as_simd_f64s(b).0.as_chunks::<N>().0);
    for (a, b) in a.iter().zip(b) {
        for r in 0..MR {
            let a = simd.splat_f64s(a[r]);
            for q in 0..N {
                sum[r][q] = simd.mul_add_e_f64s(a, b[q], sum[r][q]);
            }
        }
    }
    sum
}

/// Writes or adds a row of a tile.
#[inline(always)]
fn store<S: Simd, const N: usize>(simd: S, row: &[S::f64s; N], out: &mut [f64], add: bool) {
    if out.len() == NR {
        let out = S::as_mut_simd_f64s(out).0;
        for q in 0..N {
            out[q] = if add { simd.add_f64s(out[q], row[q]) } else { row[q] };
        }
        return;
    }
    let mut lanes = [0.0; NR];
    S::as_mut_simd_f64s(&mut lanes).0.copy_from_slice(row);
    for (out, lane) in out.iter_mut().zip(lanes) {
        *out = if add { *out + lane } else { lane };
    }
}
