//! Where frames that move between cells are best at rest.
use super::als::RIDGE;
use super::amplitudes::Amplitudes;
use super::batch::{Batch, batches};
use super::normal::Normal;
use super::problem::{Piece, Problem};
use super::spectrum::Spectrum;
use crate::shifted::{Grid, Motions, ShiftedError, Shifts};
use crate::{Mat, MatRef};
use interfaces::Vector;
use std::borrow::Cow;
use std::f64::consts::PI;

/// Waves that hold less than this part of the energy, squared, are not looked at.
const TOLERANCE: f64 = 1e-6;
/// Nor are frames moved if the waves of two cells hold more than this part of the energy.
const EDGES: f64 = 1e-3;
/// Nor is a frame moved if what is gained is not so many times what one phase does not explain.
const CLEARLY: f64 = 3.0;
/// A frame that explains less than this part of the waves of two cells stays where it is.
const EXPLAINED: f64 = 0.1;

/// The same frames, displaced by half a cell at most, so that what they carry is at rest at the centres of cells.
///
/// A wave of two cells is known at the cells' centres only: shifted by s it is multiplied by cos(π s/h). That is what becomes of the
/// edges of a body whose centre, at rest in its frame, is at the centre of a cell; a body that is c beside it leaves cos(π (s + c)/h),
/// which takes one more mode. On each axis with an even number of cells, and for each frame, this finds the c that explains most
/// of these waves, and adds it to the shifts. Modes are then c from where they are in the snapshots, and whoever shifts them
/// must do it by what is returned.
///
/// # Errors
/// Those of [`Als::solve`](super::Als::solve).
pub fn centred(
    grid: &Grid,
    shifts: &dyn Shifts,
    snapshots: MatRef<'_, f64>,
) -> Result<Motions, ShiftedError> {
    let spectrum = Spectrum::new(grid, shifts, snapshots, None, TOLERANCE)?;
    Ok(Motions::beside(shifts, &offsets(grid, shifts, &spectrum)))
}

/// What [`centred`] adds to the shifts of each frame.
pub(in crate::shifted) fn offsets(grid: &Grid, shifts: &dyn Shifts, spectrum: &Spectrum) -> Vec<Vector> {
    let (n_frames, n) = (shifts.n_frames(), shifts.n_snapshots());
    let mut offsets = vec![Vector::zeros(); n_frames];
    for &axis in &spectrum.phases.moving {
        let (cells, h) = (grid.cells()[axis], grid.spacing()[axis]);
        if cells % 2 == 1 {
            continue;
        }
        let angle = |k: usize, j: usize| PI * (shifts.motion(k, j).displacement[axis] / h).rem_euclid(2.0);
        // Each frame's waves with cosines and sines for amplitudes, and with the phases of the other axes.
        let values = Mat::from_fn(n, 2 * n_frames, |j, c| {
            let (sin, cos) = angle(c / 2, j).sin_cos();
            if c % 2 == 0 { cos } else { sin }
        });
        let amplitudes = Amplitudes { ranks: vec![2; n_frames], values };
        let problem = Problem { ridge: RIDGE, phases: &spectrum.phases, pieces: Vec::new() };
        let (mut normal, mut batch) = (Normal::new(&amplitudes), Batch::new(n));
        let mut sums = vec![[0.0; 3]; n_frames];
        let shortest = || spectrum.groups.iter().filter(|g| 2 * g.wave[axis] == cells);
        let pieces: Vec<_> = shortest()
            .map(|group| {
                let mut wave = group.wave;
                wave[axis] = 0;
                Piece { wave, data: Cow::Borrowed(&group.data), weight: 1.0 }
            })
            .collect();
        let energy: f64 = shortest().map(|g| g.energy).sum();
        for pieces in batches(n, &pieces) {
            batch.load(&problem, pieces);
            normal.solve(&mut batch);
            for phi in normal.phi.chunks_exact(4 * n_frames) {
                let (re, im) = phi.split_at(2 * n_frames);
                for ([cosines, sines, both], (re, im)) in
                    sums.iter_mut().zip(re.chunks_exact(2).zip(im.chunks_exact(2)))
                {
                    // |u|², |v|² and Re ū v of u cos + v sin.
                    *cosines += re[0].powi(2) + im[0].powi(2);
                    *sines += re[1].powi(2) + im[1].powi(2);
                    *both += re[0] * re[1] + im[0] * im[1];
                }
            }
        }
        // Fields that are no edges have much more there.
        if energy > EDGES * spectrum.energy {
            continue;
        }
        for (offset, [cosines, sines, both]) in offsets.iter_mut().zip(sums) {
            // What the best phase explains, and what needs another one.
            let half = (0.5 * (cosines - sines)).hypot(both);
            let (best, other) = (0.5 * (cosines + sines) + half, 0.5 * (cosines + sines) - half);
            if 0.5 * n as f64 * (cosines + sines) > EXPLAINED * energy && best - cosines > CLEARLY * other {
                // cos θ cos πs + sin θ sin πs = cos (πs − θ)
                offset[axis] = -0.5 * (2.0 * both).atan2(cosines - sines) / PI * h;
            }
        }
    }
    offsets
}
