//! A cylinder of diameter 1 in a stream of speed 1 whose wake swings.
use example_support::Outcome;
use example_support::prescribed_bodies::PrescribedBodies;
use example_support::walled_flows::put_walls;
use mor::galerkin::{Basis, DormandPrince, Ode, QuadraticModel};
use mor::pod::{Pod, PodParams, Rank};
use mor::{Mat, MatRef};
use render::cpu::Stopwatch;
use render::progress::Progress;
use siltflow::dem::Disc;
use siltflow::flow::{CartesianGrid, Convection, Diffusion, Fluid, Profile, Projection, Side};
use std::cell::RefCell;
use std::sync::atomic::{AtomicBool, Ordering};

/// The box \[D\] and the cylinder's place in it.
pub(crate) const BOX: [f64; 2] = [20.0, 10.0];
const PLACE: [f64; 2] = [5.0, 5.0];
/// About two periods, from which the modes are.
pub(crate) const SNAPSHOTS: usize = 120;
/// About ten periods, over which models are held against the flow.
const TIMES: usize = 601;
/// Between snapshots \[D/U\].
const INTERVAL: f64 = 0.1;

/// The full model: a flow and what it did.
pub(crate) struct Wake {
    flow: Projection<2>,
    dt: f64,
    /// Unknowns, one column per time.
    snapshots: Mat<f64>,
    /// CPU seconds of all, of the times that models predict, of the modes.
    pub(crate) cpu: f64,
    pub(crate) predicted_cpu: f64,
    pub(crate) pod_cpu: f64,
    /// f D/U of the velocity across the stream, 2 D behind the cylinder.
    pub(crate) strouhal: f64,
}

/// A reduced model and how it did.
pub(crate) struct Galerkin {
    pub(crate) rank: usize,
    /// Of the snapshots' fluctuation on the modes.
    pub(crate) projection: f64,
    /// Largest error within 1, 5 and 10 periods, relative to the fluctuation.
    pub(crate) errors: [f64; 3],
    pub(crate) strouhal: f64,
    pub(crate) project_cpu: f64,
    pub(crate) solve_cpu: f64,
    /// Coefficients of the model and of the flow.
    pub(crate) states: Mat<f64>,
    pub(crate) truth: Mat<f64>,
}

fn start(reynolds: f64, per_diameter: usize) -> Outcome<Projection<2>> {
    let grid = CartesianGrid::new(BOX.map(|l| (l * per_diameter as f64).round() as usize), BOX)?;
    let sides = [
        [Side::Inlet(Profile::Uniform([1.0, 0.0, 0.0])), Side::PressureOutlet(0.0)],
        [Side::FreeSlip, Side::FreeSlip],
    ];
    let fluid = Fluid { density: 1.0, viscosity: 1.0 / reynolds };
    let mut flow = Projection::new(grid, sides, fluid)?
        .with_diffusion(Diffusion::Explicit)
        .with_convection(Convection::Central);
    let disc = Disc::new(0.5)?;
    put_walls(&mut flow, &PrescribedBodies::default().with(disc, [PLACE[0], PLACE[1], 0.0], 0.0))?;
    // A swirl behind the cylinder, so that the wake swings soon.
    flow.set_velocity(|x| {
        let r2 = (x[0] - PLACE[0] - 1.5).powi(2) + (x[1] - PLACE[1]).powi(2);
        [1.0, 0.3 * (-r2).exp()]
    });
    Ok(flow)
}

impl Wake {
    /// Runs until the wake swings evenly, and on for all times that models predict; `None` if it was stopped.
    pub(crate) fn run(
        reynolds: f64,
        per_diameter: usize,
        settle: f64,
        stop: &AtomicBool,
    ) -> Outcome<Option<Self>> {
        let watch = Stopwatch::start();
        let mut flow = start(reynolds, per_diameter)?;
        // Courant number 0.5; a whole number of steps between snapshots.
        let per_interval = (INTERVAL * per_diameter as f64 / 0.24).ceil();
        let dt = (INTERVAL / per_interval).min(0.9 * flow.viscous_limit());
        let per_interval = (INTERVAL / dt).ceil() as usize;
        let dt = INTERVAL / per_interval as f64;
        let intervals = (settle / INTERVAL).ceil() as usize;
        let end = (intervals + TIMES - 1) as f64 * INTERVAL;
        let mut progress = Progress::new(0.0, end);
        let mut columns: Vec<Vec<f64>> = Vec::new();
        let mut before = 0.0;
        for interval in 0..intervals + TIMES {
            if stop.load(Ordering::Relaxed) {
                return Ok(None);
            }
            if interval == intervals {
                before = watch.elapsed().cpu;
            }
            if interval >= intervals {
                columns.push(flow.unknowns());
            }
            for _ in 0..if interval + 1 < intervals + TIMES { per_interval } else { 0 } {
                flow.advance(dt, [0.0; 2])?;
            }
            progress.tell(flow.steps(), flow.time(), || format!("dt {dt:.2e}  Co {:.2}", flow.courant(dt)));
        }
        progress.finish(flow.steps(), "the wake has been seen for ten periods");
        let snapshots = Mat::from_fn(columns[0].len(), TIMES, |i, j| columns[j][i]);
        let cpu = watch.elapsed().cpu;
        let mut wake =
            Self { flow, dt, snapshots, cpu, predicted_cpu: cpu - before, pod_cpu: 0.0, strouhal: 0.0 };
        let [nx, ny] = wake.cells();
        let probe = nx * ny + (ny / 2) * nx + ((PLACE[0] + 2.0) * per_diameter as f64) as usize;
        let swing: Vec<f64> = (0..TIMES).map(|j| wake.snapshots[(probe, j)]).collect();
        wake.strouhal = frequency(&swing);
        Ok(Some(wake))
    }

    pub(crate) fn rows(&self) -> usize {
        self.snapshots.nrows()
    }
    pub(crate) fn cells(&self) -> [usize; 2] {
        self.flow.grid().cells()
    }
    pub(crate) fn times(&self) -> Vec<f64> {
        (0..TIMES).map(|j| INTERVAL * j as f64).collect()
    }

    /// The POD modes of the first two periods about their mean, in the inner product of the kinetic energy.
    pub(crate) fn modes(&mut self, most: usize) -> Outcome<Pod> {
        let watch = Stopwatch::start();
        let params = PodParams {
            rank: Rank::Fixed(most),
            subtract_mean: true,
            weights: Some(self.flow.unknown_volumes()),
            ..PodParams::default()
        };
        let pod = Pod::new(self.seen(), &params)?;
        self.pod_cpu = watch.elapsed().cpu;
        Ok(pod)
    }
    fn seen(&self) -> MatRef<'_, f64> {
        self.snapshots.subcols(0, SNAPSHOTS)
    }

    /// The model on these modes, from the first snapshot on.
    pub(crate) fn project(&mut self, pod: &Pod) -> Outcome<Galerkin> {
        let (rank, watch) = (pod.rank(), Stopwatch::start());
        let basis = Basis::new(pod.modes.as_ref(), pod.mean.as_deref(), pod.weights.as_deref())?;
        // Short steps: what leaves through the outlet is taken implicitly by the flow.
        let full = Rate { flow: RefCell::new(&mut self.flow), n: basis.n(), dt: 0.2 * self.dt };
        // Small, so that nothing turns back at the outlet.
        let model = QuadraticModel::project(&basis, &full, 0.05)?;
        let project_cpu = watch.elapsed().cpu;
        let watch = Stopwatch::start();
        let first = basis.coefficients(self.snapshots.col_as_slice(0))?;
        let solver = DormandPrince { relative: 1e-8, ..DormandPrince::default() };
        let states = solver.solve(&model, &first, &self.times())?;
        let solve_cpu = watch.elapsed().cpu;
        let mut truth = Mat::zeros(rank, TIMES);
        let mut errors = [0.0_f64; 3];
        let fluctuation = (pod.energy / SNAPSHOTS as f64).sqrt();
        let period = 1.0 / self.strouhal;
        for j in 0..TIMES {
            let snapshot = self.snapshots.col_as_slice(j);
            let c = basis.coefficients(snapshot)?;
            let weights = pod.weights.as_deref().unwrap_or_default();
            let mut model = vec![0.0; basis.n()];
            basis.field(states.col_as_slice(j), &mut model)?;
            let off = model.iter().zip(snapshot).zip(weights).map(|((a, b), w)| w * (a - b) * (a - b));
            let error = off.sum::<f64>().sqrt() / fluctuation;
            for (within, most) in [1.0, 5.0, 10.0].iter().zip(&mut errors) {
                if INTERVAL * j as f64 <= within * period {
                    *most = most.max(error);
                }
            }
            truth.col_as_slice_mut(j).copy_from_slice(&c);
        }
        let swing: Vec<f64> = (0..TIMES).map(|j| states[(0, j)]).collect();
        let (projection, strouhal) = (pod.relative_error(rank), frequency(&swing));
        Ok(Galerkin { rank, projection, errors, strouhal, project_cpu, solve_cpu, states, truth })
    }
}

/// From the first to the last rise through the mean; 0 if there is none.
fn frequency(swing: &[f64]) -> f64 {
    let mean = swing.iter().sum::<f64>() / swing.len() as f64;
    let rises: Vec<f64> = swing
        .windows(2)
        .enumerate()
        .filter(|(_, w)| w[0] < mean && w[1] >= mean)
        .map(|(j, w)| INTERVAL * (j as f64 + (mean - w[0]) / (w[1] - w[0])))
        .collect();
    match rises[..] {
        [first, .., last] => (rises.len() - 1) as f64 / (last - first),
        _ => 0.0,
    }
}

/// The flow as y′ = R(y), y its unknowns.
struct Rate<'a> {
    flow: RefCell<&'a mut Projection<2>>,
    n: usize,
    dt: f64,
}

impl Ode for Rate<'_> {
    fn n(&self) -> usize {
        self.n
    }
    fn rate(&self, _: f64, y: &[f64], out: &mut [f64]) {
        // What cannot be evaluated is NaN, which who asks tells.
        if self.flow.borrow_mut().rate(y, self.dt, [0.0; 2], out).is_err() {
            out.fill(f64::NAN);
        }
    }
}
