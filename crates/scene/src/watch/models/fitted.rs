//! A model and how far it is off.
use crate::setup::{Coefficients, ModelSetup};
use crate::view::View;
use interfaces::Pose;
use mor::interpolation::{FitProgress, Method, NetworkParams, Record, Samples, SplineParams};
use mor::models::{Assessment, CoefficientFit, ModelError, Podiann, Spodiann, SpodiannParams};
use mor::pod::{Pod, PodParams, Rank};
use mor::shifted::{
    Grid, Interpolation, Motion, Motions, Progress, Ranks, ShiftedError, ShiftedPod, StopReason,
};
use mor::{Mat, MatRef};
use serde_json::{Value, json};
use std::error::Error;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

/// A model, with modes that stay or move.
pub(super) enum Fitted {
    Still(Box<Podiann>),
    Moving(Box<Spodiann>),
}

/// Why a model could not be made, by whoever could not.
type Failure = Box<dyn Error + Send + Sync>;

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
    /// Frames begin where the bodies are at the first of all snapshots.
    fn of(
        setup: &ModelSetup,
        (times, all): (&[f64], MatRef<'_, f64>),
        paths: &[Vec<Pose>],
        which: &[usize],
    ) -> Self {
        let motion = |k: usize, j: usize| {
            let (first, now) = (&paths[k][0], &paths[k][which[j]]);
            if setup.turning {
                Motion::between(first, now)
            } else {
                Motion::translation(now.position - first.position)
            }
        };
        Self {
            points: Mat::from_fn(1, which.len(), |_, j| times[which[j]]),
            snapshots: Mat::from_fn(all.nrows(), which.len(), |i, j| all[(i, which[j])]),
            motions: Motions::by(paths.len(), which.len(), motion),
        }
    }
}

/// At most so many of them, evenly spread.
fn some(all: &[usize], most: usize) -> Vec<usize> {
    let stride = all.len().div_ceil(most).max(1);
    all.iter().copied().skip(stride / 2).step_by(stride).collect()
}

impl Fitted {
    /// Of snapshots (rows × times) with the paths of the frames; nothing if somebody asks to `stop`.
    pub(super) fn new(
        setup: &ModelSetup,
        view: &dyn View,
        (times, all): (&[f64], MatRef<'_, f64>),
        paths: &[Vec<Pose>],
        stop: &AtomicBool,
    ) -> Result<Option<(Self, Story)>, Failure> {
        let go_on = || !stop.load(Ordering::Relaxed);
        if !go_on() {
            return Ok(None);
        }
        let (made, others): (Vec<usize>, Vec<usize>) =
            (0..times.len()).partition(|k| k.is_multiple_of(setup.every));
        let part = |which: &[usize]| Part::of(setup, (times, all), paths, which);
        let training = part(&made);
        let (network, spline);
        let method: Option<&dyn Method> = match &setup.coefficients {
            Coefficients::Best => None,
            Coefficients::Network(hidden) => {
                network = NetworkParams::new(hidden);
                Some(&network)
            }
            Coefficients::Spline => {
                spline = SplineParams::highest(&Samples::new(
                    training.points.as_ref(),
                    training.points.as_ref(),
                )?)?;
                Some(&spline)
            }
        };
        let mut fit_observer =
            |_: &FitProgress<'_>| if go_on() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) };
        let fitted = if paths.is_empty() {
            let params = PodParams { weights: volumes(view, all.nrows()), ..modes(setup) };
            let pod = Pod::new(training.snapshots.as_ref(), &params)?;
            Podiann::new_observed(training.points.as_ref(), &pod, method, &mut fit_observer)
                .map(|model| Self::Still(Box::new(model)))
        } else {
            let grid = grid(view, setup.interpolation)?;
            let ranks = setup.ranks.clone().map_or(Ranks::Found, Ranks::Given);
            let pod = ShiftedPod::new(grid, setup.interpolation).ranks(ranks).rank_tolerance(setup.tolerance);
            // Modes a tenth as far off as asked for are enough.
            let pod = pod.tolerance(0.1 * setup.tolerance);
            let mut observer =
                |_: &Progress| if go_on() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) };
            let found = pod.solve(&training.motions, training.snapshots.as_ref(), None, &mut observer)?;
            if found.stopped == StopReason::Asked {
                return Ok(None);
            }
            let params = SpodiannParams { coefficients: method, paths: None };
            let how = (grid, setup.interpolation);
            let (points, motions) = (training.points.as_ref(), &training.motions);
            Spodiann::new_observed(points, &found, how, motions, params, &mut fit_observer)
                .map(|model| Self::Moving(Box::new(model)))
        };
        let fitted = match fitted {
            Err(error) if error.is_stopped() => return Ok(None),
            fitted => fitted?,
        };
        let assess = |which: &[usize]| -> Result<Value, Failure> {
            let Assessment { projection, interpolation, total } =
                fitted.assess(&part(&some(which, TESTED)))?;
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
            "coefficients": fitted.coefficients(),
            "snapshots": made.len(),
            "training": assess(&made)?,
        });
        if !others.is_empty() {
            result["held_out"] = assess(&others)?;
        }
        let field = all.col(shown).iter().copied().collect();
        Ok(Some((fitted, Story { result, time: times[shown], field, predicted })))
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
    /// Methods of the coefficients as fitted, of moving modes for every frame, with the axes whose phases are inputs.
    fn coefficients(&self) -> Vec<Value> {
        match self {
            Self::Still(model) => {
                model.method().map(|method| json!({ "method": method })).into_iter().collect()
            }
            Self::Moving(model) => {
                let of = |fit: CoefficientFit| {
                    let (error, other) = (fit.left_out, fit.left_out_other);
                    json!({ "method": fit.method, "phases": fit.phases, "left_out": error, "left_out_other": other })
                };
                model.coefficient_fits().into_iter().map(|fit| fit.map_or(Value::Null, of)).collect()
            }
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

/// How many modes, of those that stay.
fn modes(setup: &ModelSetup) -> PodParams {
    match &setup.ranks {
        Some(ranks) => PodParams::of_rank(ranks[0]),
        None => {
            PodParams { rank: Rank::Tolerance(setup.tolerance), most: Some(MOST), ..PodParams::default() }
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Ranks that are given are not cut to what may be found.
    #[test]
    fn given_ranks_are_given() {
        let mut setup = ModelSetup {
            name: "a".into(),
            field: "lambda".into(),
            frames: vec![],
            turning: false,
            ranks: Some(vec![2 * MOST]),
            tolerance: 1e-3,
            interpolation: Interpolation::Spectral,
            coefficients: Coefficients::Best,
            every: 2,
        };
        assert_eq!(modes(&setup), PodParams::of_rank(2 * MOST));
        setup.ranks = None;
        assert_eq!((modes(&setup).rank, modes(&setup).most), (Rank::Tolerance(1e-3), Some(MOST)));
    }

    #[test]
    fn some_are_spread_evenly() {
        let all: Vec<usize> = (0..100).collect();
        assert_eq!(some(&all, 25).len(), 25);
        assert_eq!(some(&all[..7], 25), all[..7]);
        assert_eq!(some(&[], 25), Vec::<usize>::new());
    }
}
