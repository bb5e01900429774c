//! What happens at one side, line by line.
use super::face_excess::FaceExcess;
use super::{Extrapolation, Lines, Patch, Profile, Side, Sides};
use crate::grid::GHOSTS;
use crate::metrics::Metrics;
use crate::{CartesianGrid, FlowError};

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
pub(super) struct Law {
    /// The component has no gradient across the side (else it is given).
    pub(super) free: Vec<bool>,
    /// What is given \[m/s\].
    pub(super) value: Vec<f64>,
    /// By how much `value` changed in this step.
    pub(super) change: Vec<f64>,
}

/// One bounded side. All lists have one entry per line of nodes that ends here.
#[derive(Clone, Debug)]
pub(super) struct SideState<const D: usize> {
    pub(super) side: Side,
    pub(super) kind: Vec<FaceKind>,
    /// Velocity along the axis on the side's faces.
    pub(super) normal: Vec<f64>,
    /// The same at the start of the step under way, where it follows from the flow; else empty.
    pub(super) before: Vec<f64>,
    /// What is given of it, before inlets are balanced.
    pub(super) given: Vec<f64>,
    /// Share of every face that immersed walls leave open; empty without them.
    pub(super) open: Vec<f64>,
    /// By how much it changed in this step through what is given.
    pub(super) normal_change: Vec<f64>,
    /// Pressure on the side where it is given.
    pub(super) pressure: Vec<f64>,
    /// Velocity excess of the faces of given pressure.
    pub(super) excess: FaceExcess,
    /// Of the other components.
    pub(super) laws: [Law; D],
    /// Place of the side along its axis.
    pub(super) at: f64,
    /// Nothing given here changes in time.
    pub(super) steady: bool,
    /// No velocity through a face follows from the flow.
    pub(super) fixed: bool,
    /// The largest rates at the start.
    pub(super) rates: [f64; D],
    pub(super) beyond: Extrapolation,
}

impl<const D: usize> SideState<D> {
    pub(super) fn new(
        grid: &CartesianGrid<D>,
        sides: &Sides<D>,
        lines: &Lines,
        upper: bool,
    ) -> Result<Self, FlowError> {
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
            let x = lines.face_centre(grid, at, l);
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
        let fixed = kind.iter().all(|k| k.is_fixed());
        let steady = !side.any(&|s| matches!(s, Side::Inlet(Profile::Function(_)) | Side::MovingWall(_)));
        let lines_of_pressure = if kind.contains(&FaceKind::Pressure) { lines.len() } else { 0 };
        Ok(Self {
            side,
            kind,
            excess: FaceExcess::new(lines_of_pressure),
            normal: list(),
            before: Vec::new(),
            given: list(),
            open: Vec::new(),
            normal_change: list(),
            pressure,
            laws,
            at,
            steady,
            fixed,
            rates: [0.0; D],
            beyond: Extrapolation::beyond(grid, a, upper),
        })
    }

    /// Does no velocity here ever change? (Inlets may be shifted to balance others.)
    pub(super) fn settled(&self) -> bool {
        self.steady && self.kind.iter().all(|&k| k == FaceKind::Closed)
    }

    /// Largest speed of each component, over the width of the cells there along that component \[1/s\].
    pub(super) fn largest_rates(
        &self,
        grid: &CartesianGrid<D>,
        metrics: &Metrics<D>,
        lines: &Lines,
    ) -> [f64; D] {
        let mut rates = [0.0_f64; D];
        let at = if self.at == grid.axis(lines.axis).lower() { 0 } else { lines.cells - 1 };
        for l in (0..lines.len()).filter(|&l| lines.inside(l)) {
            let place = lines.place(l);
            for (c, rate) in rates.iter_mut().enumerate() {
                let (speed, cell) = if c == lines.axis {
                    (self.normal[l], GHOSTS + at)
                } else {
                    (self.laws[c].value[l], place[usize::from(lines.across[0] != c)])
                };
                *rate = rate.max(speed.abs() * metrics.of(Some(c), c).inv_volume[cell]);
            }
        }
        rates
    }

    pub(super) fn has_pressure(&self) -> bool {
        self.side.any(&|s| matches!(s, Side::PressureOutlet(_)))
    }

    pub(super) fn set(
        &mut self,
        grid: &CartesianGrid<D>,
        sides: &Sides<D>,
        metrics: &Metrics<D>,
        lines: &Lines,
        time: f64,
    ) {
        let a = lines.axis;
        let inward = if self.at == grid.axis(a).lower() { 1.0 } else { -1.0 };
        let bounded = std::array::from_fn(|b| b < D && b != a && !sides.periodic(b));
        for l in 0..lines.len() {
            for c in 0..D {
                let x = place(metrics, lines, c, self.at, l);
                let x = clamped(grid, x);
                // A node between patches belongs to the one that holds the face beside it.
                let part = part(grid, &self.side, a, x)
                    .or_else(|| part(grid, &self.side, a, lines.face_centre(grid, self.at, l)));
                let Some((side, extent)) = part else { continue };
                let given = match side {
                    side if side.is_wall() && c == a => Some(0.0),
                    Side::Wall(u) => Some(u[c]),
                    Side::MovingWall(u) => Some(u.at(x, time)[c]),
                    Side::Inlet(profile) => {
                        Some(profile.at(c, &InletPoint { axis: a, inward, extent, bounded, x, time }))
                    }
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
}

/// Whether immersed walls cut the face of line `l` or one next to it, by the open shares of all
/// faces of the side.
pub(super) fn is_beside_cut(open: &[f64], lines: &Lines, l: usize) -> bool {
    let steps = [0, 1, if lines.count[1] > 1 { lines.count[0] } else { 0 }];
    let below = |step: usize| l.checked_sub(step).and_then(|l| open.get(l));
    let around = steps.into_iter().flat_map(|step| [below(step), open.get(l + step)]);
    around.flatten().any(|open| *open < 1.0)
}

/// A point of an inlet.
struct InletPoint {
    /// Across the side.
    axis: usize,
    /// +1 if the axis points into the box, else −1.
    inward: f64,
    /// Lower and upper corner of the inlet.
    extent: [[f64; 3]; 2],
    /// The axes along the side on which the box does not repeat.
    bounded: [bool; 3],
    x: [f64; 3],
    time: f64,
}

impl Profile {
    /// Component `c` at a point.
    fn at(&self, c: usize, point: &InletPoint) -> f64 {
        let InletPoint { axis, inward, extent, bounded, x, time } = point;
        match self {
            Self::Uniform(u) => u[c],
            Self::Function(f) => f.at(*x, *time)[c],
            Self::Parabolic { .. } if c != *axis => 0.0,
            Self::Parabolic { peak } => {
                let shape = |b: usize| {
                    let s = ((x[b] - extent[0][b]) / (extent[1][b] - extent[0][b])).clamp(0.0, 1.0);
                    4.0 * s * (1.0 - s)
                };
                inward * peak * (0..3).filter(|&b| bounded[b]).map(shape).product::<f64>()
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
    let patch = patches.iter().find(|p: &&Patch| p.holds::<D>(a, &x))?;
    let extent = [
        std::array::from_fn(|b| box_[0][b].max(patch.lower[b])),
        std::array::from_fn(|b| box_[1][b].min(patch.upper[b])),
    ];
    Some((&patch.side, extent))
}

/// Place of the node of component `c` on a side at `at` where line `l` ends.
pub(super) fn place<const D: usize>(
    metrics: &Metrics<D>,
    lines: &Lines,
    c: usize,
    at: f64,
    l: usize,
) -> [f64; 3] {
    let index = lines.place(l);
    let mut x = [0.0; 3];
    x[lines.axis] = at;
    for b in 0..D - 1 {
        let across = lines.across[b];
        x[across] = metrics.of(Some(c), across).x[index[b]];
    }
    x
}

fn clamped<const D: usize>(grid: &CartesianGrid<D>, x: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|b| if b < D { x[b].clamp(grid.axis(b).lower(), grid.axis(b).upper()) } else { x[b] })
}
