//! Models by each method, and their errors.
use crate::fall::Fallen;
use example_support::Outcome;
use example_support::table::{Table, number};
use mor::Mat;
use mor::interpolation::{Degree, Kernel, Method, NetworkParams, RbfParams, SplineParams};
use mor::models::{Assessment, Spodiann, SpodiannParams};
use mor::shifted::fourier::Als;
use mor::shifted::{Grid, Interpolation, Motion, Motions, Shifts};
use render::cpu::Stopwatch;

/// A simulated run and its parameter.
pub(crate) struct Run {
    pub(crate) parameter: Option<f64>,
    pub(crate) fallen: Fallen,
}

/// Some snapshots of λ.
pub(crate) struct Part {
    grid: Grid,
    points: Mat<f64>,
    snapshots: Mat<f64>,
    motions: Motions,
}

impl Part {
    /// Every so many snapshots of each run.
    pub(crate) fn new(runs: &[Run], first: usize, stride: usize) -> Self {
        let which: Vec<(usize, usize)> = (0..runs.len())
            .flat_map(|i| (first..runs[i].fallen.times.len()).step_by(stride).map(move |j| (i, j)))
            .collect();
        let of = &runs[0].fallen;
        let (h, n) = (of.spacing, of.cells[0] * of.cells[1]);
        let inputs = 1 + usize::from(runs[0].parameter.is_some());
        let point = |run: &Run, j: usize| [run.fallen.times[j], run.parameter.unwrap_or(0.0)];
        let moved = |path: &[siltflow::interfaces::Pose], j: usize| path[j].position - path[0].position;
        Self {
            grid: Grid::new(of.cells, [h, h]).expect("a grid").starting_at([0.5 * h, 0.5 * h, 0.0].into()),
            points: Mat::from_fn(inputs, which.len(), |i, j| point(&runs[which[j].0], which[j].1)[i]),
            snapshots: Mat::from_fn(n, which.len(), |i, j| {
                runs[which[j].0].fallen.lambda[which[j].1 * n + i]
            }),
            motions: Motions::by(of.paths.len(), which.len(), |k, j| {
                Motion::translation(moved(&runs[which[j].0].fallen.paths[k], which[j].1))
            }),
        }
    }
}

/// Hidden layers of networks, and iterations of their training.
const HIDDEN: [usize; 2] = [24, 24];
const ITERATIONS: usize = 300;

/// Errors at unseen snapshots by each method.
pub(crate) fn table(name: &str, ranks: &[usize], known: &Part, unseen: &Part, seed: u64) -> Outcome<Table> {
    let watch = Stopwatch::start();
    let modes = Als { stagnation: 1e-2, ..Als::new(ranks) }.solve(
        &known.grid,
        &known.motions,
        known.snapshots.as_ref(),
        None,
        None,
        &mut |_| true,
    )?;
    let mut table = Table::new();
    table.section(name).row("modes of each disc", ranks[0], "");
    let error = modes.history.last().map_or(f64::NAN, |p| p.error);
    table.row("error of the decomposition", format!("{error:.2e}"), "");
    table.row("cost of the modes", number(watch.elapsed().cpu), "CPU s");
    let (spline, rbf) = (SplineParams::new(Degree::Cubic), RbfParams::new(Kernel::Cubic));
    let network = NetworkParams { iterations: ITERATIONS, seed, ..NetworkParams::new(&HIDDEN) };
    let methods: [(&str, Option<&dyn Method>); 4] =
        [("best", None), ("spline", Some(&spline)), ("rbf", Some(&rbf)), ("network", Some(&network))];
    let mut rows = Vec::new();
    for (name, coefficients) in methods {
        let watch = Stopwatch::start();
        let params = SpodiannParams { coefficients, paths: None };
        let how = (known.grid, Interpolation::Spectral);
        let model = Spodiann::new(known.points.as_ref(), &modes, how, &known.motions, params)?;
        let fit = watch.elapsed().cpu;
        rows.push(row(name, &model, unseen, fit)?);
    }
    let header =
        ["given", "projection", "total", "ratio", "worst", "last", "paths", "fit CPU s", "coefficients"];
    table.matrix(&header, rows);
    table
        .note("ratio: total error over that of the projection, of all unseen snapshots; worst, last: of one");
    table.note("snapshot; paths: root mean square error of places, in cells.");
    Ok(table)
}

fn row(name: &str, model: &Spodiann, unseen: &Part, fit: f64) -> Outcome<Vec<String>> {
    let m = unseen.points.ncols();
    let mut ratios = Vec::new();
    let (mut squares, mut frames) = (0.0, 0);
    for j in 0..m {
        let motions = Motions::by(unseen.motions.n_frames(), 1, |k, _| unseen.motions.motion(k, j));
        let (point, snapshot) =
            (unseen.points.as_ref().subcols(j, 1), unseen.snapshots.as_ref().subcols(j, 1));
        let error = model.assess(point, snapshot, &motions)?;
        ratios.push(error.total / error.projection);
        let x: Vec<f64> = point.col(0).iter().copied().collect();
        for (k, place) in model.places(&x)?.iter().enumerate() {
            squares += (place - unseen.motions.motion(k, j).displacement).norm_squared();
            frames += 1;
        }
    }
    let paths = (squares / f64::from(frames)).sqrt() / unseen.grid.spacing()[0];
    let Assessment { projection, total, .. } =
        model.assess(unseen.points.as_ref(), unseen.snapshots.as_ref(), &unseen.motions)?;
    let worst = ratios.iter().copied().fold(0.0, f64::max);
    let fitted = model.coefficient_fits().into_iter().flatten().next();
    let fitted = fitted.map_or(String::new(), |f| format!("{}, phases {:?}", f.method, f.phases));
    Ok(vec![
        name.into(),
        format!("{projection:.2e}"),
        format!("{total:.2e}"),
        format!("{:.3}", total / projection),
        format!("{worst:.2}"),
        format!("{:.3}", ratios[m - 1]),
        format!("{paths:.1e}"),
        number(fit),
        fitted,
    ])
}
