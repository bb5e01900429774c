//! How far from walls the first cells are.
use std::fmt;

/// y+ of the cells beside walls: y √(τ_w/ρ)/ν, and k's y* where nothing flows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct YPlus {
    /// The smallest one.
    pub least: f64,
    /// Their mean, weighted by area.
    pub mean: f64,
    /// The largest one.
    pub most: f64,
    /// Part of the area in 3 … 15, where neither the linear nor the logarithmic law holds.
    pub between: f64,
    /// Part of the area beyond 300, which may be outside the logarithmic layer.
    pub beyond: f64,
    /// Number of rows.
    pub rows: usize,
}

/// Where the linear law ends, and where the logarithmic one begins.
const BETWEEN: [f64; 2] = [3.0, 15.0];
/// Where the logarithmic layer may end.
const BEYOND: f64 = 300.0;

impl YPlus {
    /// Of y+ and areas.
    pub(crate) fn of(rows: impl Iterator<Item = (f64, f64)>) -> Self {
        let mut s = Self { least: f64::INFINITY, ..Self::default() };
        let mut area = 0.0;
        for (y_plus, a) in rows {
            s.rows += 1;
            s.least = s.least.min(y_plus);
            s.most = s.most.max(y_plus);
            s.mean += a * y_plus;
            s.between += if (BETWEEN[0]..=BETWEEN[1]).contains(&y_plus) { a } else { 0.0 };
            s.beyond += if y_plus > BEYOND { a } else { 0.0 };
            area += a;
        }
        if area > 0.0 {
            [&mut s.mean, &mut s.between, &mut s.beyond].into_iter().for_each(|sum| *sum /= area);
        }
        if s.rows == 0 { Self::default() } else { s }
    }

    /// For a saved state.
    pub(crate) fn numbers(&self) -> [f64; 6] {
        [self.least, self.mean, self.most, self.between, self.beyond, self.rows as f64]
    }

    /// What [`numbers`](Self::numbers) gave; `None` for another list.
    pub(crate) fn from_numbers(numbers: &[f64]) -> Option<Self> {
        let &[least, mean, most, between, beyond, rows] = numbers else { return None };
        Some(Self { least, mean, most, between, beyond, rows: rows as usize })
    }

    /// What is wrong with the distance of the cells, and by which factor to change it.
    pub fn warnings(&self) -> Vec<String> {
        let mut list = Vec::new();
        if self.between > 0.05 {
            list.push(format!(
                "y+ = 3…15 at {:.0} % of the walls (mean {:.1}): neither branch holds; refine the cells beside walls {:.1} times, to \
                 y+ of about 1, or coarsen them {:.1} times, to 30 or more",
                100.0 * self.between,
                self.mean,
                self.mean.max(1.0),
                30.0 / self.mean.max(1.0)
            ));
        }
        if self.beyond > 0.05 {
            list.push(format!(
                "y+ above 300 at {:.0} % of the walls (largest {:.0}): these cells may be outside the logarithmic layer; refine them \
                 {:.1} times",
                100.0 * self.beyond,
                self.most,
                self.most / 100.0
            ));
        }
        list
    }
}

impl fmt::Display for YPlus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "y+ {:.3} … {:.3}, mean {:.3} ({} rows)", self.least, self.most, self.mean, self.rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statistics_are_weighted_by_area() {
        let s = YPlus::of([(1.0, 1.0), (5.0, 2.0), (400.0, 1.0)].into_iter());
        assert_eq!((s.least, s.most, s.rows), (1.0, 400.0, 3));
        assert_eq!([s.mean, s.between, s.beyond], [411.0 / 4.0, 0.5, 0.25]);
        assert_eq!(s.warnings().len(), 2);
        assert!(s.warnings()[0].starts_with("y+ = 3…15 at 50 % of the walls"));
        assert_eq!(YPlus::of(std::iter::empty()), YPlus::default());
        assert!(YPlus::of([(40.0, 1.0)].into_iter()).warnings().is_empty());
    }
}
