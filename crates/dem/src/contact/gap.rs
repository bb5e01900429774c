//! Two bodies that do not touch yet.
use interfaces::Vector;

/// Where and how two bodies are close at one instant.
#[derive(Clone, Copy, Debug)]
pub struct Gap {
    /// How far their surfaces are apart \[m\].
    pub distance: f64,
    /// From the first body to the second, of unit length.
    pub normal: Vector,
    /// Velocity of the first body's surface there against the second's \[m/s\].
    pub velocity: Vector,
    /// Angular velocity of the first body against the second \[rad/s\].
    pub spin: Vector,
    /// R of the force 6πμR²U/δ of the film between them: R² = 2/((λ₁ + λ₂)√(λ₁λ₂)), λ the principal curvatures of the gap (those of both surfaces together). The reduced
    /// radius r₁r₂/(r₁ + r₂) of two spheres \[m\].
    pub radius: f64,
    /// Mean curvatures of both surfaces \[1/m\]; 0 of a wall.
    pub curvatures: [f64; 2],
    /// Is the second a wall?
    pub wall: bool,
}

/// What the first of two bodies feels across a gap; the second feels the opposite.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FilmForce {
    /// Force in the middle of the gap \[N\].
    pub force: Vector,
    /// Torque besides \[N m\].
    pub couple: Vector,
    /// The largest force per velocity that may be behind it \[N s/m\]: what the time step is chosen by.
    pub resistance: f64,
}
