//! Shifts along one axis.
use super::Interpolation;
use super::spline::{Collocation, MARGIN};
use super::stencil::{Lines, phase};
use monomorphic::fourier_transforms;
use rustfft::Fft;
use rustfft::num_complex::Complex;
use std::sync::Arc;

/// An operator or its transpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Operator,
    Transpose,
}

/// What is known of an axis.
pub(super) struct Axis {
    n: usize,
    periodic: bool,
    kind: Kind,
}

/// Nodes on either side of a line whose coefficients are found and not used. Beyond the ends of a bounded axis
/// the [`MARGIN`] before them is: its last coefficient, that of all nodes further on, is the value at the end.
fn padding(periodic: bool) -> usize {
    if periodic { MARGIN } else { 2 * MARGIN }
}

/// Origin of a shifted value.
enum Place {
    /// The first or the last node.
    End(usize),
    /// Between this node and the next.
    Behind(usize),
}

enum Kind {
    Lagrange(Interpolation),
    /// Coefficients of `n` nodes and [`padding`] on either side.
    Spline(Interpolation, Collocation),
    Spectral([Arc<dyn Fft<f64>>; 2]),
}

impl Axis {
    pub(super) fn new(n: usize, periodic: bool, interpolation: Interpolation) -> Self {
        let kind = match (interpolation, interpolation.basis()) {
            (Interpolation::Spectral, _) => {
                Kind::Spectral(fourier_transforms(if periodic { n } else { 2 * n }))
            }
            (_, Some(basis)) => {
                Kind::Spline(interpolation, Collocation::new(basis, n + 2 * padding(periodic)))
            }
            _ => Kind::Lagrange(interpolation),
        };
        Self { n, periodic, kind }
    }

    /// Node number `i`, wherever it is.
    fn node(&self, i: isize) -> usize {
        let n = self.n as isize;
        (if self.periodic { i.rem_euclid(n) } else { i.clamp(0, n - 1) }) as usize
    }

    /// The number of coefficients of a line, and which of them belongs to node `i`.
    pub(super) fn n_coefficients(&self) -> usize {
        match self.kind {
            Kind::Spline(..) if !self.periodic => self.n + 2 * MARGIN,
            _ => self.n,
        }
    }

    /// Which of the coefficients belongs to node `i`.
    pub(super) fn coefficient(&self, i: isize) -> usize {
        let n = self.n_coefficients();
        if n == self.n { self.node(i) } else { (i + MARGIN as isize).clamp(0, n as isize - 1) as usize }
    }

    /// Replaces the data, blocks of `n` × `inner`, by q(x − s), `s` in cells.
    pub(super) fn shift(&self, s: f64, side: Side, inner: usize, data: &mut Vec<f64>) {
        // Whole periods are nothing; on a bounded axis nothing is left but the value at the end after n cells and the margin.
        let limit = (self.n + MARGIN) as f64;
        let s = if self.periodic { s.rem_euclid(self.n as f64) } else { s.clamp(-limit, limit) };
        let whole = s.ceil();
        match &self.kind {
            Kind::Spectral(transforms) if self.periodic => {
                spectral(transforms, self.n, s, side, inner, data);
            }
            _ if whole == s => self.sum(&[1.0], -whole as isize, Axis::node, self.n, side, inner, data),
            Kind::Spectral(transforms) => {
                self.shift_reflected(transforms, whole, s, side, inner, data);
            }
            Kind::Lagrange(i) | Kind::Spline(i, _) => {
                let (weights, reach) = (i.weights(whole - s), i.reach());
                let weights = &weights[..2 * reach];
                let first = 1 - reach as isize - whole as isize;
                if side == Side::Operator {
                    self.coefficients(inner, data);
                }
                self.sum(weights, first, Axis::coefficient, self.n_coefficients(), side, inner, data);
                if side == Side::Transpose {
                    self.coefficients_transposed(inner, data);
                }
            }
        }
    }

    /// Shift of the even reflection of a bounded line about its ends, which has a period of 2n
    /// cells; constant beyond the first and the last node.
    fn shift_reflected(
        &self,
        transforms: &[Arc<dyn Fft<f64>>; 2],
        whole: f64,
        s: f64,
        side: Side,
        inner: usize,
        data: &mut [f64],
    ) {
        let n = self.n;
        // Value i is that at i − whole + (whole − s): between two nodes, or beyond an end.
        let place = |i: usize| match i as isize - whole as isize {
            at if at < 0 => Place::End(0),
            at if at as usize >= n - 1 => Place::End(n - 1),
            at => Place::Behind(at as usize),
        };
        let row = |i: usize| i * inner..(i + 1) * inner;
        let mut line = vec![0.0; 2 * n * inner];
        for block in data.chunks_exact_mut(n * inner) {
            match side {
                Side::Operator => {
                    for i in 0..n {
                        line[row(i)].copy_from_slice(&block[row(i)]);
                        line[row(2 * n - 1 - i)].copy_from_slice(&block[row(i)]);
                    }
                    let ends = [0, n - 1].map(|i| block[row(i)].to_vec());
                    spectral(transforms, 2 * n, s - whole, side, inner, &mut line);
                    for i in 0..n {
                        block[row(i)].copy_from_slice(match place(i) {
                            Place::End(end) => &ends[usize::from(end > 0)],
                            Place::Behind(at) => &line[row(at)],
                        });
                    }
                }
                Side::Transpose => {
                    line.fill(0.0);
                    let mut ends = vec![0.0; n * inner];
                    for i in 0..n {
                        let to = match place(i) {
                            Place::End(end) => &mut ends[row(end)],
                            Place::Behind(at) => &mut line[row(at)],
                        };
                        to.iter_mut().zip(&block[row(i)]).for_each(|(to, x)| *to += x);
                    }
                    spectral(transforms, 2 * n, s - whole, side, inner, &mut line);
                    for i in 0..n {
                        let parts = ends[row(i)].iter().zip(&line[row(i)]).zip(&line[row(2 * n - 1 - i)]);
                        for (to, ((end, a), b)) in block[row(i)].iter_mut().zip(parts) {
                            *to = end + a + b;
                        }
                    }
                }
            }
        }
    }

    /// Weighted sums of the coefficients from number i + `first` on.
    #[expect(clippy::too_many_arguments, reason = "one line of a formula")]
    fn sum(
        &self,
        weights: &[f64],
        first: isize,
        index: fn(&Self, isize) -> usize,
        n_coefficients: usize,
        side: Side,
        inner: usize,
        data: &mut Vec<f64>,
    ) {
        let index: Vec<_> =
            (0..self.n + weights.len() - 1).map(|i| index(self, i as isize + first)).collect();
        let lines = Lines { n: self.n, inner };
        let (n, m) = (self.n, n_coefficients);
        match side {
            Side::Operator => {
                let mut out = vec![0.0; data.len() / m * n];
                lines.gather(weights, &index, data, m, &mut out);
                *data = out;
            }
            Side::Transpose => {
                let mut out = vec![0.0; data.len() / n * m];
                lines.scatter(weights, &index, data, m, &mut out);
                *data = out;
            }
        }
    }

    /// Replaces blocks of `n` × `inner` values by blocks of their coefficients.
    pub(super) fn coefficients(&self, inner: usize, data: &mut Vec<f64>) {
        let Kind::Spline(_, collocation) = &self.kind else { return };
        let (n, m) = (self.n, self.n_coefficients());
        let mut out = Vec::with_capacity(data.len() / n * m);
        let padding = padding(self.periodic);
        let start = (padding - (m - n) / 2) * inner;
        let mut line = vec![0.0; (n + 2 * padding) * inner];
        for block in data.chunks_exact(n * inner) {
            for (i, row) in line.chunks_exact_mut(inner).enumerate() {
                row.copy_from_slice(&block[self.node(i as isize - padding as isize) * inner..][..inner]);
            }
            collocation.solve(inner, &mut line);
            out.extend_from_slice(&line[start..][..m * inner]);
        }
        *data = out;
    }

    /// The transpose of [`Self::coefficients`].
    pub(super) fn coefficients_transposed(&self, inner: usize, data: &mut Vec<f64>) {
        let Kind::Spline(_, collocation) = &self.kind else { return };
        let (n, m) = (self.n, self.n_coefficients());
        let mut out = vec![0.0; data.len() / m * n];
        let padding = padding(self.periodic);
        let start = (padding - (m - n) / 2) * inner;
        let mut line = vec![0.0; (n + 2 * padding) * inner];
        for (out, block) in out.chunks_exact_mut(n * inner).zip(data.chunks_exact(m * inner)) {
            line.fill(0.0);
            line[start..][..block.len()].copy_from_slice(block);
            collocation.solve(inner, &mut line);
            for (i, row) in line.chunks_exact(inner).enumerate() {
                let to = &mut out[self.node(i as isize - padding as isize) * inner..][..inner];
                to.iter_mut().zip(row).for_each(|(to, x)| *to += x);
            }
        }
        *data = out;
    }
}

/// Multiplies the Fourier coefficients by the phases of `s` cells; two real lines at a time are one complex line.
fn spectral(
    transforms: &[Arc<dyn Fft<f64>>; 2],
    n: usize,
    s: f64,
    side: Side,
    inner: usize,
    data: &mut [f64],
) {
    let factors: Vec<_> = (0..n)
        .map(|m| {
            let [re, im] = phase(m, n, s);
            let factor = Complex::new(re, im) / n as f64;
            if side == Side::Operator { factor } else { factor.conj() }
        })
        .collect();
    let [forward, inverse] = transforms;
    let mut scratch =
        vec![Complex::default(); forward.get_inplace_scratch_len().max(inverse.get_inplace_scratch_len())];
    let mut line = vec![Complex::default(); n];
    let n_lines = data.len() / n;
    // Line number l begins here.
    let start = |l: usize| l / inner * n * inner + l % inner;
    for l in (0..n_lines).step_by(2) {
        let (a, b) = (start(l), (l + 1 < n_lines).then(|| start(l + 1)));
        for (i, z) in line.iter_mut().enumerate() {
            *z = Complex::new(data[a + i * inner], b.map_or(0.0, |b| data[b + i * inner]));
        }
        forward.process_with_scratch(&mut line, &mut scratch);
        line.iter_mut().zip(&factors).for_each(|(z, f)| *z *= f);
        inverse.process_with_scratch(&mut line, &mut scratch);
        for (i, z) in line.iter().enumerate() {
            data[a + i * inner] = z.re;
            if let Some(b) = b {
                data[b + i * inner] = z.im;
            }
        }
    }
}
