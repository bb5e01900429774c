//! What the flow around a box tells of the loads on what is in it.
use crate::IbmError;
use crate::reconstruction::corners;
use crate::surface_stress::stored;
use interfaces::{Lattice, Point, Vector, VelocityField, Wrench};
use nalgebra::Matrix3;
use std::ops::Range;

/// The momentum balance of a box, fluid and bodies:
///
/// ```text
/// d/dt ∫ρu dV = −∮ [ρu (u·n) + pn − μ(∇u + ∇uᵀ)·n] dA − F,   F what the fluid does to what holds the bodies
/// ```
///
/// Another way to the loads on bodies, whatever the grid does at their surfaces: it reads the flow at the sides of the box only, and, if
/// the flow changes, the momentum within. For bodies at rest in a steady flow F is −[`outflow`](Self::outflow).
/// [`momentum`](Self::momentum) counts what flows inside the bodies, too: of a body that is forced from inside F is minus the forcing, and
/// what the fluid does to its surface is F plus the change of the momentum inside (ρV dU/dt). Values at the middles of faces are interpolated linearly, derivatives are central: second order.
#[derive(Clone, Copy)]
pub struct ControlVolume<'a> {
    velocity: &'a dyn VelocityField,
    lattice: &'a Lattice,
    pressure: &'a [f64],
    density: f64,
    viscosity: f64,
    about: Point,
    ends: [[isize; 2]; 3],
}

impl<'a> ControlVolume<'a> {
    /// The cells of `lattice` whose centres lie between the corners `low` and `high` \[m\], with this velocity and `pressure` \[Pa\] in a fluid
    /// of `density` \[kg/m³\] and dynamic `viscosity` \[Pa s\]. Moments are about the middle between the corners.
    ///
    /// # Errors
    /// [`IbmError::NoRoom`] if there is none, if the corners are not finite or farther apart than a period, or where less than two more
    /// cells lie before a side that bounds the flow; [`IbmError::Storage`] for a pressure that is not the lattice's.
    pub fn new(
        velocity: &'a dyn VelocityField,
        lattice: &'a Lattice,
        pressure: &'a [f64],
        [density, viscosity]: [f64; 2],
        [low, high]: [Point; 2],
    ) -> Result<Self, IbmError> {
        stored(lattice, pressure)?;
        let mut ends = [[0, 1]; 3];
        for axis in 0..lattice.dim {
            let (nodes, cells) = (&lattice.axes[axis], lattice.axes[axis].len() as isize);
            let finite = low[axis].is_finite() && high[axis].is_finite();
            let Range { start, end } =
                if finite { nodes.range(low[axis], high[axis]) } else { Range::default() };
            // The velocity across a side is read up to half a cell beyond it.
            let beside =
                if nodes.is_periodic() { end - start <= cells } else { start > 1 && end + 1 < cells };
            if start >= end || !beside {
                return Err(IbmError::NoRoom { axis, low: low[axis], high: high[axis] });
            }
            ends[axis] = [start, end];
        }
        let about = nalgebra::center(&low, &high);
        Ok(Self { velocity, lattice, pressure, density, viscosity, about, ends })
    }

    /// Moments about another point.
    #[must_use]
    pub fn about(mut self, point: Point) -> Self {
        self.about = point;
        self
    }

    /// ∫ρu dV and its moment \[N s, N m s\].
    pub fn momentum(&self) -> Wrench {
        let mut sum = Wrench::default();
        self.each([0, 1, 2].map(|a| self.ends[a][0]..self.ends[a][1]), |cell| {
            let x = Point::from(self.lattice.position(cell));
            let mass = self.density * self.lattice.volume(cell);
            sum += Wrench::at(self.velocity_at(x) * mass, x - self.about);
        });
        sum
    }

    /// ∮ [ρu (u·n) + pn − μ(∇u + ∇uᵀ)·n] dA and its moment \[N, N m\]: the momentum that leaves in a unit of time.
    pub fn outflow(&self) -> Wrench {
        let mut sum = Wrench::default();
        for axis in 0..self.lattice.dim {
            for side in [0, 1] {
                let face = self.ends[axis][side];
                let mut cells = [0, 1, 2].map(|a| self.ends[a][0]..self.ends[a][1]);
                cells[axis] = face..face + 1;
                let mut normal = Vector::zeros();
                normal[axis] = if side == 0 { -1.0 } else { 1.0 };
                self.each(cells, |cell| {
                    let widths = self.lattice.widths(cell);
                    let area = (0..3).filter(|a| *a != axis).map(|a| widths[a]).product::<f64>();
                    let mut x = Point::from(self.lattice.position(cell));
                    x[axis] = self.lattice.axes[axis].edge(face);
                    sum += Wrench::at(self.traction(x, normal, widths) * area, x - self.about);
                });
            }
        }
        sum
    }

    /// ρu (u·n) + pn − μ(∇u + ∇uᵀ)·n at `x`.
    fn traction(&self, x: Point, normal: Vector, widths: [f64; 3]) -> Vector {
        let u = self.velocity_at(x);
        let mut gradient = Matrix3::zeros();
        for (a, width) in widths.into_iter().enumerate().take(self.lattice.dim) {
            let mut step = Vector::zeros();
            step[a] = 0.5 * width;
            gradient.set_column(a, &((self.velocity_at(x + step) - self.velocity_at(x - step)) / width));
        }
        let pressure = value(self.lattice, self.pressure, x);
        let friction = (gradient + gradient.transpose()) * normal * self.viscosity;
        u * (self.density * u.dot(&normal)) + normal * pressure - friction
    }

    fn velocity_at(&self, x: Point) -> Vector {
        let read = |c| value(self.velocity.lattice(c), self.velocity.component(c), x);
        Vector::from_fn(|c, _| if c < self.velocity.dim() { read(c) } else { 0.0 })
    }

    fn each(&self, cells: [Range<isize>; 3], mut f: impl FnMut([isize; 3])) {
        let [along_x, along_y, along_z] = cells;
        for k in along_z {
            for j in along_y.clone() {
                along_x.clone().for_each(|i| f([i, j, k]));
            }
        }
    }
}

/// A field between its nodes.
fn value(lattice: &Lattice, field: &[f64], x: Point) -> f64 {
    corners(lattice, x).map(|(index, weight)| index.map_or(0.0, |index| weight * field[index])).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Collocated, Staggered, lattice};
    use interfaces::Nodes;

    /// u = (sin y, sin z, sin x) + (1, 0.5, 0.2), p = sin (x + 2y): against Gauss's theorem.
    fn errors(n: usize, stretched: bool) -> [f64; 2] {
        let side = |i: usize| {
            let x = i as f64 / n as f64;
            2.0 * (x + if stretched { 0.05 * (6.0 * x).sin() } else { 0.0 })
        };
        let sides: Vec<f64> = (0..=n).map(side).collect();
        let axes = [(); 3].map(|()| Nodes::centres(&sides, false));
        let lattice = Lattice::new(axes, 0, [1, n, n * n]);
        let flow = |x: [f64; 3]| [1.0 + x[1].sin(), 0.5 + x[2].sin(), 0.2 + x[0].sin()];
        let field = Collocated::new(lattice.clone(), flow);
        let pressure: Vec<f64> = (0..n * n * n)
            .map(|i| {
                let [x, y, _] = lattice.position(lattice.node(i));
                (x + 2.0 * y).sin()
            })
            .collect();
        let [density, viscosity] = [3.0, 0.7];
        let (low, high) = (side(n / 4), side(3 * n / 4));
        let corners = [Point::from([low; 3]), Point::from([high; 3])];
        let found = ControlVolume::new(&field, &lattice, &pressure, [density, viscosity], corners).unwrap();

        // ∫ f dV of what is not constant, by the midpoint rule on cells that do not depend on n.
        let parts = 64;
        let h = (high - low) / parts as f64;
        let (mut out, mut inside) = (Wrench::default(), Wrench::default());
        for i in 0..parts * parts * parts {
            let at = [i % parts, i / parts % parts, i / (parts * parts)].map(|k| low + (k as f64 + 0.5) * h);
            let [x, y, z] = at;
            let arm = Point::from(at) - nalgebra::center(&corners[0], &corners[1]);
            let u = Vector::from(flow(at));
            // ∇·(ρuu) = ρ(u·∇)u, as ∇·u = 0.
            let convection = density * Vector::new(u.y * y.cos(), u.z * z.cos(), u.x * x.cos());
            let slope = (x + 2.0 * y).cos() * Vector::new(1.0, 2.0, 0.0);
            let laplacian = -Vector::new(y.sin(), z.sin(), x.sin());
            // The stresses are symmetric: moments follow from the same density.
            out += Wrench::at((convection + slope - viscosity * laplacian) * h.powi(3), arm);
            inside += Wrench::at(u * density * h.powi(3), arm);
        }
        let error = |found: Wrench, exact: Wrench| {
            (found.force - exact.force).norm() / exact.force.norm()
                + (found.torque - exact.torque).norm() / exact.torque.norm()
        };
        [error(found.outflow(), out), error(found.momentum(), inside)]
    }

    #[test]
    fn balances_are_of_second_order() {
        for stretched in [false, true] {
            let [coarse, fine] = [12, 24].map(|n| errors(n, stretched));
            for i in 0..2 {
                assert!(fine[i] < 0.02 && fine[i] < coarse[i] / 3.2, "{stretched}: {coarse:?} {fine:?}");
            }
        }
    }

    /// A uniform stream between bounded sides of a staggered grid leaves no force, as near to them as a box may come.
    #[test]
    fn a_uniform_stream_pushes_nothing() {
        let h = 0.1;
        let sides: Vec<f64> = (0..=20).map(|i| h * f64::from(i)).collect();
        let cells = Lattice::new([(); 2].map(|()| Nodes::centres(&sides, false)), 0, [1, 20]);
        let mut stream = Staggered::between([&sides[..]; 2]);
        stream.set(|_| [0.6, -0.8, 0.0]);
        let pressure = vec![0.7; 400];
        let corners = [Point::new(2.0 * h, 2.0 * h, 0.0), Point::new(18.0 * h, 18.0 * h, 0.0)];
        let found = ControlVolume::new(&stream, &cells, &pressure, [2.0, 0.3], corners).unwrap().outflow();
        assert!(found.force.norm() < 1e-13 && found.torque.norm() < 1e-13, "{found:?}");
    }

    #[test]
    fn boxes_without_room_are_refused() {
        let periodic = lattice(2, [0.1; 3], 3.0);
        let field = Collocated::new(periodic.clone(), |_| [0.0; 3]);
        let pressure = vec![0.0; 900];
        let corners = |low: f64, high: f64| [Point::new(low, 0.5, 0.0), Point::new(high, 1.0, 0.0)];
        let volume = |lattice, low, high| {
            ControlVolume::new(&field, lattice, &pressure, [1.0; 2], corners(low, high)).map(|_| ())
        };
        // Over a periodic side.
        assert_eq!(volume(&periodic, 2.5, 3.5), Ok(()));
        let refused = |found| matches!(found, Err(IbmError::NoRoom { axis: 0, .. }));
        assert!(refused(volume(&periodic, 1.01, 1.02)) && refused(volume(&periodic, 2.0, 1.0)));
        for (low, high) in [(f64::NAN, 1.0), (0.0, f64::INFINITY), (0.5, 3.7)] {
            assert!(refused(volume(&periodic, low, high)), "{low} {high}");
        }
        let axes = [false, true].map(|periodic| Nodes::uniform(0.05, 0.1, 30, periodic));
        let bounded = Lattice::new(axes, 0, [1, 30]);
        assert!(refused(volume(&bounded, 0.1, 1.0)) && refused(volume(&bounded, 2.0, 2.9)));
        assert_eq!(volume(&bounded, 0.2, 2.8), Ok(()));
        let short = ControlVolume::new(&field, &periodic, &pressure[1..], [1.0; 2], corners(1.0, 2.0));
        assert!(matches!(short.map(|_| ()), Err(IbmError::Storage { needed: 900, found: 899 })));
    }
}
