//! What an eddy viscosity does to the momentum.
use crate::flow_state::FlowState;
use crate::linear::StencilMatrix;
use crate::spans::Spans;
use crate::{Field, kernels};

/// The stress of an eddy viscosity ν_t: ∇·[ν_t(∇u + ∇uᵀ)], and the friction of walls where a model gives it.
#[derive(Clone, Debug)]
pub struct EddyStress<const D: usize> {
    /// ν_t at the centres with its ghosts; half the sum of a ghost and the cell inside is ν_t on the side.
    pub(crate) eddy: Field<D>,
    /// Of each component.
    pub(crate) friction: [Vec<Friction>; D],
    /// The largest Σ ν_t/h² \[1/s\], of the cells or on walls.
    pub(crate) rate: f64,
    /// The faces of walls where the model gives ν_t; there the ghosts of `eddy` are those of the friction.
    pub(crate) walls: Vec<OnWall>,
}

/// ν_t on a face of a wall.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OnWall {
    pub(crate) axis: usize,
    /// Lower (0) or upper side, and the number of the line along the axis that ends there.
    pub(crate) end: usize,
    pub(crate) line: usize,
    /// Storage index of the cell before it, and of the ghost behind it.
    pub(crate) inside: usize,
    pub(crate) ghost: usize,
    /// \[m²/s\].
    pub(crate) eddy: f64,
}

/// −`rate` (u − `wall`) at a node \[m/s²\].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Friction {
    /// Number of the dense cell of the node.
    pub(crate) cell: usize,
    /// Storage index of the node.
    pub(crate) place: usize,
    /// \[1/s\].
    pub(crate) rate: f64,
    /// Velocity of the wall \[m/s\].
    pub(crate) wall: f64,
}

impl<const D: usize> EddyStress<D> {
    /// That of ν_t with its ghosts, without friction, for steps of any length.
    pub(crate) fn of(eddy: Field<D>) -> Self {
        Self { eddy, friction: std::array::from_fn(|_| Vec::new()), rate: 0.0, walls: Vec::new() }
    }

    /// Which sides have walls where the model gives ν_t, by axis and end.
    pub(crate) fn law(&self) -> [[bool; 2]; D] {
        let mut law = [[false; 2]; D];
        self.walls.iter().for_each(|wall| law[wall.axis][wall.end] = true);
        law
    }

    /// Adds the acceleration of component `c` to `source`.
    pub(crate) fn add(&self, c: usize, state: &FlowState<D>, source: &mut Field<D>) {
        let FlowState { grid, metrics, velocity, .. } = state;
        let (u, eddy) = (&velocity.components, &self.eddy);
        kernels::add_eddy_stress((grid, metrics, &Spans::default()), c, u, eddy, source);
        let (u, source) = (u[c].data(), source.data_mut());
        for f in &self.friction[c] {
            source[f.place] -= f.rate * (u[f.place] - f.wall);
        }
    }

    /// Adds the friction to the equations A δ = `rhs` of component `c`, implicitly.
    pub(crate) fn add_friction(
        &self,
        c: usize,
        velocity: &[Field<D>; D],
        matrix: &mut StencilMatrix<D>,
        rhs: &mut [f64],
    ) {
        let (u, centre) = (velocity[c].data(), matrix.parts_mut().0);
        for f in &self.friction[c] {
            centre[f.cell] += f.rate;
            rhs[f.cell] -= f.rate * (u[f.place] - f.wall);
        }
    }
}
