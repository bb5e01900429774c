//! What several frames carry, as one field.
use super::Grid;
use super::lines::Lines;
use super::stencil::phase;
use monomorphic::fourier_transforms;
use rustfft::Fft;
use rustfft::num_complex::Complex;
use std::sync::Arc;

/// Pairs of real lines that are transformed at a time.
const PAIRS: usize = 8;

/// Σ_k T^{s_k} Σ_i c_i^k φ_i^k of frames that only move along periodic axes, with modes kept as their Fourier coefficients along these axes: as a shift multiplies those by
/// phases, the sum needs one inverse transform for all frames and modes.
///
/// Shifts are [`Spectral`](super::Interpolation::Spectral).
pub(crate) struct Superposition {
    cells: [usize; 3],
    spacing: [f64; 3],
    /// Coefficients along each axis: those of negative waves along the first axis that frames move along are left out, since fields are real.
    counts: [usize; 3],
    moving: Vec<usize>,
    inverse: Vec<Arc<dyn Fft<f64>>>,
    /// Of each frame the coefficients of its modes, one after the other: rows along x, real parts before imaginary parts.
    spectra: Vec<Vec<f64>>,
    components: usize,
}

/// Memory that predictions use again.
#[derive(Default)]
pub(crate) struct Workspace {
    waves: Vec<Complex<f64>>,
    lines: Lines,
    row: Vec<f64>,
}

impl Superposition {
    /// Of the modes of each frame, all with `rows` unknowns, and axes along which frames move; None if there is no such axis, or one of them is bounded.
    pub(crate) fn new<'a>(
        grid: &Grid,
        moving: Vec<usize>,
        rows: usize,
        frames: impl Iterator<Item = Vec<&'a [f64]>>,
    ) -> Option<Self> {
        let moving: Vec<usize> = moving.into_iter().filter(|&a| grid.cells()[a] > 1).collect();
        let first = *moving.first()?;
        if !moving.iter().all(|&a| grid.periodic()[a]) {
            return None;
        }
        let cells = grid.cells();
        let mut counts = cells;
        counts[first] = cells[first] / 2 + 1;
        let [forward, inverse] =
            [0, 1].map(|i| moving.iter().map(|&a| fourier_transforms(cells[a])[i].clone()).collect());
        let components = rows / grid.n_cells();
        let mut sum =
            Self { cells, spacing: grid.spacing(), counts, moving, inverse, spectra: Vec::new(), components };
        sum.spectra =
            frames.map(|modes| modes.iter().flat_map(|m| sum.spectrum(&forward, m)).collect()).collect();
        Some(sum)
    }

    /// Rows along x, real parts before imaginary parts.
    fn spectrum(&self, forward: &[Arc<dyn Fft<f64>>], mode: &[f64]) -> Vec<f64> {
        let mut waves: Vec<Complex<f64>> = mode.iter().map(|m| Complex::new(*m, 0.0)).collect();
        let mut lines = Lines::default();
        for (&a, transform) in self.moving.iter().zip(forward) {
            let inner = self.cells[..a].iter().product();
            lines.transform(&**transform, inner, &mut waves);
        }
        let [nx, ny, nz] = self.cells;
        let [mx, my, mz] = self.counts;
        let places = (0..self.components)
            .flat_map(|c| (0..mz).flat_map(move |z| (0..my).map(move |y| ((c * nz + z) * ny + y) * nx)));
        places
            .flat_map(|first| {
                let row = &waves[first..first + mx];
                row.iter().map(|w| w.re).chain(row.iter().map(|w| w.im)).collect::<Vec<_>>()
            })
            .collect()
    }

    /// The field of these displacements and coefficients, one of either for each frame.
    pub(crate) fn field(&self, frames: &[([f64; 3], Vec<f64>)], work: &mut Workspace, out: &mut [f64]) {
        self.waves(frames, work);
        for (&a, transform) in self.moving.iter().zip(&self.inverse).skip(1) {
            let inner = self.counts[..a].iter().product();
            work.lines.transform(&**transform, inner, &mut work.waves);
        }
        self.real(work, out);
    }

    /// The coefficients of the sum, divided by the number of cells that the inverse transform multiplies them by.
    fn waves(&self, frames: &[([f64; 3], Vec<f64>)], work: &mut Workspace) {
        let [mx, my, mz] = self.counts;
        let rows = my * mz * self.components;
        let scale = self.moving.iter().map(|&a| self.cells[a] as f64).product::<f64>().recip();
        let phases: Vec<[Vec<Complex<f64>>; 3]> =
            frames.iter().map(|(s, _)| [0, 1, 2].map(|a| self.phases(a, s[a] / self.spacing[a]))).collect();
        let along_x: Vec<[Vec<f64>; 2]> = phases
            .iter()
            .map(|[x, ..]| [x.iter().map(|z| z.re).collect(), x.iter().map(|z| z.im).collect()])
            .collect();
        work.waves.resize(rows * mx, Complex::default());
        work.row.resize(4 * mx, 0.0);
        let Workspace { waves, row, .. } = work;
        pulp::Arch::new().dispatch(
            #[inline(always)]
            || {
                for (r, to) in waves.chunks_exact_mut(mx).enumerate() {
                    let (sum, of_frame) = row.split_at_mut(2 * mx);
                    sum.fill(0.0);
                    for (k, (_, c)) in frames.iter().enumerate() {
                        let mode = |i: usize| &self.spectra[k][2 * mx * (i * rows + r)..][..2 * mx];
                        let of_row = phases[k][1][r % my] * phases[k][2][r / my % mz] * scale;
                        if let [c] = c[..] {
                            add_turned(of_row * c, &along_x[k], mode(0), sum);
                            continue;
                        }
                        of_frame.fill(0.0);
                        for (i, c) in c.iter().enumerate() {
                            of_frame.iter_mut().zip(mode(i)).for_each(|(f, m)| *f += c * m);
                        }
                        add_turned(of_row, &along_x[k], of_frame, sum);
                    }
                    let (re, im) = sum.split_at(mx);
                    for (to, (re, im)) in to.iter_mut().zip(re.iter().zip(im)) {
                        *to = Complex::new(*re, *im);
                    }
                }
            },
        );
    }

    /// What a shift by s cells along an axis multiplies its coefficients by.
    fn phases(&self, axis: usize, s: f64) -> Vec<Complex<f64>> {
        let (n, count) = (self.cells[axis], self.counts[axis]);
        if !self.moving.contains(&axis) {
            return vec![Complex::new(1.0, 0.0); count];
        }
        let of = |m: usize| {
            let [re, im] = phase(m, n, s);
            Complex::new(re, im)
        };
        // Of long waves, and of every so many: all others are a product of two. The wave of two cells is no product.
        const LOW: usize = 16;
        let low: Vec<_> = (0..LOW.min(n)).map(of).collect();
        let high: Vec<_> = (0..n.div_ceil(2)).step_by(LOW).map(of).collect();
        let positive = |m: usize| low[m % LOW] * high[m / LOW];
        let number = |m: usize| match (2 * m).cmp(&n) {
            std::cmp::Ordering::Less => positive(m),
            std::cmp::Ordering::Equal => of(m),
            std::cmp::Ordering::Greater => positive(n - m).conj(),
        };
        (0..count).map(number).collect()
    }

    /// The inverse transform along the first axis, of which only half the coefficients are there; two lines are one complex line.
    fn real(&self, work: &mut Workspace, out: &mut [f64]) {
        let axis = self.moving[0];
        let (n, count) = (self.cells[axis], self.counts[axis]);
        // Along the axes before nothing moves: they have as many coefficients as cells.
        let inner: usize = self.cells[..axis].iter().product();
        let n_lines = out.len() / n;
        let Workspace { waves, lines, .. } = work;
        let (lines, scratch) = lines.blank(&*self.inverse[0], PAIRS);
        let start = |l: usize, n: usize| l / inner * n * inner + l % inner;
        for first in (0..n_lines).step_by(2 * PAIRS) {
            let pairs = (first..n_lines.min(first + 2 * PAIRS)).step_by(2);
            let used = n * pairs.len();
            for (l, line) in pairs.clone().zip(lines.chunks_exact_mut(n)) {
                let (a, b) = (start(l, count), (l + 1 < n_lines).then(|| start(l + 1, count)));
                let whole = |first: Option<usize>| first.map_or(&[][..], |first| &waves[first..][..count]);
                if inner == 1 {
                    join(whole(Some(a)), whole(b), line);
                } else {
                    let every = |first: usize| (0..count).map(|m| waves[first + m * inner]).collect();
                    let [a, b] = [Some(a), b].map(|first| first.map_or(Vec::new(), every));
                    join(&a, &b, line);
                }
            }
            self.inverse[0].process_with_scratch(&mut lines[..used], scratch);
            for (l, line) in pairs.zip(lines.chunks_exact(n)) {
                let mut part = |l: usize, of: fn(&Complex<f64>) -> f64| {
                    let out = &mut out[start(l, n)..];
                    if inner == 1 {
                        out.iter_mut().zip(line).for_each(|(x, z)| *x = of(z));
                    } else {
                        out.iter_mut().step_by(inner).zip(line).for_each(|(x, z)| *x = of(z));
                    }
                };
                part(l, |z| z.re);
                if l + 1 < n_lines {
                    part(l + 1, |z| z.im);
                }
            }
        }
    }
}

/// The coefficients of A + iB from those of the real lines A and B, or of A alone, without those of negative waves.
fn join(a: &[Complex<f64>], b: &[Complex<f64>], line: &mut [Complex<f64>]) {
    let (n, none) = (line.len(), Complex::default());
    let Some((first, rest)) = line.split_first_mut() else { return };
    *first = Complex::new(a[0].re, b.first().unwrap_or(&none).re);
    let (pairs, middle) = ((n - 1) / 2, n / 2);
    let (positive, negative) = rest.split_at_mut(pairs);
    let b_rest = b.iter().skip(1).chain(std::iter::repeat(&none));
    // A + iB, and A̅ + iB̅ of the negative wave.
    let to = positive.iter_mut().zip(negative.iter_mut().rev());
    for ((to, opposite), (a, b)) in to.zip(a[1..].iter().zip(b_rest)) {
        *to = Complex::new(a.re - b.im, a.im + b.re);
        *opposite = Complex::new(a.re + b.im, b.re - a.im);
    }
    if n.is_multiple_of(2) {
        negative[0] = Complex::new(a[middle].re, b.get(middle).unwrap_or(&none).re);
    }
}

/// `sum` += factor · factors · values; all but the first are real parts, then imaginary parts.
#[inline(always)]
fn add_turned(factor: Complex<f64>, [fr, fi]: &[Vec<f64>; 2], values: &[f64], sum: &mut [f64]) {
    let n = fr.len();
    let fi = &fi[..n];
    let ((vr, vi), (sr, si)) = (values.split_at(n), sum.split_at_mut(n));
    let (vi, si) = (&vi[..n], &mut si[..n]);
    for i in 0..n {
        let (pr, pi) = (factor.re * fr[i] - factor.im * fi[i], factor.re * fi[i] + factor.im * fr[i]);
        sr[i] += pr * vr[i] - pi * vi[i];
        si[i] += pr * vi[i] + pi * vr[i];
    }
}

#[cfg(test)]
mod tests {
    use super::super::{FieldShift, Interpolation};
    use super::*;
    use interfaces::Vector;

    /// Along some axes or all, of even and odd numbers of cells, the sum of fields that are shifted one by one.
    #[test]
    fn sums_of_shifted_fields() {
        let cases: [(&[usize], &[usize]); 7] = [
            (&[12], &[0]),
            (&[7, 6], &[0, 1]),
            (&[8, 9], &[1]),
            (&[40, 34], &[0, 1]),
            (&[6, 5, 8], &[0, 1, 2]),
            (&[5, 6, 7], &[0, 2]),
            (&[4, 9, 6], &[1, 2]),
        ];
        for (cells, moving) in cases {
            let cells = [0, 1, 2].map(|a| cells.get(a).copied().unwrap_or(1));
            let spacing = [0.5, 1.0, 2.0];
            let grid = Grid::new(cells, spacing).unwrap();
            let rows = 2 * grid.n_cells();
            let value = |i: usize| (1.0 + (i * i) as f64).sin();
            let modes: [Vec<Vec<f64>>; 2] = [1, 2].map(|rank| {
                (0..rank).map(|k| (0..rows).map(|i| value(i + 31 * (k + rank))).collect()).collect()
            });
            let frames = modes.iter().map(|m| m.iter().map(|m| &m[..]).collect());
            let sum = Superposition::new(&grid, moving.to_vec(), rows, frames).unwrap();
            let asked = [([0.7, -2.3, 11.1], vec![0.4]), ([-4.2, 0.9, 1.3], vec![1.3, -0.6])];
            let asked =
                asked.map(|(s, c)| ([0, 1, 2].map(|a| if moving.contains(&a) { s[a] } else { 0.0 }), c));
            let mut out = vec![0.0; rows];
            sum.field(&asked, &mut Workspace::default(), &mut out);
            let one_by_one = FieldShift::new(grid, Interpolation::Spectral);
            let mut expected = vec![0.0; rows];
            for ((s, c), modes) in asked.iter().zip(&modes) {
                for (c, mode) in c.iter().zip(modes) {
                    let shifted = one_by_one.shift(Vector::from(*s), mode);
                    expected.iter_mut().zip(shifted).for_each(|(e, x)| *e += c * x);
                }
            }
            let off = out.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-13, "{cells:?} along {moving:?}: {off:.1e}");
        }
        let bounded = Grid::new([8, 8], [1.0; 2]).unwrap().bounded([1]);
        assert!(Superposition::new(&bounded, vec![0, 1], 64, std::iter::empty()).is_none());
        assert!(Superposition::new(&bounded, vec![], 64, std::iter::empty()).is_none());
    }
}
