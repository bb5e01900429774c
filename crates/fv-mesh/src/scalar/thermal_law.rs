//! The mean scalar beside a smooth wall.
use interfaces::LawOfTheWall;

/// Γ_w/ν = y+/T+, by which φ_w − φ at the distance y tells what passes through a wall, as a function of 1 + ν_t/ν = y+/u+ there:
///
/// ```text
/// T+ = ∫ dy+/(1/Pr + ν_t+/Pr_t) = Pr_t u+ + ∫ [1/(1/Pr + ν_t+/Pr_t) − Pr_t/(1 + ν_t+)] dy+,   ν_t+ = 1/(du+/dy+) − 1
/// ```
///
/// with u+ of the [`LawOfTheWall`]: Pr y+ at the wall, a logarithm with the slope Pr_t/κ far from it, Pr_t u+ where Pr = Pr_t.
#[derive(Clone, Debug)]
pub(super) struct ThermalLaw {
    /// y+/u+ and y+/T+, ascending.
    table: Vec<[f64; 2]>,
}

/// The first y+ of the table, and by how much the logarithm of y+ grows from entry to entry.
const FIRST: f64 = 0.01;
const STEP: f64 = 0.04;
const ENTRIES: usize = 460;

impl ThermalLaw {
    /// Of a fluid with this Prandtl number, infinite where nothing diffuses.
    pub(super) fn new(prandtl: f64, turbulent: f64) -> Self {
        let law = LawOfTheWall::USUAL;
        // By the logarithm of y+.
        let beyond = |y: f64| {
            let eddies = 1.0 / law.slope(y) - 1.0;
            y * (1.0 / (1.0 / prandtl + eddies / turbulent) - turbulent / (1.0 + eddies))
        };
        let mut rest = (prandtl - turbulent) * FIRST;
        let table = (0..ENTRIES).map(|i| {
            let place = |i: f64| FIRST * (STEP * i).exp();
            let y = place(i as f64);
            if i > 0 {
                // Simpson's rule.
                let [a, b] = [1.0, 0.5].map(|back| beyond(place(i as f64 - back)));
                rest += STEP / 6.0 * (a + 4.0 * b + beyond(y));
            }
            let u = law.u_plus(y);
            [y / u, y / (turbulent * u + rest)]
        });
        Self { table: table.collect() }
    }

    /// y+/T+ where y+/u+ is `ratio`.
    pub(super) fn ratio(&self, ratio: f64) -> f64 {
        let above = self.table.partition_point(|row| row[0] <= ratio).clamp(1, self.table.len() - 1);
        let [[low, a], [high, b]] = [self.table[above - 1], self.table[above]];
        if high > low && ratio > low { a + (b - a) * (ratio - low) / (high - low) } else { a }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// T+ by the law at y+.
    fn t_plus(prandtl: f64, turbulent: f64, y: f64) -> f64 {
        y / ThermalLaw::new(prandtl, turbulent).ratio(y / LawOfTheWall::USUAL.u_plus(y))
    }

    /// Kader's correlation of what was measured from air to oils (1981, *Int. J. Heat Mass Transfer* 24, 1541–1544), near the wall.
    fn kader(prandtl: f64, y: f64) -> f64 {
        let beta = (3.85 * prandtl.cbrt() - 1.3).powi(2) + 2.12 * prandtl.ln();
        let gamma = 0.01 * (prandtl * y).powi(4) / (1.0 + 5.0 * prandtl.powi(3) * y);
        prandtl * y * (-gamma).exp() + (2.12 * (1.0 + y).ln() + beta) * (-1.0 / gamma).exp()
    }

    #[test]
    fn reynolds_analogy_where_both_numbers_agree() {
        for number in [0.7, 1.0, 2.0] {
            let law = ThermalLaw::new(number, number);
            for m in [1.0, 1.3, 7.77, 100.0, 3e4] {
                assert!((law.ratio(m) * number / m - 1.0).abs() < 1e-12, "{number} {m}");
            }
        }
    }

    #[test]
    fn what_was_measured_in_air_and_water() {
        for prandtl in [0.71, 1.0, 7.0] {
            for y in [1.0, 30.0, 100.0, 300.0, 1000.0] {
                let (found, measured) = (t_plus(prandtl, 0.85, y), kader(prandtl, y));
                assert!((found / measured - 1.0).abs() < 0.06, "Pr {prandtl} y+ {y}: {found} {measured}");
            }
        }
    }

    #[test]
    fn what_does_not_diffuse_does_not_pass() {
        assert_eq!(ThermalLaw::new(f64::INFINITY, 0.85).ratio(5.0), 0.0);
    }
}
