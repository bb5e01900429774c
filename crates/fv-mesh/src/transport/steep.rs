//! What goes like 1/y² at distance y from a wall.
use super::CellTransport;
use crate::grid::GHOSTS;
use crate::neighbours::neighbour;
use interfaces::Equation;

/// 1/√φ changes by no more than this share of itself from a cell's centre to its faces.
const MOST: f64 = 0.6;

impl<const D: usize> CellTransport<D> {
    /// In the cells that `e` calls steep g = 1/√φ is linear from centre to centre instead of φ: of the diffusion through a face of such cells
    ///
    /// ```text
    /// −Γ A ∂φ/∂n = Γ A 2(g_N − g_P)/(d g_f³) = r Γ A (φ_P − φ_N)/d,   r = 2 g_P² g_N²/(g_f³ (g_P + g_N))
    /// ```
    ///
    /// is left, g_f linear between both, and what is consumed is the mean of g⁻⁴ over the cell, ∏ (1 + δ²/3)/(1 − δ²)³ over the axes, δ the change of g from
    /// the centre to a face over g. Both are exact for 1/y² across a wall, both are 1 + O(h²) where φ is smooth, and neither
    /// takes a coefficient its sign. Beside a wall along even cells differences of φ itself make the flux 1.8 times too large, and φ² at the
    /// centre of the second cell is a third less than its mean.
    ///
    /// Changes rows of the matrix whose diagonal, zero so far but for what sides bring, is still to be summed.
    pub(super) fn steepen(&mut self, e: &Equation<'_>, phi: &[f64]) {
        let Self { ops, matrix, volume, x: shares, fields: [gamma, ..], .. } = self;
        let (grid, metrics, gamma) = (ops.grid(), ops.metrics(), gamma.data());
        let (centre, lower, upper) = matrix.parts_mut();
        for &(cell, _) in e.steep {
            let at = grid.cell(cell);
            for (axis, up) in (0..D).flat_map(|a| [(a, false), (a, true)]) {
                if let Some(other) = neighbour(ops, at, axis, up) {
                    shares[other] = 0.0;
                }
            }
        }
        e.steep.iter().for_each(|&(cell, share)| shares[cell] = share);
        let g = |cell: usize| phi[cell].max(f64::MIN_POSITIVE).sqrt().recip();
        let strides = grid.stride();
        for &(cell, share) in e.steep {
            let (at, own) = (grid.cell(cell), g(cell));
            let mut mean = 1.0;
            for axis in 0..D {
                let mut ends = [None; 2];
                for up in [false, true] {
                    // What is shut lets nothing through.
                    let row = if up { &upper[axis] } else { &lower[axis] };
                    let Some(other) = neighbour(ops, at, axis, up).filter(|_| row[cell] != 0.0) else {
                        continue;
                    };
                    let face = at[axis] + usize::from(up);
                    let beyond = g(other);
                    let weights = metrics.axes[axis].share.each_ref().map(|s| s[GHOSTS + face]);
                    let [below, above] = if up { [own, beyond] } else { [beyond, own] };
                    let on_face = weights[1] * below + weights[0] * above;
                    ends[usize::from(up)] = Some(on_face);
                    // Between two steep cells once.
                    if up && shares[other] > 0.0 {
                        continue;
                    }
                    let r = 2.0 * (own * beyond).powi(2) / (on_face.powi(3) * (own + beyond));
                    let mut place = at;
                    place[axis] = face;
                    let o = grid.place(place);
                    let conductivity = weights[1] * gamma[o - strides[axis]] + weights[0] * gamma[o];
                    let part = 0.5 * (share + shares[other]);
                    let less = part * (1.0 - r) * conductivity * metrics.conductance(axis, place);
                    let (high, low) = if up { (other, cell) } else { (cell, other) };
                    lower[axis][high] += less;
                    upper[axis][low] += less;
                }
                let change = match ends {
                    [Some(low), Some(high)] => 0.5 * (high - low),
                    [Some(only), None] | [None, Some(only)] => only - own,
                    [None, None] => 0.0,
                };
                let square = (change / own).abs().min(MOST).powi(2);
                mean *= (1.0 + square / 3.0) / (1.0 - square).powi(3);
            }
            centre[cell] += share * (mean - 1.0) * e.sink[cell] * volume[cell];
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{Axis, CartesianGrid, CellTransport, Side, Sides, TransportParams, Velocity};
    use interfaces::{Equation, Transport};

    /// Largest relative error of φ = 6ν/(βy²), which νφ″ = βφ² has between walls' cells and the far end, whose φ are given; y from a face of the
    /// grid plus `gap`.
    fn error(axis: Axis, gap: f64, share: f64) -> f64 {
        let (nu, beta) = (1e-3, 0.075);
        let grid = CartesianGrid::from_axes([Axis::uniform(3, 0.0, 0.3).unwrap(), axis]).unwrap();
        let n = grid.n_cells();
        let sides = Sides::new([Side::Periodic.both(), Side::FreeSlip.both()]).unwrap();
        let params = TransportParams { tolerance: 1e-13, ..TransportParams::steady() };
        let mut cells = CellTransport::new(&grid, &sides, params).unwrap();
        let velocity = Velocity::zeros(&grid, &sides);
        let mut flow = cells.on(&velocity).unwrap();
        let exact = |i: usize| 6.0 * nu / (beta * (gap + grid.centre(grid.cell(i))[1]).powi(2));
        let pinned: Vec<_> = (0..3).chain(n - 3..n).map(|i| (i, exact(i))).collect();
        let steep: Vec<_> = (0..n).map(|i| (i, share)).collect();
        let (gamma, source) = (vec![nu; n], vec![0.0; n]);
        let mut phi: Vec<f64> = (0..n).map(|i| 1.3 * exact(i)).collect();
        for _ in 0..400 {
            let sink: Vec<f64> = phi.iter().map(|phi| beta * phi).collect();
            let e = Equation {
                pinned: &pinned,
                steep: &steep,
                relax: 0.8,
                ..Equation::new(&gamma, &source, &sink)
            };
            flow.solve(&e, &mut phi).unwrap();
        }
        (0..n).map(|i| (phi[i] / exact(i) - 1.0).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn what_goes_like_the_inverse_square_is_exact() {
        let even = || Axis::uniform(12, 0.0, 1.0).unwrap();
        let faces: Vec<f64> = (0..=12).map(|j| (1.2_f64.powi(j) - 1.0) / (1.2_f64.powi(12) - 1.0)).collect();
        let widening = || Axis::from_faces(faces.clone()).unwrap();
        for gap in [0.0, 0.03] {
            let errors = [error(even(), gap, 1.0), error(widening(), gap, 1.0)];
            assert!(errors.iter().all(|e| *e < 1e-9), "{errors:?}");
        }
        // Differences of φ itself: what was before.
        assert!(error(even(), 0.0, 0.0) > 0.2);
    }

    #[test]
    fn where_it_is_smooth_nothing_changes_to_second_order() {
        // φ = 2 + sin x on a periodic axis, −φ″ + φ = source.
        let off = |n: usize, share: f64| {
            let length = std::f64::consts::TAU;
            let grid = CartesianGrid::from_axes([
                Axis::uniform(n, 0.0, length).unwrap(),
                Axis::uniform(2, 0.0, 1.0).unwrap(),
            ])
            .unwrap();
            let sides = Sides::new(Side::Periodic.everywhere()).unwrap();
            let params = TransportParams { tolerance: 1e-12, ..TransportParams::steady() };
            let mut cells = CellTransport::new(&grid, &sides, params).unwrap();
            let velocity = Velocity::zeros(&grid, &sides);
            let mut flow = cells.on(&velocity).unwrap();
            let wave = |i: usize| grid.centre(grid.cell(i))[0].sin();
            let all = 0..2 * n;
            let (one, source): (Vec<f64>, Vec<f64>) = all.clone().map(|i| (1.0, 2.0 + 2.0 * wave(i))).unzip();
            let steep: Vec<_> = all.clone().map(|i| (i, share)).collect();
            let mut phi: Vec<f64> = all.clone().map(|i| 2.0 + wave(i)).collect();
            for _ in 0..30 {
                flow.solve(&Equation { steep: &steep, ..Equation::new(&one, &source, &one) }, &mut phi)
                    .unwrap();
            }
            all.map(|i| (phi[i] - 2.0 - wave(i)).abs()).fold(0.0, f64::max)
        };
        let (coarse, fine) = (off(16, 1.0), off(32, 1.0));
        assert!((3.5..4.6).contains(&(coarse / fine)), "{coarse} {fine}");
        assert!(off(16, 0.5) > off(16, 0.0));
    }
}
