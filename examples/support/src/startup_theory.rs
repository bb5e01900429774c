//! How discs start to fall from rest: unsteady Stokes flow, before convection and displacement matter.
//!
//! In Laplace space (rate s) a disc of radius r in a flow that would be V at its place without it moves as
//!
//! ```text
//! ρs s U = (ρs − ρf) g / s + ρf s V + ρf C s (V − U),   C = 1 + 4 K₁(z) / (z K₀(z)),   z = r √(s/ν)
//! ```
//!
//! (Stokes 1851). Beyond its boundary layer, of a few √(νt), it disturbs the flow as the potential dipole
//! r² (1 + C)/2 (U − V), so that V at a disc is the sum over the dipoles of the others and of all periodic
//! images. The net weight is balanced by a uniform force on fluid and solid that keeps their mean velocity zero;
//! the sum over the images is taken so. Neglected: convection, displacement, and the variation of V across a disc,
//! of the relative order (r/distance)⁴.

use std::f64::consts::PI;

use num_complex::Complex64;

/// The fluid at rest; gravity points along −y.
#[derive(Clone, Copy, Debug)]
pub struct Fluid {
    /// kg/m³.
    pub density: f64,
    /// Kinematic viscosity in m²/s.
    pub viscosity: f64,
    /// m/s².
    pub gravity: f64,
}

/// A disc released at time zero.
#[derive(Clone, Copy, Debug)]
pub struct Released {
    /// Centre in metres.
    pub centre: [f64; 2],
    /// Metres.
    pub radius: f64,
    /// kg/m³.
    pub density: f64,
}

/// Speeds in m/s at time `t` after the release, in the doubly periodic box of the given sides or, without one,
/// in unbounded fluid.
pub fn startup_speed(t: f64, discs: &[Released], fluid: &Fluid, sides: Option<[f64; 2]>) -> Vec<f64> {
    startup_velocity(t, discs, fluid, sides).into_iter().map(|[u, v]| u.hypot(v)).collect()
}

/// Velocities in m/s; see [`startup_speed`].
fn startup_velocity(t: f64, discs: &[Released], fluid: &Fluid, sides: Option<[f64; 2]>) -> Vec<[f64; 2]> {
    /// Points of the quadrature: the error falls as 3.9^(−points), rounding grows as e^(0.17 points).
    const POINTS: usize = 28;
    let mut velocities = vec![[0.0; 2]; discs.len()];
    if t <= 0.0 {
        return velocities;
    }
    let tensors = dipole_tensors(discs, sides);
    // Talbot's contour with the constants of Trefethen, Weideman and Schmelzer (BIT 46, 2006); its lower half
    // is the mirror image of the upper one.
    for point in 0..POINTS / 2 {
        let angle = (2 * point + 1) as f64 * PI / POINTS as f64;
        let (cot, turn) = (1.0 / (0.6407 * angle).tan(), 0.6407 * angle);
        let place = Complex64::new(0.5017 * angle * cot - 0.6122, 0.2645 * angle) * POINTS as f64;
        let slope = Complex64::new(0.5017 * cot - 0.5017 * turn / turn.sin().powi(2), 0.2645) * POINTS as f64;
        let weight = place.exp() * slope * (2.0 / (POINTS as f64 * t));
        for (velocity, image) in velocities.iter_mut().zip(transformed(place / t, discs, fluid, &tensors)) {
            for axis in 0..2 {
                velocity[axis] += (weight * image[axis]).im;
            }
        }
    }
    velocities
}

/// The velocities' Laplace transforms at rate `s`.
fn transformed(
    s: Complex64,
    discs: &[Released],
    fluid: &Fluid,
    tensors: &[Vec<[[f64; 2]; 2]>],
) -> Vec<[Complex64; 2]> {
    let size = 2 * discs.len();
    let kernels: Vec<Complex64> = discs
        .iter()
        .map(|disc| {
            let z = (s / fluid.viscosity).sqrt() * disc.radius;
            1.0 + 4.0 * bessel_ratio(z) / z
        })
        .collect();
    // Ambient velocities V = T W, where W = U − V are the unknowns of
    // (ρs + ρf C) s W + (ρs − ρf) s V = (ρs − ρf) g / s.
    let induced = |row: usize, column: usize| {
        let (disc, kernel) = (&discs[column / 2], kernels[column / 2]);
        0.5 * disc.radius.powi(2) * (1.0 + kernel) * tensors[row / 2][column / 2][row % 2][column % 2]
    };
    let mut system = vec![vec![Complex64::ZERO; size + 1]; size];
    for (row, line) in system.iter_mut().enumerate() {
        let excess = discs[row / 2].density - fluid.density;
        for column in 0..size {
            line[column] = excess * s * induced(row, column);
        }
        line[row] += (discs[row / 2].density + fluid.density * kernels[row / 2]) * s;
        if row % 2 == 1 {
            line[size] = -excess * fluid.gravity / s;
        }
    }
    let relative = solve(system);
    let velocity =
        |row: usize| relative[row] + (0..size).map(|k| induced(row, k) * relative[k]).sum::<Complex64>();
    (0..discs.len()).map(|disc| [velocity(2 * disc), velocity(2 * disc + 1)]).collect()
}

/// What the dipole of unit strength of each disc (second index) and its images induce at each disc (first).
fn dipole_tensors(discs: &[Released], sides: Option<[f64; 2]>) -> Vec<Vec<[[f64; 2]; 2]>> {
    let between = |i: usize, j: usize| {
        let [x, y] = [0, 1].map(|axis| discs[i].centre[axis] - discs[j].centre[axis]);
        // With f the sum of 1/(x + iy)² over all images, the tensor is [[Re f, −Im f], [−Im f, −Re f]] plus the
        // mean flow.
        let (f, mean) = match sides {
            Some(sides) => lattice(x, y, sides, i == j),
            None if i == j => (Complex64::ZERO, 0.0),
            None => (Complex64::new(x, y).powi(-2), 0.0),
        };
        [[f.re - mean, -f.im], [-f.im, -f.re]]
    };
    (0..discs.len()).map(|i| (0..discs.len()).map(|j| between(i, j)).collect()).collect()
}

/// The sum of 1/(x + iy)² over all periodic images, row by row: along x in closed form, over the rows exponentially
/// convergent; without the disc itself if `own`. The order of this conditionally convergent sum decides on the mean
/// flow: of rows on top of each other it is zero along y, and along x it is what the second value takes off.
fn lattice(x: f64, y: f64, [width, height]: [f64; 2], own: bool) -> (Complex64, f64) {
    let y = y - height * (y / height).round();
    let rows = (3.0 + 6.0 * width / height).ceil() as i32;
    let unit = PI / width;
    let row = |k: i32| {
        let place = Complex64::new(x, y - f64::from(k) * height) * unit;
        if own && k == 0 { Complex64::from(1.0 / 3.0) } else { place.sin().powi(-2) }
    };
    ((-rows..=rows).map(row).sum::<Complex64>() * unit * unit, 2.0 * PI / (width * height))
}

/// K₁(z)/K₀(z) for Re z ≥ 0, z ≠ 0: power series near the origin, Temme's continued fraction elsewhere.
fn bessel_ratio(z: Complex64) -> Complex64 {
    /// Euler's constant.
    const GAMMA: f64 = 0.577_215_664_901_532_9;
    if z.norm() < 2.0 {
        let quarter = 0.25 * z * z;
        let (mut term, mut harmonic) = (Complex64::ONE, 0.0);
        let (mut i0, mut i1, mut rest) = (Complex64::ONE, Complex64::ONE, Complex64::ZERO);
        for k in 1..=16 {
            let k = f64::from(k);
            term *= quarter / (k * k);
            harmonic += 1.0 / k;
            (i0, i1, rest) = (i0 + term, i1 + term / (k + 1.0), rest + term * harmonic);
        }
        let k0 = rest - ((0.5 * z).ln() + GAMMA) * i0;
        // The Wronskian: I₀ K₁ + I₁ K₀ = 1/z.
        (1.0 / z - 0.5 * z * i1 * k0) / (i0 * k0)
    } else {
        // K₁/K₀ = (z + 1/2 − (1/4)/(b₁ − (9/4)/(b₂ − (25/4)/(b₃ − …)))) / z with b_n = 2 (z + n), from the end.
        let terms = 12 + (120.0 / z.norm()) as i32;
        let tail = (1..=terms).rev().fold(Complex64::ZERO, |tail, n| {
            let odd = f64::from(n) - 0.5;
            odd * odd / (2.0 * (z + f64::from(n)) - tail)
        });
        (z + 0.5 - tail) / z
    }
}

/// Gaussian elimination with row pivoting; the last column is the right-hand side.
fn solve(mut system: Vec<Vec<Complex64>>) -> Vec<Complex64> {
    let size = system.len();
    for pivot in 0..size {
        let best = (pivot..size).max_by(|&a, &b| system[a][pivot].norm().total_cmp(&system[b][pivot].norm()));
        system.swap(pivot, best.unwrap_or(pivot));
        let (above, below) = system.split_at_mut(pivot + 1);
        for row in below {
            let factor = row[pivot] / above[pivot][pivot];
            for column in pivot..=size {
                row[column] -= factor * above[pivot][column];
            }
        }
    }
    let mut solution = vec![Complex64::ZERO; size];
    for row in (0..size).rev() {
        let known: Complex64 = (row + 1..size).map(|k| system[row][k] * solution[k]).sum();
        solution[row] = (system[row][size] - known) / system[row][row];
    }
    solution
}

#[cfg(test)]
mod tests {
    use super::*;

    const WATER: Fluid = Fluid { density: 1000.0, viscosity: 1e-6, gravity: 9.81 };
    const BOX: Option<[f64; 2]> = Some([0.01, 0.02]);

    fn pair() -> [Released; 2] {
        let disc = |x: f64, y: f64, density| Released { centre: [x, y], radius: 0.5e-3, density };
        [disc(0.005, 0.016, 1060.0), disc(0.00505, 0.0135, 1030.0)]
    }

    fn close(value: f64, expected: f64, tolerance: f64) {
        assert!((value / expected - 1.0).abs() < tolerance, "{value:e} is not {expected:e}");
    }

    #[test]
    fn bessel_functions_are_right_in_the_half_plane() {
        // (|z|, arg z in degrees, K₁/K₀) by mpmath.
        let table = [
            (0.05, 0.0, 6.393120792292588, 0.0),
            (0.05, 80.0, 3.291418942641225, -4.884598574046094),
            (1.999, 0.0, 1.22814292349426, 0.0),
            (1.999, 80.0, 1.063061407959328, -0.229780760753839),
            (2.001, 0.0, 1.227931035918984, 0.0),
            (2.001, 45.0, 1.172009402464037, -0.1541540465049682),
            (2.001, 80.0, 1.062986981106833, -0.2295684785193424),
            (6.0, 80.0, 1.017370859293509, -0.0804905829097151),
            (60.0, 45.0, 1.00589216200631, -0.005858243145206382),
        ];
        for (radius, degrees, re, im) in table {
            let ratio = bessel_ratio(Complex64::from_polar(radius, f64::to_radians(degrees)));
            let error = (ratio - Complex64::new(re, im)).norm() / ratio.norm();
            assert!(error < 1e-11, "{radius} {degrees}: {ratio}, {error:e}");
        }
    }

    #[test]
    fn a_disc_alone_starts_as_published() {
        for (disc, early, late) in [(0, 1.170e-3, 5.376e-3), (1, 5.919e-4, 2.712e-3)] {
            for (t, expected) in [(0.005, early), (0.03, late)] {
                close(startup_speed(t, &pair()[disc..=disc], &WATER, None)[0], expected, 3e-4);
            }
        }
    }

    #[test]
    fn the_table_of_the_box_is_met() {
        let table = include_str!("../../../tests/data/startup_two_discs.csv");
        let rows = table.lines().filter(|line| line.starts_with("0."));
        let rows: Vec<Vec<f64>> = rows.map(|l| l.split(',').map(|v| v.parse().unwrap()).collect()).collect();
        assert_eq!(rows.len(), 30);
        for row in rows {
            let both = startup_speed(row[0], &pair(), &WATER, BOX);
            let alone = [0, 1].map(|k| startup_speed(row[0], &pair()[k..=k], &WATER, BOX)[0]);
            for (value, expected) in both.iter().chain(&alone).zip(&row[1..]) {
                close(*value, *expected, 1e-9);
            }
        }
    }

    #[test]
    fn the_lattice_knows_no_preferred_axis() {
        // A disc's own images in a square box.
        let (f, mean) = lattice(0.0, 0.0, [1.0, 1.0], true);
        assert!((2.0 * f.re - mean).abs() < 1e-12, "{f}");
        // A box and its reflection.
        let (f, mean) = lattice(0.3, 0.1, [1.0, 2.0], false);
        let (turned, turned_mean) = lattice(0.1, 0.3, [2.0, 1.0], false);
        assert!((f.re - mean + turned.re).abs() < 1e-10, "{f} {turned}");
        assert!((f.im - turned.im).abs() < 1e-10 && mean == turned_mean, "{f} {turned}");
    }

    #[test]
    fn nothing_moves_at_the_release() {
        assert_eq!(startup_speed(0.0, &pair(), &WATER, BOX), [0.0, 0.0]);
        // At first a disc accelerates freely: (ρs − ρf) g / (ρs + ρf).
        let speed = startup_speed(1e-9, &pair()[..1], &WATER, None)[0];
        close(speed / 1e-9, 60.0 * 9.81 / 2060.0, 1e-3);
    }
}
