//! What the shifts do to each wave vector.
use crate::shifted::stencil::phase;
use crate::shifted::{Grid, ShiftedError, Shifts};

/// The factors of every frame, snapshot and wave number along the axes on which something moves.
pub(super) struct Phases {
    n_frames: usize,
    n_snapshots: usize,
    /// The axes on which something moves.
    pub(super) moving: Vec<usize>,
    /// For each of them, wave number by wave number and frame by frame: real parts at all snapshots, then imaginary parts.
    tables: Vec<Vec<f64>>,
}

impl Phases {
    /// # Errors
    /// If a frame turns, leaves the grid, or moves along a bounded axis.
    pub(super) fn new(grid: &Grid, shifts: &dyn Shifts) -> Result<Self, ShiftedError> {
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
        let moving: Vec<_> = (0..3).filter(moves).collect();
        let table = |&a: &usize| {
            let n = grid.cells()[a];
            let mut table = Vec::with_capacity(n * n_frames * n_snapshots * 2);
            for wave in 0..n {
                for of_frame in distances[a].chunks_exact(n_snapshots) {
                    let factors: Vec<_> = of_frame.iter().map(|&s| phase(wave, n, s)).collect();
                    table.extend(factors.iter().map(|z| z[0]));
                    table.extend(factors.iter().map(|z| z[1]));
                }
            }
            table
        };
        let tables = moving.iter().map(table).collect();
        Ok(Self { n_frames, n_snapshots, moving, tables })
    }

    pub(super) fn n_frames(&self) -> usize {
        self.n_frames
    }

    /// The factors of one wave vector, frame by frame: real parts at all snapshots, then imaginary parts.
    pub(super) fn of(&self, wave: [usize; 3], out: &mut [f64]) {
        let (n, size) = (self.n_snapshots, 2 * self.n_snapshots * self.n_frames);
        let mut factors =
            self.moving.iter().zip(&self.tables).map(|(&a, table)| &table[wave[a] * size..][..size]);
        match factors.next() {
            Some(first) => out.copy_from_slice(first),
            None => out.chunks_exact_mut(2 * n).for_each(|frame| {
                frame[..n].fill(1.0);
                frame[n..].fill(0.0);
            }),
        }
        for second in factors {
            for (p, q) in out.chunks_exact_mut(2 * n).zip(second.chunks_exact(2 * n)) {
                let ((pr, pi), (qr, qi)) = (p.split_at_mut(n), q.split_at(n));
                for j in 0..n {
                    (pr[j], pi[j]) = (pr[j] * qr[j] - pi[j] * qi[j], pr[j] * qi[j] + pi[j] * qr[j]);
                }
            }
        }
    }
}
