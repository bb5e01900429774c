//! Boundary conditions of a scalar as the algorithms use them: ghost values.
use super::{Given, ScalarSide};
use crate::boundary::Lines;
use crate::{CartesianGrid, Field, FlowError};

/// The boundary conditions of a cell-centred scalar on every face of the sides of a box, at one time.
///
/// They fill the ghost layers by φ_ghost = value + factor·φ_inside, where the ghost lies as far outside as the cell
/// inside: the face between them has φ = ½(φ_ghost + φ_inside) and ∂φ/∂n = (φ_ghost − φ_inside)/h.
#[derive(Clone, Debug)]
pub struct ScalarBoundaries<const D: usize> {
    grid: CartesianGrid<D>,
    lines: [Lines; D],
    states: [Option<Box<[SideState; 2]>>; D],
    time: f64,
}

/// One bounded side. Lists have one entry per line of cells that ends here.
#[derive(Clone, Debug)]
struct SideState {
    side: ScalarSide,
    /// Place of the side along its axis.
    at: f64,
    /// Which patch.
    patch: Vec<usize>,
    /// Of the first and second ghost: value per given c, value and factor.
    scale: [Vec<f64>; 2],
    value: [Vec<f64>; 2],
    factor: [Vec<f64>; 2],
    /// By how much the first ghost's value changed when time was last set.
    change: Vec<f64>,
    /// Nothing here changes in time.
    steady: bool,
}

impl<const D: usize> ScalarBoundaries<D> {
    /// `sides[axis]` are the lower and upper side, at time 0.
    ///
    /// # Errors
    /// [`FlowError::Boundary`] if only one side of an axis is periodic, patches leave out a face or nest, or numbers make
    /// no sense.
    pub fn new(grid: &CartesianGrid<D>, sides: [[ScalarSide; 2]; D]) -> Result<Self, FlowError> {
        let lines: [Lines; D] = std::array::from_fn(|a| Lines::new(grid, a));
        let mut states = [const { None }; D];
        for (a, pair) in sides.into_iter().enumerate() {
            if pair[0].is_periodic() != pair[1].is_periodic() {
                let what = format!("axis {a} periodic at one side only; make both periodic or neither");
                return Err(FlowError::Boundary { what });
            }
            pair.iter().try_for_each(|side| side.check(a, false))?;
            if !pair[0].is_periodic() {
                let [lower, upper] = pair;
                let new = |side, upper| SideState::new(grid, &lines[a], side, upper);
                states[a] = Some(Box::new([new(lower, false)?, new(upper, true)?]));
            }
        }
        let mut new = Self { grid: grid.clone(), lines, states, time: 0.0 };
        new.set(0.0, true);
        // Nothing has changed yet.
        new.states.iter_mut().flatten().flat_map(|p| p.iter_mut()).for_each(|s| s.change.fill(0.0));
        Ok(new)
    }

    fn set(&mut self, time: f64, all: bool) {
        self.time = time;
        for (lines, pair) in self.lines.iter().zip(&mut self.states) {
            for state in pair.iter_mut().flat_map(|p| p.iter_mut()).filter(|s| all || !s.steady) {
                state.set(&self.grid, lines, time);
            }
        }
    }

    /// Takes what is given at `time` \[s\].
    pub fn set_time(&mut self, time: f64) {
        self.set(time, false);
    }
    /// The time of what is given \[s\].
    pub fn time(&self) -> f64 {
        self.time
    }
    /// The grid.
    pub fn grid(&self) -> &CartesianGrid<D> {
        &self.grid
    }
    /// Which axes are periodic.
    pub fn periodic(&self) -> [bool; D] {
        std::array::from_fn(|a| self.states[a].is_none())
    }

    /// Fills the ghost layers of `phi`, which is a field on the same grid.
    ///
    /// # Errors
    /// [`FlowError::Grid`] if it has another size.
    pub fn fill(&self, phi: &mut Field<D>) -> Result<(), FlowError> {
        phi.check(&self.grid)?;
        self.fill_ghosts(phi);
        Ok(())
    }

    pub(crate) fn fill_ghosts(&self, phi: &mut Field<D>) {
        let phi = phi.data_mut();
        for (lines, pair) in self.lines.iter().zip(&self.states) {
            for (upper, state) in pair.iter().flat_map(|p| p.iter()).enumerate() {
                state.fill(lines, upper == 1, phi);
            }
        }
        // Last, so that periodic ghosts repeat the bounded ones.
        for (lines, _) in self.lines.iter().zip(&self.states).filter(|(_, s)| s.is_none()) {
            lines.wrap(phi);
        }
    }

    /// The lines along axis `a`.
    pub(super) fn lines(&self, a: usize) -> &Lines {
        &self.lines[a]
    }
    /// The ends of the lines along axis `a`; `None` if periodic.
    pub(super) fn ends(&self, a: usize) -> Option<Ends<'_>> {
        let pair = self.states[a].as_deref()?;
        Some(Ends {
            factor: [&pair[0].factor[0], &pair[1].factor[0]],
            change: [&pair[0].change, &pair[1].change],
            steady: pair.iter().all(|s| s.steady),
        })
    }
}

/// The lower and upper ends of the lines along an axis: factors and changes of the first ghosts.
pub(super) struct Ends<'a> {
    pub(super) factor: [&'a [f64]; 2],
    pub(super) change: [&'a [f64]; 2],
    pub(super) steady: bool,
}

impl SideState {
    fn new<const D: usize>(
        grid: &CartesianGrid<D>,
        lines: &Lines,
        side: ScalarSide,
        upper: bool,
    ) -> Result<Self, FlowError> {
        let axis = grid.axis(lines.axis);
        let at = if upper { axis.upper() } else { axis.lower() };
        let list = || vec![0.0; lines.len()];
        let patch =
            (0..lines.len()).map(|l| find(grid, lines, &side, at, l, upper)).collect::<Result<_, _>>()?;
        let steady = match &side {
            ScalarSide::Patches(patches) => patches.iter().all(|p| is_steady(&p.side)),
            side => is_steady(side),
        };
        let two = || [list(), list()];
        let mut new =
            Self { side, at, patch, scale: two(), value: two(), factor: two(), change: list(), steady };
        let width = |i: usize| axis.width(if upper { axis.cells() - 1 - i } else { i });
        let second = if axis.cells() > 1 { 2.0 * width(0) + width(1) } else { width(0) };
        for l in 0..lines.len() {
            // Checked to have one.
            let Some((a, b, _)) = new.condition(l) else { continue };
            for (k, gap) in [width(0), second].into_iter().enumerate() {
                let scale = 1.0 / (0.5 * a + b / gap);
                new.scale[k][l] = scale;
                new.factor[k][l] = scale * (b / gap - 0.5 * a);
            }
        }
        Ok(new)
    }

    fn condition(&self, l: usize) -> Option<(f64, f64, &Given)> {
        match &self.side {
            ScalarSide::Patches(patches) => patches.get(self.patch[l])?.side.condition(),
            side => side.condition(),
        }
    }

    fn set<const D: usize>(&mut self, grid: &CartesianGrid<D>, lines: &Lines, time: f64) {
        for l in 0..lines.len() {
            let Some((.., given)) = self.condition(l) else { continue };
            let c = given.at(lines.face_centre(grid, self.at, l), time);
            let value = self.scale[0][l] * c;
            self.change[l] = value - self.value[0][l];
            self.value[0][l] = value;
            self.value[1][l] = self.scale[1][l] * c;
        }
    }

    fn fill(&self, lines: &Lines, upper: bool, phi: &mut [f64]) {
        let (n, s) = (lines.cells, lines.step);
        let second = if n > 1 { s } else { 0 };
        let laws = self.value[0].iter().zip(&self.factor[0]).zip(self.value[1].iter().zip(&self.factor[1]));
        for (o, ((v0, f0), (v1, f1))) in lines.starts().zip(laws) {
            if upper {
                let last = o + (n - 1) * s;
                phi[last + s] = v0 + f0 * phi[last];
                phi[last + 2 * s] = v1 + f1 * phi[last - second];
            } else {
                phi[o - s] = v0 + f0 * phi[o];
                phi[o - 2 * s] = v1 + f1 * phi[o + second];
            }
        }
    }
}

fn is_steady(side: &ScalarSide) -> bool {
    !matches!(side.condition(), Some((_, _, Given::Function(_))))
}

/// Number of the patch that holds the face at which line `l` ends.
fn find<const D: usize>(
    grid: &CartesianGrid<D>,
    lines: &Lines,
    side: &ScalarSide,
    at: f64,
    l: usize,
    upper: bool,
) -> Result<usize, FlowError> {
    let ScalarSide::Patches(patches) = side else { return Ok(0) };
    let (a, x) = (lines.axis, lines.face_centre(grid, at, l));
    let across = || (0..D).filter(|&b| b != a);
    patches.iter().position(|p| across().all(|b| p.lower[b] <= x[b] && x[b] <= p.upper[b])).ok_or_else(|| {
        FlowError::Boundary {
            what: format!(
                "patches of a scalar on the {} side of axis {a} that leave out the face at {x:?} m; cover the whole side",
                ["lower", "upper"][usize::from(upper)]
            ),
        }
    })
}
