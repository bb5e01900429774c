//! Observed order of convergence and Richardson extrapolation from three grids.
//!
//! With representative cell sizes h₁ < h₂ < h₃, r₂₁ = h₂/h₁, r₃₂ = h₃/h₂ and φᵢ = φ + C hᵢᵖ, the
//! order p solves
//!
//! ```text
//! (φ₃ − φ₂)/(φ₂ − φ₁) = r₂₁ᵖ (r₃₂ᵖ − 1)/(r₂₁ᵖ − 1)
//! φ_ext = φ₁ + (φ₁ − φ₂)/(r₂₁ᵖ − 1),   GCI₂₁ = 1.25 |(φ₁ − φ₂)/φ₁| / (r₂₁ᵖ − 1)
//! ```
//!
//! Roache 1994, J. Fluids Eng. 116, 405–413; Celik, Ghia, Roache & Freitas 2008, J. Fluids Eng.
//! 130, 078001.
use crate::text::number;

/// Safety factor of the grid convergence index with three grids (Roache 1994).
const SAFETY: f64 = 1.25;
/// Differences below this share of the values are round-off.
const ROUND_OFF: f64 = 1e-12;
/// Largest order that is searched for.
const LARGEST_ORDER: f64 = 20.0;
/// Refinement below which Celik et al. (2008) find orders unreliable.
const LEAST_REFINEMENT: f64 = 1.3;
/// Orders that schemes of first and second order have in their asymptotic range, with some room.
const ASYMPTOTIC: std::ops::RangeInclusive<f64> = 0.5..=3.0;

/// A value on a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridValue {
    /// Representative cell size h = (V/N)^(1/D) \[m\].
    pub h: f64,
    /// The value.
    pub value: f64,
}

/// Convergence over three grids.
#[derive(Clone, Debug, PartialEq)]
pub enum GridConvergence {
    /// Monotone convergence.
    Monotone {
        /// Observed order p.
        order: f64,
        /// Extrapolated value at h = 0.
        extrapolated: f64,
        /// Grid convergence index of the finest grid, relative; none where the value is 0.
        index: Option<f64>,
        /// Reasons to doubt them.
        doubts: Vec<String>,
    },
    /// Neither order nor extrapolation.
    None {
        /// The reason.
        reason: String,
    },
}

impl GridConvergence {
    /// From three grids, finest first.
    pub fn of(grids: [GridValue; 3]) -> Self {
        let [h, v] = [grids.map(|g| g.h), grids.map(|g| g.value)];
        let none = |reason: &str| Self::None { reason: reason.into() };
        if !(h.iter().chain(&v).all(|x| x.is_finite()) && h[0] > 0.0) {
            return none("a value is missing or not finite");
        }
        let (r21, r32) = (h[1] / h[0], h[2] / h[1]);
        if r21 <= 1.0 + 1e-9 || r32 <= 1.0 + 1e-9 {
            return none("two grids have the same cell size");
        }
        let (e21, e32) = (v[1] - v[0], v[2] - v[1]);
        let size = v.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        if e21.abs() <= ROUND_OFF * size {
            return none(
                "the two finest grids have the same value to round-off: nothing is left to extrapolate",
            );
        }
        let ratio = e32 / e21;
        if ratio < 0.0 {
            return none(
                "not monotone: the value oscillates from grid to grid, so that there is no observed order; finer grids are needed",
            );
        }
        // r₂₁ᵖ (r₃₂ᵖ − 1)/(r₂₁ᵖ − 1), which grows with p from ln r₃₂/ln r₂₁ at p = 0.
        let of_order = |p: f64| r21.powf(p) * (p * r32.ln()).exp_m1() / (p * r21.ln()).exp_m1();
        if ratio <= r32.ln() / r21.ln() {
            return none(
                "not converging: differences do not shrink with the cell size (order ≤ 0); finer grids are needed",
            );
        }
        let (mut low, mut high) = (1e-9, LARGEST_ORDER);
        if ratio >= of_order(high) {
            return none(
                "the difference of the two finest grids is so small that the order is above 20: it may vanish by chance",
            );
        }
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if of_order(middle) < ratio {
                low = middle;
            } else {
                high = middle;
            }
        }
        let order = 0.5 * (low + high);
        let left = -e21 / (order * r21.ln()).exp_m1();
        let mut doubts = Vec::new();
        if !ASYMPTOTIC.contains(&order) {
            doubts.push(format!(
                "an order of {} is not that of a scheme of first or second order: the grids are not in the asymptotic range",
                number((order * 100.0).round() / 100.0)
            ));
        }
        if r21.min(r32) < LEAST_REFINEMENT {
            doubts.push(format!(
                "grids refined by less than {LEAST_REFINEMENT} (here {:.2}) make the order uncertain (Celik et al. 2008)",
                r21.min(r32)
            ));
        }
        Self::Monotone {
            order,
            extrapolated: v[0] + left,
            index: (v[0] != 0.0).then(|| SAFETY * (left / v[0]).abs()),
            doubts,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// φ = 2 + 0.3 hᵖ on grids that are refined unequally.
    #[test]
    fn a_known_order_is_found() {
        for p in [1.0, 1.5, 2.0, 4.0] {
            let grids = [0.1, 0.15, 0.3].map(|h: f64| GridValue { h, value: 2.0 + 0.3 * h.powf(p) });
            let GridConvergence::Monotone { order, extrapolated, index, doubts } = GridConvergence::of(grids)
            else {
                panic!("order {p}")
            };
            assert!((order - p).abs() < 1e-6 && (extrapolated - 2.0).abs() < 1e-9, "{order} {extrapolated}");
            let expected = 1.25 * (extrapolated / grids[0].value - 1.0).abs();
            assert!((index.unwrap() / expected - 1.0).abs() < 1e-6);
            assert_eq!(doubts.is_empty(), p < 3.0, "{doubts:?}");
        }
    }

    /// Table 1 of Celik et al. (2008), the reattachment length: 18000, 8000 and 4500 cells of the
    /// plane.
    #[test]
    fn celiks_example() {
        let h = |n: f64| (1.0 / n).sqrt();
        let grids = [(18000.0, 6.063), (8000.0, 5.972), (4500.0, 5.863)]
            .map(|(n, value)| GridValue { h: h(n), value });
        let GridConvergence::Monotone { order, extrapolated, index, .. } = GridConvergence::of(grids) else {
            panic!()
        };
        assert!((order - 1.53).abs() < 0.01, "{order}");
        assert!((extrapolated - 6.1685).abs() < 5e-4, "{extrapolated}");
        assert!((index.unwrap() - 0.022).abs() < 5e-4, "{index:?}");
    }

    #[test]
    fn grids_without_an_order_say_so() {
        let of = |v: [f64; 3]| {
            let h = [1.0, 2.0, 4.0];
            match GridConvergence::of(std::array::from_fn(|i| GridValue { h: h[i], value: v[i] })) {
                GridConvergence::None { reason } => reason,
                found => panic!("{found:?}"),
            }
        };
        assert!(of([1.0, 1.1, 1.05]).starts_with("not monotone"));
        assert!(of([1.0, 1.2, 1.3]).starts_with("not converging"));
        assert!(of([1.0, 1.0, 1.3]).contains("round-off"));
        assert!(of([1.0, f64::NAN, 1.3]).contains("not finite"));
        assert!(of([1.0, 1.0 + 1e-10, 2.0]).contains("by chance"));
        let same = [1.0, 1.0, 2.0].map(|h| GridValue { h, value: h });
        assert!(matches!(GridConvergence::of(same), GridConvergence::None { .. }));
    }
}
