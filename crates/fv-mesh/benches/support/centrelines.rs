//! The lid-driven cavity's centrelines, against the tables of Ghia, Ghia & Shin (1982).
use fv_mesh::{CartesianGrid, Sampler, Sides, Velocity};

/// u along the vertical (`c` 0) or v along the horizontal (1) centreline of the unit box at the nodes, the sides included.
pub(crate) fn centreline(
    grid: &CartesianGrid<2>,
    sides: &Sides<2>,
    velocity: &Velocity<2>,
    c: usize,
) -> Vec<(f64, f64)> {
    let sampler = Sampler::new(grid, sides);
    let mut line = vec![(0.0, 0.0)];
    for i in 0..grid.cells()[1 - c] {
        let s = grid.axis(1 - c).centre(i);
        let at = if c == 0 { [0.5, s] } else { [s, 0.5] };
        line.push((s, sampler.velocity(velocity, at).map_or(f64::NAN, |u| u[c])));
    }
    line.push((1.0, if c == 0 { 1.0 } else { 0.0 }));
    line
}

/// The cubic through the four points of `line` around `s`.
pub(crate) fn cubic(line: &[(f64, f64)], s: f64) -> f64 {
    let after = line.partition_point(|p| p.0 < s).clamp(2, line.len() - 2);
    let points = &line[after - 2..after + 2];
    (0..4)
        .map(|i| {
            let basis = (0..4).filter(|&j| j != i).map(|j| (s - points[j].0) / (points[i].0 - points[j].0));
            points[i].1 * basis.product::<f64>()
        })
        .sum()
}

/// The largest deviation of component `c` on its centreline from the table at Reynolds number 100, 400 or 1000, in lid
/// speeds; not a number for another one.
pub(crate) fn deviation(line: &[(f64, f64)], c: usize, reynolds: f64) -> f64 {
    let table = include_str!("../../tests/data/ghia_1982_centrelines.csv");
    let Some(column) = [100.0, 400.0, 1000.0].iter().position(|&re| re == reynolds) else { return f64::NAN };
    let mut worst = 0.0_f64;
    for row in table.lines().map(|l| l.split(',').collect::<Vec<_>>()).filter(|f| f[0] == ["u", "v"][c]) {
        let (Ok(s), Ok(ghia)) = (row[1].parse::<f64>(), row[2 + column].parse::<f64>()) else { continue };
        // A misprint at Re 400.
        if !(c == 1 && s == 0.9063) {
            worst = worst.max((cubic(line, s) - ghia).abs());
        }
    }
    worst
}
