//! The sides of a flow as a transported quantity sees them.
use crate::boundary::Lines;
use crate::grid::GHOSTS;
use crate::operators::Operators;
use crate::{Axis, CartesianGrid, Field, FlowError, Patch, Side, Sides};
use interfaces::Equation;

/// What a face of a side is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Inlet,
    Wall,
    /// An outlet or a plane of symmetry.
    Open,
}

impl Kind {
    /// What is given there; `None` for ∂φ/∂n = 0.
    fn value(self, inlet: Option<f64>, wall: Option<f64>) -> Option<f64> {
        match self {
            Self::Inlet => inlet,
            Self::Wall => wall,
            Self::Open => None,
        }
    }
}

/// All sides.
#[derive(Clone, Debug)]
pub(super) struct CellSides<const D: usize> {
    lines: [Lines; D],
    /// Per axis, side and line; `None` if periodic.
    kinds: [Option<[Vec<Kind>; 2]>; D],
    /// Weights of the cells nearest to each side in the ghost behind it, by extrapolation.
    weights: [[[f64; 3]; 2]; D],
}

impl<const D: usize> CellSides<D> {
    pub(super) fn new(grid: &CartesianGrid<D>, sides: &Sides<D>) -> Result<Self, FlowError> {
        let lines: [Lines; D] = std::array::from_fn(|a| Lines::new(grid, a));
        let mut kinds = [const { None }; D];
        for a in (0..D).filter(|&a| !sides.periodic(a)) {
            let of = |upper: usize| -> Result<Vec<Kind>, FlowError> {
                let at = [grid.axis(a).lower(), grid.axis(a).upper()][upper];
                (0..lines[a].len())
                    .map(|l| kind::<D>(&sides.of(a)[upper], a, lines[a].face_centre(grid, at, l)))
                    .collect()
            };
            kinds[a] = Some([of(0)?, of(1)?]);
        }
        let weights = std::array::from_fn(|a| [0, 1].map(|upper| extrapolation(grid.axis(a), upper == 1)));
        Ok(Self { lines, kinds, weights })
    }

    /// Fills the first ghosts: φ given on inlets and walls, or ∂φ/∂n = 0.
    pub(super) fn fill(&self, phi: &mut Field<D>, inlet: Option<f64>, wall: Option<f64>) {
        self.each(phi, |kind, _, _, [inside, ..]| match kind.value(inlet, wall) {
            Some(value) => 2.0 * value - inside,
            None => inside,
        });
    }

    /// Fills the first ghosts from the three cells nearest to each side.
    pub(super) fn extrapolate(&self, phi: &mut Field<D>) {
        self.each(phi, |_, a, upper, near| {
            let w = &self.weights[a][upper];
            w[0] * near[0] + w[1] * near[1] + w[2] * near[2]
        });
    }

    /// `ghost` takes kind, axis, side and the three cells nearest to it (the last again where there are fewer).
    fn each(&self, phi: &mut Field<D>, ghost: impl Fn(Kind, usize, usize, [f64; 3]) -> f64) {
        let data = phi.data_mut();
        for (lines, kinds) in self.lines.iter().zip(&self.kinds) {
            let (n, s) = (lines.cells, lines.step);
            for (upper, kinds) in kinds.iter().flat_map(|k| k.iter()).enumerate() {
                for (o, &kind) in lines.starts().zip(kinds) {
                    let cell = |k: usize| {
                        let k = k.min(n - 1);
                        o + if upper == 1 { n - 1 - k } else { k } * s
                    };
                    let near = [0, 1, 2].map(|k| data[cell(k)]);
                    let at = if upper == 1 { o + n * s } else { o - s };
                    data[at] = ghost(kind, lines.axis, upper, near);
                }
            }
        }
        self.wrap(data);
    }

    /// Fills the ghosts of periodic axes.
    pub(super) fn wrap(&self, data: &mut [f64]) {
        for (lines, _) in self.lines.iter().zip(&self.kinds).filter(|(_, k)| k.is_none()) {
            lines.wrap(data);
        }
    }

    /// Turns the coefficients that reach through the sides into terms of centre and b of cells in the spans, and sets them to zero.
    pub(super) fn close(
        &self,
        ops: &Operators<D>,
        e: &Equation<'_>,
        [centre, b]: [&mut [f64]; 2],
        [lower, upper]: [&mut [&mut [f64]; D]; 2],
    ) {
        let (grid, metrics, spans) = (ops.grid(), ops.metrics(), ops.spans());
        for (a, (lines, kinds)) in self.lines.iter().zip(&self.kinds).enumerate() {
            let Some(kinds) = kinds else { continue };
            for (end, kinds) in kinds.iter().enumerate() {
                let i = if end == 1 { lines.cells - 1 } else { 0 };
                for l in (0..lines.len()).filter(|&l| lines.inside(l)) {
                    let cell = lines.end_cell(grid, l, end == 1);
                    if !spans.contains(grid.cells()[0], cell) {
                        continue;
                    }
                    let coefficient = if end == 1 { &mut upper[a][cell] } else { &mut lower[a][cell] };
                    if let Some(value) = kinds[l].value(Some(e.inlet), e.wall) {
                        // The side is half as far away as the ghost.
                        let width = metrics.axes[a].centres.volume[GHOSTS + i];
                        let area = grid.cell_volume(grid.cell(cell)) / width;
                        let c = area * e.diffusivity[cell] / width - *coefficient;
                        centre[cell] += c;
                        b[cell] += c * value;
                    }
                    *coefficient = 0.0;
                }
            }
        }
    }
}

/// What the face of `side`, normal to axis `a`, at `x` is.
fn kind<const D: usize>(side: &Side, a: usize, x: [f64; 3]) -> Result<Kind, FlowError> {
    match part_at::<D>(side, a, x) {
        Some(Side::Inlet(_)) => Ok(Kind::Inlet),
        Some(side) if side.is_wall() => Ok(Kind::Wall),
        Some(_) => Ok(Kind::Open),
        None => Err(FlowError::Boundary {
            what: format!(
                "patches on a side of axis {a} that leave out the face at {x:?} m; cover the whole side"
            ),
        }),
    }
}

/// The part of `side`, normal to axis `a`, that holds the face at `x`; `None` where patches leave it out.
pub(super) fn part_at<const D: usize>(side: &Side, a: usize, x: [f64; 3]) -> Option<&Side> {
    let Side::Patches(patches) = side else { return Some(side) };
    let inside = |p: &Patch, b: usize| b == a || p.lower[b] <= x[b] && x[b] <= p.upper[b];
    patches.iter().find(|p| (0..D).all(|b| inside(p, b))).map(|p| &p.side)
}

/// Weights of the cells nearest to a side in the ghost that mirrors the first: the parabola through three, the line
/// through two, or the one.
fn extrapolation(axis: &Axis, upper: bool) -> [f64; 3] {
    let n = axis.cells();
    let depth = |k: usize| {
        let x = axis.centre(if upper { n - 1 - k } else { k });
        if upper { axis.upper() - x } else { x - axis.lower() }
    };
    let x: Vec<f64> = (0..n.min(3)).map(depth).collect();
    let ghost = -x[0];
    let mut w = [0.0; 3];
    for i in 0..x.len() {
        w[i] = (0..x.len()).filter(|&j| j != i).map(|j| (ghost - x[j]) / (x[i] - x[j])).product();
    }
    w
}
