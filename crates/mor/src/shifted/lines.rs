//! Transforms along one axis of fields.
use rustfft::Fft;
use rustfft::num_complex::Complex;

/// Lines that are transformed at a time: as many neighbours are read and written together.
const TOGETHER: usize = 8;

/// Memory for transforms, to be used again.
#[derive(Default)]
pub(super) struct Lines {
    lines: Vec<Complex<f64>>,
    scratch: Vec<Complex<f64>>,
}

impl Lines {
    /// Transforms blocks of n × `inner` values along n, the length of `transform`.
    pub(super) fn transform(&mut self, transform: &dyn Fft<f64>, inner: usize, data: &mut [Complex<f64>]) {
        let n = transform.len();
        let Self { lines, scratch } = self;
        scratch.resize(transform.get_inplace_scratch_len(), Complex::default());
        if inner == 1 {
            transform.process_with_scratch(data, scratch);
            return;
        }
        lines.resize(n * TOGETHER, Complex::default());
        for block in data.chunks_exact_mut(n * inner) {
            for first in (0..inner).step_by(TOGETHER) {
                let width = TOGETHER.min(inner - first);
                let lines = &mut lines[..n * width];
                for (i, row) in block.chunks_exact(inner).enumerate() {
                    row[first..first + width].iter().enumerate().for_each(|(l, z)| lines[l * n + i] = *z);
                }
                transform.process_with_scratch(lines, scratch);
                for (i, row) in block.chunks_exact_mut(inner).enumerate() {
                    row[first..first + width].iter_mut().enumerate().for_each(|(l, z)| *z = lines[l * n + i]);
                }
            }
        }
    }

    /// Zeros for so many lines of `transform`, and what it needs besides.
    pub(super) fn blank(
        &mut self,
        transform: &dyn Fft<f64>,
        count: usize,
    ) -> (&mut [Complex<f64>], &mut [Complex<f64>]) {
        self.lines.resize(transform.len() * count, Complex::default());
        self.scratch.resize(transform.get_inplace_scratch_len(), Complex::default());
        (&mut self.lines, &mut self.scratch)
    }
}
