//! What a neuron makes of its sum.

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
    /// φ(z) and φ′(z).
    fn both(self, z: f64) -> [f64; 2] {
        match self {
            Self::Tanh => {
                let value = z.tanh();
                [value, 1.0 - value * value]
            }
            Self::Sine => z.sin_cos().into(),
            Self::Silu => {
                let gate = 1.0 / (1.0 + (-z).exp());
                [z * gate, gate * (1.0 + z * (1.0 - gate))]
            }
        }
    }
    /// Replaces sums by values, and writes the slopes.
    pub(super) fn apply(self, sums: &mut [f64], slopes: &mut [f64]) {
        for (z, slope) in sums.iter_mut().zip(slopes) {
            [*z, *slope] = self.both(*z);
        }
    }
}
