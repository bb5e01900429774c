//! Modes of snapshots that come one after the other.
use super::modes::ROUND_OFF;
use super::{Pod, PodError};
use crate::{Mat, MatRef};
use interfaces::SnapshotSink;
use monomorphic::{add_product, thin_svd};
use std::error::Error;

/// A [`Pod`] of snapshots that are seen once each and not kept: of the matrix X = U Σ Vᵀ of all before, a block C of new ones makes (Brand, Linear Algebra Appl. 415 (2006) 20)
///
/// [X C] = [U Q] ⎡Σ UᵀC; 0 R⎤ ⎡V 0; 0 1⎤ᵀ, Q R = C − U UᵀC,
///
/// whose middle factor is small. Of its singular values the largest are kept; what is left out in one step after another is at most
/// [`error_bound`](Self::error_bound) in all. Memory: the modes twice and a block.
///
/// ```
/// use mor::pod::StreamingPod;
/// let mut modes = StreamingPod::new(8).truncated_below(1e-12);
/// for j in 0..100 {
///     let t = 0.1 * j as f64;
///     let field: Vec<f64> = (0..50).map(|i| (0.2 * i as f64).sin() * t.cos() + 0.1 * i as f64 * t.sin()).collect();
///     modes.add(&field)?;
/// }
/// let pod = modes.finish()?;
/// assert_eq!(pod.rank(), 2);
/// # Ok::<(), mor::pod::PodError>(())
/// ```
#[derive(Clone, Debug)]
pub struct StreamingPod {
    rank: usize,
    truncation: f64,
    subtract_mean: bool,
    weights: Option<Vec<f64>>,
    rows: Option<usize>,
    times: Vec<f64>,
    /// New snapshots times the roots of the weights, one after the other.
    block: Vec<f64>,
    /// U, Σ and V (snapshots × r).
    modes: Mat<f64>,
    values: Vec<f64>,
    coefficients: Mat<f64>,
    /// Σ x over all snapshots, as they are.
    sum: Vec<f64>,
    energy: f64,
    /// Σ over all steps of the norm of what was left out.
    bound: f64,
}

impl StreamingPod {
    /// With at most so many modes.
    #[must_use]
    pub fn new(rank: usize) -> Self {
        Self {
            rank: rank.max(1),
            truncation: 0.0,
            subtract_mean: false,
            weights: None,
            rows: None,
            times: vec![],
            block: vec![],
            modes: Mat::zeros(0, 0),
            values: vec![],
            coefficients: Mat::zeros(0, 0),
            sum: vec![],
            energy: 0.0,
            bound: 0.0,
        }
    }

    /// Leaves out what is below this part of the norm of all snapshots so far.
    #[must_use]
    pub fn truncated_below(mut self, part: f64) -> Self {
        self.truncation = part;
        self
    }

    /// Takes the mean over the snapshots away in the end.
    #[must_use]
    pub fn subtracting_mean(mut self) -> Self {
        self.subtract_mean = true;
        self
    }

    /// With the inner product ⟨a, b⟩ = Σᵢ wᵢ aᵢ bᵢ; all w must be positive.
    ///
    /// # Errors
    /// [`PodError::Weight`].
    pub fn weighted(mut self, weights: Vec<f64>) -> Result<Self, PodError> {
        if let Some(row) = weights.iter().position(|w| !(*w > 0.0 && w.is_finite())) {
            return Err(PodError::Weight { row, value: weights[row] });
        }
        self.weights = Some(weights);
        Ok(self)
    }

    /// One more snapshot.
    ///
    /// # Errors
    /// [`PodError::Shape`], [`PodError::NotFinite`], [`PodError::NotConverged`].
    pub fn add(&mut self, field: &[f64]) -> Result<(), PodError> {
        let n = *self.rows.get_or_insert(self.weights.as_ref().map_or(field.len(), Vec::len));
        PodError::same("rows of a snapshot", n, field.len())?;
        let snapshot = self.seen();
        if let Some(row) = field.iter().position(|x| !x.is_finite()) {
            return Err(PodError::NotFinite { snapshot, row, value: field[row] });
        }
        self.sum.resize(n, 0.0);
        self.sum.iter_mut().zip(field).for_each(|(sum, x)| *sum += x);
        match &self.weights {
            None => self.block.extend_from_slice(field),
            Some(weights) => self.block.extend(field.iter().zip(weights).map(|(x, w)| w.sqrt() * x)),
        }
        // As many as there are modes: then a snapshot costs about 8 n r operations.
        if self.block.len() >= n * self.rank.max(LEAST) { self.absorb() } else { Ok(()) }
    }

    /// How many snapshots it has seen.
    #[must_use]
    pub fn seen(&self) -> usize {
        self.coefficients.nrows() + self.block.len().checked_div(self.rows.unwrap_or(0)).unwrap_or(0)
    }

    /// Of the snapshots that were pushed as a [`SnapshotSink`].
    #[must_use]
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// ‖X − Φ Σ A‖ is at most this times ‖X‖ (without the mean taken away), after [`add`](Self::add) of the last snapshot; what is still to be worked in does not count.
    #[must_use]
    pub fn error_bound(&self) -> f64 {
        if self.energy > 0.0 { self.bound / self.energy.sqrt() } else { 0.0 }
    }

    /// The modes of all snapshots.
    ///
    /// # Errors
    /// [`PodError::Empty`], [`PodError::NotConverged`].
    pub fn finish(mut self) -> Result<Pod, PodError> {
        self.absorb()?;
        let (n, m) = (self.rows.unwrap_or(0), self.coefficients.nrows());
        if n == 0 || m == 0 {
            return Err(PodError::Empty { rows: n, snapshots: m });
        }
        let mut mean = None;
        if self.subtract_mean {
            let of_all: Vec<f64> = self.sum.iter().map(|sum| sum / m as f64).collect();
            // X − x̄ 1ᵀ: a column less in the modes, a column of ones in the coefficients.
            let scaled = (0..n).map(|i| -of_all[i] * self.weights.as_ref().map_or(1.0, |w| w[i].sqrt()));
            let column = Mat::from_fn(n, 1, {
                let scaled: Vec<f64> = scaled.collect();
                move |i, _| scaled[i]
            });
            let squared: f64 = column.squared_norm_l2();
            self.update(column, None)?;
            self.energy = (self.energy - m as f64 * squared).max(0.0);
            mean = Some(of_all);
        }
        let r = self.values.len();
        let modes = match &self.weights {
            None => self.modes,
            Some(weights) => Mat::from_fn(n, r, |i, k| self.modes[(i, k)] / weights[i].sqrt()),
        };
        Ok(Pod {
            mean,
            modes,
            singular_values: self.values,
            coefficients: self.coefficients.transpose().to_owned(),
            weights: self.weights,
            energy: self.energy,
        })
    }

    /// Works the new snapshots in.
    pub(super) fn absorb(&mut self) -> Result<(), PodError> {
        let n = self.rows.unwrap_or(0);
        if n == 0 || self.block.is_empty() {
            return Ok(());
        }
        let block = std::mem::take(&mut self.block);
        let columns = block.len() / n;
        self.energy += block.iter().map(|x| x * x).sum::<f64>();
        let largest = block.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
        PodError::check_size(self.energy, largest)?;
        let new = MatRef::from_column_major_slice(&block, n, columns).to_owned();
        self.update(new, Some(columns))
    }

    /// U Σ Vᵀ with `new` columns beside it, or, without a number of them, `new` 1ᵀ added to it.
    fn update(&mut self, mut new: Mat<f64>, appended: Option<usize>) -> Result<(), PodError> {
        let (n, b) = new.shape();
        let (r, m) = (self.values.len(), self.coefficients.nrows());
        if r == 0 {
            self.modes = Mat::zeros(n, 0);
        }
        let failed = || PodError::NotConverged { rows: n, snapshots: m, largest: f64::INFINITY };
        // What is within the modes and what beside them; twice, for round-off.
        let mut within = Mat::zeros(r, b);
        for _ in 0..if r > 0 { 2 } else { 0 } {
            let mut part = Mat::zeros(r, b);
            add_product(part.as_mut(), self.modes.transpose(), new.as_ref());
            let negative = Mat::from_fn(r, b, |i, j| -part[(i, j)]);
            add_product(new.as_mut(), self.modes.as_ref(), negative.as_ref());
            within += part;
        }
        let (q, beside, p) = thin_svd(new.as_ref()).ok_or_else(failed)?;
        let s = beside.len();
        let more = appended.unwrap_or(0);
        // The right factor of the small matrix: V with unit vectors, or with the part of 1 beside it.
        let ones: Vec<f64> = (0..r).map(|k| self.coefficients.col(k).iter().sum()).collect();
        let rest = (m as f64 - ones.iter().map(|x| x * x).sum::<f64>()).max(0.0).sqrt();
        let width = r + appended.unwrap_or(1);
        let middle = Mat::from_fn(r + s, width, |i, j| {
            let old = if i == j && i < r { self.values[i] } else { 0.0 };
            let of = |c: usize| if i < r { within[(i, c)] } else { beside[i - r] * p[(c, i - r)] };
            old + match appended {
                Some(_) if j < r => 0.0,
                Some(_) => of(j - r),
                None => of(0) * if j < r { ones[j] } else { rest },
            }
        });
        let (left, values, right) = thin_svd(middle.as_ref()).ok_or_else(failed)?;
        let round_off = ROUND_OFF * (n.min(m + more) as f64).sqrt();
        let least = self.truncation.max(round_off) * self.energy.sqrt();
        let kept = values.iter().take(self.rank).take_while(|s| **s > least).count();
        self.bound += values[kept..].iter().map(|s| s * s).sum::<f64>().sqrt();
        let mut modes = Mat::zeros(n, kept);
        add_product(modes.as_mut(), self.modes.as_ref(), left.as_ref().submatrix(0, 0, r, kept));
        add_product(modes.as_mut(), q.as_ref(), left.as_ref().submatrix(r, 0, s, kept));
        let mut coefficients = Mat::zeros(m + more, kept);
        let old = coefficients.as_mut().subrows_mut(0, m);
        add_product(old, self.coefficients.as_ref(), right.as_ref().submatrix(0, 0, r, kept));
        for k in 0..kept {
            match appended {
                Some(_) => (0..more).for_each(|j| coefficients[(m + j, k)] = right[(r + j, k)]),
                None if rest > 0.0 => {
                    for j in 0..m {
                        let within: f64 = (0..r).map(|i| self.coefficients[(j, i)] * ones[i]).sum();
                        coefficients[(j, k)] += (1.0 - within) / rest * right[(r, k)];
                    }
                }
                None => {}
            }
        }
        (self.modes, self.values, self.coefficients) = (modes, values[..kept].to_vec(), coefficients);
        Ok(())
    }
}

/// Snapshots of a block, at least.
const LEAST: usize = 8;

impl SnapshotSink for StreamingPod {
    fn push(&mut self, time: f64, field: &[f64]) -> Result<(), Box<dyn Error + Send + Sync>> {
        self.add(field)?;
        self.times.push(time);
        Ok(())
    }
}
