//! Models of runs with parameters.
use crate::fall::Fallen;
use example_support::Outcome;
use mor::interpolation::{Degree, Kernel, ProductParams, RbfParams, SplineParams};
use mor::models::{Assessment, Podiann, Spodiann, SpodiannParams};
use mor::pod::{Pod, PodParams};
use mor::shifted::{Grid, Interpolation, Motion, Motions, Noise, Ranks, ShiftedPod, Shifts};
use mor::{Mat, MatRef};
use render::cpu::Stopwatch;
use siltflow::interfaces::Vector;
use std::ops::ControlFlow;
use std::path::Path;

/// One run and its parameters.
pub(crate) struct Run {
    pub(crate) density: f64,
    pub(crate) aside: f64,
    pub(crate) fallen: Fallen,
}

/// Modes of λ for each disc, and of the velocity.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sizes {
    pub(crate) shifted: usize,
    pub(crate) plain: usize,
}

/// λ by shifted modes, the velocity by plain ones; inputs are time, density, place.
pub(crate) struct Models {
    lambda: Spodiann,
    velocity: Podiann,
}

/// Of a run that the models have not seen.
pub(crate) struct Errors {
    pub(crate) lambda: Assessment,
    pub(crate) velocity: Assessment,
    /// Root mean square distance of the discs from where they are predicted, in diameters of 1 mm.
    pub(crate) place: f64,
}

const DIAMETER: f64 = 1e-3;

impl Run {
    /// Inputs at snapshot j, of about equal size.
    fn point(&self, j: usize) -> [f64; 3] {
        [10.0 * self.fallen.times[j], self.density / 1000.0, self.aside / DIAMETER]
    }
    /// Of disc k from where the first run's would start.
    fn motion(&self, k: usize, j: usize) -> Motion {
        let home = Vector::new(5e-3, [16e-3, 13.5e-3][k], 0.0);
        Motion::translation(self.fallen.paths[k][j].position.coords - home)
    }
    fn points(&self) -> Mat<f64> {
        Mat::from_fn(3, self.fallen.times.len(), |i, j| self.point(j)[i])
    }
    fn motions(&self) -> Motions {
        Motions::by(2, self.fallen.times.len(), |k, j| self.motion(k, j))
    }
    fn matrix<'a>(&self, data: &'a [f64]) -> MatRef<'a, f64> {
        let m = self.fallen.times.len();
        MatRef::from_column_major_slice(data, data.len() / m, m)
    }
}

impl Models {
    /// Of all runs but one.
    pub(crate) fn without(runs: &[Run], left_out: Option<usize>, sizes: Sizes) -> Outcome<Self> {
        let used: Vec<&Run> =
            runs.iter().enumerate().filter(|(i, _)| left_out != Some(*i)).map(|r| r.1).collect();
        let m = used[0].fallen.times.len();
        let all = used.len() * m;
        let points = Mat::from_fn(3, all, |i, j| used[j / m].point(j % m)[i]);
        let motions = Motions::by(2, all, |k, j| used[j / m].motion(k, j % m));
        let joined = |of: fn(&Fallen) -> &[f64]| -> Vec<f64> {
            used.iter().flat_map(|r| of(&r.fallen)).copied().collect()
        };

        // A spline in time, cubic radial functions in the parameters: what is known everywhere, whichever run is left out.
        let method = ProductParams {
            first: SplineParams::new(Degree::Quintic),
            others: Box::new(RbfParams::new(Kernel::Cubic).with_tail(2)),
        };
        let data = joined(|f| &f.lambda);
        let snapshots = MatRef::from_column_major_slice(&data, data.len() / all, all);
        let first = &runs[0].fallen;
        let h = first.spacing;
        let grid = Grid::new(first.cells, [h, h])?.starting_at([0.5 * h, 0.5 * h, 0.0].into());
        let modes = ShiftedPod::new(grid, Interpolation::Spectral)
            .noise(Noise::Dense)
            .ranks(Ranks::Given(vec![sizes.shifted; 2]))
            .tolerance(1e-3)
            .solve(&motions, snapshots, None, &mut |_| ControlFlow::Continue(()))?;
        let params = SpodiannParams { coefficients: Some(&method), paths: Some(&method) };
        let lambda =
            Spodiann::new(points.as_ref(), &modes, (grid, Interpolation::Spectral), &motions, params)?;

        let data = joined(|f| &f.velocity);
        let snapshots = MatRef::from_column_major_slice(&data, data.len() / all, all);
        let pod = Pod::new(snapshots, &PodParams::of_rank(sizes.plain))?;
        let velocity = Podiann::new(points.as_ref(), &pod, Some(&method))?.in_single_precision();
        Ok(Self { lambda, velocity })
    }

    /// At all snapshots of a run.
    pub(crate) fn errors(&self, run: &Run) -> Outcome<Errors> {
        let (points, motions) = (run.points(), run.motions());
        let lambda = self.lambda.assess(points.as_ref(), run.matrix(&run.fallen.lambda), &motions)?;
        let velocity = self.velocity.assess(points.as_ref(), run.matrix(&run.fallen.velocity))?;
        let mut squares = 0.0;
        let m = run.fallen.times.len();
        for j in 0..m {
            for (k, told) in self.lambda.places(&run.point(j))?.iter().enumerate() {
                squares += (told - motions.motion(k, j).displacement).norm_squared() / (2 * m) as f64;
            }
        }
        Ok(Errors { lambda, velocity, place: squares.sqrt() / DIAMETER })
    }

    /// λ and velocity at the end of a run.
    pub(crate) fn last_fields(&self, run: &Run) -> Outcome<[Vec<f64>; 2]> {
        let x = run.point(run.fallen.times.len() - 1);
        let (mut lambda, mut velocity) = (vec![0.0; self.lambda.rows()], vec![0.0; self.velocity.rows()]);
        self.lambda.predict(&x, &mut lambda)?;
        self.velocity.predict(&x, &mut velocity)?;
        Ok([lambda, velocity])
    }

    /// CPU seconds of the places, of λ and of the velocity (in single precision) at one time, and of either at all times of a run together.
    pub(crate) fn costs(&self, run: &Run) -> Outcome<[f64; 5]> {
        const TIMES: usize = 100;
        let points = run.points();
        let all = run.fallen.times.len();
        let (mut lambda, mut velocity) =
            (vec![0.0; self.lambda.rows() * all], vec![0.0; self.velocity.rows() * all]);
        let one = |i: usize| points.subcols(i % all, 1);
        let cost = |times: usize, f: &mut dyn FnMut(usize) -> Outcome<()>| -> Outcome<f64> {
            let watch = Stopwatch::start();
            (0..times).try_for_each(f)?;
            Ok(watch.elapsed().cpu / times as f64)
        };
        let (first, second) = (self.lambda.rows(), self.velocity.rows());
        Ok([
            cost(TIMES, &mut |i| Ok(self.lambda.motions(&run.point(i % all)).map(drop)?))?,
            cost(TIMES, &mut |i| Ok(self.lambda.predict_many(one(i), &mut lambda[..first])?))?,
            cost(TIMES, &mut |i| Ok(self.velocity.predict_many(one(i), &mut velocity[..second])?))?,
            cost(TIMES, &mut |_| Ok(self.lambda.predict_many(points.as_ref(), &mut lambda)?))?,
            cost(TIMES, &mut |_| Ok(self.velocity.predict_many(points.as_ref(), &mut velocity)?))?,
        ])
    }

    pub(crate) fn save(&self, out: &Path) -> Outcome<()> {
        self.lambda.record().save(&out.join("lambda.model"))?;
        self.velocity.record().save(&out.join("velocity.model"))?;
        Ok(())
    }
}
