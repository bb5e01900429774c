//! Interpolation at any point.
use super::SampleError;
use crate::algebra::check_grid;
use crate::grid::GHOSTS;
use crate::metrics::{Metrics, Nodes};
use crate::{CartesianGrid, Field, Sides, Velocity};

/// What is sampled.
#[derive(Clone, Copy, Debug)]
pub enum Quantity<'a, const D: usize> {
    /// A scalar at the cell centres.
    Cells(&'a Field<D>),
    /// A staggered velocity.
    Velocity(&'a Velocity<D>),
}

impl<'a, const D: usize> From<&'a Field<D>> for Quantity<'a, D> {
    fn from(field: &'a Field<D>) -> Self {
        Self::Cells(field)
    }
}
impl<'a, const D: usize> From<&'a Velocity<D>> for Quantity<'a, D> {
    fn from(velocity: &'a Velocity<D>) -> Self {
        Self::Velocity(velocity)
    }
}

impl<const D: usize> Quantity<'_, D> {
    pub(super) fn components(&self) -> usize {
        match self {
            Self::Cells(_) => 1,
            Self::Velocity(_) => D,
        }
    }
    /// Names of the columns.
    pub(super) fn columns(&self, name: &str) -> impl Iterator<Item = String> {
        let scalar = self.components() == 1;
        (0..self.components())
            .map(move |c| if scalar { name.to_owned() } else { format!("{name}_{}", ["x", "y", "z"][c]) })
    }
}

/// Interpolates linearly along each axis between the nodes around a point (bilinear, trilinear): exact for linear
/// fields, else of second order, on stretched grids too.
///
/// A velocity takes its values at bounded sides from the boundary conditions, through its faces there and its ghosts.
/// A cell field is extrapolated linearly from the last two cells in the half cell beside a bounded side, as its
/// ghosts may hold anything, unless [`with_ghosts`](Self::with_ghosts) says that they carry the boundary values. Along
/// periodic axes points and nodes repeat.
///
/// ```
/// use fv_mesh::{CartesianGrid, Fluid, Projection, Sampler, Side};
/// let fluid = Fluid { density: 1.0, viscosity: 0.1 };
/// let grid = CartesianGrid::new([8, 8], [1.0, 1.0])?;
/// let mut flow = Projection::new(grid, Side::Periodic.everywhere(), fluid)?;
/// flow.set_velocity(|_| [1.0, 2.0]);
/// let sampler = Sampler::new(flow.grid(), flow.sides());
/// assert_eq!(sampler.velocity(flow.velocity(), [0.3, 0.4])?, [1.0, 2.0]);
/// assert_eq!(sampler.at(flow.pressure(), [0.3, 0.4])?, 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Sampler<const D: usize> {
    grid: CartesianGrid<D>,
    metrics: Metrics<D>,
    ghosts: bool,
}

/// The two nodes around a coordinate (cell numbers, −1 and n being ghosts) and the share of the upper one.
#[derive(Clone, Copy, Debug)]
struct Pair {
    nodes: [isize; 2],
    share: f64,
}

impl<const D: usize> Sampler<D> {
    /// Samples fields on `grid` in a box with these sides.
    pub fn new(grid: &CartesianGrid<D>, sides: &Sides<D>) -> Self {
        Self::on(grid, std::array::from_fn(|a| sides.periodic(a)))
    }

    pub(crate) fn on(grid: &CartesianGrid<D>, periodic: [bool; D]) -> Self {
        Self { grid: grid.clone(), metrics: Metrics::new(grid, periodic), ghosts: false }
    }

    /// The same for cell fields whose first ghost layer, corners included, holds the boundary values: twice the
    /// value on the side less the last cell's.
    #[must_use]
    pub fn with_ghosts(mut self) -> Self {
        self.ghosts = true;
        self
    }

    /// The grid.
    pub fn grid(&self) -> &CartesianGrid<D> {
        &self.grid
    }

    /// The cell field at `x` \[m\].
    ///
    /// # Errors
    /// [`SampleError::Outside`] for a point beyond a bounded side, [`SampleError::Grid`] for a field on another grid.
    pub fn at(&self, field: &Field<D>, x: [f64; D]) -> Result<f64, SampleError> {
        check_grid(&self.grid, field.grid())?;
        Ok(self.value(field, None, self.inside(x)?))
    }

    /// The velocity at `x` \[m\], m/s.
    ///
    /// # Errors
    /// Those of [`at`](Self::at).
    pub fn velocity(&self, velocity: &Velocity<D>, x: [f64; D]) -> Result<[f64; D], SampleError> {
        check_grid(&self.grid, velocity.field(0).grid())?;
        let x = self.inside(x)?;
        Ok(std::array::from_fn(|c| self.value(velocity.field(c), Some(c), x)))
    }

    /// Errs unless `quantity` lives on the grid.
    pub(super) fn check(&self, quantity: &Quantity<'_, D>) -> Result<(), SampleError> {
        let grid = match quantity {
            Quantity::Cells(field) => field.grid(),
            Quantity::Velocity(velocity) => velocity.field(0).grid(),
        };
        Ok(check_grid(&self.grid, grid)?)
    }

    /// Component `c` of a quantity at a point that [`inside`](Self::inside) gave.
    pub(super) fn component(&self, quantity: &Quantity<'_, D>, c: usize, x: [f64; D]) -> f64 {
        match quantity {
            Quantity::Cells(field) => self.value(field, None, x),
            Quantity::Velocity(velocity) => self.value(velocity.field(c), Some(c), x),
        }
    }

    /// `x` in the box, wrapped along periodic axes.
    pub(super) fn inside(&self, x: [f64; D]) -> Result<[f64; D], SampleError> {
        let mut wrapped = x;
        for a in 0..D {
            wrapped[a] = self.inside_axis(a, x[a])?;
        }
        Ok(wrapped)
    }

    pub(super) fn inside_axis(&self, a: usize, x: f64) -> Result<f64, SampleError> {
        let axis = self.grid.axis(a);
        let (lower, upper) = (axis.lower(), axis.upper());
        if (lower..=upper).contains(&x) {
            return Ok(x);
        }
        if self.metrics.periodic[a] && x.is_finite() {
            return Ok((lower + (x - lower).rem_euclid(axis.length())).clamp(lower, upper));
        }
        Err(SampleError::Outside { axis: a, x, lower, upper })
    }

    /// The value at a point in the box of a field on the nodes of component `face`.
    fn value(&self, field: &Field<D>, face: Option<usize>, x: [f64; D]) -> f64 {
        let mut sum = 0.0;
        self.each_corner(face, x, |o, weight| {
            // What is not a number does not enter with weight 0.
            if weight != 0.0 {
                sum += weight * field.data()[o];
            }
        });
        sum
    }

    /// The value at the place in the box that is nearest to `x`, from those nodes around it that are `known`, by storage index,
    /// never extrapolated; `None` without any.
    pub(crate) fn known_value(
        &self,
        field: &Field<D>,
        face: Option<usize>,
        x: [f64; D],
        known: impl Fn(usize) -> bool,
    ) -> Option<f64> {
        let inside = |a: usize| {
            let axis = self.grid.axis(a);
            self.inside_axis(a, x[a]).unwrap_or_else(|_| x[a].clamp(axis.lower(), axis.upper()))
        };
        let x = std::array::from_fn(inside);
        // Where the weights of those known are next to nothing, all known ones count alike.
        let [mut by_weight, mut alike] = [[0.0; 2]; 2];
        self.each_corner(face, x, |o, weight| {
            if known(o) {
                let value = field.data()[o];
                for (sum, weight) in [(&mut by_weight, weight.max(0.0)), (&mut alike, 1.0)] {
                    *sum = [sum[0] + weight * value, sum[1] + weight];
                }
            }
        });
        let [sum, weight] = if by_weight[1] > 1e-3 { by_weight } else { alike };
        (weight > 0.0).then(|| sum / weight)
    }

    /// Calls `f` with the nodes of component `face` around a point in the box, by storage index, and their weights.
    fn each_corner(&self, face: Option<usize>, x: [f64; D], mut f: impl FnMut(usize, f64)) {
        let stride = self.grid.stride();
        let pairs: [Pair; D] = std::array::from_fn(|a| self.pair(a, face, x[a]));
        for corner in 0..1 << D {
            let (mut weight, mut o) = (1.0, self.grid.base());
            for a in 0..D {
                let upper = corner >> a & 1;
                weight *= [1.0 - pairs[a].share, pairs[a].share][upper];
                o = o.wrapping_add_signed(pairs[a].nodes[upper] * stride[a] as isize);
            }
            f(o, weight);
        }
    }

    /// The nodes of component `face` around `x`, which lies in the box.
    fn pair(&self, a: usize, face: Option<usize>, x: f64) -> Pair {
        let (axis, n) = (self.grid.axis(a), self.grid.axis(a).cells() as isize);
        let cell = axis.locate(x).unwrap_or(0) as isize;
        let (nodes, low) = match Metrics::<D>::family(face, a) {
            Nodes::Faces => (&self.metrics.axes[a].faces.x, cell),
            Nodes::Centres => {
                let nodes = &self.metrics.axes[a].centres.x;
                let below = x < nodes[GHOSTS + cell as usize];
                let mut low = if below { cell - 1 } else { cell };
                if face.is_none() && !self.ghosts && !self.metrics.periodic[a] {
                    if n == 1 {
                        return Pair { nodes: [0, 0], share: 0.0 };
                    }
                    low = low.clamp(0, n - 2);
                }
                (nodes, low)
            }
        };
        let place = |i: isize| nodes[(i + GHOSTS as isize) as usize];
        let share = (x - place(low)) / (place(low + 1) - place(low));
        let wrap = |i: isize| if self.metrics.periodic[a] { i.rem_euclid(n) } else { i };
        Pair { nodes: [wrap(low), wrap(low + 1)], share }
    }
}
