//! The boundary conditions as the flow algorithms use them: values on every face of the bounded sides.
mod segregated;

pub(crate) use segregated::PressureFace;

use super::{Lines, Patch, Profile, Side, Sides};
use crate::metrics::Metrics;
use crate::{CartesianGrid, Field, FlowError};

/// What holds for the velocity through one face of a side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FaceKind {
    /// Given.
    Fixed,
    /// Carried out by the mean outflow.
    Convective,
    /// Follows from the pressure.
    Pressure,
}

/// Ghost values of one component: value + factor·(value as far inside). Factor −1 fixes the value on the side, +1 its
/// gradient.
#[derive(Clone, Debug, Default)]
struct Law {
    value: Vec<f64>,
    factor: Vec<f64>,
    /// By how much `value` changed in this step.
    change: Vec<f64>,
}

/// The ends of the lines along an axis as one component sees them.
pub(crate) struct Ends<'a> {
    kinds: [EndKinds<'a>; 2],
    changes: [&'a [f64]; 2],
    /// Some value given here changes in time.
    pub(crate) moving: bool,
}

enum EndKinds<'a> {
    Normal(&'a [FaceKind]),
    Along(&'a [f64]),
}

impl Ends<'_> {
    /// Bit 0 is set if the value at the lower end of line `l` is free, bit 1 if that at the upper end is.
    pub(crate) fn kind(&self, l: usize) -> usize {
        let free = |k: &EndKinds| match k {
            EndKinds::Normal(kinds) => kinds[l] != FaceKind::Fixed,
            EndKinds::Along(factors) => factors[l] > 0.0,
        };
        usize::from(free(&self.kinds[0])) + 2 * usize::from(free(&self.kinds[1]))
    }
    /// The kind that all lines share.
    pub(crate) fn common_kind(&self) -> Option<usize> {
        let first = self.kind(0);
        (1..self.changes[0].len()).all(|l| self.kind(l) == first).then_some(first)
    }
    /// By how much the given values (twice those half way, once those on the next node) changed in this step.
    pub(crate) fn changes(&self, l: usize) -> [f64; 2] {
        [self.changes[0][l], self.changes[1][l]]
    }
}

/// One bounded side. All lists have one entry per line of nodes that ends here.
#[derive(Clone, Debug)]
struct SideState<const D: usize> {
    side: Side,
    kind: Vec<FaceKind>,
    /// Velocity along the axis on the side's faces.
    normal: Vec<f64>,
    /// By how much the given ones changed in this step.
    normal_change: Vec<f64>,
    /// Pressure on the side where it is given.
    pressure: Vec<f64>,
    /// Of the other components.
    laws: [Law; D],
    /// Place of the side along its axis.
    at: f64,
    /// Nothing here changes in time.
    steady: bool,
}

/// All sides of the box.
#[derive(Clone, Debug)]
pub(crate) struct Boundaries<const D: usize> {
    grid: CartesianGrid<D>,
    pub(crate) sides: Sides<D>,
    lines: [Lines; D],
    states: [Option<Box<[SideState<D>; 2]>>; D],
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
        let mut new = Self { grid: grid.clone(), sides, lines, states };
        new.set(metrics, 0.0, true);
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
                    if state.kind[l] != FaceKind::Fixed {
                        let x = place(metrics, lines, a, state.at, l);
                        state.normal[l] = u(std::array::from_fn(|b| x[b]))[a];
                    }
                }
            }
        }
    }

    /// Moves what is given on to `time`.
    pub(crate) fn advance(&mut self, metrics: &Metrics<D>, time: f64) {
        self.set(metrics, time, false);
    }

    /// Moves the outlets on by `dt`; `velocity` is the predicted one.
    ///
    /// # Errors
    /// [`FlowError::MassBalance`] if what enters cannot leave.
    pub(crate) fn advance_outlets(
        &mut self,
        metrics: &Metrics<D>,
        velocity: &[Field<D>; D],
        dt: f64,
    ) -> Result<(), FlowError> {
        if self.sides.closed() {
            return Ok(());
        }
        for (a, (lines, pair)) in self.lines.iter().zip(&mut self.states).enumerate() {
            let u = velocity[a].data();
            let Some(pair) = pair else { continue };
            for (upper, state) in pair.iter_mut().enumerate() {
                if !state.kind.iter().any(|&k| k != FaceKind::Fixed) {
                    continue;
                }
                let sign = [-1.0, 1.0][upper];
                let (mut flow, mut area) = (0.0, 0.0);
                for l in (0..lines.len()).filter(|&l| lines.inside(l)) {
                    if state.kind[l] == FaceKind::Convective {
                        let face = face_area(metrics, lines, l, D);
                        flow += sign * face * state.normal[l];
                        area += face;
                    }
                }
                let gap = self.grid.axis(a).width(if upper == 1 { lines.cells - 1 } else { 0 });
                let courant = if area > 0.0 { (flow / area).max(0.0) * dt / gap } else { 0.0 };
                for (l, o) in lines.starts().enumerate().filter(|&(l, _)| lines.inside(l)) {
                    let inside =
                        u[if upper == 1 { o + (lines.cells - 1) * lines.step } else { o + lines.step }];
                    match state.kind[l] {
                        FaceKind::Fixed => {}
                        FaceKind::Convective => {
                            state.normal[l] = (state.normal[l] + courant * inside) / (1.0 + courant);
                        }
                        FaceKind::Pressure => state.normal[l] = inside,
                    }
                }
            }
        }
        self.balance(metrics)
    }

    /// Shifts what leaves through convective outlets so that it equals what enters.
    fn balance(&mut self, metrics: &Metrics<D>) -> Result<(), FlowError> {
        let (mut net, mut inflow, mut area, mut free) = (0.0, 0.0, 0.0, false);
        for (lines, pair) in self.lines.iter().zip(&self.states) {
            let Some(pair) = pair else { continue };
            for (upper, state) in pair.iter().enumerate() {
                for l in (0..lines.len()).filter(|&l| lines.inside(l)) {
                    let face = face_area(metrics, lines, l, D);
                    let outward = [-1.0, 1.0][upper] * face * state.normal[l];
                    net += outward;
                    inflow += (-outward).max(0.0);
                    match state.kind[l] {
                        FaceKind::Fixed => {}
                        FaceKind::Convective => area += face,
                        FaceKind::Pressure => free = true,
                    }
                }
            }
        }
        if free {
            return Ok(());
        }
        if area == 0.0 {
            // Round-off is the pressure solver's to remove.
            let fits = net.abs() <= 1e-10 * inflow.max(net.abs());
            return if fits || net == 0.0 { Ok(()) } else { Err(FlowError::MassBalance { net, inflow }) };
        }
        let shift = net / area;
        for (lines, pair) in self.lines.iter().zip(&mut self.states) {
            let Some(pair) = pair else { continue };
            for (upper, state) in pair.iter_mut().enumerate() {
                for l in 0..lines.len() {
                    if state.kind[l] == FaceKind::Convective {
                        state.normal[l] -= [-1.0, 1.0][upper] * shift;
                    }
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
            .map(|s| if a == c { EndKinds::Normal(&s.kind) } else { EndKinds::Along(&s.laws[c].factor) });
        let changes = pair
            .each_ref()
            .map(|s| if a == c { s.normal_change.as_slice() } else { s.laws[c].change.as_slice() });
        Some(Ends { kinds, changes, moving: pair.iter().any(|s| !s.steady) })
    }

    /// Per side of axis `a`: what holds at each face of the side, in the order of dense cells; `None` if periodic.
    pub(crate) fn kinds(&self, a: usize) -> Option<[Vec<FaceKind>; 2]> {
        let lines = &self.lines[a];
        let pair = self.states[a].as_ref()?;
        Some(std::array::from_fn(|upper| {
            (0..lines.len()).filter(|&l| lines.inside(l)).map(|l| pair[upper].kind[l]).collect()
        }))
    }

    /// The velocities on the boundary faces, which outlets remember; all sides one after the other.
    pub(crate) fn memory(&self) -> Vec<f64> {
        self.states.iter().flatten().flat_map(|p| p.iter()).flat_map(|s| s.normal.iter().copied()).collect()
    }
    /// Takes back what [`memory`](Self::memory) gave; `time` is that of the state.
    pub(crate) fn recall(&mut self, metrics: &Metrics<D>, time: f64, memory: &[f64]) {
        self.set(metrics, time, false);
        let mut memory = memory.iter();
        for normal in self.states.iter_mut().flatten().flat_map(|p| p.iter_mut()).flat_map(|s| &mut s.normal)
        {
            if let Some(&value) = memory.next() {
                *normal = value;
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
                Law { value: list(), factor: vec![1.0; lines.len()], change: list() }
            }
        });
        let mut kind = vec![FaceKind::Fixed; lines.len()];
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
                    pressure[l] = *p;
                    FaceKind::Pressure
                }
                _ => FaceKind::Fixed,
            };
        }
        let steady = !side.any(&|s| matches!(s, Side::Inlet(Profile::Function(_))));
        Ok(Self { side, kind, normal: list(), normal_change: list(), pressure, laws, at, steady })
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
                // Patches cover the side; ghost lines are moved to its edge.
                let Some((side, extent)) = part(grid, &self.side, a, x) else { continue };
                let given = match side {
                    Side::Wall(u) => Some(u[c]),
                    Side::Inlet(profile) => Some(profile.at(sides, a, c, inward, extent, x, time)),
                    Side::FreeSlip if c == a => Some(0.0),
                    _ => None,
                };
                if c == a {
                    if let Some(u) = given {
                        self.normal_change[l] = u - self.normal[l];
                        self.normal[l] = u;
                    }
                } else {
                    let value = 2.0 * given.unwrap_or(0.0);
                    self.laws[c].change[l] = value - self.laws[c].value[l];
                    self.laws[c].value[l] = value;
                    self.laws[c].factor[l] = if given.is_some() { -1.0 } else { 1.0 };
                }
            }
        }
    }

    /// The component through the side.
    fn through(&self, lines: &Lines, upper: usize, u: &mut [f64]) {
        let (n, s) = (lines.cells, lines.step);
        for (l, o) in lines.starts().enumerate() {
            let wall = self.normal[l];
            let fixed = self.kind[l] == FaceKind::Fixed;
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
        let Law { value, factor, .. } = &self.laws[c];
        let second = if n > 1 { s } else { 0 };
        for (o, (value, factor)) in lines.starts().zip(value.iter().zip(factor)) {
            if upper == 1 {
                let last = o + (n - 1) * s;
                u[last + s] = value + factor * u[last];
                u[last + 2 * s] = value + factor * u[last - second];
            } else {
                u[o - s] = value + factor * u[o];
                u[o - 2 * s] = value + factor * u[o + second];
            }
        }
    }
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
fn face_centre<const D: usize>(grid: &CartesianGrid<D>, lines: &Lines, at: f64, l: usize) -> [f64; 3] {
    let index = lines.place(l);
    let mut x = [0.0; 3];
    x[lines.axis] = at;
    for b in 0..D - 1 {
        let axis = grid.axis(lines.across[b]);
        let i = index[b].saturating_sub(crate::grid::GHOSTS).min(axis.cells() - 1);
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
fn wrap(lines: &Lines, u: &mut [f64]) {
    let (n, s) = (lines.cells, lines.step);
    let (before, after) = ((2 * n - 2) % n, 1 % n);
    for o in lines.starts() {
        u[o - s] = u[o + (n - 1) * s];
        u[o - 2 * s] = u[o + before * s];
        u[o + n * s] = u[o];
        u[o + (n + 1) * s] = u[o + after * s];
    }
}
