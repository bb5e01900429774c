//! What the shifts do to each wave vector.
use super::batch::vectorised;
use crate::shifted::stencil::phase;
use crate::shifted::{Grid, ShiftedError, Shifts};

/// Numbers in the factors of low wave numbers, about: more take too much memory.
const TABLE: usize = 1 << 22;

/// The factors of every frame, snapshot and wave number along the axes on which something moves.
pub(super) struct Phases {
    n_frames: usize,
    n_snapshots: usize,
    /// The axes on which something moves.
    pub(super) moving: Vec<usize>,
    /// For each of them.
    tables: Vec<Table>,
}

/// Factors of all frames at all snapshots: of each frame real parts, then imaginary parts.
type Factors = Vec<f64>;

/// The factors of one axis: that of wave number low + high × (how many are low) is the product of two.
struct Table {
    n: usize,
    low: Vec<Factors>,
    high: Vec<Factors>,
    /// Of the wave of two cells, if there is one.
    shortest: Option<Factors>,
}

impl Table {
    fn new(n: usize, n_snapshots: usize, distances: &[f64], size: usize) -> Self {
        let count = (size / (2 * distances.len())).max(16);
        let factors = |wave: usize| {
            let of_frame = |frame: &[f64]| {
                let factors: Vec<_> = frame.iter().map(|&s| phase(wave, n, s)).collect();
                [0, 1].map(|part| factors.iter().map(|z| z[part]).collect::<Vec<_>>()).concat()
            };
            distances.chunks_exact(n_snapshots).flat_map(of_frame).collect()
        };
        // The shortest wave is no product of others.
        let longer = n.div_ceil(2);
        Self {
            n,
            low: (0..count.min(longer)).map(factors).collect(),
            high: (0..longer).step_by(count).map(factors).collect(),
            shortest: n.is_multiple_of(2).then(|| factors(n / 2)),
        }
    }

    /// Multiplies by the factors of a wave number.
    fn apply(&self, wave: usize, product: &mut Product<'_>) {
        match &self.shortest {
            Some(shortest) if 2 * wave == self.n => product.times(shortest, 1.0),
            _ => {
                let (positive, count) = (wave.min(self.n - wave), self.low.len());
                // Negative waves have conjugate factors.
                let sign = if positive == wave { 1.0 } else { -1.0 };
                product.times(&self.low[positive % count], sign);
                if positive >= count {
                    product.times(&self.high[positive / count], sign);
                }
            }
        }
    }
}

/// A product of factors, frame by frame.
struct Product<'a> {
    n_snapshots: usize,
    values: &'a mut [f64],
    empty: bool,
}

impl Product<'_> {
    /// Times factors, or their conjugates if the sign is negative.
    fn times(&mut self, factors: &[f64], sign: f64) {
        let (n, empty) = (self.n_snapshots, self.empty);
        let frames = self.values.chunks_exact_mut(2 * n).zip(factors.chunks_exact(2 * n));
        vectorised(
            frames,
            #[inline(always)]
            |(p, q)| {
                let ((pr, pi), (qr, qi)) = (p.split_at_mut(n), q.split_at(n));
                if empty {
                    pr.copy_from_slice(qr);
                    pi.iter_mut().zip(qi).for_each(|(p, q)| *p = sign * q);
                    return;
                }
                for ((pr, pi), (qr, qi)) in pr.iter_mut().zip(pi).zip(qr.iter().zip(qi)) {
                    let qi = sign * qi;
                    (*pr, *pi) = (*pr * qr - *pi * qi, *pr * qi + *pi * qr);
                }
            },
        );
        self.empty = false;
    }
}

impl Phases {
    /// # Errors
    /// If a frame turns, leaves the grid, or moves along a bounded axis.
    pub(super) fn new(grid: &Grid, shifts: &dyn Shifts) -> Result<Self, ShiftedError> {
        Self::along(grid, shifts, None)
    }

    /// Along these axes, or those along which something moves.
    pub(super) fn along(
        grid: &Grid,
        shifts: &dyn Shifts,
        axes: Option<Vec<usize>>,
    ) -> Result<Self, ShiftedError> {
        let (n_frames, n_snapshots) = (shifts.n_frames(), shifts.n_snapshots());
        let mut distances = [const { Vec::new() }; 3];
        for frame in 0..n_frames {
            for snapshot in 0..n_snapshots {
                let motion = shifts.motion(frame, snapshot);
                if !motion.is_translation() {
                    let angle = motion.rotation.angle();
                    return Err(ShiftedError::Turns { frame, snapshot, angle });
                }
                for axis in 0..3 {
                    let distance = motion.displacement[axis];
                    let cells = distance / grid.spacing()[axis];
                    if !cells.is_finite() {
                        return Err(ShiftedError::Motion { frame, snapshot });
                    }
                    ShiftedError::check_distance([frame, snapshot, axis], distance, grid.spacing()[axis])?;
                    if distance != 0.0 && grid.cells()[axis] == 1 {
                        return Err(ShiftedError::OffGrid { frame, snapshot, axis });
                    }
                    if distance != 0.0 && !grid.periodic()[axis] {
                        return Err(ShiftedError::NotPeriodic { frame, snapshot, axis, distance });
                    }
                    distances[axis].push(cells);
                }
            }
        }
        let moves = |a: &usize| {
            let n = grid.cells()[*a] as f64;
            distances[*a].iter().any(|s| s.rem_euclid(n) != 0.0)
        };
        let moving = axes.unwrap_or_else(|| (0..3).filter(moves).collect());
        let table = |&a: &usize| Table::new(grid.cells()[a], n_snapshots, &distances[a], TABLE);
        let tables = moving.iter().map(table).collect();
        Ok(Self { n_frames, n_snapshots, moving, tables })
    }

    pub(super) fn n_frames(&self) -> usize {
        self.n_frames
    }

    /// Is it a wave of two cells along one of the axes? The factors of all others have length one.
    pub(super) fn shortest(&self, wave: [usize; 3]) -> bool {
        self.moving.iter().zip(&self.tables).any(|(&a, table)| 2 * wave[a] == table.n)
    }

    /// The factors of one wave vector, frame by frame: real parts at all snapshots, then imaginary parts.
    pub(super) fn of(&self, wave: [usize; 3], out: &mut [f64]) {
        let n = self.n_snapshots;
        let mut product = Product { n_snapshots: n, values: out, empty: true };
        self.moving.iter().zip(&self.tables).for_each(|(&a, table)| table.apply(wave[a], &mut product));
        if product.empty {
            out.chunks_exact_mut(2 * n).for_each(|frame| {
                frame[..n].fill(1.0);
                frame[n..].fill(0.0);
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Product, Table, phase};

    #[test]
    fn products_are_the_factors() {
        let shifts = [0.3, -7.2, 55.1, 1e3, 0.0, 12.5];
        // All in the table, and not nearly all.
        for (n, size) in [(60, 1 << 20), (61, 0), (60, 0), (1, 0), (2, 0), (3, 0)] {
            let table = Table::new(n, 3, &shifts, size);
            assert!(size > 0 || table.low.len() <= 16);
            for wave in 0..n {
                let mut values = [f64::NAN; 12];
                table.apply(wave, &mut Product { n_snapshots: 3, values: &mut values, empty: true });
                for (j, s) in shifts.into_iter().enumerate() {
                    let at = 6 * (j / 3) + j % 3;
                    let [re, im] = phase(wave, n, s);
                    let error = (values[at] - re).hypot(values[at + 3] - im);
                    assert!(error < 1e-13, "wave {wave} of {n}, shift {s}: {error:.1e}");
                }
            }
        }
    }
}
