//! The boundary conditions as the flow algorithms use them: values on every face of the bounded sides.
mod pressure_faces;

pub(crate) use pressure_faces::PressureFace;

use super::{Lines, Patch, Profile, Side, Sides};
use crate::grid::GHOSTS;
use crate::metrics::Metrics;
use crate::{CartesianGrid, Field, FlowError};

/// What holds for the velocity through one face of a side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FaceKind {
    /// Nothing flows through.
    Closed,
    /// Given by an inlet.
    Inlet,
    /// Carried out by the mean outflow.
    Convective,
    /// Follows from the pressure.
    Pressure,
}

impl FaceKind {
    /// The velocity through the face is given.
    pub(crate) fn is_fixed(self) -> bool {
        matches!(self, Self::Closed | Self::Inlet)
    }
}

/// What holds for one component along a side.
#[derive(Clone, Debug, Default)]
struct Law {
    /// The component has no gradient across the side (else it is given).
    free: Vec<bool>,
    /// What is given \[m/s\].
    value: Vec<f64>,
    /// By how much `value` changed in this step.
    change: Vec<f64>,
}

/// Ghost value half a cell beyond a side where u_w is given, by the parabola through the side and the two nodes before it:
/// wall·u_w + first·u₀ + second·u₁. (The straight line would make an error of order 1 in the second difference.)
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extrapolation {
    pub(crate) wall: f64,
    pub(crate) first: f64,
    pub(crate) second: f64,
}

impl Extrapolation {
    /// For the first two of `n` cells from the side, `widths` wide; a straight line if there is only one.
    pub(crate) fn new(n: usize, widths: [f64; 2]) -> Self {
        if n < 2 {
            return Self { wall: 2.0, first: -1.0, second: 0.0 };
        }
        let (a, b) = (0.5 * widths[0], widths[0] + 0.5 * widths[1]);
        Self { wall: 2.0 * (a + b) / b, first: -(a + b) / (b - a), second: 2.0 * a * a / (b * (b - a)) }
    }
}

/// The ends of the lines along an axis as one component sees them.
pub(crate) struct Ends<'a> {
    kinds: [EndKinds<'a>; 2],
    changes: [&'a [f64]; 2],
    /// What a change counts for in the ghost.
    weights: [f64; 2],
    /// Some value given here changes in time.
    pub(crate) moving: bool,
}

enum EndKinds<'a> {
    Normal(&'a [FaceKind]),
    Along(&'a [bool]),
}

impl Ends<'_> {
    /// Bit 0 is set if the value at the lower end of line `l` is free, bit 1 if that at the upper end is.
    pub(crate) fn kind(&self, l: usize) -> usize {
        let free = |k: &EndKinds| match k {
            EndKinds::Normal(kinds) => !kinds[l].is_fixed(),
            EndKinds::Along(free) => free[l],
        };
        usize::from(free(&self.kinds[0])) + 2 * usize::from(free(&self.kinds[1]))
    }
    /// The kind that all lines share.
    pub(crate) fn common_kind(&self) -> Option<usize> {
        let first = self.kind(0);
        (1..self.changes[0].len()).all(|l| self.kind(l) == first).then_some(first)
    }
    /// By how much the values beyond the ends changed in this step through what is given.
    pub(crate) fn changes(&self, l: usize) -> [f64; 2] {
        [self.weights[0] * self.changes[0][l], self.weights[1] * self.changes[1][l]]
    }
}

/// One bounded side. All lists have one entry per line of nodes that ends here.
#[derive(Clone, Debug)]
struct SideState<const D: usize> {
    side: Side,
    kind: Vec<FaceKind>,
    /// Velocity along the axis on the side's faces.
    normal: Vec<f64>,
    /// What is given of it, before inlets are balanced.
    given: Vec<f64>,
    /// By how much it changed in this step through what is given.
    normal_change: Vec<f64>,
    /// Pressure on the side where it is given.
    pressure: Vec<f64>,
    /// Of the other components.
    laws: [Law; D],
    /// Place of the side along its axis.
    at: f64,
    /// Nothing here changes in time.
    steady: bool,
    beyond: Extrapolation,
}

/// The largest imbalance of inlets, relative to what enters, that is put down to summing over faces.
const SUMMING_ERROR: f64 = 0.02;

/// All sides of the box.
#[derive(Clone, Debug)]
pub(crate) struct Boundaries<const D: usize> {
    grid: CartesianGrid<D>,
    pub(crate) sides: Sides<D>,
    lines: [Lines; D],
    states: [Option<Box<[SideState<D>; 2]>>; D],
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

    /// Moves the convective outlets on by `dt`; `velocity` is the predicted one.
    ///
    /// # Errors
    /// [`FlowError::MassBalance`] if what enters cannot leave.
    pub(crate) fn advance_outlets(
        &mut self,
        metrics: &Metrics<D>,
        velocity: &[Field<D>; D],
        dt: f64,
        viscosity: f64,
    ) -> Result<(), FlowError> {
        if self.sides.closed() {
            return Ok(());
        }
        let mut outlets = false;
        for (a, (lines, pair)) in self.lines.iter().zip(&mut self.states).enumerate() {
            let u = velocity[a].data();
            let Some(pair) = pair else { continue };
            for (upper, state) in pair.iter_mut().enumerate() {
                if state.kind.iter().all(|k| k.is_fixed()) {
                    continue;
                }
                outlets = true;
                // The largest speed, and that of viscosity, so that what is left when the outflow stops leaves too.
                let fastest = (0..lines.len())
                    .filter(|&l| lines.inside(l) && state.kind[l] == FaceKind::Convective)
                    .fold(0.0, |top: f64, l| top.max(state.normal[l].abs()));
                let gap = self.grid.axis(a).width(if upper == 1 { lines.cells - 1 } else { 0 });
                let courant = (fastest + viscosity / gap) * dt / gap;
                for (l, o) in lines.starts().enumerate().filter(|&(l, _)| lines.inside(l)) {
                    if state.kind[l] == FaceKind::Convective {
                        let inside =
                            u[if upper == 1 { o + (lines.cells - 1) * lines.step } else { o + lines.step }];
                        state.normal[l] = (state.normal[l] + courant * inside) / (1.0 + courant);
                    }
                }
            }
        }
        // Inlets alone have been balanced.
        if outlets { self.balance(metrics) } else { Ok(()) }
    }

    /// Shifts what leaves through convective outlets so that it equals what enters. Without outlets the inlets are
    /// shifted, if what they miss is no more than the error of summing a smooth function over faces may be.
    fn balance(&mut self, metrics: &Metrics<D>) -> Result<(), FlowError> {
        let (mut net, mut inflow) = (0.0, 0.0);
        let (mut outlet, mut inlet, mut free) = (0.0, 0.0, false);
        let mut fastest = 0.0_f64;
        for (lines, pair) in self.lines.iter().zip(&self.states) {
            for (upper, state) in pair.iter().flat_map(|p| p.iter()).enumerate() {
                for l in (0..lines.len()).filter(|&l| lines.inside(l)) {
                    let along = state.laws.iter().filter_map(|law| law.value.get(l));
                    fastest = along.chain([&state.normal[l]]).fold(fastest, |top, u| top.max(u.abs()));
                    let face = face_area(metrics, lines, l, D);
                    let outward = [-1.0, 1.0][upper] * face * state.normal[l];
                    net += outward;
                    inflow += (-outward).max(0.0);
                    match state.kind[l] {
                        FaceKind::Closed => {}
                        FaceKind::Inlet => inlet += face,
                        FaceKind::Convective => outlet += face,
                        FaceKind::Pressure => free = true,
                    }
                }
            }
        }
        self.imbalance = 0.0;
        if !net.is_finite() {
            let what = "a velocity at an inlet that is not finite; give a function that is".into();
            return Err(FlowError::Boundary { what });
        }
        if free || net == 0.0 {
            return Ok(());
        }
        // Round-off of a lid, say, given by a function.
        let round_off = 1e-12 * inlet * fastest;
        if outlet == 0.0 && net.abs() > round_off.max(SUMMING_ERROR * inflow.max(inflow + net)) {
            return Err(FlowError::MassBalance { net, inflow });
        }
        let (kind, area) =
            if outlet > 0.0 { (FaceKind::Convective, outlet) } else { (FaceKind::Inlet, inlet) };
        self.imbalance = net;
        let shift = net / area;
        for pair in self.states.iter_mut().flatten() {
            for (upper, state) in pair.iter_mut().enumerate() {
                for (normal, _) in state.normal.iter_mut().zip(&state.kind).filter(|&(_, k)| *k == kind) {
                    *normal -= [-1.0, 1.0][upper] * shift;
                }
            }
        }
        Ok(())
    }

    /// Boundary faces and ghost layers of velocity component `c`.
    pub(crate) fn fill_velocity(&self, c: usize, u: &mut Field<D>) {
        let u = u.data_mut();
        for (a, (lines, pair)) in self.lines.iter().zip(&self.states).enumerate() {
            for (upper, state) in pair.iter().flat_map(|p| p.iter()).enumerate() {
                if a == c { state.through(lines, upper, u) } else { state.along(lines, upper, c, u) }
            }
        }
        self.wrap(u);
    }

    /// Ghosts of the periodic axes: last, so that they repeat those of the bounded ones.
    fn wrap(&self, u: &mut [f64]) {
        for lines in self.lines.iter().filter(|l| self.sides.periodic(l.axis)) {
            wrap(lines, u);
        }
    }

    /// Ghost layer of a pressure: periodic, without normal gradient, or given on the side.
    pub(crate) fn fill_pressure(&self, p: &mut Field<D>) {
        self.fill_cells(p, 2.0);
    }
    /// Ghost layer of a pressure correction: the same with zero where the pressure is given.
    pub(crate) fn fill_correction(&self, phi: &mut Field<D>) {
        self.fill_cells(phi, 0.0);
    }

    /// Ghost layer of a scalar without gradient across any bounded side.
    pub(crate) fn fill_even(&self, phi: &mut Field<D>) {
        let phi = phi.data_mut();
        for lines in self.lines.iter().filter(|l| !self.sides.periodic(l.axis)) {
            for o in lines.starts() {
                for upper in 0..2 {
                    let (inside, ghost) = ends(lines, o, upper);
                    phi[ghost] = phi[inside];
                }
            }
        }
        self.wrap(phi);
    }

    fn fill_cells(&self, p: &mut Field<D>, factor: f64) {
        let p = p.data_mut();
        for (lines, pair) in self.lines.iter().zip(&self.states) {
            for (upper, state) in pair.iter().flat_map(|p| p.iter()).enumerate() {
                for (l, o) in lines.starts().enumerate() {
                    let (inside, ghost) = ends(lines, o, upper);
                    p[ghost] = match state.kind[l] {
                        FaceKind::Pressure => factor * state.pressure[l] - p[inside],
                        _ => p[inside],
                    };
                }
            }
        }
        self.wrap(p);
    }

    /// The velocity through faces of given pressure follows the correction: u −= `scale` ∂φ/∂n with φ = 0 on the side;
    /// `phi` is dense.
    pub(crate) fn correct(&mut self, scale: f64, phi: &[f64]) {
        for (a, (lines, pair)) in self.lines.iter().zip(&mut self.states).enumerate() {
            let Some(pair) = pair else { continue };
            for (upper, state) in pair.iter_mut().enumerate().filter(|(_, s)| s.has_pressure()) {
                let sign = [-1.0, 1.0][upper];
                let width = self.grid.axis(a).width(if upper == 1 { lines.cells - 1 } else { 0 });
                for l in (0..lines.len()).filter(|&l| lines.inside(l)) {
                    if state.kind[l] == FaceKind::Pressure {
                        let inside = phi[lines.end_cell(&self.grid, l, upper == 1)];
                        state.normal[l] += sign * scale * 2.0 * inside / width;
                    }
                }
            }
        }
    }

    /// The lines along axis `a`.
    pub(crate) fn lines(&self, a: usize) -> &Lines {
        &self.lines[a]
    }

    /// The ends of the lines along axis `a` for component `c`; `None` if periodic.
    pub(crate) fn ends(&self, a: usize, c: usize) -> Option<Ends<'_>> {
        let pair = self.states[a].as_deref()?;
        let kinds = pair
            .each_ref()
            .map(|s| if a == c { EndKinds::Normal(&s.kind) } else { EndKinds::Along(&s.laws[c].free) });
        let changes = pair
            .each_ref()
            .map(|s| if a == c { s.normal_change.as_slice() } else { s.laws[c].change.as_slice() });
        let weights = pair.each_ref().map(|s| if a == c { 1.0 } else { s.beyond.wall });
        Some(Ends { kinds, changes, weights, moving: pair.iter().any(|s| !s.steady) })
    }

    /// −2 p/w² in the cells before faces of given pressure p, zero elsewhere (dense): the right-hand side of the harmonic
    /// pressure that takes those values. `None` without such faces.
    pub(crate) fn given_pressures(&self) -> Option<Vec<f64>> {
        let sides = || {
            self.lines.iter().zip(&self.states).flat_map(|(lines, pair)| {
                pair.iter()
                    .flat_map(|p| p.iter())
                    .enumerate()
                    .map(move |(upper, state)| (lines, upper, state))
            })
        };
        if !sides().any(|(_, _, state)| state.has_pressure()) {
            return None;
        }
        let mut rhs = vec![0.0; self.grid.n_cells()];
        for (lines, upper, state) in sides() {
            let width = self.grid.axis(lines.axis).width(if upper == 1 { lines.cells - 1 } else { 0 });
            for l in (0..lines.len()).filter(|&l| lines.inside(l) && state.kind[l] == FaceKind::Pressure) {
                rhs[lines.end_cell(&self.grid, l, upper == 1)] -= 2.0 * state.pressure[l] / (width * width);
            }
        }
        Some(rhs)
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
                for l in (0..lines.len()).filter(|&l| lines.inside(l)) {
                    for c in 0..D {
                        let (speed, at) = if c == lines.axis {
                            (
                                state.normal[l],
                                if state.at == self.grid.axis(c).lower() { 0 } else { lines.cells - 1 },
                            )
                        } else {
                            let place = lines.place(l);
                            let b = usize::from(lines.across[0] != c);
                            (state.laws[c].value[l], place[b] - GHOSTS)
                        };
                        rates[c] = rates[c].max(speed.abs() * metrics.of(Some(c), c).inv_volume[GHOSTS + at]);
                    }
                }
            }
        }
        rates
    }

    /// The velocities on the sides, which outlets and implicit diffusion remember; all sides one after the other.
    pub(crate) fn memory(&self) -> Vec<f64> {
        let states = self.states.iter().flatten().flat_map(|p| p.iter());
        states
            .flat_map(|s| s.normal.iter().chain(s.laws.iter().flat_map(|law| &law.value)).copied())
            .collect()
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

impl<const D: usize> SideState<D> {
    fn new(grid: &CartesianGrid<D>, sides: &Sides<D>, lines: &Lines, upper: bool) -> Result<Self, FlowError> {
        let a = lines.axis;
        let side = sides.0[a][usize::from(upper)].clone();
        let at = if upper { grid.axis(a).upper() } else { grid.axis(a).lower() };
        let list = || vec![0.0; lines.len()];
        let laws = std::array::from_fn(|c| {
            if c == a {
                Law::default()
            } else {
                Law { free: vec![true; lines.len()], value: list(), change: list() }
            }
        });
        let mut kind = vec![FaceKind::Closed; lines.len()];
        let mut pressure = list();
        for l in 0..lines.len() {
            let x = face_centre(grid, lines, at, l);
            let Some((part, _)) = part(grid, &side, a, x) else {
                let which = ["lower", "upper"][usize::from(upper)];
                return Err(FlowError::Boundary {
                    what: format!(
                        "patches on the {which} side of axis {a} that leave out the face at {x:?} m; \
                         cover the whole side, with a wall for instance"
                    ),
                });
            };
            kind[l] = match part {
                Side::ConvectiveOutlet => FaceKind::Convective,
                Side::PressureOutlet(p) => {
                    if lines.cells < 2 {
                        return Err(FlowError::Boundary {
                            what: format!(
                                "an outlet of given pressure on axis {a}, which has one cell; it needs two or more"
                            ),
                        });
                    }
                    pressure[l] = *p;
                    FaceKind::Pressure
                }
                Side::Inlet(_) => FaceKind::Inlet,
                _ => FaceKind::Closed,
            };
        }
        let steady = !side.any(&|s| matches!(s, Side::Inlet(Profile::Function(_))));
        Ok(Self {
            side,
            kind,
            normal: list(),
            given: list(),
            normal_change: list(),
            pressure,
            laws,
            at,
            steady,
            beyond: extrapolation(grid, a, upper),
        })
    }

    fn has_pressure(&self) -> bool {
        self.side.any(&|s| matches!(s, Side::PressureOutlet(_)))
    }

    fn set(
        &mut self,
        grid: &CartesianGrid<D>,
        sides: &Sides<D>,
        metrics: &Metrics<D>,
        lines: &Lines,
        time: f64,
    ) {
        let a = lines.axis;
        let inward = if self.at == grid.axis(a).lower() { 1.0 } else { -1.0 };
        for l in 0..lines.len() {
            for c in 0..D {
                let x = place(metrics, lines, c, self.at, l);
                let x = clamped(grid, x);
                // A node between patches belongs to the one that holds the face beside it.
                let part = part(grid, &self.side, a, x)
                    .or_else(|| part(grid, &self.side, a, face_centre(grid, lines, self.at, l)));
                let Some((side, extent)) = part else { continue };
                let given = match side {
                    Side::Wall(u) => Some(u[c]),
                    Side::Inlet(profile) => Some(profile.at(sides, a, c, inward, extent, x, time)),
                    Side::FreeSlip if c == a => Some(0.0),
                    _ => None,
                };
                if c == a {
                    if let Some(u) = given {
                        self.given[l] = u;
                        self.normal[l] = u;
                    }
                } else {
                    let (law, value) = (&mut self.laws[c], given.unwrap_or(0.0));
                    law.change[l] = value - law.value[l];
                    law.value[l] = value;
                    law.free[l] = given.is_none();
                }
            }
        }
    }

    /// The component through the side.
    fn through(&self, lines: &Lines, upper: usize, u: &mut [f64]) {
        let (n, s) = (lines.cells, lines.step);
        for (l, o) in lines.starts().enumerate() {
            let wall = self.normal[l];
            let fixed = self.kind[l].is_fixed();
            let beyond = |inside: f64| if fixed { 2.0 * wall - inside } else { wall };
            if upper == 1 {
                u[o + n * s] = wall;
                u[o + (n + 1) * s] = beyond(u[o + (n - 1) * s]);
            } else {
                u[o] = wall;
                u[o - s] = beyond(u[o + s]);
                u[o - 2 * s] = beyond(u[o + n.min(2) * s]);
            }
        }
    }

    /// A component along the side.
    fn along(&self, lines: &Lines, upper: usize, c: usize, u: &mut [f64]) {
        let (n, s) = (lines.cells, lines.step);
        let Law { value, free, .. } = &self.laws[c];
        let Extrapolation { wall, first, second } = self.beyond;
        let inward = if n > 1 { s } else { 0 };
        for (o, (&value, &free)) in lines.starts().zip(value.iter().zip(free)) {
            let (u0, u1, ghosts) = if upper == 1 {
                let last = o + (n - 1) * s;
                (u[last], u[last - inward], [last + s, last + 2 * s])
            } else {
                (u[o], u[o + inward], [o - s, o - 2 * s])
            };
            u[ghosts[0]] = if free { u0 } else { wall * value + first * u0 + second * u1 };
            u[ghosts[1]] = if free { u1 } else { 2.0 * value - u1 };
        }
    }
}

/// The extrapolation beyond a side of axis `a`.
pub(crate) fn extrapolation<const D: usize>(grid: &CartesianGrid<D>, a: usize, upper: bool) -> Extrapolation {
    let (axis, n) = (grid.axis(a), grid.cells()[a]);
    let cell = |k: usize| if upper { n - 1 - k.min(n - 1) } else { k.min(n - 1) };
    Extrapolation::new(n, [axis.width(cell(0)), axis.width(cell(1))])
}

impl Profile {
    /// Component `c` at `x`; `extent` are the lower and upper corner of the inlet.
    #[allow(clippy::too_many_arguments)]
    fn at<const D: usize>(
        &self,
        sides: &Sides<D>,
        a: usize,
        c: usize,
        inward: f64,
        extent: [[f64; 3]; 2],
        x: [f64; 3],
        time: f64,
    ) -> f64 {
        match self {
            Self::Uniform(u) => u[c],
            Self::Function(f) => f(x, time)[c],
            Self::Parabolic { .. } if c != a => 0.0,
            Self::Parabolic { peak } => {
                let across = (0..D).filter(|&b| b != a && !sides.periodic(b));
                let shape = |b: usize| {
                    let s = ((x[b] - extent[0][b]) / (extent[1][b] - extent[0][b])).clamp(0.0, 1.0);
                    4.0 * s * (1.0 - s)
                };
                inward * peak * across.map(shape).product::<f64>()
            }
        }
    }
}

/// The part of a side that holds `x`, with its lower and upper corner.
fn part<'a, const D: usize>(
    grid: &CartesianGrid<D>,
    side: &'a Side,
    a: usize,
    x: [f64; 3],
) -> Option<(&'a Side, [[f64; 3]; 2])> {
    let corner = |upper: bool| -> [f64; 3] {
        std::array::from_fn(|b| match (b < D, upper) {
            (false, _) => 0.0,
            (true, false) => grid.axis(b).lower(),
            (true, true) => grid.axis(b).upper(),
        })
    };
    let box_ = [corner(false), corner(true)];
    let Side::Patches(patches) = side else { return Some((side, box_)) };
    let patch = patches
        .iter()
        .find(|p: &&Patch| (0..D).filter(|&b| b != a).all(|b| p.lower[b] <= x[b] && x[b] <= p.upper[b]))?;
    let extent = [
        std::array::from_fn(|b| box_[0][b].max(patch.lower[b])),
        std::array::from_fn(|b| box_[1][b].min(patch.upper[b])),
    ];
    Some((&patch.side, extent))
}

/// Place of the node of component `c` on a side at `at` where line `l` ends.
fn place<const D: usize>(metrics: &Metrics<D>, lines: &Lines, c: usize, at: f64, l: usize) -> [f64; 3] {
    let index = lines.place(l);
    let mut x = [0.0; 3];
    x[lines.axis] = at;
    for b in 0..D - 1 {
        let across = lines.across[b];
        x[across] = metrics.of(Some(c), across).x[index[b]];
    }
    x
}

/// Centre of the face at which line `l` ends, ghost lines moved to the edge of the side.
pub(crate) fn face_centre<const D: usize>(
    grid: &CartesianGrid<D>,
    lines: &Lines,
    at: f64,
    l: usize,
) -> [f64; 3] {
    let index = lines.place(l);
    let mut x = [0.0; 3];
    x[lines.axis] = at;
    for b in 0..D - 1 {
        let axis = grid.axis(lines.across[b]);
        let i = index[b].saturating_sub(GHOSTS).min(axis.cells() - 1);
        x[lines.across[b]] = axis.centre(i);
    }
    x
}

fn clamped<const D: usize>(grid: &CartesianGrid<D>, x: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|b| if b < D { x[b].clamp(grid.axis(b).lower(), grid.axis(b).upper()) } else { x[b] })
}

/// Area of the face at which line `l` ends \[m²\]; length in a plane grid.
fn face_area<const D: usize>(metrics: &Metrics<D>, lines: &Lines, l: usize, d: usize) -> f64 {
    let index = lines.place(l);
    (0..d - 1).map(|b| metrics.axes[lines.across[b]].width[index[b]]).product()
}

/// Storage index of the cell before a side and of the ghost behind it, on the line that starts at `o`.
fn ends(lines: &Lines, o: usize, upper: usize) -> (usize, usize) {
    let last = o + (lines.cells - 1) * lines.step;
    if upper == 1 { (last, last + lines.step) } else { (o, o - lines.step) }
}

/// Ghosts of a periodic axis.
pub(crate) fn wrap(lines: &Lines, u: &mut [f64]) {
    let (n, s) = (lines.cells, lines.step);
    let (before, after) = ((2 * n - 2) % n, 1 % n);
    for o in lines.starts() {
        u[o - s] = u[o + (n - 1) * s];
        u[o - 2 * s] = u[o + before * s];
        u[o + n * s] = u[o];
        u[o + (n + 1) * s] = u[o + after * s];
    }
}
