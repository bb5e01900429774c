//! Turbulence models beside bodies that move.
use fv_mesh::{ClosureSlot, EddyStress, FlowError, Modelled, Projection};
use ibm::NearWalls;
use interfaces::{Bodies, Checkpoint, Closure, RestartError, SolveError};

/// A turbulence model that sees the bodies of [`Particles`](crate::Particles) as walls, wherever they are: what
/// [`Hooked`](fv_mesh::Hooked) takes instead of a [`Modelled`] alone.
///
/// | cells | k | ω or ε | ν_t of the momentum |
/// |---|---|---|---|
/// | centre in a body | 0 | the largest of all | up to 2½ cells deep that on the wall |
/// | up to 1½ cells outside | own equation, production by the wall functions | by the wall functions | on the wall: (ν + ν_t) u_t/y is the friction |
/// | 1½ to 2½ cells outside | steadily from the former to the latter | alike | alike |
/// | others | own equation | own equation | the model's |
///
/// after Isoz et al. (2023), section 3, with a steady passage, since the velocity is forced smoothly ([`ibm::NearWalls`]). Nothing diffuses from
/// cells outside into those inside. Cells that come out of a body take the mean state of those beside them. Wall distances are
/// those of bodies and box. Models that do not ask for walls ([`Closure::wants_walls`]) are left as they are.
pub struct Walled<const D: usize, C> {
    /// The model.
    pub model: Modelled<D, C>,
    near: NearWalls,
    /// Distance from the walls of the box.
    of_box: Vec<f64>,
}

impl<const D: usize, C: Closure> Walled<D, C> {
    /// The model, that knows the walls of the box.
    pub fn new(model: Modelled<D, C>) -> Self {
        let of_box = model.transport().wall_distance().to_vec();
        Self { model, near: NearWalls::new(), of_box }
    }
    /// The cells in and beside the bodies, as the model last saw them.
    pub fn near_walls(&self) -> &NearWalls {
        &self.near
    }

    /// Are there bodies for the model to see?
    fn sees_bodies(&self) -> bool {
        self.model.closure.wants_walls() && !(self.near.rows().is_empty() && self.near.solid().is_empty())
    }

    /// Tells the model of the rows, with k as it is.
    fn show(&mut self, flow: &Projection<D>) -> Result<(), FlowError> {
        if let Some(k) = self.model.closure.kinetic_energy() {
            self.near.fill_k(k);
        }
        self.model.see_walls(flow, self.near.rows(), self.near.film())
    }
}

impl<const D: usize, C: Closure> ClosureSlot<D> for Walled<D, C> {
    fn stress(&mut self, flow: &Projection<D>) -> Result<Option<&EddyStress<D>>, FlowError> {
        self.model.stress(flow)
    }

    fn correct(&mut self, flow: &Projection<D>, dt: f64) -> Result<(), FlowError> {
        if !self.sees_bodies() {
            return self.model.correct(flow, dt);
        }
        self.model.immerse(self.near.solid(), flow.time())?;
        self.near.fill(flow.velocity(), flow.fluid().viscosity);
        self.show(flow)?;
        self.model.correct_beside(flow, self.near.rows(), dt)?;
        // With the new k.
        self.show(flow)
    }

    fn fastest(&self) -> f64 {
        self.model.fastest()
    }

    fn follow(&mut self, flow: &Projection<D>, bodies: &dyn Bodies) -> Result<(), FlowError> {
        if !self.model.closure.wants_walls() || bodies.n_bodies() == 0 && !self.sees_bodies() {
            return Ok(());
        }
        let lattice = flow.grid().lattice(None, flow.sides());
        let moved = self.near.place(&lattice, bodies).map_err(|e| FlowError::Closure {
            time: flow.time(),
            source: SolveError::Solver(e.to_string()),
        })?;
        if !moved {
            return Ok(());
        }
        let nearest = self.of_box.iter().zip(self.near.distance()).map(|(a, b)| a.min(*b));
        self.model.transport_mut().wall_distance_mut().iter_mut().zip(nearest).for_each(|(d, n)| *d = n);
        self.near.fill(flow.velocity(), flow.fluid().viscosity);
        self.show(flow)
    }
}

/// The model's state.
impl<const D: usize, C: Checkpoint> Checkpoint for Walled<D, C> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        self.model.save(sink);
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        // Made anew, from the bodies as they were restored.
        self.near = NearWalls::new();
        self.model.restore(source)
    }
}
