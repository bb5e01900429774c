//! Direct solution on the coarsest level.
use super::axis::AxisLevel;
use super::stencil::Stencil;

/// The dense Cholesky factor of the volume-weighted operator V A, plus c v vᵀ if A is singular.
pub(super) struct Coarsest {
    volumes: Vec<f64>,
    /// Lower triangle, row by row; 1/L_ii on the diagonal.
    factor: Vec<f64>,
    x: Vec<f64>,
}

impl Coarsest {
    pub(super) fn new(axes: &[AxisLevel; 3]) -> Self {
        let [x, m, l] = axes.each_ref().map(|a| &a.widths);
        let mut volumes = Vec::new();
        for l in l {
            for m in m {
                volumes.extend(x.iter().map(|x| x * m * l));
            }
        }
        let total: f64 = volumes.iter().sum();
        volumes.iter_mut().for_each(|v| *v /= total);
        let n = volumes.len();
        Self { volumes, factor: vec![0.0; n * n], x: vec![0.0; n] }
    }

    /// Factorises the operator; `phi` is work space.
    pub(super) fn factorise(&mut self, s: &Stencil<f32>, singular: bool, phi: &mut [f32], row: &mut [f32]) {
        let (n, [nx, rows, layers]) = (self.volumes.len(), s.cells);
        let place = |c: usize| c / nx * s.stride() + 1 + c % nx;
        for column in 0..n {
            phi.fill(0.0);
            phi[place(column)] = 1.0;
            let at = column / nx * s.stride();
            s.set_ghosts(&mut phi[at..at + s.stride()]);
            for k in 0..layers {
                let around = [-1, 0, 1].map(|d| s.layer_of(phi, k as isize + d));
                for j in 0..rows {
                    s.apply(around, j, k, &mut row[..nx]);
                    for i in 0..nx {
                        let c = (k * rows + j) * nx + i;
                        self.factor[c * n + column] = self.volumes[c] * f64::from(row[i]);
                    }
                }
            }
        }
        let largest = (0..n).map(|i| self.factor[i * n + i]).fold(0.0, f64::max);
        if singular {
            let scale = if largest > 0.0 { largest * n as f64 } else { 1.0 };
            for c in 0..n {
                for d in 0..n {
                    self.factor[c * n + d] += scale * self.volumes[c] * self.volumes[d];
                }
            }
        }
        for i in 0..n {
            let (done, current) = self.factor.split_at_mut(i * n);
            let current = &mut current[..n];
            for j in 0..i {
                let other = &done[j * n..][..n];
                let sum: f64 = (0..j).map(|m| current[m] * other[m]).sum();
                current[j] = (current[j] - sum) * other[j];
            }
            let (diagonal, pivot) = (current[i], current[i] - current[..i].iter().map(|x| x * x).sum::<f64>());
            // Cells that vanishing coefficients cut off get no correction.
            current[i] = if pivot > 1e-6 * diagonal { 1.0 / pivot.sqrt() } else { 0.0 };
        }
    }

    /// Solves A φ = f.
    pub(super) fn solve(&mut self, s: &Stencil<f32>, f: &[f32], phi: &mut [f32]) {
        let (n, nx) = (self.volumes.len(), s.cells[0]);
        let x = &mut self.x;
        for (r, f) in f.chunks_exact(s.stride()).enumerate() {
            for i in 0..nx {
                x[r * nx + i] = self.volumes[r * nx + i] * f64::from(f[i + 1]);
            }
        }
        for i in 0..n {
            let row = &self.factor[i * n..][..n];
            let sum: f64 = (0..i).map(|m| row[m] * x[m]).sum();
            x[i] = (x[i] - sum) * row[i];
        }
        for i in (0..n).rev() {
            let row = &self.factor[i * n..][..n];
            x[i] *= row[i];
            let xi = x[i];
            for m in 0..i {
                x[m] -= row[m] * xi;
            }
        }
        for (r, phi) in phi.chunks_exact_mut(s.stride()).enumerate() {
            for i in 0..nx {
                phi[i + 1] = x[r * nx + i] as f32;
            }
            s.set_ghosts(phi);
        }
    }
}
