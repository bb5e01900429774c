//! Creeping flow between eccentric cylinders that turn (Wannier 1950, Quart. Appl. Math. 8, 1).
use crate::Outcome;
use crate::prescribed_bodies::{Bore, PrescribedBodies};
use crate::walled_flows::put_walls;
use dem::Disc;
use fv_mesh::{CartesianGrid, Fluid, Projection, Side};
use nalgebra::{DMatrix, DVector, SVector};
use std::f64::consts::{PI, TAU};

/// Radii of the cylinders \[m\], and the distance of their axes: half of the mean gap.
const RADII: [f64; 2] = [0.25, 0.5];
const ECCENTRICITY: f64 = 0.125;
/// Along no axis of a grid, from the axis of the inner cylinder to that of the outer one.
const ACROSS: [f64; 2] = [0.6, 0.8];
/// Dynamic and kinematic viscosity.
const VISCOSITY: f64 = 1.0;
/// Angular velocity of the inner cylinder \[rad/s\]; so slow that inertia plays no part (Re 6e-5).
const TURNING: f64 = 1e-3;

/// The exact creeping flow between two circles that turn in themselves.
///
/// With the y axis through both centres, the outer circle's further from the origin, both enclose the pole (0, s). Of the functions
///
/// ```text
/// ψ = A L + B y(y+s)/r₊² + C y(y−s)/r₋² + D y + E r² + F y L,   r±² = x² + (y±s)²,  L = ln(r₊²/r₋²)
/// ```
///
/// all biharmonic with a pressure of one value, some combination sticks to both circles: its coefficients solve the conditions of
/// no slip at points of them (more than needed; what is left is round-off).
#[derive(Clone, Debug)]
pub struct Wannier {
    /// Radius of each circle and place of its centre on the y axis.
    circles: [[f64; 2]; 2],
    pole: f64,
    coefficients: SVector<f64, 6>,
}

impl Wannier {
    /// Between circles of these `radii` \[m\], the inner one first, at a distance of `eccentricity` \[m\], that turn at `turning` \[rad/s\].
    pub fn new(radii: [f64; 2], eccentricity: f64, turning: [f64; 2]) -> Self {
        let [inner, outer] = radii;
        // Both enclose the same pole: y² − r² = s².
        let low = (outer * outer - inner * inner - eccentricity * eccentricity) / (2.0 * eccentricity);
        let circles = [[inner, low], [outer, low + eccentricity]];
        let pole = (low * low - inner * inner).sqrt();
        let (mut rows, mut values): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
        for ([radius, centre], turning) in circles.into_iter().zip(turning) {
            for k in 0..POINTS {
                let (sin, cos) = (TAU * (f64::from(k) + 0.5) / f64::from(POINTS)).sin_cos();
                let [u, v] = modes(pole, [radius * cos, centre + radius * sin]);
                rows.extend(u.iter().chain(&v));
                values.extend([-turning * radius * sin, turning * radius * cos]);
            }
        }
        let (matrix, values) = (DMatrix::from_row_iterator(values.len(), 6, rows), DVector::from_vec(values));
        // The functions differ in size: they are scaled to columns of length 1.
        let sizes: Vec<f64> = matrix.column_iter().map(|column| column.norm()).collect();
        let scaled = DMatrix::from_fn(matrix.nrows(), 6, |i, j| matrix[(i, j)] / sizes[j]);
        let found = scaled.svd(true, true).solve(&values, 1e-14).unwrap_or_else(|_| DVector::zeros(6));
        let coefficients = SVector::from_fn(|j, _| found[j] / sizes[j]);
        Self { circles, pole, coefficients }
    }
    /// Velocity \[m/s\] at a place in the frame of ψ.
    fn velocity(&self, x: [f64; 2]) -> [f64; 2] {
        modes(self.pole, x).map(|mode| mode.dot(&self.coefficients))
    }
    /// Is this place of the frame of ψ between the circles?
    fn between(&self, x: [f64; 2]) -> bool {
        let [inner, outer] = self.circles.map(|[radius, centre]| x[0].hypot(x[1] - centre) - radius);
        inner > 0.0 && outer < 0.0
    }
    /// Force \[N/m\] on the inner circle along x, and torque \[N\] about its centre, in a fluid of dynamic `viscosity` \[Pa s\].
    ///
    /// At the pole F is a force on the fluid (ψ = −f Y ln r/(4πμ)), A and F together turn it (u = T/(4πμr)).
    pub fn load(&self, viscosity: f64) -> [f64; 2] {
        let [a, f] = [self.coefficients[0], self.coefficients[5]];
        let force = -8.0 * PI * viscosity * f;
        let about_the_pole = -8.0 * PI * viscosity * (a + self.pole * f);
        [force, about_the_pole - (self.pole - self.circles[0][1]) * force]
    }
}

/// Points on each circle that have to stick.
const POINTS: u32 = 24;

/// The velocities (∂ψ/∂y, −∂ψ/∂x) of the six functions.
fn modes(s: f64, [x, y]: [f64; 2]) -> [SVector<f64, 6>; 2] {
    let (p, q) = (y + s, y - s);
    let (pp, qq) = (x * x + p * p, x * x + q * q);
    let (l, lx, ly) = ((pp / qq).ln(), 2.0 * x * (1.0 / pp - 1.0 / qq), 2.0 * (p / pp - q / qq));
    let over = |t: f64, tt: f64| [-2.0 * x * y * t / (tt * tt), (t + y) / tt - 2.0 * y * t * t / (tt * tt)];
    let [[bx, by], [cx, cy]] = [over(p, pp), over(q, qq)];
    let along = [ly, by, cy, 1.0, 2.0 * y, l + y * ly];
    let across = [lx, bx, cx, 0.0, 2.0 * x, y * lx];
    [SVector::from(along), -SVector::from(across)]
}

/// The flow between eccentric cylinders of radii 0.25 (turning, centre at the origin) and 0.5 m (at rest), by cut links.
pub struct EccentricCylinders {
    /// The flow, which starts with the exact velocity.
    pub flow: Projection<2>,
    /// The cylinders, the inner one first.
    pub bodies: PrescribedBodies,
    exact: Wannier,
}

impl EccentricCylinders {
    /// With `cells` per metre, moved by `shift` cells against the origin.
    ///
    /// # Errors
    /// Those of the walls and of the flow.
    pub fn new(cells: usize, shift: [f64; 2]) -> Outcome<Self> {
        let h = 1.0 / cells as f64;
        let half = RADII[1] + 2.0 * h;
        let centre = ACROSS.map(|a| ECCENTRICITY * a);
        let origin = [0, 1].map(|a| centre[a] + shift[a] * h - half);
        let grid = CartesianGrid::new([cells + 4; 2], [2.0 * half; 2])?.with_origin(origin)?;
        let mut flow =
            Projection::new(grid, Side::WALL.everywhere(), Fluid { density: 1.0, viscosity: VISCOSITY })?;
        let inner = PrescribedBodies::default().with(Disc::new(RADII[0])?, [0.0; 3], TURNING);
        let outer = Bore { radius: RADII[1], half: [2.0 * half; 2] };
        let bodies = inner.with(outer, [centre[0], centre[1], 0.0], 0.0);
        put_walls(&mut flow, &bodies)?;
        let exact = Wannier::new(RADII, ECCENTRICITY, [TURNING, 0.0]);
        flow.set_velocity(|x| velocity_in(&exact, x));
        Ok(Self { flow, bodies, exact })
    }
    /// The exact velocity over that of the inner cylinder's surface is this one times [`SCALE`](Self::SCALE); zero outside.
    pub fn exact(&self, x: [f64; 2]) -> [f64; 2] {
        velocity_in(&self.exact, x)
    }
    /// One over the speed of the inner cylinder's surface \[s/m\].
    pub const SCALE: f64 = 1.0 / (TURNING * RADII[0]);
    /// What the exact flow does to the inner cylinder: force across the line of centres \[N/m\] and torque \[N\].
    pub fn exact_load(&self) -> [f64; 2] {
        self.exact.load(VISCOSITY)
    }
    /// Of a force, the parts across and along the line of centres.
    pub fn parts(&self, force: [f64; 2]) -> [f64; 2] {
        let [a, b] = ACROSS;
        [force[0] * b - force[1] * a, force[0] * a + force[1] * b]
    }
}

/// In the frame of the grid: its origin is the centre of the inner circle, ψ's y axis lies along [`ACROSS`].
fn velocity_in(exact: &Wannier, x: [f64; 2]) -> [f64; 2] {
    let [a, b] = ACROSS;
    let there = [x[0] * b - x[1] * a, x[0] * a + x[1] * b + exact.circles[0][1]];
    if !exact.between(there) {
        return [0.0; 2];
    }
    let [u, v] = exact.velocity(there);
    [u * b + v * a, v * b - u * a]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exact_flow_sticks_to_both_circles() {
        for (eccentricity, turning) in [(0.125, [1.0, 0.0]), (0.2, [1.0, -0.7]), (0.01, [0.0, 1.0])] {
            let exact = Wannier::new(RADII, eccentricity, turning);
            for ([radius, centre], turning) in exact.circles.into_iter().zip(turning) {
                for k in 0..101 {
                    let (sin, cos) = f64::from(k).sin_cos();
                    let [u, v] = exact.velocity([radius * cos, centre + radius * sin]);
                    let slip = (u + turning * radius * sin).hypot(v - turning * radius * cos);
                    assert!(slip < 1e-9, "{eccentricity} {turning}: {slip}");
                }
            }
        }
    }

    /// Between circles that are almost concentric the torque is that of Couette, 4πμωR₁²R₂²/(R₂² − R₁²).
    #[test]
    fn the_torque_tends_to_that_of_concentric_circles() {
        let [_, torque] = Wannier::new(RADII, 1e-3, [1.0, 0.0]).load(1.0);
        assert!((torque / (-4.0 * PI / 12.0) - 1.0).abs() < 1e-4, "{torque}");
    }

    /// The vorticity of a creeping flow is harmonic, and the work of the wall goes into heat:
    /// −Tω = μ ∫ 2 e:e dA, on a mesh of polar kind between the circles.
    #[test]
    fn the_exact_flow_creeps_and_its_work_becomes_heat() {
        let exact = Wannier::new(RADII, ECCENTRICITY, [1.0, 0.0]);
        let d = 1e-4;
        // ∂u/∂x, ∂u/∂y, ∂v/∂x, ∂v/∂y.
        let gradient = |[x, y]: [f64; 2]| {
            let [east, west] = [d, -d].map(|d| exact.velocity([x + d, y]));
            let [north, south] = [d, -d].map(|d| exact.velocity([x, y + d]));
            [east[0] - west[0], north[0] - south[0], east[1] - west[1], north[1] - south[1]]
                .map(|g| g / (2.0 * d))
        };
        let vorticity = |x: [f64; 2]| {
            let [_, uy, vx, _] = gradient(x);
            vx - uy
        };
        let [[r1, y1], [r2, y2]] = exact.circles;
        let place = |t: f64, angle: f64| {
            let (sin, cos) = angle.sin_cos();
            let r = r1 + t * (r2 - r1);
            [r * cos, y1 + t * (y2 - y1) + r * sin]
        };
        let (across, around) = (60, 60);
        let (mut heat, step) = (0.0, 0.02);
        for i in 0..across {
            for k in 0..around {
                let (t, angle) =
                    ((f64::from(i) + 0.5) / f64::from(across), TAU * f64::from(k) / f64::from(around));
                let [x, y] = place(t, angle);
                let [ux, uy, vx, vy] = gradient([x, y]);
                assert!((ux + vy).abs() < 1e-6);
                // ∂(x, y)/∂(t, angle) = r (r₂ − r₁ + (y₂ − y₁) sin).
                let r = r1 + t * (r2 - r1);
                let area = r * (r2 - r1 + (y2 - y1) * angle.sin()) * TAU / f64::from(across * around);
                heat += area * (2.0 * (ux * ux + vy * vy) + (uy + vx) * (uy + vx));
                if (20..40).contains(&i) {
                    let beside = [[step, 0.0], [-step, 0.0], [0.0, step], [0.0, -step]];
                    let mean = beside.iter().map(|b| vorticity([x + b[0], y + b[1]])).sum::<f64>() / 4.0;
                    assert!((mean - vorticity([x, y])).abs() < 2e-3, "{mean} {}", vorticity([x, y]));
                }
            }
        }
        let [_, torque] = exact.load(1.0);
        assert!((-torque / heat - 1.0).abs() < 1e-3, "{torque} {heat}");
    }
}
