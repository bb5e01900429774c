//! The sweeps of the outer iteration over fields in double precision. Sums are made per task and added in
//! order, so that they do not depend on the number of threads.
use super::axis::AxisLevel;
use super::level::layers_per_task;
use super::stencil::{Real, Stencil};
use crate::poisson::Rows;
use pulp::{Arch, Simd, WithSimd};

/// Layout, volumes and partial sums.
pub(super) struct Sweeps {
    frame: Frame,
    per_task: usize,
    partial: Vec<[f64; 2]>,
}

/// Layout and volumes.
struct Frame {
    cells: [usize; 3],
    /// Widths of the cells, scaled so that the volumes add up to 1.
    widths: [Vec<f64>; 3],
}

/// What a sweep does to a row of the fields it writes: `a` and `single` with ghosts, `dense` without (empty if there
/// is no such field). Returns two sums weighted by the widths along x.
trait RowSweep<T>: Sync {
    fn row(&self, at: At, row: Row<T>, widths: &[f64]) -> [f64; 2];
}

/// Place of a row.
#[derive(Clone, Copy)]
struct At {
    row: usize,
    j: usize,
    k: usize,
}

/// A row of each of the fields to write.
struct Row<'a, T> {
    a: &'a mut [f64],
    single: &'a mut [T],
    dense: &'a mut [f64],
}

/// A run of layers of a sweep.
struct Task<'a, K, T> {
    frame: &'a Frame,
    sweep: &'a K,
    /// First layer.
    start: usize,
    a: &'a mut [f64],
    single: &'a mut [T],
    dense: &'a mut [f64],
    sums: &'a mut [f64; 2],
}

impl<K: RowSweep<T>, T> WithSimd for Task<'_, K, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { frame, sweep, start, a, single, dense, sums } = self;
        let ([n, rows, _], stride) = (frame.cells, frame.cells[0] + 2);
        let count = (a.len() / stride).max(single.len() / stride).max(dense.len() / n);
        *sums = [0.0; 2];
        for r in 0..count {
            let (j, k) = (r % rows, start + r / rows);
            let row =
                Row { a: part(a, r, stride), single: part(single, r, stride), dense: part(dense, r, n) };
            let sum = sweep.row(At { row: start * rows + r, j, k }, row, &frame.widths[0]);
            let area = frame.widths[1][j] * frame.widths[2][k];
            sums[0] += area * sum[0];
            sums[1] += area * sum[1];
        }
    }
}

/// What some tasks write. The fields are divided alike, but for those that are not there.
struct Parts<'a, T> {
    /// Number of the first task.
    first: usize,
    /// What a task takes of `a` and `single`, and of `dense`.
    lengths: [usize; 2],
    a: &'a mut [f64],
    single: &'a mut [T],
    dense: &'a mut [f64],
    /// One per task.
    sums: &'a mut [[f64; 2]],
}

impl<T: Send> Parts<'_, T> {
    /// Does the `job` to the part of each task.
    fn each(self, job: &(dyn Fn(Parts<'_, T>) + Sync)) {
        let Self { first, lengths, a, single, dense, sums } = self;
        let tasks = sums.len() / 2;
        if tasks == 0 {
            return job(Parts { first, lengths, a, single, dense, sums });
        }
        let [padded, bare] = lengths.map(|length| tasks * length);
        let (a, last_a) = a.split_at_mut(padded.min(a.len()));
        let (single, last_single) = single.split_at_mut(padded.min(single.len()));
        let (dense, last_dense) = dense.split_at_mut(bare.min(dense.len()));
        let (sums, last_sums) = sums.split_at_mut(tasks);
        let low = Parts { first, lengths, a, single, dense, sums };
        let high = Parts {
            first: first + tasks,
            lengths,
            a: last_a,
            single: last_single,
            dense: last_dense,
            sums: last_sums,
        };
        rayon::join(|| low.each(job), || high.each(job));
    }
}

/// Row `r` of a field; nothing of an empty one.
#[inline(always)]
fn part<T>(field: &mut [T], r: usize, length: usize) -> &mut [T] {
    if field.is_empty() { field } else { &mut field[r * length..][..length] }
}

/// Σ w a b in a fixed order.
#[inline(always)]
fn weighted<T: Copy>(w: &[f64], n: usize, term: impl Fn(usize) -> T, product: impl Fn(T) -> f64) -> f64 {
    const LANES: usize = 8;
    let mut sums = [0.0; LANES];
    let whole = n / LANES * LANES;
    for i in (0..whole).step_by(LANES) {
        for lane in 0..LANES {
            sums[lane] += w[i + lane] * product(term(i + lane));
        }
    }
    let rest: f64 = (whole..n).map(|i| w[i] * product(term(i))).sum();
    sums.iter().sum::<f64>() + rest
}

impl Sweeps {
    pub(super) fn new(axes: &[AxisLevel; 3]) -> Self {
        let cells: [usize; 3] = std::array::from_fn(|a| axes[a].cells());
        let widths = axes.each_ref().map(|axis| {
            let length: f64 = axis.widths.iter().sum();
            axis.widths.iter().map(|w| w / length).collect()
        });
        let per_task = layers_per_task(cells);
        Self {
            frame: Frame { cells, widths },
            per_task,
            partial: vec![[0.0; 2]; cells[2].div_ceil(per_task)],
        }
    }

    fn run<K: RowSweep<T>, T: Real>(
        &mut self,
        sweep: &K,
        a: &mut [f64],
        single: &mut [T],
        dense: &mut [f64],
    ) -> [f64; 2] {
        let (frame, per_task) = (&self.frame, self.per_task);
        let [n, rows, _] = frame.cells;
        let lengths = [per_task * rows * (n + 2), per_task * rows * n];
        let parts = Parts { first: 0, lengths, a, single, dense, sums: &mut self.partial };
        parts.each(&|Parts { first, a, single, dense, sums, .. }| {
            let (start, sums) = (first * per_task, &mut sums[0]);
            Arch::new().dispatch(Task { frame, sweep, start, a, single, dense, sums });
        });
        self.partial.iter().fold([0.0; 2], |sum, part| [sum[0] + part[0], sum[1] + part[1]])
    }

    /// Writes −f to `r`; returns the mean of −f and its mean square.
    pub(super) fn load(&mut self, fill: Rows<'_>, r: &mut [f64]) -> [f64; 2] {
        struct Load<'a>(Rows<'a>);
        impl RowSweep<f32> for Load<'_> {
            #[inline(always)]
            fn row(&self, at: At, row: Row<f32>, w: &[f64]) -> [f64; 2] {
                let n = row.a.len() - 2;
                let r = &mut row.a[1..n + 1];
                (self.0)(at.row, r);
                r.iter_mut().for_each(|r| *r = -*r);
                [weighted(w, n, |i| r[i], |r| r), weighted(w, n, |i| r[i], |r| r * r)]
            }
        }
        self.run(&Load(fill), r, &mut [], &mut [])
    }

    /// Subtracts `mean` from `r` and writes `r` times `scale` to `single`; returns the mean square of `r`.
    pub(super) fn centre<T: Real>(&mut self, mean: f64, scale: f64, r: &mut [f64], single: &mut [T]) -> f64 {
        struct Centre {
            mean: f64,
            scale: f64,
        }
        impl<T: Real> RowSweep<T> for Centre {
            #[inline(always)]
            fn row(&self, _: At, row: Row<T>, w: &[f64]) -> [f64; 2] {
                let n = row.a.len() - 2;
                let (r, single) = (&mut row.a[1..n + 1], &mut row.single[1..n + 1]);
                for i in 0..n {
                    r[i] -= self.mean;
                    single[i] = T::of(r[i] * self.scale);
                }
                [weighted(w, n, |i| r[i], |r| r * r), 0.0]
            }
        }
        self.run(&Centre { mean, scale }, r, single, &mut [])[0]
    }

    /// Copies a dense field to one with ghosts.
    pub(super) fn copy_in(&mut self, s: &Stencil<f64>, from: &[f64], to: &mut [f64]) {
        struct Copy<'a>(&'a Stencil<f64>, &'a [f64]);
        impl RowSweep<f32> for Copy<'_> {
            #[inline(always)]
            fn row(&self, at: At, row: Row<f32>, _: &[f64]) -> [f64; 2] {
                let n = row.a.len() - 2;
                row.a[1..n + 1].copy_from_slice(&self.1[at.row * n..][..n]);
                self.0.set_ghosts(row.a);
                [0.0; 2]
            }
        }
        self.run(&Copy(s, from), to, &mut [], &mut []);
    }

    /// q = A p; returns ⟨p, q⟩.
    pub(super) fn apply(&mut self, s: &Stencil<f64>, p: &[f64], q: &mut [f64]) -> f64 {
        struct Apply<'a>(&'a Stencil<f64>, &'a [f64]);
        impl RowSweep<f32> for Apply<'_> {
            #[inline(always)]
            fn row(&self, At { row: at, j, k }: At, row: Row<f32>, w: &[f64]) -> [f64; 2] {
                let n = row.a.len() - 2;
                let around = [-1, 0, 1].map(|d| self.0.layer_of(self.1, k as isize + d));
                let q = &mut row.a[1..n + 1];
                self.0.apply(around, j, k, q);
                let p = &self.1[at * (n + 2) + 1..][..n];
                [weighted(w, n, |i| (p[i], q[i]), |(p, q)| p * q), 0.0]
            }
        }
        self.run(&Apply(s, p), q, &mut [], &mut [])[0]
    }

    /// ⟨z, r⟩ and ⟨z, q⟩; `r` is not changed.
    pub(super) fn products<T: Real>(&mut self, z: &[T], r: &mut [f64], q: &[f64]) -> [f64; 2] {
        struct Products<'a, T>(&'a [T], &'a [f64]);
        impl<T: Real> RowSweep<T> for Products<'_, T> {
            #[inline(always)]
            fn row(&self, At { row: at, .. }: At, row: Row<T>, w: &[f64]) -> [f64; 2] {
                let n = row.a.len() - 2;
                let inner = at * (n + 2) + 1;
                let (z, r, q) = (&self.0[inner..][..n], &row.a[1..n + 1], &self.1[inner..][..n]);
                [
                    weighted(w, n, |i| (z[i], r[i]), |(z, r)| z.double() * r),
                    weighted(w, n, |i| (z[i], q[i]), |(z, q)| z.double() * q),
                ]
            }
        }
        self.run(&Products(z, q), r, &mut [], &mut [])
    }

    /// p ← `scale` z + `beta` p.
    pub(super) fn direct<T: Real>(
        &mut self,
        s: &Stencil<f64>,
        scale: f64,
        z: &[T],
        beta: f64,
        p: &mut [f64],
    ) {
        struct Direct<'a, T> {
            s: &'a Stencil<f64>,
            scale: f64,
            z: &'a [T],
            beta: f64,
        }
        impl<T: Real> RowSweep<T> for Direct<'_, T> {
            #[inline(always)]
            fn row(&self, at: At, row: Row<T>, _: &[f64]) -> [f64; 2] {
                let n = row.a.len() - 2;
                let z = &self.z[at.row * (n + 2) + 1..][..n];
                let p = &mut row.a[1..n + 1];
                for i in 0..n {
                    p[i] = self.scale * z[i].double() + self.beta * p[i];
                }
                self.s.set_ghosts(row.a);
                [0.0; 2]
            }
        }
        self.run(&Direct { s, scale, z, beta }, p, &mut [], &mut []);
    }

    /// φ ← φ + α p, r ← r − α q, `single` ← `scale` r; returns the mean square of r.
    pub(super) fn advance<T: Real>(
        &mut self,
        step: Advance<'_>,
        r: &mut [f64],
        single: &mut [T],
        phi: &mut [f64],
    ) -> f64 {
        self.run(&step, r, single, phi)[0]
    }

    /// Subtracts the mean of a dense field.
    pub(super) fn remove_mean(&mut self, phi: &mut [f64]) {
        struct Shift(f64);
        impl RowSweep<f32> for Shift {
            #[inline(always)]
            fn row(&self, _: At, row: Row<f32>, w: &[f64]) -> [f64; 2] {
                let phi = row.dense;
                phi.iter_mut().for_each(|phi| *phi -= self.0);
                [weighted(w, phi.len(), |i| phi[i], |phi| phi), 0.0]
            }
        }
        let [mean, _] = self.run(&Shift(0.0), &mut [], &mut [], phi);
        self.run(&Shift(mean), &mut [], &mut [], phi);
    }
}

/// A step of conjugate gradients along the direction p, q = A p.
pub(super) struct Advance<'a> {
    pub(super) alpha: f64,
    pub(super) p: &'a [f64],
    pub(super) q: &'a [f64],
    /// Of the residual in lower precision.
    pub(super) scale: f64,
}

impl<T: Real> RowSweep<T> for Advance<'_> {
    #[inline(always)]
    fn row(&self, at: At, row: Row<T>, w: &[f64]) -> [f64; 2] {
        let n = row.dense.len();
        let inner = at.row * (n + 2) + 1;
        let (p, q) = (&self.p[inner..][..n], &self.q[inner..][..n]);
        let (r, single, phi) = (&mut row.a[1..n + 1], &mut row.single[1..n + 1], row.dense);
        for i in 0..n {
            phi[i] += self.alpha * p[i];
            r[i] -= self.alpha * q[i];
            single[i] = T::of(self.scale * r[i]);
        }
        [weighted(w, n, |i| r[i], |r| r * r), 0.0]
    }
}
