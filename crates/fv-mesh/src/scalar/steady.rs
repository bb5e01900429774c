//! The steady state of a scalar in a flow that does not change.
use super::Scalar;
use super::kernel::{Input, Step, advance};
use super::mixing::sources;
use crate::grid::GHOSTS;
use crate::linear::StencilMatrix;
use crate::momentum_matrix::{self as momentum, MomentumSolver};
use crate::operators::Carried;
use crate::{FlowError, Velocity, kernels};

/// When [`Scalar::settle`] ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settling {
    /// Largest change of φ in the last iteration over the largest |φ|.
    pub tolerance: f64,
    /// Iterations allowed.
    pub max_iterations: usize,
}

impl Default for Settling {
    fn default() -> Self {
        Self { tolerance: 1e-8, max_iterations: 500 }
    }
}

/// The part of δ that is taken: with all of it the corrections of limited convection go to and fro for ever.
const DAMPING: f64 = 0.7;
/// By how much the linear solver brings residuals down in an iteration, and how many of its own it may take.
const REDUCTION: f64 = 1e-2;
const SWEEPS: usize = 500;

/// A δ = rest in a steady velocity.
struct System<const D: usize> {
    matrix: StencilMatrix<D>,
    /// What carries beside walls ([`Scalar::through`]).
    through: Option<[Velocity<D>; 2]>,
    rest: Vec<f64>,
    delta: Vec<f64>,
    solver: MomentumSolver,
    /// Solutions begun.
    iterations: u64,
}

impl<const D: usize> System<D> {
    fn new(scalar: &Scalar<D>, velocity: &Velocity<D>) -> Result<Self, FlowError> {
        let n = scalar.grid.n_cells();
        let through = scalar.through(velocity);
        Ok(Self {
            matrix: scalar.steady_matrix(through.as_ref().map_or(velocity, |[whole, _]| whole))?,
            through,
            rest: vec![0.0; n],
            delta: vec![0.0; n],
            solver: MomentumSolver::new(n, REDUCTION, SWEEPS),
            iterations: 0,
        })
    }
}

impl<const D: usize> Scalar<D> {
    /// The steady φ in a steady `velocity` under what is given at `time` \[s\], from the φ there is:
    ///
    /// ```text
    /// A δ = −∇·(uφ) + ∇·((Γ + D_t)∇φ) + S,   φ ← φ + 0.7 δ
    /// ```
    ///
    /// A is the operator with upwind convection, the right-hand side has the scalar's own scheme (deferred correction, Khosla & Rubin 1974). After each iteration `hold` may
    /// change values, as bodies do, in the cells whose storage indices are `held`. Answers the number of iterations.
    ///
    /// # Errors
    /// [`FlowError::Boundary`] where neither a side nor `held` gives φ a value; [`FlowError::ScalarNotSteady`] after too many iterations;
    /// [`FlowError::OtherGrid`] or [`FlowError::Boundary`] for a velocity that does not fit; [`FlowError::ScalarDiverged`].
    pub fn settle(
        &mut self,
        velocity: &Velocity<D>,
        time: f64,
        Settling { tolerance, max_iterations }: Settling,
        held: &[usize],
        mut hold: impl FnMut(&mut [f64]),
    ) -> Result<usize, FlowError> {
        self.check_velocity(velocity)?;
        let given = |a: usize| {
            self.boundaries.ends(a).is_some_and(|e| e.factor.iter().any(|f| f.iter().any(|f| *f != 1.0)))
        };
        if held.is_empty() && self.walls.is_none() && !(0..D).any(given) {
            let what = "sides that all give a scalar's gradient, by which its steady state is known but for a constant; give its value somewhere";
            return Err(FlowError::Boundary { what: what.into() });
        }
        self.begin(time, &mut hold);
        let mut system = System::new(self, velocity)?;
        let mut change = f64::INFINITY;
        for iteration in 1..=max_iterations {
            change = self.correct(&mut system, velocity, time, held, &mut hold)?;
            if change <= tolerance {
                return Ok(iteration);
            }
        }
        Err(FlowError::ScalarNotSteady { iterations: max_iterations, change, tolerance })
    }

    /// One iteration of [`settle`](Self::settle), for a flow that the scalar drives: answers the largest change of φ over the largest |φ|.
    ///
    /// # Errors
    /// As there.
    pub fn approach(
        &mut self,
        velocity: &Velocity<D>,
        time: f64,
        held: &[usize],
        mut hold: impl FnMut(&mut [f64]),
    ) -> Result<f64, FlowError> {
        self.begin(time, &mut hold);
        let mut system = System::new(self, velocity)?;
        self.correct(&mut system, velocity, time, held, &mut hold)
    }

    fn begin(&mut self, time: f64, hold: &mut impl FnMut(&mut [f64])) {
        self.boundaries.set_time(time);
        self.impose(hold);
        self.wet_through();
        self.step = 0;
    }

    /// Solves for δ and takes its part, answers the largest change of φ over the largest |φ|.
    fn correct(
        &mut self,
        System { matrix, through, rest, delta, solver, iterations }: &mut System<D>,
        velocity: &Velocity<D>,
        time: f64,
        held: &[usize],
        hold: &mut impl FnMut(&mut [f64]),
    ) -> Result<f64, FlowError> {
        *iterations += 1;
        self.rest(through.as_ref().map_or([velocity; 2], |[whole, far]| [whole, far]), rest);
        for o in held.iter().copied().chain(self.dry()) {
            // Ghosts belong to no cell.
            if let Some(cell) = self.grid.cell_at(o) {
                momentum::pin(matrix, self.grid.index(cell), 0.0, rest);
            }
        }
        solver.solve(matrix, rest, delta)?;
        self.next.data_mut().copy_from_slice(self.phi.data());
        delta.iter_mut().for_each(|delta| *delta *= DAMPING);
        kernels::add_dense(&self.grid, delta, &mut self.phi);
        self.impose(hold);
        self.wet_through();
        let mut largest = [0.0_f64; 2];
        for (now, before) in self.phi.values().zip(self.next.values()) {
            if !now.is_finite() {
                return Err(FlowError::ScalarDiverged { step: *iterations, time, dt: 0.0 });
            }
            largest = [largest[0].max((now - before).abs()), largest[1].max(now.abs())];
        }
        Ok(if largest[0] > 0.0 { largest[0] / largest[1] } else { 0.0 })
    }

    /// −∇·(uφ) + Γ∇²φ + ∇·(D_t∇φ) + S of every cell.
    fn rest(&mut self, [whole, far]: [&Velocity<D>; 2], out: &mut [f64]) {
        self.stir();
        let input = Input {
            carried: Carried {
                grid: &self.grid,
                metrics: &self.metrics,
                carrier: &self.carrier,
                velocity: &far.components,
                phi: self.phi.data(),
            },
            source: sources(&self.mixing, &self.source),
            zeros: &self.zeros,
        };
        let step = Step { dt: 1.0, weights: [1.0, 0.0], explicit: [self.diffusivity; D], implicit: [0.0; D] };
        advance(input, step, &mut self.next, (&mut self.tendency, None));
        out.iter_mut().zip(self.tendency.values()).for_each(|(out, rest)| *out = rest);
        self.shut(whole, out);
    }

    /// u·∇δ − ∇·((Γ + D_t)∇δ) with upwind differences and the homogeneous conditions at the sides.
    fn steady_matrix(&self, velocity: &Velocity<D>) -> Result<StencilMatrix<D>, FlowError> {
        let (grid, gamma, s) = (&self.grid, self.diffusivity, self.grid.stride());
        let mut matrix = StencilMatrix::new(grid.cells(), self.boundaries.periodic())?;
        let (centre, lower, upper) = matrix.parts_mut();
        let mut sides = [lower, upper];
        centre.fill(0.0);
        for b in 0..D {
            let (nodes, u) = (&self.metrics.axes[b].centres, velocity.components[b].data());
            // What flows in through the lower and upper face of a cell, and conduction over it, per volume.
            let through = |i: usize| {
                let (cell, o) = (grid.cell(i), grid.place(grid.cell(i)));
                let q = GHOSTS + cell[b];
                let inflow = [u[o], -u[o + s[b]]].map(|u| nodes.inv_volume[q] * u);
                let eddies =
                    self.mixing.as_ref().map_or([0.0; 2], |m| m.on_faces(&self.metrics, b, s[b], o, q));
                (inflow, [(gamma + eddies[0]) * nodes.down[q], (gamma + eddies[1]) * nodes.up[q]])
            };
            for i in 0..grid.n_cells() {
                let (inflow, conducted) = through(i);
                for (k, side) in sides.iter_mut().enumerate() {
                    side[b][i] = -(inflow[k].max(0.0) + conducted[k]);
                    centre[i] -= side[b][i];
                }
            }
            let Some(ends) = self.boundaries.ends(b) else { continue };
            let lines = self.boundaries.lines(b);
            for l in (0..lines.len()).filter(|&l| lines.inside(l)) {
                for (k, side) in sides.iter_mut().enumerate() {
                    let i = lines.end_cell(grid, l, k == 1);
                    let (inflow, conducted) = through(i);
                    // Beyond the side δ is f δ, on it the mean of both.
                    centre[i] += side[b][i] + (1.0 - ends.factor[k][l]) * (0.5 * inflow[k] + conducted[k]);
                    side[b][i] = 0.0;
                }
            }
        }
        self.shut_matrix(velocity, &mut matrix);
        Ok(matrix)
    }
}
