//! Fits of frames that only move, as [`HuberDescent`](super::huber_descent::HuberDescent) needs
//! them.
use super::dense::{product, thin};
use super::descent::huber;
use super::fourier::{Als, Patience, RIDGE, factorise, substitute};
use super::residual_parts::Parts;
use super::shifted_pod::Watch;
use super::translated::{Translated, started};
use super::waves::Waves;
use super::{Frame, FrameOperators, Motions, Progress, ShiftedError, StopReason};
use interfaces::Vector;
use monomorphic::{Mat, MatRef};
use rayon::prelude::*;

/// Fields M = Σ_k T^k Φ_k Σ_k A_k of frames.
#[derive(Clone)]
pub(super) struct Fields {
    pub(super) frames: Vec<Frame>,
    pub(super) offsets: Vec<Vector>,
    pub(super) stopped: StopReason,
}

impl Fields {
    pub(super) fn ranks(&self) -> Vec<usize> {
        self.frames.iter().map(Frame::rank).collect()
    }

    /// Σ_k ‖Q_k‖².
    pub(super) fn square(&self) -> f64 {
        self.frames.iter().flat_map(|f| &f.singular_values).map(|s| s * s).sum()
    }
}

/// Reweightings at a level of Huber's function, at most.
const REWEIGHTINGS: usize = 100;
/// They end when no entry changes by more than this share of the level.
const UNCHANGED: f64 = 1e-3;

impl Translated<'_> {
    /// Fields of these ranks fitted to `data`, from `start` on, with a weight of Σ_k ‖Q_k‖² against
    /// the squared error, no less than the default of [`Als`].
    pub(super) fn fit(
        &self,
        data: MatRef<'_, f64>,
        start: Fields,
        ranks: &[usize],
        ridge: f64,
        patience: Patience,
        watch: &mut Watch<'_>,
    ) -> Result<Fields, ShiftedError> {
        let part = Translated { snapshots: data, ..*self };
        let (spectrum, offsets) = part.spectrum(None)?;
        let als = self.als(ranks, self.pod.tolerance);
        let als = Als { ridge: ridge.max(als.ridge), ..als };
        let mut go_on = |p: &Progress| watch.see(p).is_continue();
        let d = als.fit(&spectrum, Some(&started(start.frames)), patience, &mut go_on)?;
        Ok(Fields { frames: d.frames, offsets, stopped: d.stopped })
    }

    /// Fields whose amplitudes minimise Huber's function at the given modes, with the bound for its
    /// level.
    pub(super) fn with_amplitudes(&self, fields: Fields, bound: f64) -> Fields {
        let moved = Motions::beside(self.shifts, &fields.offsets);
        let waves = Waves::new(&self.pod.grid, &moved, self.snapshots.nrows());
        let waves = waves.expect("frames that move");
        let n = self.snapshots.ncols();
        // A column per snapshot of each mode.
        let mut images = vec![];
        for (k, frame) in fields.frames.iter().enumerate() {
            let modes = waves.waves(frame.modes.as_ref());
            for i in 0..frame.rank() {
                let mut image = Mat::from_fn(modes.nrows(), n, |x, _| modes[(x, i)]);
                waves.to_lab(k, image.as_mut());
                images.push(waves.fields(image.as_ref()));
            }
        }
        let mut amplitudes: Vec<Mat<f64>> = fields.frames.iter().map(Frame::scaled_coefficients).collect();
        let better = |j: usize| {
            let modes: Vec<&[f64]> = images.iter().map(|image| image.col_as_slice(j)).collect();
            let snapshot: Vec<f64> = self.snapshots.col(j).iter().copied().collect();
            let before: Vec<f64> = amplitudes.iter().flat_map(|a| a.col_as_slice(j).to_vec()).collect();
            let found = regressed(&snapshot, &modes, bound);
            let loss = |x: &[f64]| residual(&snapshot, &modes, x).map(|r| huber(r, bound)).sum::<f64>();
            if loss(&found) < loss(&before) { found } else { before }
        };
        let found: Vec<_> = (0..n).into_par_iter().map(better).collect();
        for (j, found) in found.into_iter().enumerate() {
            let mut found = found.into_iter();
            for a in &mut amplitudes {
                (0..a.nrows()).zip(&mut found).for_each(|(i, x)| a[(i, j)] = x);
            }
        }
        let frames = fields.frames.iter().zip(amplitudes).map(|(frame, a)| {
            let (u, singular_values, v) = thin(a.transpose().to_owned(), frame.rank());
            let coefficients = u.transpose().to_owned();
            Frame { modes: product(frame.modes.as_ref(), v.as_ref()), singular_values, coefficients }
        });
        Fields { frames: frames.collect(), ..fields }
    }

    /// Parts of a residual in each frame.
    pub(super) fn parts(&self, residual: &Mat<f64>, fields: &Fields) -> Vec<Parts> {
        let moved = Motions::beside(self.shifts, &fields.offsets);
        let waves = Waves::new(&self.pod.grid, &moved, residual.nrows()).expect("frames that move");
        let residual = waves.waves(residual.as_ref());
        let in_frame = |k: usize| {
            let mut field = residual.clone();
            waves.to_lab_transposed(k, field.as_mut());
            Parts::new(waves.fields(field.as_ref()), &fields.frames[k])
        };
        (0..self.shifts.n_frames()).map(in_frame).collect()
    }

    /// Fields without the modes that `data` does not need.
    pub(super) fn pruned(
        &self,
        data: MatRef<'_, f64>,
        fields: Fields,
        watch: &mut Watch<'_>,
    ) -> Result<Fields, ShiftedError> {
        let moved = Motions::beside(self.shifts, &fields.offsets);
        let part = Translated { pod: self.pod, shifts: &moved, snapshots: data };
        let most = fields.ranks();
        let (frames, stopped) = part.search(Some(fields.frames), &most, self.pod.rank_tolerance, watch)?;
        Ok(Fields { frames, stopped, ..fields })
    }
}

/// x that minimises Σ ρ_δ(q − Σ_s x_s b_s) for unit vectors b, by iteratively reweighted least
/// squares (Holland & Welsch 1977) with δ from the largest entry down to a bound; or the
/// least-squares fit without the entries beyond δ, once no other exceeds the bound.
fn regressed(q: &[f64], b: &[&[f64]], bound: f64) -> Vec<f64> {
    let mut x = vec![0.0; b.len()];
    let mut level = q.iter().fold(0.0_f64, |most, q| most.max(q.abs()));
    let bound = bound.max(f64::EPSILON * level);
    let nothing = vec![0.0; q.len()];
    while level > bound {
        for _ in 0..REWEIGHTINGS {
            let change = weighted(q, b, &x, |r| level / level.max(r.abs()));
            x.iter_mut().zip(&change).for_each(|(x, change)| *x += change);
            if residual(&nothing, b, &change).all(|r| r.abs() <= UNCHANGED * level) {
                break;
            }
        }
        let change = weighted(q, b, &x, |r| if r.abs() <= level { 1.0 } else { 0.0 });
        let trimmed: Vec<f64> = x.iter().zip(&change).map(|(x, change)| x + change).collect();
        let exact = residual(q, b, &x)
            .zip(residual(q, b, &trimmed))
            .all(|(before, after)| before.abs() > level || after.abs() <= bound);
        if exact {
            return trimmed;
        }
        level *= 0.5;
    }
    x
}

/// q − Σ_s x_s b_s.
fn residual<'a>(q: &'a [f64], b: &'a [&[f64]], x: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
    q.iter().enumerate().map(move |(i, q)| q - b.iter().zip(x).map(|(b, x)| b[i] * x).sum::<f64>())
}

/// Change of x by weighted least squares.
fn weighted(q: &[f64], b: &[&[f64]], x: &[f64], weight: impl Fn(f64) -> f64) -> Vec<f64> {
    let rank = b.len();
    let (mut gram, mut change) = (vec![0.0; rank * rank], vec![0.0; rank]);
    for (i, r) in residual(q, b, x).enumerate() {
        let w = weight(r);
        for s in 0..rank {
            change[s] += w * r * b[s][i];
            (s..rank).for_each(|t| gram[t + s * rank] += w * b[s][i] * b[t][i]);
        }
    }
    factorise(rank, &mut gram, RIDGE);
    substitute(&gram, &mut change);
    change
}

#[cfg(test)]
mod tests {
    use super::regressed;

    /// Two unit vectors at an angle of 0.1 rad; 6 of 40 entries are wrong. All others are exact in
    /// the end.
    #[test]
    fn amplitudes_beside_wrong_entries_are_exact() {
        let unit = |shift: f64| {
            let b: Vec<f64> = (0..40).map(|i| (-((i as f64 - 20.0 - shift) / 6.0).powi(2)).exp()).collect();
            let norm = b.iter().map(|b| b * b).sum::<f64>().sqrt();
            b.iter().map(|b| b / norm).collect::<Vec<_>>()
        };
        let (b, c) = (unit(0.0), unit(0.6));
        let mut q: Vec<f64> = b.iter().zip(&c).map(|(b, c)| 1.7 * b - 0.4 * c).collect();
        for i in [3, 17, 19, 22, 25, 31] {
            q[i] += if i % 2 == 0 { 0.75 } else { -1.5 };
        }
        let x = regressed(&q, &[&b, &c], 1e-9);
        assert!((x[0] - 1.7).abs() < 1e-8 && (x[1] + 0.4).abs() < 1e-8, "{x:?}");
    }
}
