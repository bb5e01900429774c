//! Functions beyond the samples.
use crate::interpolation::{InterpolationError, Interpolator};

/// Continuation of coefficients and paths beyond the samples' times and parameters. Phases are periodic and not extrapolated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Extrapolation {
    /// The value at the nearest point of the samples' domain.
    Constant,
    /// Value and slopes there: y(x₀) + Σ_i ∂y/∂x_i(x₀) (x_i − x₀_i).
    #[default]
    Linear,
    /// The function as it is: polynomials of high degree grow without bounds, radial functions and networks tend anywhere.
    Function,
}

impl Extrapolation {
    const ALL: [Self; 3] = [Self::Constant, Self::Linear, Self::Function];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Constant => "constant",
            Self::Linear => "linear",
            Self::Function => "function",
        }
    }
    pub(super) fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|e| e.name() == name)
    }

    /// y(x), extrapolated along the first `slow` inputs.
    pub(super) fn predict(
        self,
        function: &dyn Interpolator,
        slow: usize,
        x: &[f64],
        out: &mut [f64],
    ) -> Result<(), InterpolationError> {
        let domain = &function.domain()[..slow.min(x.len())];
        let beyond = |(i, [low, high]): (usize, &[f64; 2])| (x[i] < *low || x[i] > *high).then_some(i);
        let outside: Vec<usize> = domain.iter().enumerate().filter_map(beyond).collect();
        if outside.is_empty() || self == Self::Function {
            return function.predict(x, out);
        }
        let mut nearest = x.to_vec();
        outside.iter().for_each(|&i| nearest[i] = x[i].clamp(domain[i][0], domain[i][1]));
        function.predict(&nearest, out)?;
        if self == Self::Linear {
            let mut slope = vec![0.0; out.len()];
            for i in outside {
                function.derivative(&nearest, i, &mut slope)?;
                out.iter_mut().zip(&slope).for_each(|(out, slope)| *out += slope * (x[i] - nearest[i]));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Mat;
    use crate::interpolation::{Degree, Method, Samples, SplineParams};

    /// t² (1 + μ) on [0, 1]².
    #[test]
    fn beyond_the_samples() {
        let points = Mat::from_fn(2, 36, |i, j| [j % 6, j / 6][i] as f64 / 5.0);
        let values = Mat::from_fn(1, 36, |_, j| points[(0, j)].powi(2) * (1.0 + points[(1, j)]));
        let samples = Samples::new(points.as_ref(), values.as_ref()).unwrap();
        let function = SplineParams::new(Degree::Quintic).fit(&samples).unwrap();
        let at = |how: Extrapolation, x: [f64; 2]| {
            let mut y = [0.0];
            how.predict(function.as_ref(), 2, &x, &mut y).unwrap();
            y[0]
        };
        for (how, wanted) in [
            (Extrapolation::Constant, 2.0),
            (Extrapolation::Linear, 2.0 + 4.0 * 2.0 + 0.5),
            (Extrapolation::Function, 9.0 * 2.5),
        ] {
            assert!((at(how, [3.0, 1.5]) - wanted).abs() < 1e-9, "{how:?}");
            assert!((at(how, [0.3, 0.7]) - 0.09 * 1.7).abs() < 1e-12);
            assert_eq!(Extrapolation::named(how.name()), Some(how));
        }
    }
}
