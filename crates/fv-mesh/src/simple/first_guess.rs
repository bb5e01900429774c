//! The flow before the first iteration.
use super::{LONG, Simple};
use crate::flow_state::{FlowState, each_cell};
use crate::momentum_matrix as momentum;
use crate::{FlowError, Modelled, Sampler};
use interfaces::Closure;

/// Σ |∇·u| V over Σ |u| A that may be left, and the most solutions of the pressure equation to get there.
const LEFT: f64 = 1e-4;
const MOST: usize = 20;

impl<const D: usize> Simple<D> {
    /// Takes velocity and pressure of another flow, on another grid as a rule, for a first guess: linear between the nodes that
    /// fluid passes there, and beyond the outermost of them as at the nearest. A solution on half as many cells along each axis costs little;
    /// it pays where the flow is far from its first guess, as behind bluff bodies, and not where few iterations bring it near.
    ///
    /// Before this set sides and walls.
    pub fn start_from(&mut self, other: &Self) {
        let FlowState { grid, velocity, pressure, .. } = &other.state;
        let sampler = Sampler::new(grid, other.sides());
        let open: [Option<Vec<bool>>; D] =
            std::array::from_fn(|c| other.walls.as_ref().map(|walls| walls.open_nodes(grid, c)));
        let wet = other.walls.as_ref().map(|_| {
            let passes =
                |c: usize, cell: [usize; D]| open[c].as_ref().is_none_or(|open| open[grid.index(cell)]);
            let above = |c: usize, cell: [usize; D]| -> [usize; D] {
                std::array::from_fn(|a| if a == c { (cell[a] + 1).min(grid.cells()[a] - 1) } else { cell[a] })
            };
            let is_wet = |cell| (0..D).any(|c| passes(c, cell) || passes(c, above(c, cell)));
            (0..grid.n_cells()).map(|cell| is_wet(grid.cell(cell))).collect::<Vec<bool>>()
        });
        // What is no cell's is on a side of the box.
        let holds = |list: &Option<Vec<bool>>, o: usize| {
            list.as_ref().is_none_or(|list| grid.cell_at(o).is_none_or(|cell| list[grid.index(cell)]))
        };
        self.set_velocity(|x| {
            std::array::from_fn(|c| {
                let known = |o: usize| holds(&open[c], o);
                sampler.known_value(velocity.field(c), Some(c), x, known).unwrap_or_default()
            })
        });
        let own = &mut self.state;
        let data = own.pressure.data_mut();
        each_cell(&own.grid, |o, cell| {
            let value = sampler.known_value(pressure, None, own.grid.centre(cell), |o| holds(&wet, o));
            data[o] = value.unwrap_or_default();
        });
        own.fill_pressure();
    }

    /// The same with what a turbulence model has found there, for one of the same kind.
    ///
    /// # Errors
    /// [`FlowError::Closure`] for a model that has nothing in common with the other.
    pub fn start_with<C: Closure>(
        &mut self,
        model: &mut Modelled<D, C>,
        other: &Self,
        found: &Modelled<D, C>,
    ) -> Result<(), FlowError> {
        self.start_from(other);
        let onto = |list: &[f64]| found.transport().at_cells(list, &self.state.grid);
        let state: Vec<Vec<f64>> = found.closure.cell_state().into_iter().map(onto).collect();
        let started = model.closure.set_cell_state(&state);
        started.map_err(|source| FlowError::Closure { time: 0.0, source })
    }

    /// Adds the potential to the velocity that frees it of divergence: u ← u − ∇φ. The momentum equations of a flow that
    /// passes through walls send it anywhere.
    ///
    /// # Errors
    /// As [`iterate`](Self::iterate).
    pub(super) fn free_first_guess(&mut self) -> Result<(), FlowError> {
        let (centre, lower, upper) = self.matrix.parts_mut();
        centre.fill(1.0);
        lower.into_iter().chain(upper).for_each(|list| list.fill(0.0));
        for c in 0..D {
            self.correction.set(c, &self.matrix, None, 1.0);
            for &cell in &self.pinned[c] {
                self.correction.freeze(c, cell);
            }
            if let Some(walls) = &self.walls {
                walls.narrow(c, &mut self.correction);
            }
        }
        let FlowState { metrics, boundaries, fluid, velocity, .. } = &mut self.state;
        boundaries.advance_outlets(metrics, &velocity.components, LONG, fluid.viscosity)?;
        boundaries.reset_outlets(&velocity.components);
        self.state.fill_velocity();
        let has_solids = self.walls.is_some() || self.pinned.iter().any(|p| !p.is_empty());
        self.correction.update(&mut self.state.boundaries)?;
        for _ in 0..MOST {
            let FlowState { grid, metrics, boundaries, velocity, .. } = &mut self.state;
            let velocity = &mut velocity.components;
            if let Some(walls) = &self.walls {
                walls.show_fluxes(velocity);
            }
            let through = momentum::throughput(grid, metrics, velocity);
            let divergence = self.correction.measure(boundaries, velocity);
            let done = divergence <= LEFT * through;
            if !done {
                if has_solids {
                    self.correction.skip_frozen();
                }
                self.correction.solve(false)?;
                self.correction.correct(boundaries, velocity);
            }
            if let Some(walls) = &self.walls {
                walls.show_nodes(velocity);
            }
            self.state.fill_velocity();
            if done {
                break;
            }
        }
        Ok(())
    }
}
