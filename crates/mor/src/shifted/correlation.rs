//! Speeds of several movers by phase correlation.
use super::Grid;
use super::estimate::{Basis, Paths};
use super::lines::Lines;
use monomorphic::{Mat, MatRef, Qr, fourier_transforms};
use rustfft::num_complex::Complex;

/// How far apart in cells two peaks are at least.
const APART: f64 = 4.0;
/// Windows in time.
const WINDOWS: usize = 16;

/// Correlations between snapshots some steps apart, averaged over windows in time.
struct Correlations<'a> {
    cells: [usize; 3],
    axes: &'a [usize],
    /// Of each snapshot, for each cell.
    spectra: Vec<Vec<Complex<f64>>>,
}

/// A place on the grid with sub-cell accuracy, in cells, and how high the correlation is there.
#[derive(Clone, Copy)]
struct Peak {
    way: [f64; 3],
    height: f64,
}

/// Paths that follow the highest peaks, the fastest first.
pub(super) fn first_paths(
    grid: &Grid,
    axes: &[usize],
    snapshots: MatRef<'_, f64>,
    n_frames: usize,
    times: &[f64],
    basis: &Basis,
) -> Paths {
    let c = Correlations::new(grid, axes, snapshots);
    let n = times.len();
    let mut best: Option<(f64, usize, usize)> = None;
    for lag in (0..).map(|p| 1 << p).take_while(|lag| 6 * lag <= n) {
        for (w, &(first, last)) in windows(n, lag).iter().enumerate() {
            let peaks = c.peaks(&c.surface(first, last, lag), n_frames + 1);
            // How clearly the movers stand out, if they are told apart from one another.
            let score = match (peaks.get(n_frames - 1), peaks.get(n_frames)) {
                (Some(least), Some(next)) => least.height / next.height.max(1e-3 * least.height),
                (Some(_), None) => 1e3,
                _ => 0.0,
            };
            if best.is_none_or(|b| score > b.0) {
                best = Some((score, lag, w));
            }
        }
    }
    let (_, lag, start) = best.unwrap_or((0.0, 1, 0));
    let windows = windows(n, lag);
    let surfaces: Vec<_> = windows.iter().map(|&(first, last)| c.surface(first, last, lag)).collect();
    let mut peaks = c.peaks(&surfaces[start], n_frames);
    peaks.resize(n_frames, Peak { way: [0.0; 3], height: 0.0 });
    let size = |p: &Peak| p.way.iter().map(|x| x * x).sum::<f64>();
    peaks.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let coefficients = peaks.iter().map(|peak| {
        let ways = c.follow(&surfaces, start, peak.way);
        let along = |&a: &usize| {
            let way: Vec<f64> = ways.iter().map(|w| w[a] * grid.spacing()[a]).collect();
            smooth(&way, &windows, lag, times, basis)
        };
        axes.iter().map(along).collect()
    });
    Paths { coefficients: coefficients.collect() }
}

/// First and last snapshot of each window.
fn windows(n: usize, lag: usize) -> Vec<(usize, usize)> {
    let pairs = n - lag;
    let count = WINDOWS.min(pairs);
    (0..count)
        .map(|w| (w * pairs / count, ((w + 1) * pairs / count).max(w * pairs / count + 1) - 1))
        .collect()
}

impl<'a> Correlations<'a> {
    fn new(grid: &Grid, axes: &'a [usize], snapshots: MatRef<'_, f64>) -> Self {
        let cells = grid.cells();
        // Components are correlated as their sum of squares would be told apart from nothing: the first one that varies is taken.
        let n = grid.n_cells();
        let varies = |c: usize| {
            let part = snapshots.subrows(c * n, n);
            part.col_iter().any(|col| col.iter().any(|&x| x != col[0]))
        };
        let component = (0..snapshots.nrows() / n).find(|&c| varies(c)).unwrap_or(0);
        let spectra = (0..snapshots.ncols()).map(|j| {
            let mut z: Vec<_> = (0..n).map(|i| Complex::from(snapshots[(component * n + i, j)])).collect();
            for &a in axes {
                let forward = &*fourier_transforms(cells[a])[0];
                Lines::default().transform(forward, cells[..a].iter().product(), &mut z);
            }
            z
        });
        Self { cells, axes, spectra: spectra.collect() }
    }

    /// Where what is seen is a lag later, averaged from one snapshot to another.
    fn surface(&self, first: usize, last: usize, lag: usize) -> Vec<f64> {
        let mut sum = vec![Complex::default(); self.spectra[0].len()];
        for j in first..=last {
            let (a, b) = (&self.spectra[j], &self.spectra[j + lag]);
            let largest = a.iter().zip(b).skip(1).map(|(a, b)| (a.conj() * b).norm()).fold(0.0, f64::max);
            for ((sum, a), b) in sum.iter_mut().zip(a).zip(b) {
                let c = a.conj() * b;
                // Weak waves are round-off.
                *sum += c / (c.norm() + 1e-2 * largest).max(f64::MIN_POSITIVE);
            }
        }
        sum[0] = Complex::default();
        for &a in self.axes {
            let inverse = &fourier_transforms(self.cells[a])[1];
            Lines::default().transform(&**inverse, self.cells[..a].iter().product(), &mut sum);
        }
        sum.iter().map(|z| z.re).collect()
    }

    fn place(&self, cell: usize) -> [usize; 3] {
        let [nx, ny, _] = self.cells;
        [cell % nx, cell / nx % ny, cell / (nx * ny)]
    }

    /// The shortest way from one place to another.
    fn shortest(&self, from: [f64; 3], to: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|a| {
            let (d, n) = (to[a] - from[a], self.cells[a] as f64);
            if self.axes.contains(&a) { d - n * (d / n).round() } else { d }
        })
    }

    fn distance(&self, from: [f64; 3], to: [f64; 3]) -> f64 {
        self.shortest(from, to).iter().map(|x| x * x).sum::<f64>().sqrt()
    }

    /// The highest ones that are apart.
    fn peaks(&self, surface: &[f64], count: usize) -> Vec<Peak> {
        let mut peaks: Vec<Peak> = Vec::new();
        while peaks.len() < count {
            let free = |cell: &usize| {
                let at = self.place(*cell).map(|i| i as f64);
                peaks.iter().all(|p| self.distance(p.way, at) > APART)
            };
            let best = (0..surface.len()).filter(free).max_by(|&a, &b| surface[a].total_cmp(&surface[b]));
            let Some(best) = best.filter(|&c| surface[c] > 0.0) else { break };
            peaks.push(self.refined(surface, best));
        }
        peaks
    }

    /// By a parabola along each axis.
    fn refined(&self, surface: &[f64], cell: usize) -> Peak {
        let at = self.place(cell);
        let mut way = at.map(|i| i as f64);
        for &a in self.axes {
            let n = self.cells[a];
            let stride: usize = self.cells[..a].iter().product();
            let beside = |step: usize| surface[cell - at[a] * stride + (at[a] + step) % n * stride];
            let [low, here, high] = [beside(n - 1), surface[cell], beside(1)];
            let bend = low - 2.0 * here + high;
            if bend < 0.0 {
                way[a] += (0.5 * (low - high) / bend).clamp(-0.5, 0.5);
            }
        }
        Peak { way: self.shortest([0.0; 3], way), height: surface[cell] }
    }

    /// The way of one mover in every window, told from where it was in those before.
    fn follow(&self, surfaces: &[Vec<f64>], start: usize, way: [f64; 3]) -> Vec<[f64; 3]> {
        let mut ways = vec![way; surfaces.len()];
        let mut next = |w: usize, before: [usize; 2]| {
            let [a, b] = before.map(|w| ways[w]);
            let expected = [0, 1, 2].map(|i| 2.0 * a[i] - b[i]);
            let change: f64 = [0, 1, 2].map(|i| (a[i] - b[i]).powi(2)).iter().sum::<f64>().sqrt();
            let reach = APART.max(change);
            let near = |cell: &usize| self.distance(expected, self.place(*cell).map(|i| i as f64)) <= reach;
            let surface = &surfaces[w];
            let best = (0..surface.len()).filter(near).max_by(|&a, &b| surface[a].total_cmp(&surface[b]));
            ways[w] = best.filter(|&cell| surface[cell] > 0.0).map_or(expected, |cell| {
                let peak = self.refined(surface, cell).way;
                let way = self.shortest(expected, peak);
                [0, 1, 2].map(|i| expected[i] + way[i])
            });
        };
        for w in start + 1..surfaces.len() {
            next(w, [w - 1, if w - 1 > start { w - 2 } else { start }]);
        }
        for w in (0..start).rev() {
            next(w, [w + 1, if w + 1 < start { w + 2 } else { start }]);
        }
        ways
    }
}

/// The coefficients whose path goes so far within a lag in each window, with as many polynomials as half the windows at most.
fn smooth(ways: &[f64], windows: &[(usize, usize)], lag: usize, times: &[f64], basis: &Basis) -> Vec<f64> {
    let used = basis.degree.min(windows.len().div_ceil(2)).max(1);
    let rows: Vec<Vec<f64>> = windows
        .iter()
        .map(|&(first, last)| {
            let mut mean = vec![0.0; used];
            for j in first..=last {
                let (a, b) = (basis.values(times[j]), basis.values(times[j + lag]));
                mean.iter_mut()
                    .enumerate()
                    .for_each(|(p, m)| *m += (b[p] - a[p]) / (last - first + 1) as f64);
            }
            mean
        })
        .collect();
    let mut right = Mat::from_fn(ways.len(), 1, |i, _| ways[i]);
    Qr::new(Mat::from_fn(ways.len(), used, |i, p| rows[i][p])).solve(right.as_mut());
    let solved = |p: usize| if p < used && right[(p, 0)].is_finite() { right[(p, 0)] } else { 0.0 };
    (0..basis.degree).map(solved).collect()
}
