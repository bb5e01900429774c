//! λ of discs on known paths.
use interfaces::Vector;
use mor::Mat;
use mor::models::{Assessment, ModelError, Spodiann};
use mor::shifted::{Grid, Motion, Motions, Shifts};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;

/// A disc that starts from rest, approaches a terminal velocity and drifts sideways; faster for larger μ.
pub(crate) struct Disc {
    start: [f64; 2],
    radius: f64,
    /// Terminal velocity [cells per unit of time], relaxation time, and size [cells], turns and phase of a sideways oscillation.
    velocity: f64,
    relaxation: f64,
    drift: [f64; 3],
}

impl Disc {
    fn random(rng: &mut Pcg64, cells: [usize; 2], start: [f64; 2], radius: f64) -> Self {
        Self {
            start,
            radius,
            velocity: rng.random_range(0.4..1.4) * cells[1] as f64,
            relaxation: rng.random_range(0.1..0.5),
            drift: [rng.random_range(-6.0..6.0), rng.random_range(0.3..1.2), rng.random_range(0.0..TAU)],
        }
    }
    fn displacement(&self, t: f64, mu: f64) -> Vector {
        let tau = self.relaxation * (1.0 + 0.2 * mu);
        let fallen = self.velocity * (1.0 + 0.3 * mu) * (t - tau * (1.0 - (-t / tau).exp()));
        let [size, turns, phase] = self.drift;
        let aside = size * (1.0 + 0.2 * mu) * ((TAU * turns * t + phase).sin() - phase.sin()) * t;
        Vector::new(aside, -fallen, 0.0)
    }
}

/// Discs in a doubly periodic box.
pub(crate) struct Discs {
    pub(crate) grid: Grid,
    discs: Vec<Disc>,
}

/// Snapshots at points that are times t ∈ [0, 1], or times and parameters μ ∈ [−1, 1].
pub(crate) struct Part {
    pub(crate) points: Mat<f64>,
    pub(crate) snapshots: Mat<f64>,
    pub(crate) motions: Motions,
}

impl Discs {
    /// So many rows and columns of discs at random.
    pub(crate) fn random(seed: u64, cells: [usize; 2], [columns, rows]: [usize; 2], radius: f64) -> Self {
        let mut rng = Pcg64::seed_from_u64(seed);
        let width = [cells[0] / columns, cells[1] / rows].map(|n| n as f64);
        let start = |k: usize, rng: &mut Pcg64| {
            [k % columns, k / columns]
                .map(|i| i as f64 + rng.random_range(0.4..0.6))
                .iter()
                .zip(width)
                .map(|(i, w)| i * w)
                .collect::<Vec<_>>()
        };
        let disc = |k: usize| {
            let start = start(k, &mut rng);
            Disc::random(&mut rng, cells, [start[0], start[1]], radius)
        };
        let discs = (0..columns * rows).map(disc).collect();
        Self { grid: Grid::new(cells, [1.0; 2]).expect("a grid"), discs }
    }
    pub(crate) fn count(&self) -> usize {
        self.discs.len()
    }
    /// λ = min(1, max(0, ½ + (R − r)/h)), added up.
    pub(crate) fn part(&self, points: &[Vec<f64>]) -> Part {
        let (grid, discs) = (&self.grid, &self.discs);
        let cells = grid.cells();
        let moved = |k: usize, j: usize| {
            discs[k].displacement(points[j][0], points[j].get(1).copied().unwrap_or(0.0))
        };
        let motions = Motions::by(discs.len(), points.len(), |k, j| Motion::translation(moved(k, j)));
        let nearest = |d: f64, n: usize| d - n as f64 * (d / n as f64).round();
        let value = |i: usize, j: usize| {
            let x = grid.centre(i);
            let disc = |(k, disc): (usize, &Disc)| {
                let s = motions.motion(k, j).displacement;
                let r = nearest(x.x - disc.start[0] - s.x, cells[0])
                    .hypot(nearest(x.y - disc.start[1] - s.y, cells[1]));
                (0.5 + disc.radius - r).clamp(0.0, 1.0)
            };
            discs.iter().enumerate().map(disc).sum::<f64>()
        };
        Part {
            points: Mat::from_fn(points[0].len(), points.len(), |i, j| points[j][i]),
            snapshots: Mat::from_fn(grid.n_cells(), points.len(), value),
            motions,
        }
    }
}

/// Times t_j = (j + ½ shift)/(m − 1), j = 0 … m − 1 − shift.
pub(crate) fn times(m: usize, between: bool) -> Vec<f64> {
    let shift = usize::from(between);
    (0..m - shift).map(|j| (j as f64 + 0.5 * shift as f64) / (m - 1) as f64).collect()
}

/// Points of all pairs of times and parameters.
pub(crate) fn runs(times: &[f64], parameters: &[f64]) -> Vec<Vec<f64>> {
    parameters.iter().flat_map(|mu| times.iter().map(move |t| vec![*t, *mu])).collect()
}

/// Errors of every snapshot.
pub(crate) fn each(model: &Spodiann, part: &Part) -> Result<Vec<Assessment>, ModelError> {
    let one = |j: usize| {
        let motions = Motions::by(part.motions.n_frames(), 1, |k, _| part.motions.motion(k, j));
        model.assess(part.points.as_ref().subcols(j, 1), part.snapshots.as_ref().subcols(j, 1), &motions)
    };
    (0..part.points.ncols()).map(one).collect()
}
