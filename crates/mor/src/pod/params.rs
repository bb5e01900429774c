//! How snapshots are decomposed.
use super::PodError;

/// Which singular value decomposition.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum SvdMethod {
    /// The method of snapshots if all modes that are kept have σ_k ≥ 1e-5 σ₁, else by QR.
    #[default]
    Auto,
    /// Right singular vectors V of R of Y = Q R, made of blocks of rows (2 n m² operations), modes Y V Σ⁻¹ and one pass of
    /// Cholesky QR: all singular values to round-off of the largest. More snapshots than rows are decomposed whole.
    Qr,
    /// Eigenvectors of the matrix of all products of snapshots (Sirovich, Q. Appl. Math. 45 (1987) 561), n m² operations, and one pass of Cholesky QR, which
    /// makes modes orthonormal again; modes with σ_k < 1e-5 σ₁ are lost in round-off and left out.
    Snapshots,
    /// Projection on a random subspace of a few dimensions more than modes are wanted, after some power iterations (Halko, Martinsson and Tropp, SIAM Rev. 53 (2011) 217); for few modes.
    Randomised {
        /// So many dimensions more.
        oversampling: usize,
        /// Products with Y Yᵀ; each sharpens the spectrum, at the price of two passes over the data.
        power_iterations: usize,
        /// Of the random numbers.
        seed: u64,
    },
}

/// How many modes are kept; never one whose singular value is nothing but round-off.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Rank {
    /// All.
    #[default]
    All,
    /// So many, or as many as there are.
    Fixed(usize),
    /// The fewest with Σ_kept σ² ≥ this share of Σ σ².
    Energy(f64),
    /// The fewest with ‖Y − Y_kept‖ ≤ this times ‖Y‖, in Frobenius' norm.
    Tolerance(f64),
    /// Those before the largest ratio of two successive singular values.
    Gap,
}

/// How to make a [`Pod`](super::Pod).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PodParams {
    /// The algorithm.
    pub method: SvdMethod,
    /// How many modes.
    pub rank: Rank,
    /// At most so many modes.
    pub most: Option<usize>,
    /// Takes the mean over the snapshots away first.
    pub subtract_mean: bool,
    /// w of the inner product ⟨a, b⟩ = Σᵢ wᵢ aᵢ bᵢ, such as volumes of cells; 1 if there are none. Rows of weight 0 have no say, but modes have values there.
    pub weights: Option<Vec<f64>>,
}

impl PodParams {
    /// So many modes, otherwise as by default.
    #[must_use]
    pub fn of_rank(rank: usize) -> Self {
        Self { rank: Rank::Fixed(rank), ..Self::default() }
    }

    pub(super) fn check(&self, rows: usize) -> Result<(), PodError> {
        let share = |what, value: f64, must| {
            if (0.0..=1.0).contains(&value) { Ok(()) } else { Err(PodError::Parameter { what, value, must }) }
        };
        match self.rank {
            Rank::Energy(value) => share("share of the energy", value, "from 0 to 1")?,
            Rank::Tolerance(value) => share("tolerance", value, "from 0 to 1")?,
            Rank::All | Rank::Fixed(_) | Rank::Gap => {}
        }
        let random = matches!(self.method, SvdMethod::Randomised { .. });
        if random && self.most.is_none() && !matches!(self.rank, Rank::Fixed(_)) {
            return Err(PodError::Parameter {
                what: "number of modes of a randomised decomposition",
                value: f64::INFINITY,
                must: "bounded: give `Rank::Fixed` or `most`",
            });
        }
        let Some(weights) = &self.weights else { return Ok(()) };
        PodError::same("weights", rows, weights.len())?;
        let bad = weights.iter().position(|w| !(w.is_finite() && *w >= 0.0));
        match bad.or_else(|| weights.iter().all(|w| *w == 0.0).then_some(0)) {
            Some(row) => Err(PodError::Weight { row, value: weights[row] }),
            None => Ok(()),
        }
    }

    /// The largest number of modes that can be asked for, of so many.
    pub(super) fn limit(&self, available: usize) -> usize {
        let fixed = if let Rank::Fixed(n) = self.rank { n } else { usize::MAX };
        available.min(fixed).min(self.most.unwrap_or(usize::MAX))
    }

    /// How many modes are kept of singular values in descending order, those above `floor` being more than round-off; Σσ² of all there are is `energy`.
    pub(super) fn kept(&self, values: &[f64], energy: f64, floor: f64) -> usize {
        let real = values.iter().take_while(|s| **s > floor).count();
        let within = |left: f64| {
            let mut rest = energy;
            let enough = values[..real].iter().position(|s| {
                let reached = rest <= left * energy;
                rest -= s * s;
                reached
            });
            enough.unwrap_or(real)
        };
        let wanted = match self.rank {
            Rank::All | Rank::Fixed(_) => real,
            Rank::Energy(share) => within((1.0 - share).max(1e-15)),
            Rank::Tolerance(tolerance) => within((tolerance * tolerance).max(1e-30)),
            Rank::Gap => {
                let ratio = |k: usize| values[k] / values.get(k + 1).copied().unwrap_or(0.0).max(floor);
                (0..real).max_by(|&a, &b| ratio(a).total_cmp(&ratio(b))).map_or(0, |k| k + 1)
            }
        };
        self.limit(wanted.min(real))
    }
}
