//! What happens at the six (four) sides of the box.
use crate::{CartesianGrid, Field, FlowError};

/// What happens at one side of the box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Side {
    /// The flow that leaves here enters at the opposite side.
    Periodic,
    /// A wall to which the fluid sticks, moving along itself with this velocity \[m/s\]; the
    /// component normal to the wall must be zero.
    Wall([f64; 3]),
    /// A frictionless wall, or a plane of symmetry.
    FreeSlip,
}

impl Side {
    /// A wall at rest.
    pub const WALL: Self = Self::Wall([0.0; 3]);
}

/// The lower and upper side of every axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sides<const D: usize>(pub(crate) [[Side; 2]; D]);

impl<const D: usize> Sides<D> {
    /// `sides[axis][0]` is the lower side, `sides[axis][1]` the upper.
    ///
    /// # Errors
    /// [`FlowError::Boundary`] if only one side of an axis is periodic, or a wall moves through
    /// itself or not at finite speed.
    pub fn new(sides: [[Side; 2]; D]) -> Result<Self, FlowError> {
        let fail = |what| Err(FlowError::Boundary { what });
        for (a, pair) in sides.iter().enumerate() {
            if (pair[0] == Side::Periodic) != (pair[1] == Side::Periodic) {
                return fail(format!("axis {a} periodic at one side only; make both periodic or neither"));
            }
            for side in pair {
                if let Side::Wall(u) = side {
                    if u[a] != 0.0 {
                        return fail(format!(
                            "a wall normal to axis {a} that moves along it at {} m/s; set that component to 0",
                            u[a]
                        ));
                    }
                    if u.iter().any(|u| !u.is_finite()) {
                        return fail(format!(
                            "a wall normal to axis {a} with velocity {u:?}; give finite numbers"
                        ));
                    }
                }
            }
        }
        Ok(Self(sides))
    }
    /// Is axis `a` periodic?
    pub fn periodic(&self, a: usize) -> bool {
        self.0[a][0] == Side::Periodic
    }

    /// Ghost layers (and the faces on the boundary) of velocity component `c`.
    pub(crate) fn fill_velocity(&self, grid: &CartesianGrid<D>, c: usize, u: &mut Field<D>) {
        let (n, stride) = (grid.cells(), grid.stride());
        for a in 0..D {
            let (s, n) = (stride[a], n[a]);
            each_line(grid, a, u.data_mut(), |u, o| match self.0[a] {
                [Side::Periodic, _] => {
                    u[o - s] = u[o + (n - 1) * s];
                    u[o + n * s] = u[o];
                }
                // Faces on the boundary; nothing flows through.
                _ if a == c => {
                    u[o] = 0.0;
                    u[o - s] = -u[o + s];
                    u[o + n * s] = 0.0;
                }
                [lower, upper] => {
                    u[o - s] = beyond(lower, c, u[o]);
                    u[o + n * s] = beyond(upper, c, u[o + (n - 1) * s]);
                }
            });
        }
    }
    /// Ghost layers of a pressure: periodic, or without normal gradient.
    pub(crate) fn fill_pressure(&self, grid: &CartesianGrid<D>, p: &mut Field<D>) {
        let (n, stride) = (grid.cells(), grid.stride());
        for a in 0..D {
            let (s, n, periodic) = (stride[a], n[a], self.periodic(a));
            each_line(grid, a, p.data_mut(), |p, o| {
                (p[o - s], p[o + n * s]) =
                    if periodic { (p[o + (n - 1) * s], p[o]) } else { (p[o], p[o + (n - 1) * s]) };
            });
        }
    }
}

/// The value half a cell beyond a side, from the one half a cell before it.
fn beyond(side: Side, c: usize, inside: f64) -> f64 {
    match side {
        Side::Wall(u) => 2.0 * u[c] - inside,
        Side::FreeSlip | Side::Periodic => inside,
    }
}

/// Calls `f(data, o)` with the storage index `o` of the first cell of every line along axis `a`,
/// ghost lines of the axes before `a` included, so that corners are filled too.
fn each_line<const D: usize>(
    grid: &CartesianGrid<D>,
    a: usize,
    data: &mut [f64],
    mut f: impl FnMut(&mut [f64], usize),
) {
    let (n, stride, base) = (grid.cells(), grid.stride(), grid.base());
    let (b, c) = match (D, a) {
        (2, _) => (1 - a, None),
        (_, 0) => (1, Some(2)),
        (_, 1) => (0, Some(2)),
        _ => (0, Some(1)),
    };
    // From one ghost below to one ghost above.
    let (lines_c, stride_c) = c.map_or((1, 0), |c| (n[c] + 2, stride[c]));
    let start = base - stride[b] - stride_c;
    for k in 0..lines_c {
        for j in 0..n[b] + 2 {
            f(data, start + k * stride_c + j * stride[b]);
        }
    }
}
