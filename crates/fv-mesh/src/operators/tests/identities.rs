//! What holds to round-off on any grid and for any field.
use super::*;
use crate::operators::Operators;
use crate::{Convection, ScalarBoundaries, ScalarSide};
use proptest::prelude::*;

/// Numbers in −1 … 1 that depend on `seed` alone.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (z ^ (z >> 31)) as f64 / (u64::MAX as f64) * 2.0 - 1.0
    }
    fn grid<const D: usize>(&mut self, cells: [usize; D]) -> CartesianGrid<D> {
        let axes = cells.map(|n| {
            let mut faces = vec![0.0];
            for i in 0..n {
                faces.push(faces[i] + 1.0 + 0.8 * self.next());
            }
            Axis::from_faces(faces).unwrap()
        });
        CartesianGrid::from_axes(axes).unwrap()
    }
    fn field<const D: usize>(&mut self, grid: &CartesianGrid<D>) -> Field<D> {
        let mut field = Field::zeros(grid);
        field.data_mut().iter_mut().for_each(|v| *v = self.next());
        field
    }
}

/// Σ V a b and the size of its terms.
fn dot<const D: usize>(a: &Field<D>, b: &Field<D>) -> (f64, f64) {
    let grid = a.grid();
    a.values().zip(b.values()).enumerate().fold((0.0, 0.0), |(sum, size), (i, (a, b))| {
        let term = grid.cell_volume(grid.cell(i)) * a * b;
        (sum + term, size + term.abs())
    })
}

/// Flux of a face field out of the bounded sides, and the size of its terms.
fn outflow<const D: usize>(grid: &CartesianGrid<D>, faces: &[Field<D>; D]) -> (f64, f64) {
    let (n, s) = (grid.cells(), grid.stride());
    let (mut sum, mut size) = (0.0, 0.0);
    for i in 0..grid.n_cells() {
        let cell = grid.cell(i);
        let o = grid.base() + (0..D).map(|a| cell[a] * s[a]).sum::<usize>();
        for a in 0..D {
            let area = grid.cell_volume(cell) / grid.axis(a).width(cell[a]);
            for (at_end, face, sign) in [(cell[a] == 0, o, -1.0), (cell[a] + 1 == n[a], o + s[a], 1.0)] {
                if at_end {
                    let term = sign * area * faces[a].data()[face];
                    (sum, size) = (sum + term, size + term.abs());
                }
            }
        }
    }
    (sum, size)
}

fn sides<const D: usize>(kinds: &mut Random, homogeneous: bool) -> [[ScalarSide; 2]; D] {
    std::array::from_fn(|_| {
        if kinds.next() > 0.3 {
            return ScalarSide::Periodic.both();
        }
        [0, 1].map(|_| {
            let c = if homogeneous { 0.0 } else { kinds.next() };
            match (kinds.next() * 1.5 + 1.5) as usize {
                0 => ScalarSide::value(c),
                1 => ScalarSide::Gradient(c.into()),
                _ => ScalarSide::Mixed { a: 0.5 + kinds.next().abs(), b: kinds.next().abs(), c: c.into() },
            }
        })
    })
}

fn close(a: f64, b: f64, size: f64) {
    assert!((a - b).abs() <= 1e-12 * (size + f64::MIN_POSITIVE), "{a:e} {b:e}, terms of {size:e}");
}

fn identities<const D: usize>(cells: [usize; D], seed: u64) {
    let mut random = Random(seed);
    let grid = random.grid(cells);
    let boundaries = ScalarBoundaries::new(&grid, sides(&mut random, true)).unwrap();
    let ops = Operators::new(&grid, boundaries.periodic());
    let one = {
        let mut one = Field::zeros(&grid);
        one.data_mut().fill(1.0);
        one
    };
    let (mut a, mut b) = (random.field(&grid), random.field(&grid));
    boundaries.fill(&mut a).unwrap();
    boundaries.fill(&mut b).unwrap();
    let zeros = || Field::zeros(&grid);

    // Gauss: Σ V ∇·F is the flux through the sides.
    let (mut flux, mut divergence) = (std::array::from_fn(|_| zeros()), zeros());
    ops.face_gradient(&a, &mut flux).unwrap();
    ops.divergence(&flux, &mut divergence).unwrap();
    let (total, size) = dot(&one, &divergence);
    let (out, terms) = outflow(&grid, &flux);
    // On periodic axes what leaves at one end enters at the other.
    close(total, out, size + terms);

    // ∇·∇ is the Laplacian, with variable Γ = 1 as well.
    let (mut la, mut lb, mut variable) = (zeros(), zeros(), zeros());
    ops.laplacian(1.0, &a, &mut la).unwrap();
    ops.laplacian(1.0, &b, &mut lb).unwrap();
    ops.variable_laplacian(&one, &a, &mut variable).unwrap();
    let scale = la.values().map(f64::abs).fold(0.0, f64::max);
    for ((l, d), v) in la.values().zip(divergence.values()).zip(variable.values()) {
        close(l, d, 10.0 * scale);
        close(l, v, 10.0 * scale);
    }

    // (b, La) = (a, Lb), (a, La) ≤ 0, with any Γ > 0.
    let mut gamma = zeros();
    gamma.set(|_| 1.1 + random.next());
    ScalarBoundaries::new(
        &grid,
        std::array::from_fn(|d| {
            [ScalarSide::NO_GRADIENT, ScalarSide::Periodic][usize::from(boundaries.periodic()[d])].both()
        }),
    )
    .unwrap()
    .fill(&mut gamma)
    .unwrap();
    for pass in 0..2 {
        if pass == 1 {
            ops.variable_laplacian(&gamma, &a, &mut la).unwrap();
            ops.variable_laplacian(&gamma, &b, &mut lb).unwrap();
        }
        let ((ab, size), (ba, _), (aa, _)) = (dot(&b, &la), dot(&a, &lb), dot(&a, &la));
        close(ab, ba, size);
        assert!(aa <= 1e-12 * size, "{aa:e}");
    }

    // Σ V ∂φ/∂x is what stands on the sides.
    for c in 0..D {
        let mut slope = zeros();
        ops.gradient(&a, c, &mut slope).unwrap();
        let mut faces: [Field<D>; D] = std::array::from_fn(|_| zeros());
        ops.to_faces(&a, c, &mut faces[c]).unwrap();
        let (sum, size) = dot(&one, &slope);
        let (out, terms) = outflow(&grid, &faces);
        close(sum, out, size + terms);
    }
}

/// Whatever the scheme, convection in a closed box moves φ about and makes none; a constant stays one if ∇·u = 0.
fn convection_conserves<const D: usize>(cells: [usize; D], seed: u64) {
    let mut random = Random(seed);
    let grid = random.grid(cells);
    let boundaries = ScalarBoundaries::new(&grid, sides(&mut random, false)).unwrap();
    let periodic = boundaries.periodic();
    let ops = Operators::new(&grid, periodic);
    let flow = std::array::from_fn(|a| [Side::FreeSlip, Side::Periodic][usize::from(periodic[a])].both());
    let mut velocity = Velocity::zeros(&grid, &Sides::new(flow).unwrap());
    let s = grid.stride();
    for c in 0..D {
        let u = &mut velocity.components[c];
        u.set(|_| random.next());
        let last = grid.cells()[c];
        for i in 0..grid.n_cells() {
            let cell = grid.cell(i);
            if cell[c] == 0 {
                let o = grid.base() + (0..D).map(|a| cell[a] * s[a]).sum::<usize>();
                if !periodic[c] {
                    u.data_mut()[o] = 0.0;
                }
                u.data_mut()[o + last * s[c]] = u.data()[o];
            }
        }
    }
    let mut phi = random.field(&grid);
    boundaries.fill(&mut phi).unwrap();
    let mut one = Field::zeros(&grid);
    one.data_mut().fill(1.0);
    let mut out = Field::zeros(&grid);
    for scheme in Convection::ALL {
        ops.convection(&velocity, &phi, scheme, &mut out).unwrap();
        let (sum, size) = dot(&one, &out);
        close(sum, 0.0, size);
    }
}

/// A field moved by some cells along periodic axes has a moved result, bit for bit on a uniform grid.
fn translation<const D: usize>(cells: [usize; D], seed: u64) {
    let mut random = Random(seed);
    let grid = CartesianGrid::new(cells, [1.0; D]).unwrap();
    let boundaries = ScalarBoundaries::new(&grid, ScalarSide::Periodic.everywhere()).unwrap();
    let ops = Operators::new(&grid, [true; D]);
    let shift: [usize; D] = cells.map(|n| ((random.next().abs() * n as f64) as usize).min(n - 1));
    let moved = |field: &Field<D>| {
        let values: Vec<f64> = field.values().collect();
        let (mut i, mut out) = (0, Field::zeros(&grid));
        out.set(|_| {
            let cell = grid.cell(i);
            i += 1;
            values[grid.index(std::array::from_fn(|a| (cell[a] + shift[a]) % cells[a]))]
        });
        boundaries.fill(&mut out).unwrap();
        out
    };
    let velocity = {
        let sides = Sides::new(Side::Periodic.everywhere()).unwrap();
        let mut u = Velocity::zeros(&grid, &sides);
        for c in 0..D {
            u.components[c] = random.field(&grid);
            boundaries.fill(&mut u.components[c]).unwrap();
        }
        u
    };
    let mut moved_velocity = velocity.clone();
    for c in 0..D {
        moved_velocity.components[c] = moved(&velocity.components[c]);
    }
    let mut phi = random.field(&grid);
    boundaries.fill(&mut phi).unwrap();
    let moved_phi = moved(&phi);
    let (mut first, mut second) = (Field::zeros(&grid), Field::zeros(&grid));
    let same = |a: &Field<D>, b: &Field<D>| assert!(moved(a).values().eq(b.values()));
    for scheme in Convection::ALL {
        ops.convection(&velocity, &phi, scheme, &mut first).unwrap();
        ops.convection(&moved_velocity, &moved_phi, scheme, &mut second).unwrap();
        let worst =
            moved(&first).values().zip(second.values()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        // Interface weights come from coordinates, which are round-off apart.
        assert!(worst < 1e-11, "{scheme:?} {worst:e}");
    }
    ops.laplacian(0.3, &phi, &mut first).unwrap();
    ops.laplacian(0.3, &moved_phi, &mut second).unwrap();
    same(&first, &second);
    ops.strain_rate(&velocity, &mut first).unwrap();
    ops.strain_rate(&moved_velocity, &mut second).unwrap();
    let worst = moved(&first).values().zip(second.values()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(worst < 1e-11, "{worst:e}");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(48) })]

    #[test]
    fn hold_in_the_plane(cells in [1usize..9, 1usize..9], seed: u64) {
        identities(cells, seed);
        convection_conserves(cells, seed);
        translation(cells, seed);
    }
    #[test]
    fn hold_in_space(cells in [1usize..7, 1usize..6, 1usize..6], seed: u64) {
        identities(cells, seed);
        convection_conserves(cells, seed);
        translation(cells, seed);
    }
}

#[test]
fn a_linear_field_has_an_exact_gradient() {
    let mut random = Random(7);
    let grid: CartesianGrid<3> = random.grid([7, 5, 6]);
    let metrics = Metrics::new(&grid, [false; 3]);
    let ops = Operators::new(&grid, [false; 3]);
    let phi = exact(&grid, &metrics, None, |x| 3.0 * x[0] - 2.0 * x[1] + 0.5 * x[2]);
    let mut out = Field::zeros(&grid);
    for (c, slope) in [3.0, -2.0, 0.5].into_iter().enumerate() {
        ops.gradient(&phi, c, &mut out).unwrap();
        assert!(out.values().all(|g| (g - slope).abs() < 1e-12));
    }
}

#[test]
fn fields_of_other_grids_are_refused() {
    let grid = CartesianGrid::new([4, 3], [1.0; 2]).unwrap();
    let other = CartesianGrid::new([3, 4], [1.0; 2]).unwrap();
    let ops = Operators::new(&grid, [true; 2]);
    let (mut ours, theirs) = (Field::zeros(&grid), Field::zeros(&other));
    let error = ops.laplacian(1.0, &theirs, &mut ours).unwrap_err();
    assert_eq!(error, crate::FlowError::OtherGrid { expected: vec![4, 3], found: vec![3, 4] });
    let phi = ours.clone();
    assert!(matches!(ops.gradient(&phi, 2, &mut ours), Err(crate::FlowError::Grid { .. })));
}
