//! Fourier, cosine and sine transforms of real data, two lines at a time.
use super::super::PoissonAxis;
use super::super::transform::AxisTransform;
use rustfft::num_complex::Complex;

/// Real numbers that are gathered from each row when columns are transformed.
const GROUP: usize = 16;

/// Diagonalises a uniform axis with like ends by a real transform, not normalised: Hartley's on a
/// periodic axis (real and linear, with cos + sin in place of e^{−i}), else the cosine or sine transform.
pub(super) struct FastTransform {
    transform: AxisTransform,
    width: f64,
}

/// Work space of transforms.
pub(super) struct FastScratch {
    fft: Vec<Complex<f64>>,
    lines: Vec<Complex<f64>>,
}

impl FastScratch {
    /// Room for the transforms of some axes.
    pub(super) fn new<'a>(transforms: impl Iterator<Item = &'a FastTransform>) -> Self {
        let (mut fft, mut lines) = (0, 0);
        for FastTransform { transform, .. } in transforms {
            fft = fft.max(transform.scratch_len());
            lines = lines.max(transform.len() * GROUP / 2);
        }
        Self { fft: vec![Complex::default(); fft], lines: vec![Complex::default(); lines] }
    }
}

impl FastTransform {
    pub(super) fn new(axis: &PoissonAxis) -> Self {
        let width = axis.length() / axis.cells() as f64;
        Self { transform: AxisTransform::new(axis.cells(), axis.ends), width }
    }

    pub(super) fn eigenvalues(&self) -> Vec<f64> {
        let scale = 1.0 / (self.width * self.width);
        (0..self.transform.len()).map(|k| self.transform.eigenvalue(k) * scale).collect()
    }

    /// Transforms `rows` rows, `ld` apart, in place.
    #[inline(always)]
    pub(super) fn rows(
        &self,
        data: &mut [f64],
        ld: usize,
        rows: usize,
        forward: bool,
        scratch: &mut FastScratch,
    ) {
        let n = self.transform.len();
        let line = &mut scratch.lines[..n];
        let none: &mut [f64] = &mut [];
        for first in (0..rows).step_by(2) {
            let pair = &mut data[first * ld..];
            let (a, b) = if first + 1 < rows {
                let (a, b) = pair.split_at_mut(ld);
                (&mut a[..n], &mut b[..n])
            } else {
                (&mut pair[..n], &mut none[..])
            };
            if forward {
                if b.is_empty() {
                    self.transform.pack(a, a, line);
                } else {
                    self.transform.pack(a, b, line);
                }
                self.forward(line, &mut scratch.fft);
                for (a, z) in a.iter_mut().zip(&*line) {
                    *a = z.re;
                }
                for (b, z) in b.iter_mut().zip(&*line) {
                    *b = z.im;
                }
            } else {
                for (z, &re) in line.iter_mut().zip(&*a) {
                    *z = Complex { re, im: re };
                }
                for (z, &im) in line.iter_mut().zip(&*b) {
                    z.im = im;
                }
                self.inverse(line, &mut scratch.fft);
                self.transform.unpack(line, a, b);
            }
        }
    }

    /// Transforms `columns` columns of `data`, whose rows are `ld` apart, in place.
    #[inline(always)]
    pub(super) fn columns(
        &self,
        data: &mut [f64],
        ld: usize,
        columns: usize,
        forward: bool,
        scratch: &mut FastScratch,
    ) {
        for start in (0..columns).step_by(GROUP) {
            let width = GROUP.min(columns - start);
            self.gather(&data[start..], ld, width, forward, scratch);
            self.scatter(&mut data[start..], ld, width, forward, scratch);
        }
    }

    /// Transforms `columns` columns from `from` to `to`.
    #[inline(always)]
    pub(super) fn columns_to(
        &self,
        (from, from_ld): (&[f64], usize),
        (to, to_ld): (&mut [f64], usize),
        columns: usize,
        forward: bool,
        scratch: &mut FastScratch,
    ) {
        for start in (0..columns).step_by(GROUP) {
            let width = GROUP.min(columns - start);
            self.gather(&from[start..], from_ld, width, forward, scratch);
            self.scatter(&mut to[start..], to_ld, width, forward, scratch);
        }
    }

    /// Gathers columns, two to a complex line, and transforms them.
    #[inline(always)]
    fn gather(&self, data: &[f64], ld: usize, width: usize, forward: bool, scratch: &mut FastScratch) {
        let n = self.transform.len();
        let lines = &mut scratch.lines[..n * GROUP / 2];
        let mut lanes = [0.0; GROUP];
        for j in 0..n {
            let (slot, sign) = if forward { self.transform.slot(j) } else { (j, 1.0) };
            lanes[..width].copy_from_slice(&data[j * ld..][..width]);
            for c in 0..GROUP / 2 {
                lines[c * n + slot] = Complex { re: sign * lanes[2 * c], im: sign * lanes[2 * c + 1] };
            }
        }
        let lines = &mut lines[..n * width.div_ceil(2)];
        if forward {
            self.forward(lines, &mut scratch.fft);
        } else {
            self.inverse(lines, &mut scratch.fft);
        }
    }

    #[inline(always)]
    fn scatter(&self, data: &mut [f64], ld: usize, width: usize, forward: bool, scratch: &FastScratch) {
        let n = self.transform.len();
        let lines = &scratch.lines[..n * GROUP / 2];
        let mut lanes = [0.0; GROUP];
        for j in 0..n {
            let (slot, sign) = if forward { (j, 1.0) } else { self.transform.slot(j) };
            for c in 0..GROUP / 2 {
                let z = lines[c * n + slot];
                (lanes[2 * c], lanes[2 * c + 1]) = (sign * z.re, sign * z.im);
            }
            data[j * ld..][..width].copy_from_slice(&lanes[..width]);
        }
    }

    #[inline(always)]
    fn forward(&self, lines: &mut [Complex<f64>], fft: &mut [Complex<f64>]) {
        self.transform.forward(lines, fft);
        if self.transform.periodic() {
            self.hartley(lines, 0.5, 0.5);
        }
    }

    #[inline(always)]
    fn inverse(&self, lines: &mut [Complex<f64>], fft: &mut [Complex<f64>]) {
        if self.transform.periodic() {
            self.hartley(lines, 0.5, -0.5);
        }
        self.transform.inverse(lines, fft);
    }

    /// Fourier to Hartley spectra, H_k = α Z_k + ᾱ Z_{−k} with α = (1 + i)/2, or back, with ᾱ for α.
    #[inline(always)]
    fn hartley(&self, lines: &mut [Complex<f64>], re: f64, im: f64) {
        let (alpha, beta) = (Complex { re, im }, Complex { re, im: -im });
        let n = self.transform.len();
        for line in lines.chunks_exact_mut(n) {
            // Modes 0 and n/2 are their own mirrors and stay.
            let (low, high) = line[1..].split_at_mut(n / 2);
            for (p, q) in low[..(n - 1) / 2].iter_mut().zip(high.iter_mut().rev()) {
                (*p, *q) = (alpha * *p + beta * *q, alpha * *q + beta * *p);
            }
        }
    }
}
