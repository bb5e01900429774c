//! Rotations of periodic fields.
use super::axis::{Axis, Side};
use super::{Grid, Interpolation};
use interfaces::Rotation;
use monomorphic::fourier_transforms;
use rustfft::Fft;
use rustfft::num_complex::Complex;
use std::f64::consts::PI;
use std::sync::Arc;

/// Rotates periodic fields by shears: each shifts the lines along one axis by what their place on another one tells, through phases
/// of their Fourier coefficients. A shift is orthogonal (but for the wave of two cells), so is the rotation; its transpose is its inverse.
///
/// In a plane, R(θ) = X(−tan θ/2) Y(sin θ) X(−tan θ/2) (Unser, Thévenaz & Yaroslavsky 1995). In between a field has wave numbers up to
/// 1/cos(θ/2) times its own, and those beyond half a wave per cell are mistaken for others. So half turns are made by renumbering and
/// a shift, and more than 45° in two steps of half the angle: 1/cos 22.5° = 1.08.
///
/// Lines are told apart by the way from the centre to their nearest image: half a period from the centre the field is torn.
pub(super) struct Turner {
    cells: [usize; 3],
    spacing: [f64; 3],
    transforms: [[Arc<dyn Fft<f64>>; 2]; 3],
    axes: [Axis; 3],
}

/// Of a rotation.
#[derive(Clone, Copy, Debug)]
enum Step {
    /// q(2c − x) in the plane of two axes.
    HalfTurn([usize; 2]),
    /// Lines along the first axis move by so much per length on the second one.
    Shear([usize; 2], f64),
}

/// The angles of R = R_z R_y R_x about the axes; about z alone exactly so.
pub(super) fn angles(rotation: &Rotation) -> [f64; 3] {
    let (roll, pitch, yaw) = rotation.euler_angles();
    [roll, pitch, yaw]
}

/// What a rotation about axis `a` turns, the first towards the second.
fn plane(a: usize) -> [usize; 2] {
    [(a + 1) % 3, (a + 2) % 3]
}

impl Turner {
    pub(super) fn new(grid: &Grid) -> Self {
        let cells = grid.cells();
        Self {
            cells,
            spacing: grid.spacing(),
            transforms: cells.map(fourier_transforms),
            axes: cells.map(|n| Axis::new(n, true, Interpolation::Spectral)),
        }
    }

    /// Replaces whole fields by q(c + R⁻¹ (x − c)) or by the transpose of that, `centre` in cells.
    pub(super) fn turn(&self, rotation: &Rotation, centre: [f64; 3], side: Side, fields: &mut [f64]) {
        let mut steps = steps(rotation);
        if side == Side::Transpose {
            steps.reverse();
        }
        for field in fields.chunks_exact_mut(self.cells.iter().product()) {
            for step in &steps {
                match *step {
                    Step::HalfTurn(axes) => axes.into_iter().for_each(|a| self.reflect(a, centre[a], field)),
                    Step::Shear(axes, slope) => {
                        let slope = if side == Side::Operator { slope } else { -slope };
                        self.shear(axes, slope, centre[axes[1]], field);
                    }
                }
            }
        }
    }

    /// q(2c − x) along one axis, which is its own transpose.
    fn reflect(&self, a: usize, centre: f64, field: &mut [f64]) {
        let (n, inner) = (self.cells[a], self.cells[..a].iter().product::<usize>());
        for block in field.chunks_exact_mut(n * inner) {
            for i in 1..n.div_ceil(2) {
                let (low, high) = block.split_at_mut((n - i) * inner);
                low[i * inner..][..inner].swap_with_slice(&mut high[..inner]);
            }
        }
        let mut data = field.to_vec();
        self.axes[a].shift(2.0 * centre, Side::Operator, inner, &mut data);
        field.copy_from_slice(&data);
    }

    fn shear(&self, [along, across]: [usize; 2], slope: f64, centre: f64, field: &mut [f64]) {
        let (n, m) = (self.cells[along], self.cells[across]);
        let slope = slope * self.spacing[across] / self.spacing[along];
        let stride = |a: usize| self.cells[..a].iter().product::<usize>();
        let half = n / 2 + 1;
        let mut phases = Vec::with_capacity(m * half);
        for j in 0..m {
            let way = j as f64 - centre;
            let s = slope * (way - m as f64 * (way / m as f64).round());
            let wave = Complex::cis(-2.0 * PI * (s / n as f64).rem_euclid(1.0));
            let mut factor = Complex::from(1.0 / n as f64);
            for _ in 0..half {
                phases.push(factor);
                factor *= wave;
            }
            if n.is_multiple_of(2) {
                // The wave of two cells stays real.
                phases[j * half + n / 2] = Complex::from((PI * s.rem_euclid(2.0)).cos() / n as f64);
            }
        }
        let lines: Vec<_> = (0..field.len())
            .filter(|cell| (cell / stride(along)).is_multiple_of(n))
            .map(|cell| (cell, &phases[cell / stride(across) % m * half..][..half]))
            .collect();
        let [forward, inverse] = &self.transforms[along];
        let scratch = forward.get_inplace_scratch_len().max(inverse.get_inplace_scratch_len());
        let mut scratch = vec![Complex::default(); scratch];
        let mut line = vec![Complex::default(); n];
        let stride = stride(along);
        let imaginary = Complex::new(0.0, 1.0);
        // Two real lines are one complex line.
        for pair in lines.chunks(2) {
            let (first, second) = (pair[0], pair.get(1).copied());
            for (i, z) in line.iter_mut().enumerate() {
                let im = second.map_or(0.0, |(start, _)| field[start + i * stride]);
                *z = Complex::new(field[first.0 + i * stride], im);
            }
            forward.process_with_scratch(&mut line, &mut scratch);
            for k in 0..half {
                let (z, mirrored) = (line[k], line[(n - k) % n].conj());
                let a = (z + mirrored) * 0.5 * first.1[k];
                let b = (z - mirrored) * Complex::new(0.0, -0.5) * second.map_or(first.1[k], |s| s.1[k]);
                line[(n - k) % n] = a.conj() + imaginary * b.conj();
                line[k] = a + imaginary * b;
            }
            inverse.process_with_scratch(&mut line, &mut scratch);
            for (i, z) in line.iter().enumerate() {
                field[first.0 + i * stride] = z.re;
                if let Some((start, _)) = second {
                    field[start + i * stride] = z.im;
                }
            }
        }
    }
}

/// What is done to a field one after the other.
fn steps(rotation: &Rotation) -> Vec<Step> {
    let mut steps = Vec::new();
    for (a, angle) in angles(rotation).into_iter().enumerate().filter(|(_, angle)| *angle != 0.0) {
        let [x, y] = plane(a);
        let half_turns = (angle / PI).round();
        if half_turns != 0.0 {
            steps.push(Step::HalfTurn([x, y]));
        }
        let angle = angle - PI * half_turns;
        let parts = if angle.abs() > PI / 4.0 { 2 } else { 1 };
        let angle = angle / f64::from(parts);
        let outer = -(angle / 2.0).tan();
        steps.push(Step::Shear([x, y], outer));
        for part in 1..=parts {
            steps.push(Step::Shear([y, x], angle.sin()));
            steps.push(Step::Shear([x, y], if part < parts { 2.0 * outer } else { outer }));
        }
    }
    steps
}
