//! Transforms that diagonalise the second difference along one axis.
//!
//! They act on complex data that carry two real fields at once, one as real and one as imaginary
//! part. Being linear over the complex numbers they need not tell the two apart.
use super::AxisBounds;
use monomorphic::fourier_transforms;
use rustfft::Fft;
use rustfft::num_complex::Complex;
use std::f64::consts::PI;
use std::sync::Arc;

/// Fourier transform (periodic axis) or cosine transform of the second kind (walls) of length n,
/// both ways, not normalised: forward and back multiply by n.
///
/// The sine transform of a Dirichlet axis is a cosine transform of (−1)^j f_j: the sign turns odd
/// images into even ones. The cosine transform is an FFT of the even entries followed by the odd
/// ones backwards (Makhoul 1980), then a twist of the spectrum.
pub(super) struct AxisTransform {
    bounds: AxisBounds,
    n: usize,
    forward: Arc<dyn Fft<f64>>,
    inverse: Arc<dyn Fft<f64>>,
    /// exp(−iπk/2n), k = 0..=n/2; empty on a periodic axis.
    twist: Vec<Complex<f64>>,
}

impl AxisTransform {
    pub(super) fn new(n: usize, bounds: AxisBounds) -> Self {
        let [forward, inverse] = fourier_transforms(n);
        let quarter = |k: usize| Complex::from_polar(1.0, -PI * k as f64 / (2 * n) as f64);
        let walls = bounds != AxisBounds::Periodic;
        Self {
            bounds,
            n,
            forward,
            inverse,
            twist: if walls { (0..=n / 2).map(quarter).collect() } else { Vec::new() },
        }
    }

    pub(super) fn len(&self) -> usize {
        self.n
    }

    pub(super) fn periodic(&self) -> bool {
        self.bounds == AxisBounds::Periodic
    }

    /// Complex numbers of scratch that [`Self::forward`] and [`Self::inverse`] need.
    pub(super) fn scratch_len(&self) -> usize {
        self.forward.get_inplace_scratch_len().max(self.inverse.get_inplace_scratch_len())
    }

    /// Minus the eigenvalue of the second difference for mode k, per cell size squared.
    pub(super) fn eigenvalue(&self, k: usize) -> f64 {
        let n = self.n as f64;
        match self.bounds {
            AxisBounds::Periodic => 4.0 * (PI * k.min(self.n - k) as f64 / n).sin().powi(2),
            AxisBounds::Neumann => 4.0 * (PI * k as f64 / (2.0 * n)).sin().powi(2),
            _ => 4.0 * (PI * k as f64 / (2.0 * n)).cos().powi(2),
        }
    }

    /// Where entry j stands in the order that [`Self::forward`] takes and [`Self::inverse`] gives, and
    /// the sign it has there.
    #[inline(always)]
    pub(super) fn slot(&self, j: usize) -> (usize, f64) {
        match (self.periodic(), j % 2) {
            (true, _) => (j, 1.0),
            (false, 0) => (j / 2, 1.0),
            _ => (self.n - 1 - j / 2, self.odd_sign()),
        }
    }

    #[inline(always)]
    fn odd_sign(&self) -> f64 {
        if self.bounds == AxisBounds::Dirichlet { -1.0 } else { 1.0 }
    }

    /// Interleaves two real rows into one complex row, in the order of [`Self::slot`].
    #[inline(always)]
    pub(super) fn pack(&self, a: &[f64], b: &[f64], row: &mut [Complex<f64>]) {
        if self.periodic() {
            for ((z, &re), &im) in row.iter_mut().zip(a).zip(b) {
                *z = Complex { re, im };
            }
            return;
        }
        let sign = self.odd_sign();
        let (even, odd) = row.split_at_mut(self.n.div_ceil(2));
        for ((z, a), b) in even.iter_mut().zip(a.chunks(2)).zip(b.chunks(2)) {
            *z = Complex { re: a[0], im: b[0] };
        }
        for ((z, a), b) in odd.iter_mut().rev().zip(a.chunks_exact(2)).zip(b.chunks_exact(2)) {
            *z = Complex { re: sign * a[1], im: sign * b[1] };
        }
    }

    /// The reverse of [`Self::pack`]; `b` may be empty, its half is then dropped.
    #[inline(always)]
    pub(super) fn unpack(&self, row: &[Complex<f64>], a: &mut [f64], b: &mut [f64]) {
        self.unpack_part(row, |z| z.re, a);
        self.unpack_part(row, |z| z.im, b);
    }

    #[inline(always)]
    fn unpack_part(&self, row: &[Complex<f64>], part: impl Fn(&Complex<f64>) -> f64, out: &mut [f64]) {
        if self.periodic() {
            for (x, z) in out.iter_mut().zip(row) {
                *x = part(z);
            }
            return;
        }
        let sign = self.odd_sign();
        let (even, odd) = row.split_at(self.n.div_ceil(2));
        for (x, z) in out.iter_mut().step_by(2).zip(even) {
            *x = part(z);
        }
        for (x, z) in out.iter_mut().skip(1).step_by(2).zip(odd.iter().rev()) {
            *x = sign * part(z);
        }
    }

    /// Transforms lines of length n that lie one behind the other.
    #[inline(always)]
    pub(super) fn forward(&self, lines: &mut [Complex<f64>], scratch: &mut [Complex<f64>]) {
        self.forward.process_with_scratch(lines, scratch);
        if self.periodic() {
            return;
        }
        let i = Complex::<f64>::i();
        for line in lines.chunks_exact_mut(self.n) {
            self.twist_pairs(line, |w, low, high| {
                let (p, q) = (w * low, w.conj() * high);
                ((p + q).scale(0.5), (i * (p - q)).scale(0.5))
            });
        }
    }

    /// Transforms back.
    #[inline(always)]
    pub(super) fn inverse(&self, lines: &mut [Complex<f64>], scratch: &mut [Complex<f64>]) {
        if !self.periodic() {
            let i = Complex::<f64>::i();
            for line in lines.chunks_exact_mut(self.n) {
                self.twist_pairs(line, |w, low, high| (w.conj() * (low - i * high), w * (low + i * high)));
            }
        }
        self.inverse.process_with_scratch(lines, scratch);
    }

    /// Replaces the entries k and n − k by what `turn(twist_k, low, high)` makes of them.
    #[inline(always)]
    fn twist_pairs(
        &self,
        line: &mut [Complex<f64>],
        turn: impl Fn(Complex<f64>, Complex<f64>, Complex<f64>) -> (Complex<f64>, Complex<f64>),
    ) {
        let half = self.n / 2;
        let (low, high) = line[1..].split_at_mut(half);
        for ((low, high), &w) in low.iter_mut().zip(high.iter_mut().rev()).zip(&self.twist[1..]) {
            (*low, *high) = turn(w, *low, *high);
        }
        if self.n.is_multiple_of(2) {
            let middle = low[half - 1];
            low[half - 1] = turn(self.twist[half], middle, middle).0;
        }
    }
}
