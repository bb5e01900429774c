//! What a wall function is told of the flow beside a wall.
use crate::Vector;

/// A cell beside a wall, as a wall function sees it. Lengths are measured along the normal from the wall; tangential velocities
/// are relative to the wall's, |(I − nn)(u − u_wall)|.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WallRow {
    /// Number of the cell, x fastest.
    pub cell: usize,
    /// Distance of its centre from the wall \[m\], positive.
    pub y: f64,
    /// Area of the wall that is this row's \[m²\]; in the plane length \[m\]. A cell beside two walls has two rows.
    pub area: f64,
    /// Tangential velocity at the centre \[m/s\].
    pub u_t: f64,
    /// Mean of |∂u_t/∂n| over the cell \[1/s\], from the wall's velocity to that on its far face; `None` where it is not known.
    pub shear: Option<f64>,
    /// Turbulence kinetic energy at the centre \[m²/s²\]; 0 where there is none.
    pub k: f64,
    /// Kinematic viscosity of the fluid \[m²/s\].
    pub nu: f64,
    /// Where the fluid flows along the wall: unit vector of the tangential velocity at P₁, at the centre without P₁; zero where
    /// nothing flows.
    pub tangent: Vector,
    /// What is seen at P₁ and P₂, farther out on the normal; `None` where there is no room for them.
    pub points: [Option<WallPoint>; 2],
    /// Where the wall's friction (ν + ν_t) u_t/y is taken from, and k for its ν_t, instead of from the centre: for walls beside which the
    /// velocity of the centre is not to be trusted.
    pub seen: Option<WallPoint>,
    /// The wall's friction τ_w/ρ \[m²/s²\] where it is known already, instead of (ν + ν_t) u_t/y.
    pub friction: Option<f64>,
    /// Share of the model's own equations in the cell, in 0 … 1: with 0 the wall functions say all.
    pub free: f64,
}

/// The flow at a point on the normal of a wall.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WallPoint {
    /// Distance from the wall \[m\].
    pub y: f64,
    /// Tangential velocity \[m/s\].
    pub u_t: f64,
    /// Turbulence kinetic energy \[m²/s²\]; 0 where there is none.
    pub k: f64,
}
