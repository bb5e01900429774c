//! What a neuron makes of its sum.
use std::f64::consts::{FRAC_2_PI, LOG2_E};

/// The function applied to every entry of a hidden layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Activation {
    /// tanh z.
    Tanh,
    /// sin z (Sitzmann et al., NeurIPS 2020).
    Sine,
    /// z/(1 + e^−z), also called swish.
    Silu,
}

impl Activation {
    /// All.
    pub const ALL: [Self; 3] = [Self::Tanh, Self::Sine, Self::Silu];

    /// In files and tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Tanh => "tanh",
            Self::Sine => "sine",
            Self::Silu => "SiLU",
        }
    }
    /// Replaces sums by values φ(z), and writes the slopes φ′(z): without calls and branches, so that the loop takes as many at a
    /// time as the processor does, with the same result on all.
    pub(super) fn apply(self, sums: &mut [f64], slopes: &mut [f64]) {
        let pairs = sums.iter_mut().zip(slopes);
        pulp::Arch::new().dispatch(|| match self {
            Self::Tanh => pairs.for_each(|(z, slope)| [*z, *slope] = tanh(*z)),
            Self::Sine => pairs.for_each(|(z, slope)| [*z, *slope] = sine(*z)),
            Self::Silu => pairs.for_each(|(z, slope)| [*z, *slope] = silu(*z)),
        });
    }
}

/// Added to a number up to 2⁵¹ and taken off again, it rounds it; between, the whole number is in the lowest bits.
const ROUND: f64 = 1.5 * (1u64 << 52) as f64;

/// Coefficients of the power series of a function in x², from the highest, by how far each factorial is from the last.
#[inline(always)]
fn series(x2: f64, coefficients: &[f64]) -> f64 {
    coefficients.iter().fold(0.0, |sum, c| sum * x2 + c)
}

/// eˣ for |x| ≤ 700, to two units in the last place: 2ⁿ e^r with |r| ≤ ½ ln 2 and 14 terms.
#[inline(always)]
fn exp(x: f64) -> f64 {
    const LN2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];
    const COEFFICIENTS: [f64; 14] = inverse_factorials();
    let shifted = x * LOG2_E + ROUND;
    let n = shifted - ROUND;
    let r = (x - n * LN2[0]) - n * LN2[1];
    series(r, &COEFFICIENTS) * f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52)
}

/// 1/13!, …, 1/1!, 1/0!.
const fn inverse_factorials() -> [f64; 14] {
    let mut all = [1.0; 14];
    let (mut i, mut factorial) = (0, 1.0);
    while i < 13 {
        i += 1;
        factorial *= i as f64;
        all[13 - i] = 1.0 / factorial;
    }
    all
}

#[inline(always)]
fn tanh(z: f64) -> [f64; 2] {
    // Beyond ±20 it is ±1 to the last place.
    let e = exp((2.0 * z).clamp(-40.0, 40.0));
    let value = 1.0 - 2.0 / (e + 1.0);
    [value, 1.0 - value * value]
}

#[inline(always)]
fn silu(z: f64) -> [f64; 2] {
    // Below −700 it is 0 to the last place.
    let z = z.max(-700.0);
    let gate = 1.0 / (1.0 + exp((-z).max(-700.0)));
    [z * gate, gate * (1.0 + z * (1.0 - gate))]
}

/// sin z and cos z with |z| up to 10⁵, and those of ±10⁵ beyond: z − n π/2 by three parts of π/2, of which the first two have 33 bits.
#[inline(always)]
fn sine(z: f64) -> [f64; 2] {
    const PARTS: [f64; 3] = [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];
    const SIN: [f64; 9] = {
        let mut all = [1.0; 9];
        let (mut i, mut factorial) = (0, 1.0);
        while i < 8 {
            i += 1;
            factorial *= -((2 * i * (2 * i + 1)) as f64);
            all[8 - i] = 1.0 / factorial;
        }
        all
    };
    const COS: [f64; 9] = {
        let mut all = [1.0; 9];
        let (mut i, mut factorial) = (0, 1.0);
        while i < 8 {
            i += 1;
            factorial *= -((2 * i * (2 * i - 1)) as f64);
            all[8 - i] = 1.0 / factorial;
        }
        all
    };
    let z = z.clamp(-1e5, 1e5);
    let shifted = z * FRAC_2_PI + ROUND;
    let n = shifted - ROUND;
    let r = ((z - n * PARTS[0]) - n * PARTS[1]) - n * PARTS[2];
    let r2 = r * r;
    let (sin, cos) = (r * series(r2, &SIN), series(r2, &COS));
    let quadrant = shifted.to_bits();
    // Odd quadrants: sine and cosine change places; the sign is the second bit of n for the sine, of n + 1 for the cosine.
    let swap = 0u64.wrapping_sub(quadrant & 1);
    let pick = |even: f64, odd: f64| (even.to_bits() & !swap) | (odd.to_bits() & swap);
    let sign = |n: u64| (n & 2) << 62;
    [
        f64::from_bits(pick(sin, cos) ^ sign(quadrant)),
        f64::from_bits(pick(cos, sin) ^ sign(quadrant.wrapping_add(1))),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_and_slopes_are_right_to_the_last_places() {
        let exact = |activation: Activation, z: f64| match activation {
            Activation::Tanh => [z.tanh(), 1.0 / z.cosh().powi(2)],
            Activation::Sine => z.sin_cos().into(),
            Activation::Silu => {
                let gate = 1.0 / (1.0 + (-z).exp());
                [z * gate, gate + z * gate * (1.0 / (1.0 + z.exp()))]
            }
        };
        for activation in Activation::ALL {
            for i in -40_000..=40_000 {
                let z = f64::from(i) * 1e-3 * if i % 7 == 0 { 10.0 } else { 1.0 };
                let (mut value, mut slope) = ([z], [f64::NAN]);
                activation.apply(&mut value, &mut slope);
                let exact = exact(activation, z);
                let off = (value[0] - exact[0]).abs().max((slope[0] - exact[1]).abs());
                assert!(off <= 1e-15 * (1.0 + exact[0].abs()), "{activation:?} {z}: {off:e}");
            }
            for z in [650.0, -650.0, 1e300, -1e300] {
                let (mut value, mut slope) = ([z], [f64::NAN]);
                activation.apply(&mut value, &mut slope);
                let good =
                    activation == Activation::Sine || (value[0] - exact(activation, z)[0]).abs() < 1e-15;
                assert!(
                    value[0].is_finite() && slope[0].is_finite() && good,
                    "{activation:?} {z}: {value:?} {slope:?}"
                );
            }
        }
    }
}
