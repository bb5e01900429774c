//! CPU time and memory of runs, estimated by their first steps.
use crate::available_memory::AvailableMemory;
use crate::build_error::BuildError;
use crate::peak_memory::PeakMemory;
use crate::run::RunError;
use crate::setup::{Algorithm, ModelSetup, Output, Setup};
use crate::trial::{ANY_COURANT, Cost, Trial, Tried};
use coupling::{Evolving, Grains};
use fv_mesh::{Axis, CartesianGrid, Projection, Side};

/// Cells and bodies of scenes too large for first steps in a check.
const MANY_CELLS: usize = 500_000;
const MANY_BODIES: usize = 100_000;
/// Memory of first steps, at most, for each cell of a flow, and of pictures alone \[bytes\].
const MEMORY_OF_CELL: [f64; 2] = [3000.0, 100.0];
/// Cells along each axis of the grid that stands for a large one.
const WINDOW: usize = 16;

/// Runs `task` on one thread, whose clock tells its CPU time.
pub(crate) fn one_thread<T: Send>(task: impl FnOnce() -> T + Send) -> Result<T, RunError> {
    Ok(rayon::ThreadPoolBuilder::new().num_threads(1).build()?.install(task))
}

/// CPU time and memory of a run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Estimate {
    pub(crate) cost: Cost,
    /// Memory of the process before, and beyond that at the peak \[bytes\]; none without `/proc`.
    pub(crate) memory: Option<[f64; 2]>,
    /// Whether files could not be written, so that cost and memory lack them.
    pub(crate) unwritten: bool,
}

impl Estimate {
    /// Combination of both, number by number.
    fn with(self, other: Self, combine: impl Fn(f64, f64) -> f64) -> Self {
        let memory = self.memory.zip(other.memory).map(|(a, b)| [a[0], combine(a[1], b[1])]);
        let unwritten = self.unwritten || other.unwritten;
        Self { cost: self.cost.with(other.cost, &combine), memory, unwritten }
    }
    fn times(self, factor: f64) -> Self {
        self.with(self, |own, _| own * factor)
    }
    fn plus(self, other: Self) -> Self {
        self.with(other, |own, other| own + other)
    }
    /// Excess over another.
    fn beyond(self, other: Self) -> Self {
        self.with(other, |own, other| (own - other).max(0.0))
    }
}

impl Cost {
    /// CPU time of a run of so many steps with its files \[s\].
    pub(crate) fn of_run(&self, steps: f64, output: &Output) -> f64 {
        let snapshots = (output.snapshots + 1) as f64;
        let pictures = output.images.as_ref().map_or(0.0, |i| (output.snapshots / i.every + 1) as f64);
        let [with, without] = self.snapshot;
        let marched = match self.iterations {
            Some(iterations) => iterations.cost_of(steps, self.step),
            None => steps * self.step,
        };
        marched + pictures * with + (snapshots - pictures) * without + self.state + self.later
    }
}

impl Setup {
    /// Takes the first steps.
    pub(crate) fn try_steps(&self, files: bool) -> Result<(Tried, Estimate), BuildError> {
        let memory = PeakMemory::start();
        let folder = if files { tempfile::tempdir().ok() } else { None };
        let trial = Trial { setup: self, folder: folder.as_ref().map(tempfile::TempDir::path) };
        let tried = if files { one_thread(|| trial.run())? } else { trial.run() }?;
        let memory = memory.map(|memory| [memory.before(), memory.taken()]);
        let unwritten = tried.unwritten || files && folder.is_none();
        let estimate = Estimate { cost: tried.cost, memory, unwritten };
        Ok((tried, estimate))
    }

    /// Estimate by smaller scenes, with and without bodies: what a flow takes grows with its cells,
    /// what bodies add to it with the cells at their surfaces, and bodies alone with their number.
    pub(crate) fn estimate_by_smaller(
        &self,
        files: bool,
        available: Option<&AvailableMemory>,
    ) -> Result<Option<Estimate>, BuildError> {
        let room = available.map_or(f64::INFINITY, |available| available.bytes / self.memory_of_cell());
        let small = self.smaller(room as usize)?;
        let cells = self.cells() as f64 / small.cells() as f64;
        let bodies = self.bodies.list.len() as f64 / small.bodies.list.len().max(1) as f64;
        if self.fluid.is_none() {
            let all = small.try_steps(files)?.1;
            let step = bodies.max(1.0) * all.cost.step;
            let mut larger = all.times(cells.max(bodies));
            larger.cost.step = step;
            return Ok(Some(larger));
        }
        let surface = bodies.max(1.0) * cells.powf(1.0 - 1.0 / self.dim() as f64);
        let all = small.try_steps(files).ok().map(|(_, estimate)| estimate);
        let flow = small.without_bodies().try_steps(files).ok().map(|(_, estimate)| estimate);
        Ok(match (all, flow) {
            (Some(all), Some(flow)) => {
                let mut larger = flow.times(cells).plus(all.beyond(flow).times(surface));
                larger.cost.iterations = all
                    .cost
                    .iterations
                    .and_then(|iterations| iterations.scaled(cells, self.cells(), surface));
                Some(larger)
            }
            (all, flow) => all.or(flow).map(|estimate| estimate.times(cells)),
        })
    }

    fn memory_of_cell(&self) -> f64 {
        MEMORY_OF_CELL[usize::from(self.fluid.is_none())]
    }

    /// Whether first steps take too long or too much memory for a check.
    pub(crate) fn is_large(&self, available: Option<&AvailableMemory>) -> bool {
        let needed = self.cells() as f64 * self.memory_of_cell();
        needed > MANY_CELLS as f64 * MEMORY_OF_CELL[0]
            || self.bodies.list.len() > MANY_BODIES
            || available.is_some_and(|available| needed > available.bytes)
    }

    /// The estimate with memory that is taken later than in the first steps: for the inverse at
    /// immersed walls and for fits of models.
    pub(crate) fn with_later_memory(&self, mut estimate: Estimate) -> Estimate {
        if let Some([_, taken]) = &mut estimate.memory {
            let inverse = estimate.cost.iterations.map_or(0.0, |iterations| iterations.memory());
            *taken += inverse.max(self.memory_of_models());
        }
        estimate
    }

    /// Memory of the largest fit of a model, behind the run's last step \[bytes\].
    fn memory_of_models(&self) -> f64 {
        let fit = |model: &ModelSetup| model.memory(self.cells(), self.dim(), self.output.snapshots);
        self.models.iter().map(fit).fold(0.0, f64::max)
    }

    /// Requires that there is room for what a run takes.
    pub(crate) fn require_memory(
        &self,
        memory: Option<[f64; 2]>,
        available: Option<AvailableMemory>,
    ) -> Result<(), BuildError> {
        match (memory, available) {
            (Some([_, needed]), Some(AvailableMemory { bytes: free, limit })) if needed > free => {
                Err(BuildError::Memory { cells: self.cells() as f64, needed, free, limit })
            }
            _ => Ok(()),
        }
    }

    /// Findings about a scene that is too large to be tried: limits of its narrowest cells, of the
    /// flow alone.
    pub(crate) fn untried<const D: usize>(&self) -> Result<Tried, BuildError> {
        let longest = match self.flow.algorithm {
            _ if self.fluid.is_none() => Some(Grains::new(self.bodies()?).longest_dt()),
            Algorithm::Simple => None,
            Algorithm::Piso => Some(f64::INFINITY),
            Algorithm::Projection => {
                let window = |a: usize| {
                    let n = WINDOW.min(self.axes[a].cells());
                    Axis::uniform(n, 0.0, self.axes[a].narrowest() * n as f64)
                };
                let axes: Vec<_> = (0..D).map(window).collect::<Result<_, _>>()?;
                let grid = CartesianGrid::<D>::from_axes(std::array::from_fn(|a| axes[a].clone()))?;
                let walls = std::array::from_fn(|_| [Side::Wall([0.0; 3]), Side::Wall([0.0; 3])]);
                let flow = Projection::new(grid, walls, self.fluid())?.with_diffusion(self.diffusion());
                Some(flow.stable_dt(ANY_COURANT))
            }
        };
        self.initial(&self.grid::<D>()?)?;
        let initial = self.initial_speed() / self.narrowest();
        let limits = longest.map(|longest| [longest, initial]);
        let pressure = "chosen at the start of the run".into();
        Ok(Tried { limits, pressure, thin: Vec::new(), cost: Cost::default(), unwritten: false })
    }
}
