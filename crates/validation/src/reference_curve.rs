//! Curves that others published, and how far a computed one is from them.

/// Rows of two numbers, separated by a comma or blanks; lines that begin with # are comments.
pub fn read(text: &str) -> Vec<(f64, f64)> {
    let row = |line: &str| {
        let mut numbers = line.split([',', ' ', ';']).filter(|v| !v.is_empty()).map(str::parse);
        Some((numbers.next()?.ok()?, numbers.next()?.ok()?))
    };
    text.lines().filter(|line| !line.starts_with('#')).filter_map(row).collect()
}

/// The value of a curve, straight between its points; `None` before the first and after the last.
pub fn at(curve: &[(f64, f64)], x: f64) -> Option<f64> {
    let after = curve.partition_point(|p| p.0 < x);
    let (b, a) = (*curve.get(after)?, curve[after.saturating_sub(1)]);
    if after == 0 {
        return (x == b.0).then_some(b.1);
    }
    Some(a.1 + (b.1 - a.1) * (x - a.0) / (b.0 - a.0))
}

/// How far a computed curve is from published points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Distance {
    /// Largest difference.
    pub largest: f64,
    /// Where.
    pub at: f64,
    /// Root mean square.
    pub rms: f64,
    /// Points compared.
    pub points: usize,
}

impl Distance {
    /// Over those `points` for which `which` says so and where there is a computed value.
    pub fn between(computed: &[(f64, f64)], points: &[(f64, f64)], which: impl Fn(f64) -> bool) -> Self {
        let mut distance = Self::default();
        for &(x, y) in points.iter().filter(|p| which(p.0)) {
            let Some(ours) = at(computed, x) else { continue };
            let off = (ours - y).abs();
            if off > distance.largest {
                (distance.largest, distance.at) = (off, x);
            }
            distance.rms += off * off;
            distance.points += 1;
        }
        distance.rms = (distance.rms / distance.points.max(1) as f64).sqrt();
        distance
    }
}

/// When a curve first passes `level`, straight between its points.
pub fn passes(curve: &[(f64, f64)], level: f64) -> Option<f64> {
    let pair = curve.windows(2).find(|p| (p[0].1 - level) * (p[1].1 - level) <= 0.0 && p[0].1 != p[1].1)?;
    let [a, b] = [pair[0], pair[1]];
    Some(a.0 + (level - a.1) / (b.1 - a.1) * (b.0 - a.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_is_read_and_compared() {
        let points = read("# of a line\n0,1\n1 3.5\n9,0\n");
        assert_eq!(points, [(0.0, 1.0), (1.0, 3.5), (9.0, 0.0)]);
        let line = [(0.0, 1.0), (2.0, 5.0)];
        assert_eq!((at(&line, 0.0), at(&line, 0.5), at(&line, 2.1)), (Some(1.0), Some(2.0), None));
        let distance = Distance::between(&line, &points, |_| true);
        assert_eq!((distance.largest, distance.at, distance.points), (0.5, 1.0, 2));
        assert_eq!(distance.rms, (0.125_f64).sqrt());
        assert_eq!(passes(&line, 4.0), Some(1.5));
        assert_eq!(passes(&line, 6.0), None);
    }
}
