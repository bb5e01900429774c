//! Immersed walls in the steady algorithm.
use super::Simple;
use super::walls::{SimpleWalls, WallStress};
use crate::boundary::Boundaries;
use crate::flow_state::FlowState;
use crate::spans::Spans;
use crate::{Field, FlowError, FlowStatistics, Modelled};
use interfaces::{Closure, CutCells, Vector, Wrench};

impl<const D: usize> Simple<D> {
    /// Sets the turbulence kinetic energy k \[m²/s²\] at the cell centres, from which [`WallStress::Law`] takes the friction
    /// velocity; `None` takes it away. [`iterate_with`](Self::iterate_with) takes it from the model.
    pub fn set_turbulence_energy(&mut self, k: Option<&Field<D>>) {
        match (&mut self.energy, k) {
            (Some(own), Some(k)) => own.data_mut().copy_from_slice(k.data()),
            (own, k) => *own = k.cloned(),
        }
    }

    /// Sums and extremes of the velocity, as it is now. With immersed walls ∇·u is that of the fluxes through the open parts of the faces.
    pub fn statistics(&mut self) -> FlowStatistics {
        match &self.walls {
            None => self.state.statistics(),
            Some(walls) => {
                self.state.statistics_of_fluxes(|state| walls.show_fluxes(&mut state.velocity.components))
            }
        }
    }

    /// Puts immersed walls at rest into the flow, or takes them out: mass and momentum are balanced over what they leave of
    /// the control volumes, and `stress` acts on the walls in them. Before this set what the box's sides are; after this the
    /// first guess and eddy viscosity.
    ///
    /// Faces of the box's sides that walls close let nothing pass; inlets pass the open part of what is given, convective outlets
    /// what comes to their open part, and faces of given pressure are open or shut as a whole.
    ///
    /// # Errors
    /// [`FlowError::Parameter`] for walls on another grid and a law with impossible numbers, and those of the sides.
    pub fn set_walls(&mut self, walls: Option<(&CutCells, WallStress)>) -> Result<(), FlowError> {
        let FlowState { grid, metrics, boundaries, velocity, pressure, .. } = &mut self.state;
        let made = match walls {
            Some((cuts, stress)) => {
                Some(SimpleWalls::new(cuts, stress, grid, metrics, &boundaries.pressure_faces(grid))?)
            }
            None => None,
        };
        let mut sides = Boundaries::new(grid, boundaries.sides.clone(), metrics)?;
        if let Some((cuts, _)) = walls {
            sides.narrow(grid, metrics, |c, index| {
                let list = &cuts.faces[c];
                list.binary_search_by_key(&index, |face| face.index).map_or(1.0, |k| list[k].open)
            })?;
        }
        *boundaries = sides;
        self.correction = self.params.pressure_solver(grid, metrics, boundaries)?;
        if let Some(walls) = &made {
            walls.stop(grid, &mut velocity.components);
            pressure.data_mut().fill(0.0);
        }
        let spans = made.as_ref().map_or_else(Spans::default, |walls| walls.spans.clone());
        self.equations.set_spans(&spans);
        self.matrix.set_spans(spans);
        self.delta.iter_mut().for_each(|delta| delta.fill(0.0));
        self.walls = made.map(Box::new);
        self.state.fill_velocity();
        self.state.fill_pressure();
        Ok(())
    }

    /// Friction of the fluid on each body of the walls in the last iteration \[N, N m\], about its centre of mass.
    pub fn wall_friction(&self) -> Vec<Wrench> {
        self.walls.as_ref().map_or_else(Vec::new, |walls| walls.friction(self.state.fluid.density))
    }

    /// Force of the pressure on each body of the walls \[N, N m\], about its centre of mass: −Σ p A n over the cells with wall.
    pub fn wall_pressure_force(&self) -> Vec<Wrench> {
        self.walls.as_ref().map_or_else(Vec::new, |walls| walls.pressure_force(&self.state.pressure))
    }

    /// What every piece of wall, in the order given, took from the fluid per area in the last iteration \[Pa\].
    pub fn wall_tractions(&self) -> Vec<Vector> {
        let density = self.state.fluid.density;
        self.walls.as_ref().map_or_else(Vec::new, |walls| walls.tractions().map(|t| density * t).collect())
    }

    /// Of every piece of wall, in the order given, the friction velocity u_τ \[m/s\] by which it had its friction in the last iteration: for [`Scalar::rub`](crate::Scalar::rub).
    pub fn wall_friction_velocities(&self) -> Vec<f64> {
        self.walls.as_ref().map_or_else(Vec::new, |walls| walls.friction_velocities().collect())
    }

    /// Takes from a model what holds in cells that walls cut.
    pub(super) fn look_at<C: Closure>(&mut self, model: &mut Modelled<D, C>) {
        let Some(walls) = &mut self.walls else { return };
        match model.closure.kinetic_energy() {
            Some(k) => {
                let field = self.energy.get_or_insert_with(|| Field::zeros(&self.state.grid));
                model.transport().spread(k, field);
            }
            None => self.energy = None,
        }
        if let Some(stress) = &mut self.stress {
            walls.extend(&mut stress.eddy, self.energy.as_ref(), self.state.fluid.viscosity);
            model.transport().wrap(&mut stress.eddy);
        }
        if !model.transport().has_walls() {
            model.transport_mut().set_walls(walls.dry_cells(&self.state.grid), false);
        }
    }
}
