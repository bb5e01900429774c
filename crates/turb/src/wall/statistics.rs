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
    /// Mean of y+ over that part.
    pub mean_between: f64,
    /// Part of the area below the [range](Self::range) of the model.
    pub below: f64,
    /// Mean of y+ over that part.
    pub mean_below: f64,
    /// Part of the area beyond 300, which may be outside the logarithmic layer.
    pub beyond: f64,
    /// Part of the area with laminar friction: ν_t on the wall is below that where the linear and the logarithmic law meet. All of it where cells resolve the viscous
    /// sublayer.
    pub laminar: f64,
    /// Part of the area with laminar friction at y+ above 15, beyond any viscous sublayer.
    pub laminar_beyond: f64,
    /// y+ from which and up to which the model holds beside walls.
    pub range: [f64; 2],
    /// Number of rows.
    pub rows: usize,
}

/// A row of the statistics.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WallSample {
    pub(crate) y_plus: f64,
    pub(crate) area: f64,
    pub(crate) laminar: bool,
}

/// Where the linear law ends, and where the logarithmic one begins.
const BETWEEN: [f64; 2] = [3.0, 15.0];
/// Where the logarithmic layer may end.
const BEYOND: f64 = 300.0;
/// Part of the area from which on a warning is given.
const NOTICEABLE: f64 = 0.05;

impl YPlus {
    /// Statistics of the rows of a model that holds from y+ `from` on.
    pub(crate) fn of(rows: impl Iterator<Item = WallSample>, from: f64) -> Self {
        let mut s = Self { least: f64::INFINITY, range: [from, BEYOND], ..Self::default() };
        let mut area = 0.0;
        for WallSample { y_plus, area: a, laminar } in rows {
            let part = |holds: bool| if holds { a } else { 0.0 };
            s.rows += 1;
            s.least = s.least.min(y_plus);
            s.most = s.most.max(y_plus);
            s.mean += a * y_plus;
            let between = part((BETWEEN[0]..=BETWEEN[1]).contains(&y_plus));
            s.between += between;
            s.mean_between += between * y_plus;
            let below = part(y_plus < from);
            s.below += below;
            s.mean_below += below * y_plus;
            s.beyond += part(y_plus > BEYOND);
            s.laminar += part(laminar);
            s.laminar_beyond += part(laminar && y_plus > BETWEEN[1]);
            area += a;
        }
        for (mean, part) in [(&mut s.mean_between, s.between), (&mut s.mean_below, s.below)] {
            *mean = if part > 0.0 { *mean / part } else { 0.0 };
        }
        if area > 0.0 {
            let sums = [
                &mut s.mean,
                &mut s.between,
                &mut s.below,
                &mut s.beyond,
                &mut s.laminar,
                &mut s.laminar_beyond,
            ];
            sums.into_iter().for_each(|sum| *sum /= area);
        }
        if s.rows == 0 { Self::default() } else { s }
    }

    /// For a saved state.
    pub(crate) fn numbers(&self) -> [f64; 13] {
        let Self { least, mean, most, between, mean_between, below, mean_below, beyond, .. } = *self;
        let [from, to] = self.range;
        let (laminar, laminar_beyond, rows) = (self.laminar, self.laminar_beyond, self.rows as f64);
        [
            least,
            mean,
            most,
            between,
            mean_between,
            below,
            mean_below,
            beyond,
            laminar,
            laminar_beyond,
            from,
            to,
            rows,
        ]
    }

    /// What [`numbers`](Self::numbers) gave; `None` for another list.
    pub(crate) fn from_numbers(numbers: &[f64]) -> Option<Self> {
        let &[
            least,
            mean,
            most,
            between,
            mean_between,
            below,
            mean_below,
            beyond,
            laminar,
            laminar_beyond,
            from,
            to,
            rows,
        ] = numbers
        else {
            return None;
        };
        Some(Self {
            least,
            mean,
            most,
            between,
            mean_between,
            below,
            mean_below,
            beyond,
            laminar,
            laminar_beyond,
            range: [from, to],
            rows: rows as usize,
        })
    }

    /// What is wrong with the distance of the cells, and by which factor to change it.
    pub fn warnings(&self) -> Vec<String> {
        let mut list = Vec::new();
        let percent = |part: f64| format!("{:.0} %", 100.0 * part);
        if self.below > NOTICEABLE {
            list.push(format!(
                "y+ below {:.0} at {} of the walls (mean there {:.1}): this model has no terms for the viscous sublayer, and its friction is too \
                 large there, by a half and more below y+ 3; coarsen the cells beside walls {:.1} times, to y+ {:.0} or more, or take SST or k-omega",
                self.range[0],
                percent(self.below),
                self.mean_below,
                self.range[0] / self.mean_below.max(1e-3),
                self.range[0],
            ));
        } else if self.between > NOTICEABLE {
            list.push(format!(
                "y+ = 3…15 at {} of the walls (mean there {:.1}): neither branch holds; refine the cells beside walls {:.1} times, to \
                 y+ of about 1, or coarsen them {:.1} times, to 30 or more",
                percent(self.between),
                self.mean_between,
                self.mean_between,
                30.0 / self.mean_between,
            ));
        }
        if self.beyond > NOTICEABLE {
            list.push(format!(
                "y+ above 300 at {} of the walls (largest {:.0}): these cells may be outside the logarithmic layer; refine them \
                 {:.1} times",
                percent(self.beyond),
                self.most,
                self.most / 100.0
            ));
        }
        if self.laminar_beyond > NOTICEABLE {
            list.push(format!(
                "laminar friction at y+ above 15 at {} of the walls: no turbulence is produced there, and friction is too low unless the \
                 flow is laminar; refine the cells beside walls {:.0} times, to y+ of about 1, or give more turbulence where the fluid enters",
                percent(self.laminar_beyond),
                self.mean.max(1.0),
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
        let sample = |y_plus: f64, area: f64, laminar: bool| WallSample { y_plus, area, laminar };
        let rows = [sample(1.0, 1.0, true), sample(5.0, 2.0, true), sample(400.0, 1.0, true)];
        let s = YPlus::of(rows.into_iter(), 0.0);
        assert_eq!((s.least, s.most, s.rows), (1.0, 400.0, 3));
        assert_eq!([s.mean, s.between, s.beyond, s.below], [411.0 / 4.0, 0.5, 0.25, 0.0]);
        assert_eq!([s.laminar, s.laminar_beyond], [1.0, 0.25]);
        assert_eq!(s.warnings().len(), 3);
        // The factors are those of the part that is warned of, not of the mean over all walls.
        assert!(s.warnings()[0].starts_with("y+ = 3…15 at 50 % of the walls (mean there 5.0)"));
        assert!(s.warnings()[0].contains("refine the cells beside walls 5.0 times"));
        assert!(s.warnings()[0].contains("coarsen them 6.0 times"));
        assert!(s.warnings()[2].starts_with("laminar friction at y+ above 15 at 25 % of the walls"));
        // A model that begins at y+ 30.
        let s = YPlus::of(rows.into_iter(), 30.0);
        assert_eq!((s.below, s.mean_below), (0.75, 11.0 / 3.0));
        assert!(s.warnings()[0].starts_with("y+ below 30 at 75 % of the walls (mean there 3.7)"));
        assert!(s.warnings()[0].contains("coarsen the cells beside walls 8.2 times"));
        assert_eq!(YPlus::from_numbers(&s.numbers()), Some(s));
        assert_eq!(YPlus::of(std::iter::empty(), 30.0), YPlus::default());
        assert!(YPlus::of([sample(40.0, 1.0, false)].into_iter(), 30.0).warnings().is_empty());
        // Resolved layers.
        assert!(YPlus::of([sample(0.8, 1.0, true)].into_iter(), 0.0).warnings().is_empty());
    }
}
