//! How much too steep differences find a logarithmic layer.
use super::near_solids::NEAREST;
use crate::least_squares::norm2;
use crate::{CartesianGrid, Velocity};
use interfaces::LogSlope;

/// Cells farther than so many of their extents from a wall are left alone: 2 % too steep there.
const FARTHEST: f64 = 4.5;

/// Cells beside an immersed wall in a layer u = (u_τ/κ) ln y + const. |S| by [`strain_rate`](interfaces::Transport::strain_rate) is
/// u_τ/(κy) times the root of
///
/// ```text
/// Σ_a 2 (t_a n_a ρ_aa)² + Σ_(a<b) (t_a n_b ρ_ab + t_b n_a ρ_ba)²,   ρ_ab = y (∂ ln y/∂x_b)/n_b by the differences of component a,
/// ```
///
/// n the normal and t the direction of the flow along the wall; it should be 1. A node nearer than half a cell has the velocity at the
/// middle of what the wall leaves of its cell.
#[derive(Clone, Debug)]
pub(super) struct LogSlopes<const D: usize> {
    cells: Vec<Cell<D>>,
    slopes: Vec<LogSlope>,
}

#[derive(Clone, Debug)]
struct Cell<const D: usize> {
    /// Storage index.
    place: usize,
    normal: [f64; D],
    /// ρ_ab.
    ratios: [[f64; D]; D],
}

/// ln y as nodes of cells of extent 1 have it.
fn seen(y: f64) -> f64 {
    match y {
        y if y >= 0.5 => y.ln(),
        y if y >= 0.0 => (0.5 * y + 0.25).ln(),
        // In the solid the velocity goes on in a straight line.
        y => 0.25_f64.ln() + 2.0 * y,
    }
}

impl<const D: usize> LogSlopes<D> {
    /// From cells, their widths, and the distance of the nearest wall and its gradient there.
    pub(super) fn new(
        grid: &CartesianGrid<D>,
        cells: impl Iterator<Item = (usize, [f64; D], f64, [f64; D])>,
    ) -> Self {
        let mut new = Self { cells: Vec::new(), slopes: Vec::new() };
        for (cell, width, distance, slope) in cells {
            let norm = norm2(&slope).sqrt();
            let normal = slope.map(|s| s / norm);
            let extent: f64 = (0..D).map(|a| normal[a].abs() * width[a]).sum();
            let y = distance / extent;
            if !(NEAREST..=FARTHEST).contains(&y) {
                continue;
            }
            let up = |a: usize| normal[a].abs() * width[a] / extent;
            // Between the two faces of a cell, or between the means over those of the cells on either side.
            let ratio = |a: usize, b: usize| {
                let (step, aside) = if a == b { (0.5 * up(a), 0.0) } else { (up(b), 0.5 * up(a)) };
                let rise = |y: f64| seen(y + step) - seen(y - step);
                if step > 1e-6 { y * (rise(y - aside) + rise(y + aside)) / (4.0 * step) } else { 1.0 }
            };
            let ratios = std::array::from_fn(|a| std::array::from_fn(|b| ratio(a, b)));
            new.cells.push(Cell { place: grid.place(grid.cell(cell)), normal, ratios });
            new.slopes.push(LogSlope { cell, distance, part: 1.0 });
        }
        new
    }

    /// For this flow.
    pub(super) fn update(&mut self, grid: &CartesianGrid<D>, velocity: &Velocity<D>) -> &[LogSlope] {
        let s = grid.stride();
        for (cell, slope) in self.cells.iter().zip(&mut self.slopes) {
            let Cell { normal: n, ratios, .. } = cell;
            let mut t: [f64; D] = std::array::from_fn(|a| {
                let u = velocity.components[a].data();
                0.5 * (u[cell.place] + u[cell.place + s[a]])
            });
            let through: f64 = (0..D).map(|a| t[a] * n[a]).sum();
            (0..D).for_each(|a| t[a] -= through * n[a]);
            let mut found = 0.0;
            for a in 0..D {
                found += 2.0 * (t[a] * n[a] * ratios[a][a]).powi(2);
                for b in 0..a {
                    found += (t[a] * n[b] * ratios[a][b] + t[b] * n[a] * ratios[b][a]).powi(2);
                }
            }
            let given = norm2(&t);
            slope.part = if found > given { (given / found).sqrt() } else { 1.0 };
        }
        &self.slopes
    }
}

#[cfg(test)]
mod tests {
    use crate::metrics::Metrics;
    use crate::operators::tests::exact_velocity;
    use crate::transport::CellTransport;
    use crate::{CartesianGrid, Side, Sides, TransportParams};
    use interfaces::Transport;

    /// The largest deviations of |S| y κ/u_τ from 1 one to four cells before a plane wall with this normal, of the part left and of all,
    /// in a flow along `t`.
    fn deviations<const D: usize>(cells: usize, normal: [f64; 3], t: [f64; 3]) -> [f64; 2] {
        let h = 1.0 / cells as f64;
        let grid = CartesianGrid::<D>::new([cells; D], [1.0; D]).unwrap();
        let sides = Sides::new(Side::FreeSlip.everywhere()).unwrap();
        let height = |x: [f64; D]| (0..D).map(|a| normal[a] * (x[a] - 0.5)).sum::<f64>();
        let metrics = Metrics::new(&grid, [false; D]);
        let velocity =
            exact_velocity(&grid, &metrics, |x| std::array::from_fn(|a| t[a] * height(x).max(0.1 * h).ln()));
        let centre = |i: usize| grid.centre(grid.cell(i));
        let n = grid.n_cells();
        let mut transport = CellTransport::new(&grid, &sides, TransportParams::steady()).unwrap();
        for (i, y) in transport.wall_distance_mut().iter_mut().enumerate() {
            *y = height(centre(i)).max(0.0);
        }
        let dry = (0..n).filter(|&i| height(centre(i)) <= 0.0);
        transport.set_walls(dry.map(|i| (i, Vec::new())).collect(), false);
        let mut strain = vec![0.0; n];
        let mut on = transport.on(&velocity).unwrap();
        on.strain_rate(&mut strain).unwrap();
        let extent: f64 = normal[..D].iter().map(|n| n.abs() * h).sum();
        let mut worst = [0.0; 2];
        for slope in on.log_slopes() {
            let inner = grid.cell(slope.cell).iter().all(|&k| (2..cells - 2).contains(&k));
            if inner && (1.55 * extent..4.0 * extent).contains(&slope.distance) {
                assert!(slope.part > 0.5 && slope.part <= 1.0);
                let all = strain[slope.cell] * slope.distance;
                for (worst, seen) in worst.iter_mut().zip([slope.part * all, all]) {
                    *worst = f64::max(*worst, (seen - 1.0).abs());
                }
            }
        }
        worst
    }

    #[test]
    fn a_logarithmic_layer_has_its_slope_at_any_angle() {
        // At 45° two differences over two cells cancel each other.
        let least = |degrees: i32| if degrees == 45 { 0.005 } else { 0.02 };
        for degrees in [0, 10, 30, 45, 75, 105, 150, 200, 260, 340] {
            let (s, c) = f64::from(degrees).to_radians().sin_cos();
            let [part, all] = deviations::<2>(30, [-s, c, 0.0], [c, s, 0.0]);
            assert!(part < 1e-10 && all > least(degrees), "{degrees}: {part:e}, {all}");
        }
        let (third, half) = (3.0_f64.sqrt().recip(), 0.5_f64.sqrt());
        let oblique = [
            ([third; 3], [half, -half, 0.0]),
            ([0.36, 0.48, 0.8], [0.8, -0.6, 0.0]),
            ([0.36, 0.48, 0.8], [-0.48, -0.64, 0.6]),
        ];
        for (normal, t) in oblique {
            let [part, all] = deviations::<3>(20, normal, t);
            // The direction of the flow is that of means over faces.
            assert!(part < 1e-5 && all > 0.005, "{normal:?}, {t:?}: {part:e}, {all}");
        }
    }
}
