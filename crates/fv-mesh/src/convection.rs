//! Convection schemes: what a carried quantity is worth on the interface between two nodes.

/// κ of van Leer's (1985) upwind values of third order for means over cells: the share of the line between both nodes in what is carried beside walls, the rest goes
/// on from the nodes by their gradients.
pub(crate) const KAPPA: f64 = 1.0 / 3.0;

/// Scheme for the value φ_f of a carried quantity on the interface between the upwind node U and the downwind
/// node D, with the far upwind node UU before them. Chosen once, outside every kernel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Convection {
    /// φ_f = ½(φ_U + φ_D) for momentum, which keeps kinetic energy on any grid (Verstappen & Veldman 2003); for
    /// scalars the linear interpolation between U and D. Second order.
    #[default]
    Central,
    /// φ_f = φ_U. First order, bounded.
    Upwind,
    /// φ_f = φ_U + (x_f − x_U)(φ_U − φ_UU)/(x_U − x_UU). Second order.
    LinearUpwind,
    /// The parabola through UU, U and D (Leonard 1979). Second order for the divergence.
    Quick,
    /// φ_f = φ_U + ψ(r)(x_f − x_U)/(x_D − x_U)·(φ_D − φ_U), ψ = (r + |r|)/(1 + |r|) of the ratio r of successive
    /// slopes (van Leer 1974). Second order away from extrema, total-variation diminishing.
    Limited,
}

impl Convection {
    /// All schemes.
    pub const ALL: [Self; 5] = [Self::Central, Self::Upwind, Self::LinearUpwind, Self::Quick, Self::Limited];

    /// Is what is carried a linear function of the nodes', of second order and from upwind?
    pub(crate) fn is_linear_upwind(self) -> bool {
        matches!(self, Self::LinearUpwind | Self::Quick)
    }

    /// Weights a, b, g at an interface at `f` between nodes at `u` (upwind) and `d`, `far` the node before `u`.
    pub(crate) fn weights(self, far: f64, u: f64, d: f64, f: f64) -> [f64; 3] {
        let t = (f - u) / (d - u);
        match self {
            Self::Central => [t, 0.0, 1.0],
            Self::Upwind => [0.0, 0.0, 1.0],
            Self::LinearUpwind => [0.0, (f - u) / (u - far), 1.0],
            Self::Quick => {
                let m = (f - u) * (f - d) / (d - far);
                [t + m / (d - u), -m / (u - far), 1.0]
            }
            Self::Limited => [0.0, 2.0 * t, (d - u) / (u - far)],
        }
    }
}
