//! Profiles along the surface normal.

/// How a quantity φ varies with the distance s from the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Profile {
    /// φ = φ_S: no fluid point.
    Constant,
    /// A line: one fluid point P₁.
    Linear,
    /// A parabola: P₁ and P₂ (figure 3b).
    #[default]
    Quadratic,
    /// φ = φ_S + c ln(1 + s/s₀): P₁; for velocities at high y⁺, s₀ = ν/(E u_τ). Given gradients take
    /// the line instead.
    Logarithmic {
        /// s₀ \[m\].
        length: f64,
    },
}

/// What is given at the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Given {
    /// The value φ_S (Dirichlet).
    #[default]
    Value,
    /// The derivative along the outward normal, ∂φ/∂n (Neumann).
    Gradient,
}

/// φ at P as a sum of what is known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Weights {
    /// Of what is given at the surface.
    pub surface: f64,
    /// Of φ at P₁ and P₂.
    pub points: [f64; 2],
}

impl Profile {
    /// How many fluid points it takes.
    pub fn points(self, given: Given) -> usize {
        match (self, given) {
            (Self::Constant, Given::Value) => 0,
            (Self::Quadratic, _) => 2,
            _ => 1,
        }
    }

    /// The weights at distance `s` from the surface for fluid points at the distances `s1` and `s2`.
    /// Where there are less than the profile takes, its order is that of the points there are; with none
    /// φ is φ_S, or unknown (`None`) where a gradient is given.
    pub fn weights(self, given: Given, s: f64, s1: Option<f64>, s2: Option<f64>) -> Option<Weights> {
        let w = |surface, first, second| Some(Weights { surface, points: [first, second] });
        let (s1, s2) = match self.points(given) {
            0 => (None, None),
            1 => (s1, None),
            _ => (s1, s2),
        };
        match (given, s1, s2) {
            (Given::Value, None, _) => w(1.0, 0.0, 0.0),
            (Given::Value, Some(s1), None) => {
                let share = match self {
                    // Behind the surface it goes on as it came.
                    Self::Logarithmic { length } => {
                        (s.abs() / length).ln_1p().copysign(s) / (s1 / length).ln_1p()
                    }
                    _ => s / s1,
                };
                w(1.0 - share, share, 0.0)
            }
            (Given::Value, Some(s1), Some(s2)) => w(
                (s - s1) * (s - s2) / (s1 * s2),
                s * (s - s2) / (s1 * (s1 - s2)),
                s * (s - s1) / (s2 * (s2 - s1)),
            ),
            (Given::Gradient, None, _) => None,
            // The constant leaves the gradient out.
            (Given::Gradient, Some(_), None) if self == Self::Constant => w(0.0, 1.0, 0.0),
            (Given::Gradient, Some(s1), None) => w(s - s1, 1.0, 0.0),
            (Given::Gradient, Some(s1), Some(s2)) => {
                // φ = φ₁ + g (s − s₁) + c (s² − s₁²), c from φ₂.
                let c = (s * s - s1 * s1) / (s2 * s2 - s1 * s1);
                w(s - s1 - c * (s2 - s1), 1.0 - c, c)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every profile meets the functions it is made for, with values and gradients given.
    #[test]
    fn profiles_are_exact_for_their_own_functions() {
        let log = |s: f64| 2.0 - 3.0 * (s / 0.1).ln_1p();
        type Function = fn(f64) -> f64;
        let cases: [(Profile, Function, f64); 4] = [
            (Profile::Constant, |_| 2.0, 0.0),
            (Profile::Linear, |s| 2.0 - 3.0 * s, -3.0),
            (Profile::Quadratic, |s| 2.0 - 3.0 * s + 5.0 * s * s, -3.0),
            (Profile::Logarithmic { length: 0.1 }, |s| 2.0 - 3.0 * s, -3.0),
        ];
        let at = |w: Weights, f: Function, surface: f64| {
            w.surface * surface + w.points[0] * f(1.1) + w.points[1] * f(2.3)
        };
        for (profile, f, slope) in cases {
            let (s, s1, s2) = (0.3, Some(1.1), Some(2.3));
            if !matches!(profile, Profile::Logarithmic { .. }) {
                let w = profile.weights(Given::Value, s, s1, s2).unwrap();
                assert!((at(w, f, f(0.0)) - f(s)).abs() < 1e-14, "{profile:?}");
            }
            let w = profile.weights(Given::Gradient, s, s1, s2).unwrap();
            assert!((at(w, f, slope) - f(s)).abs() < 1e-14, "{profile:?} with its gradient");
        }
        let w =
            Profile::Logarithmic { length: 0.1 }.weights(Given::Value, 0.3, Some(1.1), Some(2.3)).unwrap();
        assert!((w.surface * log(0.0) + w.points[0] * log(1.1) - log(0.3)).abs() < 1e-14);
    }

    #[test]
    fn missing_points_lower_the_order() {
        let weights = |given, s1, s2| Profile::Quadratic.weights(given, 0.3, s1, s2);
        let line = weights(Given::Value, Some(1.2), None).unwrap();
        assert!((line.surface - 0.75).abs() < 1e-15 && (line.points[0] - 0.25).abs() < 1e-15);
        assert_eq!(weights(Given::Value, None, None), Some(Weights { surface: 1.0, points: [0.0; 2] }));
        let line = weights(Given::Gradient, Some(1.2), None).unwrap();
        assert!((line.surface + 0.9).abs() < 1e-15 && line.points == [1.0, 0.0]);
        assert_eq!(weights(Given::Gradient, None, None), None);
    }
}
