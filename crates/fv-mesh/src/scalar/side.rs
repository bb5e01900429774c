//! Boundary conditions of a cell-centred scalar as the user gives them.
use crate::FlowError;
use std::fmt;
use std::sync::Arc;

/// A number at a place \[m\] and time \[s\].
type ScalarFunction = Arc<dyn Fn([f64; 3], f64) -> f64 + Send + Sync>;

/// What is given on a side.
#[derive(Clone)]
pub enum Given {
    /// The same everywhere and always.
    Uniform(f64),
    /// Any function of place and time; see [`Given::function`].
    Function(ScalarFunction),
}

impl Given {
    /// `f(x, t)` of place \[m\] and time \[s\]. It is asked for at the centres of the side's faces.
    pub fn function(f: impl Fn([f64; 3], f64) -> f64 + Send + Sync + 'static) -> Self {
        Self::Function(Arc::new(f))
    }
    pub(super) fn at(&self, x: [f64; 3], time: f64) -> f64 {
        match self {
            Self::Uniform(value) => *value,
            Self::Function(f) => f(x, time),
        }
    }
}

impl From<f64> for Given {
    fn from(value: f64) -> Self {
        Self::Uniform(value)
    }
}

impl fmt::Debug for Given {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Uniform(value) => f.debug_tuple("Uniform").field(value).finish(),
            Self::Function(_) => f.write_str("Function(..)"),
        }
    }
}

/// A rectangle of a side and what holds for a scalar there.
#[derive(Clone, Debug)]
pub struct ScalarPatch {
    /// Lower corner \[m\]; the coordinate normal to the side does not matter.
    pub lower: [f64; 3],
    /// Upper corner \[m\].
    pub upper: [f64; 3],
    /// What holds there; neither periodic nor patches again.
    pub side: ScalarSide,
}

/// What holds for a scalar φ at one side of the box, n the normal that points out of it.
#[derive(Clone, Debug)]
pub enum ScalarSide {
    /// The field repeats beyond the opposite side.
    Periodic,
    /// φ is given.
    Value(Given),
    /// ∂φ/∂n is given \[1/m\].
    Gradient(Given),
    /// a φ + b ∂φ/∂n = c, with a ≥ 0, b ≥ 0 \[m\] and one of them positive. Transfer to surroundings at φ_∞,
    /// −Γ ∂φ/∂n = h(φ − φ_∞), has a = h, b = Γ, c = h φ_∞.
    Mixed {
        /// Factor of φ.
        a: f64,
        /// Factor of ∂φ/∂n.
        b: f64,
        /// What the sum is.
        c: Given,
    },
    /// Different things on parts of the side: the first patch that holds a face's centre counts. Patches have to cover
    /// the whole side.
    Patches(Vec<ScalarPatch>),
}

impl ScalarSide {
    /// ∂φ/∂n = 0: insulated walls, planes of symmetry, outlets.
    pub const NO_GRADIENT: Self = Self::Gradient(Given::Uniform(0.0));

    /// φ = `value`.
    pub fn value(value: impl Into<Given>) -> Self {
        Self::Value(value.into())
    }
    /// The flux `into` the box by diffusion, Γ ∂φ/∂n = `into`, where the diffusivity Γ is `diffusivity` \[m²/s\].
    pub fn flux(into: f64, diffusivity: f64) -> Self {
        Self::Gradient(Given::Uniform(into / diffusivity))
    }

    /// This at both sides of an axis.
    pub fn both(&self) -> [Self; 2] {
        [self.clone(), self.clone()]
    }
    /// This at every side of the box.
    pub fn everywhere<const D: usize>(&self) -> [[Self; 2]; D] {
        std::array::from_fn(|_| self.both())
    }
    pub(crate) fn is_periodic(&self) -> bool {
        matches!(self, Self::Periodic)
    }

    /// a, b and c of a φ + b ∂φ/∂n = c.
    pub(super) fn condition(&self) -> Option<(f64, f64, &Given)> {
        match self {
            Self::Value(value) => Some((1.0, 0.0, value)),
            Self::Gradient(gradient) => Some((0.0, 1.0, gradient)),
            Self::Mixed { a, b, c } => Some((*a, *b, c)),
            Self::Periodic | Self::Patches(_) => None,
        }
    }

    pub(super) fn check(&self, axis: usize, patch: bool) -> Result<(), FlowError> {
        let fail = |what| Err(FlowError::Boundary { what });
        if let Some((a, b, c)) = self.condition() {
            if !(a.is_finite() && b.is_finite() && a >= 0.0 && b >= 0.0 && a + b > 0.0) {
                return fail(format!(
                    "{a} φ + {b} ∂φ/∂n on a side of axis {axis}; give finite factors, not negative and not both zero"
                ));
            }
            return match c {
                Given::Uniform(c) if !c.is_finite() => {
                    fail(format!("a scalar given as {c} on a side of axis {axis}; give a finite number"))
                }
                _ => Ok(()),
            };
        }
        match self {
            Self::Periodic if patch => {
                fail(format!("a periodic patch of a side of axis {axis}; make the whole axis periodic"))
            }
            Self::Patches(_) if patch => {
                fail(format!("patches in a patch of a side of axis {axis}; list them flat"))
            }
            Self::Patches(patches) => patches.iter().try_for_each(|p| p.side.check(axis, true)),
            _ => Ok(()),
        }
    }
}
