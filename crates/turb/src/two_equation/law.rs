//! What makes one model of two equations differ from another.
use super::NOTHING;
use crate::{Inflow, TurbulenceError};

/// The second unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// ω \[1/s\].
    Omega,
    /// ε \[m²/s³\].
    Epsilon,
}

impl Scale {
    /// y+ of first cells from which on a model with it holds. That of ω has the viscous sublayer in it; ε without damping functions has not, and friction is 67 to
    /// 137 % too large below y+ 3.
    pub fn least_y_plus(self) -> f64 {
        match self {
            Self::Omega => 0.0,
            Self::Epsilon => 30.0,
        }
    }
    /// That of `inflow`.
    pub fn of(self, inflow: &Inflow) -> f64 {
        match self {
            Self::Omega => inflow.omega,
            Self::Epsilon => inflow.epsilon(),
        }
    }
}

/// A cell as a law sees it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Local {
    /// k \[m²/s²\], positive.
    pub k: f64,
    /// ω or ε, positive.
    pub scale: f64,
    /// ν_t \[m²/s\].
    pub eddy: f64,
    /// |S| = √(2 S:S) \[1/s\].
    pub strain: f64,
    /// ∇k·∇s, where the law asks for it.
    pub cross: f64,
    /// Distance from the nearest wall \[m\].
    pub distance: f64,
    /// ν \[m²/s\].
    pub nu: f64,
    /// What [`Law::auxiliary`] said.
    pub auxiliary: f64,
}

/// Invariants of the velocity gradient.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Invariants {
    /// √(2 S:S) \[1/s\].
    pub strain: f64,
    /// √(2 Ω:Ω) \[1/s\].
    pub rotation: f64,
    /// S_ij S_jk S_ki/(S:S)^(3/2).
    pub third: f64,
}

impl Invariants {
    /// Of ∂u_a/∂x_b = `g[a][b]`.
    pub fn of(g: &[[f64; 3]; 3]) -> Self {
        let s = |a: usize, b: usize| 0.5 * (g[a][b] + g[b][a]);
        let w = |a: usize, b: usize| 0.5 * (g[a][b] - g[b][a]);
        let (mut ss, mut ww, mut sss) = (0.0, 0.0, 0.0);
        for a in 0..3 {
            for b in 0..3 {
                ss += s(a, b) * s(a, b);
                ww += w(a, b) * w(a, b);
                for c in 0..3 {
                    sss += s(a, b) * s(b, c) * s(c, a);
                }
            }
        }
        let third = if ss > 0.0 { sss / (ss * ss.sqrt()) } else { 0.0 };
        Self { strain: (2.0 * ss).sqrt(), rotation: (2.0 * ww).sqrt(), third }
    }

    /// Of a plane shear flow of slope `slope` \[1/s\].
    pub fn shear(slope: f64) -> Self {
        Self { strain: slope, rotation: slope, third: 0.0 }
    }
}

/// Terms of one equation in one cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Terms {
    /// ν + σ ν_t \[m²/s\].
    pub diffusivity: f64,
    /// What is produced per time, not negative.
    pub source: f64,
    /// Rate at which it is consumed \[1/s\], not negative.
    pub sink: f64,
}

impl Terms {
    /// What dies out ends at next to nothing, not below the least value: set to that in every iteration it would never be at rest.
    pub(super) fn put(self, [diffusivity, source, sink]: &mut [Vec<f64>; 3], i: usize) {
        (diffusivity[i], source[i], sink[i]) =
            (self.diffusivity, self.source + NOTHING * self.sink, self.sink);
    }
}

/// A model of two equations: its constants, and its terms in a cell.
pub trait Law: Clone + Send + Sync {
    /// Its second unknown s.
    const SCALE: Scale;
    /// Does it want ∇k·∇s?
    const CROSS_DIFFUSION: bool = false;
    /// Does it want all invariants of the velocity gradient, or only |S|?
    const GRADIENT: bool = false;
    /// Does it want [`auxiliary`](Self::auxiliary)?
    const AUXILIARY: bool = false;

    /// # Errors
    /// [`TurbulenceError::Value`] for constants that make no sense.
    fn check(&self) -> Result<(), TurbulenceError>;
    /// A number that both equations need, from the state before they are solved.
    fn auxiliary(&self, _cell: &Local, _invariants: Invariants) -> f64 {
        0.0
    }
    /// The equation of s.
    fn scale_terms(&self, cell: &Local) -> Terms;
    /// The equation of k, with s just solved; `production` is ν_t S² \[m²/s³\], beside walls that of the wall functions.
    fn k_terms(&self, cell: &Local, production: f64) -> Terms;
    /// ν_t \[m²/s\], with both just solved.
    fn eddy_viscosity(&self, cell: &Local) -> f64;
}
