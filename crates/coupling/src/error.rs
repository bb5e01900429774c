//! What can go wrong.
use fv_mesh::FlowError;
use ibm::IbmError;
use interfaces::{BodyId, RestartError};

/// Why a coupled step could not be made.
#[derive(Debug, thiserror::Error)]
pub enum CouplingError {
    /// The flow could not go on.
    #[error(transparent)]
    Flow(#[from] FlowError),
    /// The bodies could not be put on the grid.
    #[error(transparent)]
    Immersed(#[from] IbmError),
    /// The bodies could not go on.
    #[error("the bodies could not be moved at t = {time} s: {source}")]
    Dynamics {
        /// When \[s\].
        time: f64,
        /// Why.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// A body's equation of motion has no solution.
    #[error(
        "body {} has no finite velocity at t = {time} s; the run has diverged: take a smaller time step", body.0
    )]
    Motion {
        /// The body.
        body: BodyId,
        /// When \[s\].
        time: f64,
    },
    /// A body does not fit into the box.
    #[error(
        "body {} is {size:.3e} m long along axis {axis}, the box only {length:.3e} m (of a periodic axis, a cell more is possible): make the body smaller or the box larger", body.0)]
    TooLarge {
        /// The body.
        body: BodyId,
        /// Axis, 0 for x.
        axis: usize,
        /// Extent of the body \[m\].
        size: f64,
        /// Length of the box \[m\].
        length: f64,
    },
    /// Bodies were taken away behind the coupling's back.
    #[error(
        "there were {before} bodies and are {now}: call `Particles::renumber` with the numbers that `remove` answers"
    )]
    Renumbered {
        /// How many there were.
        before: usize,
        /// How many there are.
        now: usize,
    },
    /// A body stands outside the box.
    #[error(
        "the centre of body {} is at {centre:.3e} m along axis {axis}, outside the box from {:.3e} to {:.3e} m: move it inside; a body that an inflow puts beyond an open side has to move inwards", body.0, box_[0], box_[1])]
    Outside {
        /// The body.
        body: BodyId,
        /// Axis, 0 for x.
        axis: usize,
        /// Where its centre is \[m\].
        centre: f64,
        /// Where the box begins and ends \[m\].
        box_: [f64; 2],
    },
    /// A body went out through a bounded side.
    #[error(
        "body {} went out of the box along axis {axis} at {speed:.3e} m/s, up to t = {time:.6} s: its centre is at {centre:.3e} m, and the box reaches from {:.3e} to {:.3e} m; {by}", body.0, box_[0], box_[1])]
    Escaped {
        /// The body.
        body: BodyId,
        /// Axis, 0 for x.
        axis: usize,
        /// Where its centre is \[m\].
        centre: f64,
        /// Where the box begins and ends \[m\].
        box_: [f64; 2],
        /// Its speed \[m/s\].
        speed: f64,
        /// When \[s\].
        time: f64,
        /// Through what.
        by: Escape,
    },
    /// Flow and particles were told different densities.
    #[error(
        "the flow's density is {flow} kg/m³ but the particles were told {particles} kg/m³; give both the same"
    )]
    Density {
        /// The flow's \[kg/m³\].
        flow: f64,
        /// What the particles were told \[kg/m³\].
        particles: f64,
    },
    /// The schedule makes no sense.
    #[error("the run's {name} is {value}; {remedy}")]
    Schedule {
        /// Which value.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What to give instead.
        remedy: &'static str,
    },
    /// The velocity has grown so much that time stands still.
    #[error(
        "at t = {time:.6} s the flow has become so fast that a Courant number of {courant} allows steps of no more than {dt:.3e} s: the run is diverging, or something in it is that fast"
    )]
    Collapsed {
        /// The step \[s\].
        dt: f64,
        /// When \[s\].
        time: f64,
        /// The Courant number asked for.
        courant: f64,
    },
    /// The flow moves too far in a step.
    #[error(
        "the flow moved {courant:.3e} cells in a step of {dt:.3e} s, up to t = {time:.6} s; take a smaller time step; a run that then ends even earlier diverges for another reason"
    )]
    Courant {
        /// The Courant number.
        courant: f64,
        /// The step \[s\].
        dt: f64,
        /// When \[s\].
        time: f64,
    },
    /// A step that exceeded the Courant number could not be taken back.
    #[error("the state before a step that went too far could not be restored: {0}")]
    TakeBack(#[from] RestartError),
    /// An observer could not do its work.
    #[error("{what}: {source}")]
    Output {
        /// What it was doing.
        what: String,
        /// Why it failed.
        source: std::io::Error,
    },
}

/// Kind of opening through which a body has left the box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Escape {
    /// Through a wall or a plane of symmetry.
    Wall,
    /// Through an open side, all of it, with no exit ahead.
    NoExit,
}

impl std::fmt::Display for Escape {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Wall => {
                "there is a wall, whose contact was too soft to stop it or which its prescribed motion leads through: give a larger Young's modulus, less load, less speed, or an exit in front of the wall"
            }
            Self::NoExit => {
                "the side is open, and no exit is ahead of the body: give one at the side or beyond it (`exits` of a scene, `dem::Population::with_exit`)"
            }
        })
    }
}
