//! The fastest solver that serves a box.
use super::separable::swept_axis;
use super::{DirectPoisson, PoissonAxis, PoissonError, PoissonInfo, PoissonSolver, SeparablePoisson};
use std::fmt;

/// How one axis is dealt with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisMethod {
    /// Fourier, cosine or sine transform.
    Transform,
    /// Products with the eigenvectors of an axis of `cells` cells: 4 `cells` operations per cell of the box.
    Product {
        /// Cells of the axis.
        cells: usize,
    },
    /// A tridiagonal system per mode.
    Sweep,
}

/// The solvers that [`Poisson`] picks from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PoissonKind {
    /// [`DirectPoisson`].
    Direct,
    /// [`SeparablePoisson`].
    Separable,
}

/// Which solver serves a box, and why: its [`Display`](fmt::Display) is a sentence such as
/// "transforms along x, sweep along y: y is stretched".
#[derive(Clone, Debug, PartialEq)]
pub struct PoissonChoice {
    /// The solver.
    pub kind: PoissonKind,
    /// How each axis is dealt with.
    pub methods: Vec<AxisMethod>,
    /// Time of a solve on one thread per cell \[ns\]: an estimate for a processor with AVX2 at about
    /// 3 GHz, right within a factor of two. Worth comparing with an iterative solver where long axes
    /// are dealt with by products.
    pub nanoseconds_per_cell: f64,
    reasons: Vec<Reason>,
}

/// What is particular about an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Reason {
    Stretched,
    Mixed,
    None,
}

const NAMES: [&str; 3] = ["x", "y", "z"];

impl PoissonChoice {
    /// The choice for a box with these axes; nothing is made yet.
    pub fn new<const D: usize>(axes: &[PoissonAxis; D]) -> Self {
        let last_or_fast =
            |(a, axis): (usize, &PoissonAxis)| axis.is_uniform() && (a == D - 1 || axis.is_fast());
        let uniform = axes.iter().enumerate().all(last_or_fast);
        let swept = if uniform { D - 1 } else { swept_axis(axes) };
        let methods: Vec<AxisMethod> = axes
            .iter()
            .enumerate()
            .map(|(a, axis)| match axis.is_fast() {
                _ if a == swept => AxisMethod::Sweep,
                true => AxisMethod::Transform,
                false => AxisMethod::Product { cells: axis.cells() },
            })
            .collect();
        let reasons = axes
            .iter()
            .map(|axis| match (axis.is_uniform(), axis.is_mixed()) {
                (false, _) => Reason::Stretched,
                (true, true) => Reason::Mixed,
                (true, false) => Reason::None,
            })
            .collect();
        let kind = if uniform { PoissonKind::Direct } else { PoissonKind::Separable };
        let nanoseconds_per_cell = cost(kind, swept == D - 1, &methods);
        Self { kind, methods, nanoseconds_per_cell, reasons }
    }

    /// The names of the axes for which `which` holds.
    fn names(&self, which: impl Fn(usize) -> bool) -> Vec<&'static str> {
        (0..self.methods.len()).filter(|&a| which(a)).map(|a| NAMES[a]).collect()
    }
}

/// Measured on one core of an EPYC 7003.
fn cost(kind: PoissonKind, last: bool, methods: &[AxisMethod]) -> f64 {
    let transforms: f64 = methods
        .iter()
        .map(|method| match (method, kind) {
            (AxisMethod::Sweep, _) => 0.0,
            (AxisMethod::Transform, PoissonKind::Direct) => 3.0,
            (AxisMethod::Transform, PoissonKind::Separable) => 4.0,
            (AxisMethod::Product { cells }, _) => 1.0 + 0.085 * *cells as f64,
        })
        .sum();
    transforms + if last { 1.5 } else { 5.0 }
}

/// "x", "x and y", "x, y and z".
fn list(names: &[&str]) -> String {
    match names {
        [] => String::new(),
        [one] => (*one).into(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

impl fmt::Display for PoissonChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let transformed = self.names(|a| self.methods[a] == AxisMethod::Transform);
        if !transformed.is_empty() {
            write!(f, "transforms along {}, ", list(&transformed))?;
        }
        for (method, name) in self.methods.iter().zip(NAMES) {
            if let AxisMethod::Product { cells } = method {
                write!(f, "products with {cells} eigenvectors along {name}, ")?;
            }
        }
        write!(f, "sweep along {}: ", list(&self.names(|a| self.methods[a] == AxisMethod::Sweep)))?;
        let stretched = self.names(|a| self.reasons[a] == Reason::Stretched);
        let mixed = self.names(|a| self.reasons[a] == Reason::Mixed);
        let are = |names: &[&str]| if names.len() == 1 { "is" } else { "are" };
        match (stretched.as_slice(), mixed.as_slice()) {
            ([], []) => write!(f, "all axes are uniform"),
            (s, []) => write!(f, "{} {} stretched", list(s), are(s)),
            ([], m) => write!(f, "the ends of {} differ", list(m)),
            (s, m) => write!(f, "{} {} stretched, the ends of {} differ", list(s), are(s), list(m)),
        }
    }
}

/// A solver for a box with any axes: [`DirectPoisson`] where all are uniform and none but the last has
/// ends that differ, else [`SeparablePoisson`].
///
/// ```
/// use fv_mesh::poisson::{AxisBounds, Poisson, PoissonAxis};
/// let x = PoissonAxis::uniform(4, 0.5, AxisBounds::Periodic);
/// let y = PoissonAxis { widths: vec![0.1, 0.2, 0.3], ends: AxisBounds::Neumann };
/// let poisson = Poisson::new([x, y], 0.0)?;
/// assert_eq!(poisson.choice().to_string(), "transforms along x, sweep along y: y is stretched");
/// # Ok::<(), fv_mesh::poisson::PoissonError>(())
/// ```
#[derive(Debug)]
pub struct Poisson<const D: usize> {
    choice: PoissonChoice,
    solver: Solver<D>,
}

#[derive(Debug)]
enum Solver<const D: usize> {
    Direct(Box<DirectPoisson<D>>),
    Separable(Box<SeparablePoisson<D>>),
}

impl<const D: usize> Poisson<D> {
    /// Solver for a box with these axes and the shift s ≥ 0 \[1/m²\]; D is 2 or 3.
    ///
    /// # Errors
    ///
    /// [`PoissonError::NoCells`], [`PoissonError::Spacing`], [`PoissonError::Shift`] and
    /// [`PoissonError::Eigen`].
    pub fn new(axes: [PoissonAxis; D], shift: f64) -> Result<Self, PoissonError> {
        for (axis, a) in axes.iter().enumerate() {
            a.check(axis)?;
        }
        let choice = PoissonChoice::new(&axes);
        let solver = if choice.kind == PoissonKind::Direct {
            let (cells, ends) = (axes.each_ref().map(PoissonAxis::cells), axes.each_ref().map(|a| a.ends));
            let spacing = axes.each_ref().map(|a| a.length() / a.cells() as f64);
            Solver::Direct(Box::new(DirectPoisson::new_helmholtz(cells, spacing, ends, shift)?))
        } else {
            Solver::Separable(Box::new(SeparablePoisson::new_helmholtz(axes, shift)?))
        };
        Ok(Self { choice, solver })
    }

    /// Which solver was made, and why.
    pub fn choice(&self) -> &PoissonChoice {
        &self.choice
    }

    /// Solves for the right-hand side that `fill` makes row by row; see [`DirectPoisson::solve_rows`].
    ///
    /// # Errors
    ///
    /// [`PoissonError::Length`] and [`PoissonError::NonFinite`]; `phi` is then left as it was.
    pub fn solve_rows<F>(&mut self, fill: F, phi: &mut [f64]) -> Result<PoissonInfo, PoissonError>
    where
        F: Fn(usize, &mut [f64]) + Sync,
    {
        match &mut self.solver {
            Solver::Direct(solver) => solver.solve_rows(fill, phi),
            Solver::Separable(solver) => solver.solve_rows(fill, phi),
        }
    }
}

impl<const D: usize> PoissonSolver<D> for Poisson<D> {
    fn solve(&mut self, rhs_in_phi_out: &mut [f64]) -> Result<PoissonInfo, PoissonError> {
        match &mut self.solver {
            Solver::Direct(solver) => solver.solve(rhs_in_phi_out),
            Solver::Separable(solver) => solver.solve(rhs_in_phi_out),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::AxisBounds::{self, DirichletNeumann, Neumann, NeumannDirichlet, Periodic};
    use super::*;

    fn uniform(n: usize, ends: AxisBounds) -> PoissonAxis {
        PoissonAxis::uniform(n, 0.1, ends)
    }

    fn stretched(n: usize, ends: AxisBounds) -> PoissonAxis {
        PoissonAxis { widths: (0..n).map(|i| 1.0 + i as f64).collect(), ends }
    }

    #[test]
    fn the_choice_is_explained() {
        use PoissonKind::{Direct, Separable};
        for (axes, kind, words) in [
            (
                [uniform(4, Periodic), uniform(5, Neumann), uniform(6, NeumannDirichlet)],
                Direct,
                "transforms along x and y, sweep along z: the ends of z differ",
            ),
            (
                [uniform(4, Periodic), uniform(5, Neumann), uniform(6, Periodic)],
                Direct,
                "transforms along x and y, sweep along z: all axes are uniform",
            ),
            (
                [uniform(4, Periodic), uniform(5, DirichletNeumann), uniform(6, Neumann)],
                Separable,
                "transforms along x and z, sweep along y: the ends of y differ",
            ),
            (
                [stretched(4, Neumann), stretched(6, Neumann), stretched(5, Neumann)],
                Separable,
                "products with 4 eigenvectors along x, products with 5 eigenvectors along z, \
                 sweep along y: x, y and z are stretched",
            ),
            (
                [uniform(4, NeumannDirichlet), stretched(6, Neumann), uniform(5, Neumann)],
                Separable,
                "transforms along z, products with 4 eigenvectors along x, \
                 sweep along y: y is stretched, the ends of x differ",
            ),
        ] {
            let poisson = Poisson::new(axes, 0.0).unwrap();
            assert_eq!(poisson.choice().to_string(), words);
            assert_eq!(poisson.choice().kind, kind);
            assert_eq!(matches!(poisson.solver, Solver::Direct(_)), kind == Direct);
        }
    }

    #[test]
    fn long_stretched_axes_cost_more() {
        let cost = |axes: [PoissonAxis; 2]| PoissonChoice::new(&axes).nanoseconds_per_cell;
        let one = cost([uniform(2000, Periodic), stretched(2000, Neumann)]);
        let both = cost([stretched(2000, Periodic), stretched(2000, Neumann)]);
        assert!(one < 10.0 && both > 100.0, "{one} {both}");
    }

    #[test]
    fn both_solvers_serve() {
        for axes in [[uniform(4, Neumann), uniform(5, Neumann)], [uniform(4, Neumann), stretched(5, Neumann)]]
        {
            // f is constant but for its mean.
            let mut poisson = Poisson::new(axes.clone(), 0.0).unwrap();
            let mut phi = vec![3.0; 20];
            let info = poisson.solve(&mut phi).unwrap();
            assert!((info.removed_mean - 3.0).abs() < 1e-14 && phi.iter().all(|p| p.abs() < 1e-13));
            // With a shift −s φ = f.
            let mut poisson = Poisson::new(axes, 2.0).unwrap();
            poisson.solve_rows(|_, row| row.fill(3.0), &mut phi).unwrap();
            assert!(phi.iter().all(|p| (p + 1.5).abs() < 1e-13), "{phi:?}");
        }
        let none = PoissonAxis { widths: vec![], ends: Neumann };
        assert_eq!(
            Poisson::new([uniform(4, Neumann), none], 0.0).map(|_| ()).unwrap_err(),
            PoissonError::NoCells { axis: 1 }
        );
    }
}
