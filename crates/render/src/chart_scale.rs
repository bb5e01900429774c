//! Scale of a chart's axis: range, power of ten, what is beyond.
use crate::chart::ChartAxis;
use std::ops::Range;

/// Share of the values at either end that an axis may cut off.
const TAIL: f64 = 0.005;
/// An axis is cut if all values take so many times the room of those between the tails.
const CUT: f64 = 4.0;
/// Intervals of a line: of those with more points the least and the greatest value of each is drawn.
const INTERVALS: usize = 560;
/// Relative span below which values are constant.
const CONSTANT: f64 = 1e-9;
/// Ticks that a range has at most.
const TICKS: f64 = 6.0;

/// Scale of an axis.
#[derive(Clone, Debug)]
pub(crate) struct Scale {
    logarithmic: bool,
    /// Values are divided by this power of ten.
    exponent: i32,
    /// Ends in the scale's own coordinate.
    ends: [f64; 2],
    /// Least and greatest value of an axis that is cut.
    pub(crate) beyond: Option<[f64; 2]>,
}

impl Scale {
    /// Scale for values, with room for `levels`; none without a value that can be drawn.
    pub(crate) fn of(
        axis: &ChartAxis,
        values: impl Iterator<Item = f64>,
        levels: impl IntoIterator<Item = f64>,
    ) -> Option<Self> {
        let drawable = |v: &f64| v.is_finite() && (!axis.logarithmic || *v > 0.0);
        let mut values: Vec<f64> = values.filter(drawable).collect();
        values.sort_unstable_by(f64::total_cmp);
        let (mut low, mut high) = (*values.first()?, *values.last()?);
        let mut beyond = None;
        if !axis.logarithmic {
            let tail = (TAIL * values.len() as f64).ceil() as usize;
            let inner = [
                values[tail.min(values.len() / 2)],
                values[(values.len() - 1).saturating_sub(tail).max(values.len() / 2)],
            ];
            let span = inner[1] - inner[0];
            if span > 0.0 && high - low > CUT * span {
                let room = [low.max(inner[0] - 0.5 * span), high.min(inner[1] + 0.5 * span)];
                if values.len() > 50 {
                    beyond = Some([low, high]);
                    [low, high] = room;
                }
            }
        }
        for level in levels.into_iter().filter(drawable) {
            (low, high) = (low.min(level), high.max(level));
        }
        if axis.logarithmic {
            let ends = [low.log10().floor(), high.log10().ceil()];
            let high = if ends[1] > ends[0] { ends[1] } else { ends[0] + 1.0 };
            return Some(Self { logarithmic: true, exponent: 0, ends: [ends[0], high], beyond });
        }
        let size = low.abs().max(high.abs());
        let exponent = match size {
            0.0 => 0,
            s if (1e-2..1e4).contains(&s) => 0,
            s => 3 * (s.log10() / 3.0).floor() as i32,
        };
        let unit = 10_f64.powi(exponent);
        let (mut low, mut high) = (low / unit, high / unit);
        if high - low <= CONSTANT * (size / unit) {
            let room = if size == 0.0 { 1.0 } else { 0.05 * (size / unit) };
            (low, high) = (low - room, high + room);
        }
        Some(Self { logarithmic: false, exponent, ends: [low, high], beyond })
    }

    /// Ends with some room, for drawing.
    pub(crate) fn range(&self) -> Range<f64> {
        let [low, high] = self.ends;
        let room = if self.logarithmic { 0.0 } else { 0.03 * (high - low) };
        low - room..high + room
    }

    /// Coordinate of a value; none if it has none.
    pub(crate) fn place(&self, value: f64) -> Option<f64> {
        let place = if self.logarithmic { value.log10() } else { value / 10_f64.powi(self.exponent) };
        place.is_finite().then_some(place)
    }

    /// Quantity and unit with the power of ten.
    pub(crate) fn description(&self, axis: &ChartAxis) -> String {
        let power = match self.exponent {
            0 => String::new(),
            n => format!("10{} ", superscript(n)),
        };
        match (axis.unit.as_str(), power.as_str()) {
            ("", "") => axis.label.clone(),
            ("", power) => format!("{} in {}", axis.label, power.trim_end()),
            (unit, power) => format!("{} in {power}{unit}", axis.label),
        }
    }

    /// Characters of the longest label of a tick.
    pub(crate) fn longest_label(&self) -> usize {
        let Range { start, end } = self.range();
        let ticks = (0..=10).map(|i| start + (end - start) * f64::from(i) / 10.0);
        // Ticks are rounder than these numbers, which have all decimals.
        ticks.map(|tick| tick_label(tick, self).chars().count()).max().unwrap_or(1).min(8)
    }

    /// Polylines within the plot, with y on scale `y`. Interrupted where a value is not finite and
    /// where the line leaves the range.
    pub(crate) fn pieces(&self, y: &Self, points: &[(f64, f64)]) -> Vec<Vec<(f64, f64)>> {
        let Range { start, end } = y.range();
        let mut pieces = Vec::new();
        for run in points.split(|p| self.place(p.0).is_none() || y.place(p.1).is_none()) {
            let placed: Vec<(f64, f64)> =
                run.iter().filter_map(|p| Some((self.place(p.0)?, y.place(p.1)?))).collect();
            pieces.extend(clipped(&thinned(&placed), [start, end]));
        }
        pieces
    }
}

/// Least and greatest value of each interval of lines with many points.
fn thinned(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    if points.len() <= 4 * INTERVALS {
        return points.to_vec();
    }
    let length = points.len().div_ceil(INTERVALS);
    let ends = |part: &[(f64, f64)]| {
        let by_y = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        let (low, high) = (part.iter().min_by(by_y), part.iter().max_by(by_y));
        let mut kept: Vec<(f64, f64)> =
            [part.first(), low, high, part.last()].into_iter().flatten().copied().collect();
        kept.sort_by(|a, b| a.0.total_cmp(&b.0));
        kept.dedup();
        kept
    };
    points.chunks(length).flat_map(ends).collect()
}

/// The parts of a polyline between two values of y.
fn clipped(points: &[(f64, f64)], [low, high]: [f64; 2]) -> Vec<Vec<(f64, f64)>> {
    let inside = |p: &(f64, f64)| (low..=high).contains(&p.1);
    let mut pieces: Vec<Vec<(f64, f64)>> = vec![Vec::new()];
    if let [only] = points
        && inside(only)
    {
        pieces[0].push(*only);
    }
    for pair in points.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let at = |y: f64| (a.0 + (b.0 - a.0) * (y - a.1) / (b.1 - a.1), y);
        let end = |p: (f64, f64)| match p.1 {
            y if y < low => at(low),
            y if y > high => at(high),
            _ => p,
        };
        if a.1.max(b.1) < low || a.1.min(b.1) > high {
            pieces.push(Vec::new());
            continue;
        }
        let (from, to) = (end(a), end(b));
        if let Some(piece) = pieces.last_mut() {
            if piece.last() != Some(&from) {
                piece.push(from);
            }
            piece.push(to);
        }
        if !inside(&b) {
            pieces.push(Vec::new());
        }
    }
    pieces.retain(|piece| !piece.is_empty());
    pieces
}

/// Text of a tick.
pub(crate) fn tick_label(tick: f64, scale: &Scale) -> String {
    if scale.logarithmic {
        let whole = tick.round();
        if (tick - whole).abs() < 1e-6 {
            return format!("10{}", superscript(whole as i32));
        }
        return format!("{:.1e}", 10_f64.powf(tick));
    }
    let Range { start, end } = scale.range();
    let decimals = (-((end - start) / TICKS).log10().floor()).max(0.0) as usize + 1;
    let text = format!("{tick:.decimals$}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text.is_empty() || text == "-0" || text == "-" { "0".into() } else { text.replace('-', "−") }
}

fn superscript(n: i32) -> String {
    let raised = |c: char| match c {
        '-' => '⁻',
        c => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][c.to_digit(10).unwrap_or(0) as usize],
    };
    n.to_string().chars().map(raised).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn linear(values: &[f64]) -> Scale {
        Scale::of(&ChartAxis::linear("F", "N"), values.iter().copied(), []).unwrap()
    }

    #[test]
    fn small_values_have_a_power_of_ten() {
        let scale = linear(&[0.0, 3e-6]);
        assert_eq!(scale.description(&ChartAxis::linear("F", "N")), "F in 10⁻⁶ N");
        assert_eq!(tick_label(2.5, &scale), "2.5");
        assert_eq!(tick_label(-1.0, &scale), "−1");
    }

    #[test]
    fn a_spike_is_cut_and_told() {
        let mut values = vec![1.0; 500];
        values.iter_mut().enumerate().for_each(|(i, v)| *v += i as f64 * 1e-3);
        values[0] = 1e4;
        let scale = linear(&values);
        assert_eq!(scale.beyond, Some([1.001, 1e4]));
        assert!(scale.range().end < 2.0);
        assert_eq!(linear(&[1.0, 2.0, 1e4]).beyond, None);
    }

    #[test]
    fn lines_end_at_the_range() {
        let points = [(0.0, 0.0), (1.0, 10.0), (2.0, 0.0), (3.0, 0.0)];
        let pieces = clipped(&points, [-1.0, 5.0]);
        assert_eq!(pieces, [vec![(0.0, 0.0), (0.5, 5.0)], vec![(1.5, 5.0), (2.0, 0.0), (3.0, 0.0)]]);
        assert!(clipped(&[(0.0, 9.0), (1.0, 9.0)], [0.0, 1.0]).is_empty());
    }

    #[test]
    fn thinned_lines_keep_their_peaks() {
        let mut points: Vec<(f64, f64)> = (0..100_000).map(|i| (f64::from(i), 0.0)).collect();
        points[31_234].1 = 7.0;
        let thin = thinned(&points);
        assert!(thin.len() < 4 * INTERVALS && thin.contains(&(31_234.0, 7.0)));
    }

    #[test]
    fn constants_and_nothing() {
        assert!(linear(&[2.0, 2.0]).range().contains(&2.0));
        assert!(linear(&[0.0]).range().contains(&0.0));
        assert!(Scale::of(&ChartAxis::linear("", ""), [f64::NAN].into_iter(), []).is_none());
    }
}
