//! A box that follows a body.
use crate::{CouplingError, FlowSolver, Observer, Particles, Simulation, StepInfo, Strategy};
use ibm::Forcing;
use interfaces::{BodyId, Dynamics};

/// Keeps a body at its place in the box, for bodies that sink or rise for longer than a box can be: whenever it is a whole cell
/// away, the box moves on by whole cells over the fluid ([`FlowSolver::move_window`]). Bodies, walls and everything that is
/// written keep their places in the laboratory.
///
/// The fluid that comes in is as the last cells before it, so the end ahead has to be where the fluid is at rest (or streams
/// uniformly), and the end behind where it may flow out; other bodies must not be left behind. Of the
/// [observers](Observer) it comes first, so that those which save or show the state see where the box is.
///
/// ```
/// # use coupling::{CouplingError, MovingWindow, Observer};
/// // The body that was put in first stays three quarters up the box along y.
/// let window = MovingWindow::following(0, 1).at(0.75)?;
/// # Ok::<(), CouplingError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovingWindow {
    serial: u64,
    axis: usize,
    place: f64,
}

impl MovingWindow {
    /// The body with this [serial number](Particles::serial) stays in the middle of the box along `axis`; when it is gone, the box
    /// stays.
    pub fn following(serial: u64, axis: usize) -> Self {
        Self { serial, axis, place: 0.5 }
    }
    /// Its centre stays at this share of the box's length from the lower end.
    ///
    /// # Errors
    /// [`CouplingError::Schedule`] for a place that is not within the box.
    pub fn at(self, place: f64) -> Result<Self, CouplingError> {
        if place > 0.0 && place < 1.0 {
            return Ok(Self { place, ..self });
        }
        let (name, remedy) = ("window's place", "give a share of the box's length, between 0 and 1");
        Err(CouplingError::Schedule { name, value: place, remedy })
    }
}

impl<const D: usize, F: Forcing, B: Dynamics, S: Strategy, A: FlowSolver<D>>
    Observer<Simulation<D, Particles<F, B, S>, A>> for MovingWindow
{
    fn step(
        &mut self,
        simulation: &mut Simulation<D, Particles<F, B, S>, A>,
        _: &StepInfo,
    ) -> Result<(), CouplingError> {
        let Simulation { flow, particles, .. } = simulation;
        let mut ids = (0..particles.bodies.n_bodies()).map(BodyId);
        let followed = ids.find(|b| particles.serial(*b) == Some(self.serial));
        let (Some(body), Self { axis, place, .. }) = (followed, *self) else { return Ok(()) };
        let grid = flow.grid();
        // An axis that is not there, and a body that is nowhere, are for the flow and the next step to tell.
        let [from, length, cell] =
            [grid.origin(), grid.lengths(), grid.spacing()].map(|of| of.get(axis).copied().unwrap_or(1.0));
        let ahead = particles
            .bodies
            .pose(body)
            .position
            .coords
            .get(axis)
            .map_or(1.0, |x| (x - from - place * length) / cell);
        if ahead.abs() >= 1.0 {
            flow.move_window(axis, ahead.trunc() as i64)?;
            particles.forcing.place(flow.velocity(), &particles.bodies)?;
        }
        Ok(())
    }
}
