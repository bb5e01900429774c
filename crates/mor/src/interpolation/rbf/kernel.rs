//! Radial functions.

/// A radial function φ(r) of the distance r in scaled inputs (the samples fill [−1, 1] in each); ε is the shape parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kernel {
    /// r³; needs a tail of degree 1.
    Cubic,
    /// r⁵; needs a tail of degree 2.
    Quintic,
    /// r² ln r; needs a tail of degree 1.
    ThinPlate,
    /// exp(−(ε r)²).
    Gaussian,
    /// √(1 + (ε r)²); needs a tail of degree 0.
    Multiquadric,
    /// Wendland's function with four continuous derivatives, (1 − εr)⁶₊ (35 (εr)² + 18 εr + 3)/3; up to three inputs.
    Wendland,
}

impl Kernel {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Cubic, Self::Quintic, Self::ThinPlate, Self::Gaussian, Self::Multiquadric, Self::Wendland];

    /// What tables and files call it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Cubic => "cubic",
            Self::Quintic => "quintic",
            Self::ThinPlate => "thin plate",
            Self::Gaussian => "Gaussian",
            Self::Multiquadric => "multiquadric",
            Self::Wendland => "Wendland C4",
        }
    }
    /// Does it depend on ε? The others only scale with it.
    #[must_use]
    pub fn has_shape(self) -> bool {
        matches!(self, Self::Gaussian | Self::Multiquadric | Self::Wendland)
    }
    /// The lowest degree of polynomials in the tail with which the equations are solvable at any distinct points (where the tail is
    /// determined); None if it needs no tail.
    #[must_use]
    pub fn lowest_tail(self) -> Option<usize> {
        match self {
            Self::Cubic | Self::ThinPlate => Some(1),
            Self::Quintic => Some(2),
            Self::Multiquadric => Some(0),
            Self::Gaussian | Self::Wendland => None,
        }
    }
    /// φ from r².
    pub(super) fn value(self, r2: f64, shape: f64) -> f64 {
        match self {
            Self::Cubic => r2 * r2.sqrt(),
            Self::Quintic => r2 * r2 * r2.sqrt(),
            Self::ThinPlate => {
                if r2 > 0.0 {
                    0.5 * r2 * r2.ln()
                } else {
                    0.0
                }
            }
            Self::Gaussian => (-shape * shape * r2).exp(),
            Self::Multiquadric => (1.0 + shape * shape * r2).sqrt(),
            Self::Wendland => {
                let s = shape * r2.sqrt();
                (1.0 - s).max(0.0).powi(6) * ((35.0 * s + 18.0) * s + 3.0) / 3.0
            }
        }
    }
    /// φ′(r)/r from r²: the gradient of φ(|x − c|) is this times x − c.
    pub(super) fn slope(self, r2: f64, shape: f64) -> f64 {
        match self {
            Self::Cubic => 3.0 * r2.sqrt(),
            Self::Quintic => 5.0 * r2 * r2.sqrt(),
            // Infinite at the centre, where x − c is zero faster.
            Self::ThinPlate => {
                if r2 > 0.0 {
                    r2.ln() + 1.0
                } else {
                    0.0
                }
            }
            Self::Gaussian => -2.0 * shape * shape * self.value(r2, shape),
            Self::Multiquadric => shape * shape / self.value(r2, shape),
            Self::Wendland => {
                let s = shape * r2.sqrt();
                -56.0 / 3.0 * shape * shape * (1.0 - s).max(0.0).powi(5) * (5.0 * s + 1.0)
            }
        }
    }
}
