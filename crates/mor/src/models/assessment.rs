//! How far a model is from snapshots it has not seen.

/// Relative errors, in the norm over all unknowns and snapshots: ‖·‖² = Σ_j |·|².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Assessment {
    /// ‖Q − ΠQ‖/‖Q‖: what the modes cannot show, whatever their coefficients.
    pub projection: f64,
    /// ‖ΠQ − Q̂‖/‖Q‖: what the prediction Q̂ adds by its coefficients and paths.
    pub interpolation: f64,
    /// ‖Q − Q̂‖/‖Q‖.
    pub total: f64,
}

/// Sums of squares on the way to an [`Assessment`].
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sums {
    whole: f64,
    left: f64,
    apart: f64,
    off: f64,
}

impl std::ops::AddAssign for Sums {
    fn add_assign(&mut self, other: Self) {
        self.whole += other.whole;
        self.left += other.left;
        self.apart += other.apart;
        self.off += other.off;
    }
}

impl Sums {
    /// A snapshot, the nearest field the modes have, and the prediction.
    pub(super) fn add(&mut self, snapshot: &[f64], nearest: &[f64], predicted: &[f64]) {
        for ((q, n), p) in snapshot.iter().zip(nearest).zip(predicted) {
            self.whole += q * q;
            self.left += (q - n) * (q - n);
            self.apart += (n - p) * (n - p);
            self.off += (q - p) * (q - p);
        }
    }
    pub(super) fn assessment(self) -> Assessment {
        let relative = |sum: f64| if sum == 0.0 { 0.0 } else { (sum / self.whole).sqrt() };
        Assessment {
            projection: relative(self.left),
            interpolation: relative(self.apart),
            total: relative(self.off),
        }
    }
}
