//! The boundary conditions in −∇²φ = f: order of the solution.
use super::*;
use crate::linear::{CgParams, CgScratch, Jacobi, LinearOperator, conjugate_gradient};
use std::sync::Mutex;

/// φ = Π (2 + sin(w x + s)).
fn value(x: [f64; 3], d: usize) -> f64 {
    (0..d).map(|a| factor(a, 0, x[a])).product()
}
fn factor(a: usize, k: usize, x: f64) -> f64 {
    let (w, s) = ([1.6, -1.3, 1.4][a], [0.2, 0.6, -0.3][a]);
    let phase: f64 = w * x + s;
    w.powi(k as i32) * [2.0 + phase.sin(), phase.cos(), -phase.sin()][k]
}
fn slope(c: usize, x: [f64; 3], d: usize) -> f64 {
    (0..d).map(|a| factor(a, usize::from(a == c), x[a])).product()
}
fn laplacian(x: [f64; 3], d: usize) -> f64 {
    (0..d).map(|c| (0..d).map(|a| factor(a, 2 * usize::from(a == c), x[a])).product::<f64>()).sum()
}

/// What is given on the sides.
#[derive(Clone, Copy, Debug)]
enum Kind {
    Value,
    /// The gradient on all sides but one.
    Gradient,
    Mixed,
    /// The three on parts of every side.
    Patches,
}

fn side<const D: usize>(grid: &CartesianGrid<D>, kind: Kind, c: usize, upper: usize) -> ScalarSide {
    let sign = [-1.0, 1.0][upper];
    let (a, b) = (2.0, 0.7);
    let given = |f: fn([f64; 3], f64, usize, usize) -> f64| Given::function(move |x, _| f(x, sign, c, D));
    match kind {
        Kind::Gradient if c == 0 && upper == 0 => ScalarSide::Value(given(|x, _, _, d| value(x, d))),
        Kind::Value => ScalarSide::Value(given(|x, _, _, d| value(x, d))),
        Kind::Gradient => ScalarSide::Gradient(given(|x, sign, c, d| sign * slope(c, x, d))),
        Kind::Mixed => ScalarSide::Mixed {
            a,
            b,
            c: given(|x, sign, c, d| 2.0 * value(x, d) + 0.7 * sign * slope(c, x, d)),
        },
        Kind::Patches => {
            let across = usize::from(c == 0);
            let patch = |from: f64, to: f64, kind: Kind| {
                let (mut lower, mut upper_corner) = ([-1.0; 3], [2.0; 3]);
                (lower[across], upper_corner[across]) = (from, to);
                ScalarPatch { lower, upper: upper_corner, side: side(grid, kind, c, upper) }
            };
            // The ends lie on faces, at the same places on all grids of a family.
            let axis = grid.axis(across);
            let end = |quarters: usize| axis.faces()[quarters * axis.cells() / 4];
            let patches = vec![
                patch(end(0), end(1), Kind::Value),
                patch(end(1), end(2), Kind::Mixed),
                patch(end(2), end(4), Kind::Gradient),
            ];
            ScalarSide::Patches(patches)
        }
    }
}

/// −V L with the boundary values left out; symmetric.
struct Negative<const D: usize> {
    ops: Operators<D>,
    boundaries: ScalarBoundaries<D>,
    /// What the boundary values give with φ = 0.
    given: Vec<f64>,
    volume: Vec<f64>,
    work: Mutex<[Field<D>; 2]>,
}

impl<const D: usize> Negative<D> {
    fn affine(&self, x: &[f64], y: &mut [f64]) {
        let mut work = self.work.lock().unwrap();
        let [phi, out] = &mut *work;
        crate::kernels::copy_dense(self.ops.grid(), x, phi);
        self.boundaries.fill(phi).unwrap();
        self.ops.laplacian(1.0, phi, out).unwrap();
        for ((y, l), volume) in y.iter_mut().zip(out.values()).zip(&self.volume) {
            *y = -l * volume;
        }
    }
}

impl<const D: usize> LinearOperator for Negative<D> {
    fn n(&self) -> usize {
        self.given.len()
    }
    fn apply(&self, x: &[f64], y: &mut [f64]) {
        self.affine(x, y);
        y.iter_mut().zip(&self.given).for_each(|(y, g)| *y -= g);
    }
}

fn solution_error<const D: usize>(family: Family, kind: Kind, n: usize) -> [f64; 2] {
    let grid: CartesianGrid<D> = family.grid(n);
    let sides = std::array::from_fn(|c| [0, 1].map(|upper| side(&grid, kind, c, upper)));
    let boundaries = ScalarBoundaries::new(&grid, sides).unwrap();
    let ops = Operators::new(&grid, boundaries.periodic());
    let cells = grid.n_cells();
    let volume = (0..cells).map(|i| grid.cell_volume(grid.cell(i))).collect();
    let work = Mutex::new([Field::zeros(&grid), Field::zeros(&grid)]);
    let mut a = Negative { ops, boundaries, given: vec![0.0; cells], volume, work };
    let mut given = vec![0.0; cells];
    a.affine(&vec![0.0; cells], &mut given);
    a.given = given;
    let place = |x: [f64; D]| std::array::from_fn(|b| if b < D { x[b] } else { 0.0 });
    let b: Vec<f64> = (0..cells)
        .map(|i| {
            let cell = grid.cell(i);
            -laplacian(place(grid.centre(cell)), D) * grid.cell_volume(cell) - a.given[i]
        })
        .collect();
    // A rough diagonal will do.
    let diagonal: Vec<f64> = (0..cells)
        .map(|i| {
            let (cell, v) = (grid.cell(i), grid.cell_volume(grid.cell(i)));
            (0..D).map(|a| 2.0 * v / grid.axis(a).width(cell[a]).powi(2)).sum()
        })
        .collect();
    let mut jacobi = Jacobi::new(&diagonal).unwrap();
    let mut x = vec![1.0; cells];
    let params = CgParams { relative: 1e-11, ..CgParams::default() };
    conjugate_gradient(&a, &mut jacobi, &b, &mut x, &mut CgScratch::new(cells), &params).unwrap();
    let mut values = x.iter();
    let mut found = Field::zeros(&grid);
    found.set(|_| *values.next().unwrap());
    norms(&found, &Field::from_fn(&grid, |x| value(place(x), D)), |_| 1.0)
}

#[test]
fn solutions_are_of_second_order_with_every_condition() {
    for &family in families(2) {
        for kind in [Kind::Value, Kind::Gradient, Kind::Mixed, Kind::Patches] {
            let errors = [20, 40].map(|n| solution_error::<2>(family, kind, n));
            assert_order(&format!("{family:?} 2-D {kind:?}"), errors[0], errors[1], 2.0);
        }
    }
    for &family in families(3) {
        for kind in [Kind::Value, Kind::Gradient, Kind::Mixed] {
            let errors = [12, 24].map(|n| solution_error::<3>(family, kind, n));
            assert_order(&format!("{family:?} 3-D {kind:?}"), errors[0], errors[1], 2.0);
        }
    }
}

#[test]
fn ghosts_meet_the_condition_on_the_side() {
    let grid = CartesianGrid::new([4, 3], [2.0, 0.6]).unwrap();
    let mixed = ScalarSide::Mixed { a: 0.3, b: 1.1, c: 2.0.into() };
    let sides =
        [[ScalarSide::value(5.0), ScalarSide::Gradient((-2.0).into())], [mixed, ScalarSide::flux(3.0, 0.5)]];
    let boundaries = ScalarBoundaries::new(&grid, sides).unwrap();
    let mut phi = Field::from_fn(&grid, |x| x[0] * 7.0 + x[1] * x[1]);
    boundaries.fill(&mut phi).unwrap();
    let (d, s, base) = (phi.data(), grid.stride(), grid.base());
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
    for j in 0..3 {
        let o = base + j * s[1];
        near(0.5 * (d[o - 1] + d[o]), 5.0);
        near(0.5 * (d[o - 2] + d[o + 1]), 5.0);
        near((d[o + 4] - d[o + 3]) / 0.5, -2.0);
        near((d[o + 5] - d[o + 2]) / 1.5, -2.0);
    }
    for o in base..base + 4 {
        let (ghost, inside) = (d[o - s[1]], d[o]);
        near(0.3 * 0.5 * (ghost + inside) + 1.1 * (ghost - inside) / 0.2, 2.0);
        let (ghost, inside) = (d[o - 2 * s[1]], d[o + s[1]]);
        near(0.3 * 0.5 * (ghost + inside) + 1.1 * (ghost - inside) / 0.6, 2.0);
        near((d[o + 3 * s[1]] - d[o + 2 * s[1]]) / 0.2, 6.0);
    }
}

#[test]
fn impossible_conditions_are_errors() {
    let grid = CartesianGrid::new([4, 3], [1.0; 2]).unwrap();
    let patch = |to: f64, side: ScalarSide| {
        ScalarSide::Patches(vec![ScalarPatch { lower: [0.0; 3], upper: [to; 3], side }])
    };
    let bad = [
        ScalarSide::Periodic,
        ScalarSide::value(f64::NAN),
        ScalarSide::flux(1.0, 0.0),
        ScalarSide::Mixed { a: 0.0, b: 0.0, c: 1.0.into() },
        ScalarSide::Mixed { a: 1.0, b: -0.1, c: 1.0.into() },
        patch(0.5, ScalarSide::NO_GRADIENT),
        patch(1.0, ScalarSide::Periodic),
        patch(1.0, patch(1.0, ScalarSide::NO_GRADIENT)),
    ];
    for side in bad {
        let sides = [[side.clone(), ScalarSide::NO_GRADIENT], ScalarSide::NO_GRADIENT.both()];
        let error = ScalarBoundaries::new(&grid, sides).map(|_| ());
        assert!(matches!(error, Err(crate::FlowError::Boundary { .. })), "{side:?}");
    }
    assert!(
        ScalarBoundaries::new(
            &grid,
            [patch(1.0, ScalarSide::value(1.0)).both(), ScalarSide::Periodic.both()]
        )
        .is_ok()
    );
}
