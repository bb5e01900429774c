//! A model and how far it is off.
use crate::setup::{Coefficients, ModelSetup};
use crate::view::View;
use interfaces::Pose;
use mor::interpolation::{InterpolationError, Method, NetworkParams, Record, Samples, SplineParams};
use mor::models::{Assessment, ModelError, Podiann, Spodiann, SpodiannParams};
use mor::pod::{Pod, PodError, PodParams, Rank};
use mor::shifted::{Grid, Interpolation, Motions, Ranks, ShiftedError, ShiftedPod, Shifts};
use mor::{Mat, MatRef};
use serde_json::{Value, json};
use std::ops::ControlFlow;

/// A model, with modes that stay or move.
pub(super) enum Fitted {
    Still(Box<Podiann>),
    Moving(Box<Spodiann>),
}

/// Why a model could not be made.
#[derive(Debug, thiserror::Error)]
pub(super) enum FitError {
    #[error(transparent)]
    Pod(#[from] PodError),
    #[error(transparent)]
    Shifted(#[from] ShiftedError),
    #[error(transparent)]
    Model(#[from] ModelError),
    #[error(transparent)]
    Interpolation(#[from] InterpolationError),
}

/// What there is to tell.
pub(super) struct Story {
    pub(super) result: Value,
    /// A time between snapshots that made the model, if there are such \[s\].
    pub(super) time: f64,
    /// The field then, and as the model has it.
    pub(super) field: Vec<f64>,
    pub(super) predicted: Vec<f64>,
}

/// Snapshots on which a model is tested, at most: the nearest fields of modes that move take long.
const TESTED: usize = 25;
/// Modes that are found, at most.
const MOST: usize = 100;

/// Some of the snapshots.
struct Part {
    points: Mat<f64>,
    snapshots: Mat<f64>,
    motions: Motions,
}

impl Part {
    fn of(
        setup: &ModelSetup,
        (times, all): (&[f64], MatRef<'_, f64>),
        paths: &[Vec<Pose>],
        which: &[usize],
    ) -> Result<Self, ShiftedError> {
        // Frames begin where the bodies are at the first snapshot, in every part.
        let along = |path: &Vec<Pose>| which.iter().map(|&k| path[k]).collect::<Vec<_>>();
        let mut part: Vec<Vec<Pose>> = paths.iter().map(along).collect();
        part.iter_mut().zip(paths).for_each(|(part, path)| part.insert(0, path[0]));
        let motions =
            if setup.turning { Motions::along(&part)? } else { Motions::along_without_turning(&part)? };
        Ok(Self {
            points: Mat::from_fn(1, which.len(), |_, j| times[which[j]]),
            snapshots: Mat::from_fn(all.nrows(), which.len(), |i, j| all[(i, which[j])]),
            motions: Motions::by(paths.len(), which.len(), |k, j| motions.motion(k, j + 1)),
        })
    }
}

/// At most so many of them, evenly spread.
fn some(all: &[usize], most: usize) -> Vec<usize> {
    let stride = all.len().div_ceil(most).max(1);
    all.iter().copied().skip(stride / 2).step_by(stride).collect()
}

impl Fitted {
    /// Of snapshots (rows × times) with the paths of the frames.
    pub(super) fn new(
        setup: &ModelSetup,
        view: &dyn View,
        (times, all): (&[f64], MatRef<'_, f64>),
        paths: &[Vec<Pose>],
    ) -> Result<(Self, Story), FitError> {
        let (made, others): (Vec<usize>, Vec<usize>) =
            (0..times.len()).partition(|k| k.is_multiple_of(setup.every));
        let part = |which: &[usize]| Part::of(setup, (times, all), paths, which);
        let training = part(&made)?;
        let samples = || Samples::new(training.points.as_ref(), training.points.as_ref());
        let (network, spline);
        let method: Option<&dyn Method> = match &setup.coefficients {
            Coefficients::Best => None,
            Coefficients::Network(hidden) => {
                network = NetworkParams::new(hidden);
                Some(&network)
            }
            Coefficients::Spline => {
                spline = SplineParams::highest(&samples()?)?;
                Some(&spline)
            }
        };
        let fitted = if paths.is_empty() {
            let rank = setup.ranks.as_ref().map_or(Rank::Tolerance(setup.tolerance), |r| Rank::Fixed(r[0]));
            let params = PodParams {
                rank,
                most: Some(MOST),
                weights: volumes(view, all.nrows()),
                ..PodParams::default()
            };
            let pod = Pod::new(training.snapshots.as_ref(), &params)?;
            Self::Still(Box::new(Podiann::new(training.points.as_ref(), &pod, method)?))
        } else {
            let grid = grid(view, setup.interpolation)?;
            let ranks = setup.ranks.clone().map_or(Ranks::Found, Ranks::Given);
            let pod = ShiftedPod::new(grid, setup.interpolation).ranks(ranks).rank_tolerance(setup.tolerance);
            // Modes a tenth as far off as asked for are enough.
            let pod = pod.tolerance(0.1 * setup.tolerance);
            let found = pod.solve(&training.motions, training.snapshots.as_ref(), None, &mut |_| {
                ControlFlow::Continue(())
            })?;
            let params = SpodiannParams { coefficients: method, paths: None };
            let how = (grid, setup.interpolation);
            Self::Moving(Box::new(Spodiann::new(
                training.points.as_ref(),
                &found,
                how,
                &training.motions,
                params,
            )?))
        };
        let assess = |which: &[usize]| -> Result<Value, FitError> {
            let Assessment { projection, interpolation, total } =
                fitted.assess(&part(&some(which, TESTED))?)?;
            Ok(json!({ "projection": projection, "interpolation": interpolation, "total": total }))
        };
        let shown = others.get(others.len() / 2).or(made.last()).copied().unwrap_or(0);
        let mut predicted = vec![0.0; all.nrows()];
        fitted.predict(times[shown], &mut predicted)?;
        let mut result = json!({
            "model": setup.name,
            "field": setup.field,
            "kind": if paths.is_empty() { "podiann" } else { "spodiann" },
            "ranks": fitted.ranks(),
            "snapshots": made.len(),
            "training": assess(&made)?,
        });
        if !others.is_empty() {
            result["held_out"] = assess(&others)?;
        }
        let field = all.col(shown).iter().copied().collect();
        Ok((fitted, Story { result, time: times[shown], field, predicted }))
    }

    fn assess(&self, part: &Part) -> Result<Assessment, ModelError> {
        match self {
            Self::Still(model) => model.assess(part.points.as_ref(), part.snapshots.as_ref()),
            Self::Moving(model) => model.assess(part.points.as_ref(), part.snapshots.as_ref(), &part.motions),
        }
    }
    fn predict(&self, time: f64, out: &mut [f64]) -> Result<(), ModelError> {
        match self {
            Self::Still(model) => model.predict(&[time], out),
            Self::Moving(model) => model.predict(&[time], out),
        }
    }
    fn ranks(&self) -> Vec<usize> {
        match self {
            Self::Still(model) => vec![model.rank()],
            Self::Moving(model) => model.ranks(),
        }
    }
    pub(super) fn record(&self) -> Record {
        match self {
            Self::Still(model) => model.record(),
            Self::Moving(model) => model.record(),
        }
    }
    /// Name and values of each mode.
    pub(super) fn modes(&self) -> Vec<(String, Vec<f64>)> {
        let of = |prefix: String, modes: MatRef<'_, f64>| -> Vec<(String, Vec<f64>)> {
            (0..modes.ncols())
                .map(|i| (format!("{prefix}mode_{}", i + 1), modes.col(i).iter().copied().collect()))
                .collect()
        };
        match self {
            Self::Still(model) => of(String::new(), model.modes()),
            Self::Moving(model) => (0..model.ranks().len())
                .flat_map(|k| of(format!("frame_{}_", k + 1), model.modes(k)))
                .collect(),
        }
    }
}

/// Volumes of the cells for every row, where they are not all equal.
fn volumes(view: &dyn View, rows: usize) -> Option<Vec<f64>> {
    let dim = view.dim();
    if (0..dim).all(|a| view.axis(a).is_uniform()) {
        return None;
    }
    let n: [usize; 3] = [0, 1, 2].map(|a| if a < dim { view.axis(a).cells() } else { 1 });
    let width = |a: usize, i: usize| if a < dim { view.axis(a).width(i) } else { 1.0 };
    let one = (0..n[2]).flat_map(|k| {
        (0..n[1]).flat_map(move |j| (0..n[0]).map(move |i| width(0, i) * width(1, j) * width(2, k)))
    });
    let one: Vec<f64> = one.collect();
    Some(one.iter().copied().cycle().take(rows).collect())
}

/// The cells, all equal; a box that is not periodic is taken for one by spectral interpolation.
fn grid(view: &dyn View, interpolation: Interpolation) -> Result<Grid, ShiftedError> {
    let axes: Vec<_> = (0..view.dim()).map(|a| (view.axis(a).cells(), view.axis(a).mean_width())).collect();
    let grid = match axes[..] {
        [x, y] => Grid::new([x.0, y.0], [x.1, y.1])?,
        [x, y, z] => Grid::new([x.0, y.0, z.0], [x.1, y.1, z.1])?,
        _ => Grid::new([axes[0].0], [axes[0].1])?,
    };
    let first = [0, 1, 2].map(|a| if a < view.dim() { view.axis(a).centre(0) } else { 0.0 });
    let grid = grid.starting_at(first.into());
    Ok(match interpolation {
        Interpolation::Spectral => grid,
        _ => grid.bounded((0..view.dim()).filter(|&a| !view.periodic(a))),
    })
}
