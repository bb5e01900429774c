//! The boundary conditions as the flow algorithms use them: values on every face of the bounded sides.
use super::side_state::place;
use super::{FaceKind, Lines, Side, SideState, Sides};
use crate::metrics::Metrics;
use crate::{CartesianGrid, FlowError};

/// All sides of the box.
#[derive(Clone, Debug)]
pub(crate) struct Boundaries<const D: usize> {
    pub(super) grid: CartesianGrid<D>,
    pub(crate) sides: Sides<D>,
    pub(super) lines: [Lines; D],
    pub(super) states: [Option<Box<[SideState<D>; 2]>>; D],
    /// What outlets or inlets were shifted by to balance \[m³/s\].
    pub(crate) imbalance: f64,
}

impl<const D: usize> Boundaries<D> {
    pub(crate) fn new(
        grid: &CartesianGrid<D>,
        sides: Sides<D>,
        metrics: &Metrics<D>,
    ) -> Result<Self, FlowError> {
        let lines: [Lines; D] = std::array::from_fn(|a| Lines::new(grid, a));
        let mut states = [const { None }; D];
        for a in 0..D {
            if !sides.periodic(a) {
                let new = |upper: bool| SideState::new(grid, &sides, &lines[a], upper);
                states[a] = Some(Box::new([new(false)?, new(true)?]));
            }
        }
        let mut new = Self { grid: grid.clone(), sides, lines, states, imbalance: 0.0 };
        new.set(metrics, 0.0, true);
        // Nothing has changed yet.
        for state in new.states.iter_mut().flatten().flat_map(|p| p.iter_mut()) {
            state.laws.iter_mut().for_each(|law| law.change.fill(0.0));
        }
        new.balance(metrics)?;
        for (lines, pair) in new.lines.iter().zip(&mut new.states) {
            for state in pair.iter_mut().flat_map(|p| p.iter_mut()) {
                state.rates = state.largest_rates(grid, metrics, lines);
            }
        }
        Ok(new)
    }

    /// Sets what is given for time `time`; `all` includes what does not change.
    fn set(&mut self, metrics: &Metrics<D>, time: f64, all: bool) {
        for (lines, pair) in self.lines.iter().zip(&mut self.states) {
            for state in pair.iter_mut().flat_map(|p| p.iter_mut()) {
                if all || !state.steady {
                    state.set(&self.grid, &self.sides, metrics, lines, time);
                }
            }
        }
    }

    /// Takes the velocity through outlets from `u(x)` \[m/s\].
    pub(crate) fn start(&mut self, metrics: &Metrics<D>, u: impl Fn([f64; D]) -> [f64; D]) {
        for (a, (lines, pair)) in self.lines.iter().zip(&mut self.states).enumerate() {
            for state in pair.iter_mut().flat_map(|p| p.iter_mut()) {
                for l in (0..lines.len()).filter(|&l| lines.inside(l)) {
                    if !state.kind[l].is_fixed() {
                        let x = place(metrics, lines, a, state.at, l);
                        state.normal[l] = u(std::array::from_fn(|b| x[b]))[a];
                    }
                }
            }
        }
    }

    /// Moves what is given on to `time`, and remembers by how much it changed.
    ///
    /// # Errors
    /// [`FlowError::MassBalance`] if what enters cannot leave.
    pub(crate) fn advance(&mut self, metrics: &Metrics<D>, time: f64) -> Result<(), FlowError> {
        for state in self.states.iter_mut().flatten().flat_map(|p| p.iter_mut()) {
            for (change, normal) in state.normal_change.iter_mut().zip(&state.normal) {
                *change = -normal;
            }
        }
        self.set(metrics, time, false);
        let mut outlets = false;
        for state in self.states.iter_mut().flatten().flat_map(|p| p.iter_mut()) {
            for l in 0..state.kind.len() {
                match state.kind[l] {
                    // The shift of the last step is taken back.
                    FaceKind::Inlet => state.normal[l] = state.given[l],
                    FaceKind::Closed => {}
                    FaceKind::Convective | FaceKind::Pressure => outlets = true,
                }
            }
        }
        if !outlets && !self.sides.closed() {
            self.balance(metrics)?;
        }
        for state in self.states.iter_mut().flatten().flat_map(|p| p.iter_mut()) {
            for (change, normal) in state.normal_change.iter_mut().zip(&state.normal) {
                *change += normal;
            }
        }
        Ok(())
    }

    /// Closes what immersed walls close of the sides: `open(a, index)` is the open share of the face of axis `a` with this
    /// storage index. What enters and leaves passes the open part.
    ///
    /// # Errors
    /// [`FlowError::MassBalance`] if what enters cannot leave.
    pub(crate) fn narrow(
        &mut self,
        grid: &CartesianGrid<D>,
        metrics: &Metrics<D>,
        open: impl Fn(usize, usize) -> f64,
    ) -> Result<(), FlowError> {
        let stride = grid.stride();
        for (a, (lines, pair)) in self.lines.iter().zip(&mut self.states).enumerate() {
            for (upper, state) in pair.iter_mut().flat_map(|p| p.iter_mut()).enumerate() {
                state.open = vec![1.0; lines.len()];
                for (l, o) in lines.starts().enumerate().filter(|&(l, _)| lines.inside(l)) {
                    let share = open(a, o + upper * lines.cells * stride[a]);
                    if share == 0.0 {
                        state.kind[l] = FaceKind::Closed;
                        (state.normal[l], state.given[l]) = (0.0, 0.0);
                    }
                    state.open[l] = share;
                }
            }
        }
        self.balance(metrics)
    }

    /// Axes and storage indices of the faces on which the pressure is given.
    pub(crate) fn pressure_faces(
        &self,
        grid: &CartesianGrid<D>,
    ) -> std::collections::HashSet<(usize, usize)> {
        let mut out = std::collections::HashSet::new();
        for (a, (lines, pair)) in self.lines.iter().zip(&self.states).enumerate() {
            for (upper, state) in pair.iter().flat_map(|p| p.iter()).enumerate() {
                let free = lines.starts().enumerate().filter(|&(l, _)| state.kind[l] == FaceKind::Pressure);
                out.extend(free.map(|(_, o)| (a, o + upper * lines.cells * grid.stride()[a])));
            }
        }
        out
    }

    /// The same on a grid of the same size.
    pub(crate) fn set_grid(&mut self, grid: &CartesianGrid<D>) {
        self.grid = grid.clone();
        for (a, pair) in self.states.iter_mut().enumerate() {
            for (state, at) in
                pair.iter_mut().flat_map(|p| p.iter_mut()).zip([grid.axis(a).lower(), grid.axis(a).upper()])
            {
                state.at = at;
            }
        }
    }

    /// Takes the velocity through the outlets on the sides of axis `a` from its component along that axis.
    pub(crate) fn take_through(&mut self, a: usize, u: &[f64]) {
        let lines = &self.lines[a];
        for (upper, state) in self.states[a].iter_mut().flat_map(|p| p.iter_mut()).enumerate() {
            for (l, o) in lines.starts().enumerate() {
                if !state.kind[l].is_fixed() {
                    state.normal[l] = u[o + upper * lines.cells * lines.step];
                }
            }
        }
    }

    /// Does anything on the sides beside axis `a` hold on parts of them only?
    pub(crate) fn patched_beside(&self, a: usize) -> bool {
        let beside = self.sides.0.iter().enumerate().filter(|(b, _)| *b != a);
        beside.flat_map(|(_, pair)| pair).any(|side| matches!(side, Side::Patches(_)))
    }

    /// The lines along axis `a`.
    pub(crate) fn lines(&self, a: usize) -> &Lines {
        &self.lines[a]
    }

    /// Per side of axis `a`: what holds at each face of the side, in the order of dense cells; `None` if periodic.
    pub(crate) fn kinds(&self, a: usize) -> Option<[Vec<FaceKind>; 2]> {
        let lines = &self.lines[a];
        let pair = self.states[a].as_ref()?;
        Some(std::array::from_fn(|upper| {
            (0..lines.len()).filter(|&l| lines.inside(l)).map(|l| pair[upper].kind[l]).collect()
        }))
    }

    /// Largest speed given on a side, per component, over the width of the cells there along that component.
    pub(crate) fn rates(&self, metrics: &Metrics<D>) -> [f64; D] {
        let mut rates = [0.0_f64; D];
        for (lines, pair) in self.lines.iter().zip(&self.states) {
            for state in pair.iter().flat_map(|p| p.iter()) {
                let side = if state.settled() {
                    state.rates
                } else {
                    state.largest_rates(&self.grid, metrics, lines)
                };
                rates.iter_mut().zip(side).for_each(|(rate, side)| *rate = rate.max(side));
            }
        }
        rates
    }

    /// The velocities on the sides, which outlets and implicit diffusion remember; all sides one after the other.
    pub(crate) fn memory(&self, memory: &mut Vec<f64>) {
        memory.clear();
        for state in self.states.iter().flatten().flat_map(|p| p.iter()) {
            memory.extend_from_slice(&state.normal);
            state.laws.iter().for_each(|law| memory.extend_from_slice(&law.value));
        }
    }

    /// Takes back what [`memory`](Self::memory) gave.
    pub(crate) fn recall(&mut self, memory: &[f64]) {
        let mut memory = memory.iter();
        for state in self.states.iter_mut().flatten().flat_map(|p| p.iter_mut()) {
            let laws = state.laws.iter_mut().flat_map(|law| &mut law.value);
            for (value, &kept) in state.normal.iter_mut().chain(laws).zip(&mut memory) {
                *value = kept;
            }
        }
    }
}
