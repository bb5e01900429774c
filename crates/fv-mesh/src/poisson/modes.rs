//! Where the modes of a layer lie and in which blocks they are swept.
use super::transform::AxisTransform;
use pulp::bytemuck;
use rustfft::num_complex::Complex;

/// Modes in a row that a block takes from one place of a layer; it takes two such segments.
pub(super) const SEGMENT: usize = 4;
/// Complex numbers of a cache line.
const LINE: usize = 4;
/// Modes of a block.
pub(super) const WIDTH: usize = 2 * SEGMENT;

/// Layout of the complex spectrum of one layer, which carries two real layers a + ib.
///
/// A sweep has to tell a from b at the ends of the last axis. On a Fourier axis â_k is the complex
/// conjugate of â_{−k}, so mode k of a + ib parts into â_k and b̂_k together with its mirror −k; with
/// cosines â and b̂ are real and every mode is its own mirror. Each block therefore holds a segment
/// of modes and the segment of their mirrors. Mode n, a copy of mode 0, completes the mirror pairs.
/// Segments may reach past a row into padding.
pub(super) struct Modes {
    n: usize,
    /// Padding ahead of a row.
    pub(super) front: usize,
    /// From row to row.
    pub(super) row_stride: usize,
    /// From layer to layer.
    pub(super) layer_stride: usize,
    /// Offsets of both segments of each block in a layer.
    pub(super) blocks: Vec<[usize; 2]>,
    /// Lane of a block that holds the mirror of each lane.
    pub(super) mirror: [usize; WIDTH],
}

impl Modes {
    pub(super) fn new(x: &AxisTransform, y: Option<&AxisTransform>) -> Self {
        let (n, rows) = (x.len(), y.map_or(1, AxisTransform::len));
        let mirrored_rows = y.is_some_and(AxisTransform::periodic);
        let mirror_row = |row: usize| if mirrored_rows { (rows - row) % rows } else { row };
        // First mode of both segments of each block in a row; which rows need blocks; the mirrors.
        let (segments, rows_swept, mirror): (Vec<[isize; 2]>, _, [usize; WIDTH]) = if x.periodic() {
            let starts = (0..=n / 2).step_by(SEGMENT).map(|k| k as isize);
            let segments = starts.map(|k| [k, n as isize + 1 - k - SEGMENT as isize]).collect();
            (segments, rows, std::array::from_fn(|lane| WIDTH - 1 - lane))
        } else if mirrored_rows {
            let starts = (0..n).step_by(SEGMENT).map(|k| k as isize);
            let mirror = std::array::from_fn(|lane| (lane + SEGMENT) % WIDTH);
            (starts.map(|k| [k, k]).collect(), rows / 2 + 1, mirror)
        } else {
            let starts = (0..n).step_by(WIDTH).map(|k| k as isize);
            (starts.map(|k| [k, k + SEGMENT as isize]).collect(), rows, std::array::from_fn(|lane| lane))
        };
        let first = segments.iter().flatten().fold(0, |a, &k| a.min(k));
        let end = segments.iter().flatten().fold(n as isize, |a, &k| a.max(k + SEGMENT as isize));
        // Mode 0 of every row begins a cache line.
        let front = ((-first) as usize).next_multiple_of(LINE);
        let row_stride = (front + end as usize).next_multiple_of(LINE);
        let place = |row: usize, k: isize| row * row_stride + (front as isize + k) as usize;
        let blocks = (0..rows_swept)
            .flat_map(|row| segments.iter().map(move |s| (row, s)))
            .map(|(row, &[low, high])| [place(row, low), place(mirror_row(row), high)])
            .collect();
        // An odd number of cache lines spreads the layers over the sets of the caches.
        let layer_stride = ((rows * row_stride / LINE) | 1) * LINE;
        Self { n, front, row_stride, layer_stride, blocks, mirror }
    }

    /// Mode along x and row of a place in a layer; none in the padding.
    pub(super) fn at(&self, place: usize) -> Option<(usize, usize)> {
        let (row, k) = (place / self.row_stride, (place % self.row_stride).checked_sub(self.front)?);
        (k <= self.n).then_some((k % self.n, row))
    }

    /// Puts the modes of complex layer `s` from where the sweeps left them, block by block and layer
    /// by layer, to their places in the layer.
    #[inline(always)]
    pub(super) fn gather(&self, s: usize, solutions: &[f64], layer: &mut [Complex<f64>]) {
        let block = solutions.len() / self.blocks.len();
        let layer: &mut [f64] = bytemuck::cast_slice_mut(layer);
        for (b, segments) in self.blocks.iter().enumerate() {
            let lanes = &solutions[b * block + s * 2 * WIDTH..][..2 * WIDTH];
            for (at, from) in segments.iter().zip(lanes.chunks_exact(2 * SEGMENT)) {
                layer[2 * at..2 * at + 2 * SEGMENT].copy_from_slice(from);
            }
        }
    }
}
