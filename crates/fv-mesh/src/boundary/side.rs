//! Boundary conditions of the velocity as the user gives them.
use crate::FlowError;
use std::fmt;
use std::sync::Arc;

/// Velocity \[m/s\] as a function of place \[m\] and time \[s\].
#[derive(Clone)]
pub struct VelocityFunction(Arc<dyn Fn([f64; 3], f64) -> [f64; 3] + Send + Sync>);

impl VelocityFunction {
    /// The function `u(x, t)`.
    pub fn new(u: impl Fn([f64; 3], f64) -> [f64; 3] + Send + Sync + 'static) -> Self {
        Self(Arc::new(u))
    }
    /// Velocity \[m/s\] at the place `x` \[m\] and time `t` \[s\].
    pub fn at(&self, x: [f64; 3], t: f64) -> [f64; 3] {
        (self.0)(x, t)
    }
}

impl fmt::Debug for VelocityFunction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("VelocityFunction(..)")
    }
}

/// Velocity over an inlet.
#[derive(Clone, Debug)]
pub enum Profile {
    /// The same everywhere \[m/s\].
    Uniform([f64; 3]),
    /// Into the box with the speed peak·Π 4s(1 − s), s = 0…1 across the inlet along each bounded axis of the side:
    /// the profile of a developed plane flow (a product of parabolas in a duct).
    Parabolic {
        /// Speed in the middle \[m/s\].
        peak: f64,
    },
    /// Any function of place and time; see [`Profile::function`].
    Function(VelocityFunction),
}

impl Profile {
    /// The velocity `u(x, t)` \[m/s\] of place \[m\] and time \[s\].
    pub fn function(u: impl Fn([f64; 3], f64) -> [f64; 3] + Send + Sync + 'static) -> Self {
        Self::Function(VelocityFunction::new(u))
    }
}

/// A rectangle of a side and what happens there.
#[derive(Clone, Debug)]
pub struct Patch {
    /// Lower corner \[m\]; the coordinate normal to the side does not matter.
    pub lower: [f64; 3],
    /// Upper corner \[m\].
    pub upper: [f64; 3],
    /// What happens there; neither periodic nor patches again.
    pub side: Side,
}

impl Patch {
    /// Whether `x`, on a side of a box in `D` dimensions that is normal to axis `a`, is in this patch.
    pub(crate) fn holds<const D: usize>(&self, a: usize, x: &[f64; 3]) -> bool {
        (0..D).filter(|&b| b != a).all(|b| self.lower[b] <= x[b] && x[b] <= self.upper[b])
    }
}

/// What happens at one side of the box.
#[derive(Clone, Debug)]
pub enum Side {
    /// The flow that leaves here enters at the opposite side.
    Periodic,
    /// A wall to which the fluid sticks, moving along itself with this velocity \[m/s\]; the
    /// component normal to the wall must be zero.
    Wall([f64; 3]),
    /// A wall to which the fluid sticks, moving along itself with a velocity that depends on place and time. The component
    /// normal to the wall has no effect.
    MovingWall(VelocityFunction),
    /// A frictionless wall, or a plane of symmetry.
    FreeSlip,
    /// Fluid enters with this velocity.
    Inlet(Profile),
    /// Fluid leaves: ∂u/∂t + U ∂u/∂n = 0 for the component through the side, U the largest speed there plus ν/h, and ∂u/∂n = 0 for
    /// the others. What leaves through all such faces is shifted by one velocity so that it equals what enters.
    ConvectiveOutlet,
    /// Fluid leaves (or enters) through a side of given pressure \[Pa\], with ∂u/∂n = 0 for the components along it; the
    /// component through it follows the momentum of the face inside and the pressure gradient to the given value. Needs
    /// two or more cells along the axis.
    PressureOutlet(f64),
    /// Different things on parts of the side: the first patch that holds a face's centre counts. Patches have to cover
    /// the whole side.
    Patches(Vec<Patch>),
}

impl Side {
    /// A wall at rest.
    pub const WALL: Self = Self::Wall([0.0; 3]);

    /// This at both sides of an axis.
    pub fn both(&self) -> [Self; 2] {
        [self.clone(), self.clone()]
    }
    /// This at every side of the box.
    pub fn everywhere<const D: usize>(&self) -> [[Self; 2]; D] {
        std::array::from_fn(|_| self.both())
    }
    /// A wall whose velocity along itself is `u(x, t)` \[m/s\] of place \[m\] and time \[s\].
    pub fn moving_wall(u: impl Fn([f64; 3], f64) -> [f64; 3] + Send + Sync + 'static) -> Self {
        Self::MovingWall(VelocityFunction::new(u))
    }
    /// Whether this is a wall, steady or moving.
    pub fn is_wall(&self) -> bool {
        matches!(self, Self::Wall(_) | Self::MovingWall(_))
    }
    /// Velocity \[m/s\] of a wall at the place `x` \[m\] and time `t` \[s\]; `None` if this is no wall.
    pub fn wall_velocity(&self, x: [f64; 3], t: f64) -> Option<[f64; 3]> {
        match self {
            Self::Wall(u) => Some(*u),
            Self::MovingWall(u) => Some(u.at(x, t)),
            _ => None,
        }
    }
    pub(crate) fn is_periodic(&self) -> bool {
        matches!(self, Self::Periodic)
    }
    /// Is this, or a patch of it, such that `f` holds?
    pub(crate) fn any(&self, f: &impl Fn(&Self) -> bool) -> bool {
        match self {
            Self::Patches(patches) => patches.iter().any(|p| p.side.any(f)),
            side => f(side),
        }
    }
    /// Nothing flows through.
    pub(crate) fn is_closed(&self) -> bool {
        !self.any(&|s| matches!(s, Self::Inlet(_) | Self::ConvectiveOutlet | Self::PressureOutlet(_)))
    }

    fn check(&self, a: usize, patch: bool) -> Result<(), FlowError> {
        let fail = |what| Err(FlowError::Boundary { what });
        let finite = |u: &[f64]| u.iter().all(|u| u.is_finite());
        match self {
            Self::Wall(u) if !finite(u) => {
                fail(format!("a wall normal to axis {a} with velocity {u:?}; give finite numbers"))
            }
            Self::Wall(u) if u[a] != 0.0 => fail(format!(
                "a wall normal to axis {a} that moves along it at {} m/s; set that component to 0",
                u[a]
            )),
            Self::Inlet(Profile::Uniform(u)) if !finite(u) => {
                fail(format!("an inlet normal to axis {a} with velocity {u:?}; give finite numbers"))
            }
            Self::Inlet(Profile::Parabolic { peak }) if !peak.is_finite() => {
                fail(format!("an inlet normal to axis {a} with a peak of {peak} m/s; give a finite one"))
            }
            Self::PressureOutlet(p) if !p.is_finite() => {
                fail(format!("an outlet normal to axis {a} at a pressure of {p} Pa; give a finite one"))
            }
            Self::Periodic if patch => {
                fail(format!("a periodic patch of a side of axis {a}; make the whole axis periodic"))
            }
            Self::Patches(_) if patch => {
                fail(format!("patches in a patch of a side of axis {a}; list them flat"))
            }
            Self::Patches(patches) => patches.iter().try_for_each(|p| p.side.check(a, true)),
            _ => Ok(()),
        }
    }
}

/// The lower and upper side of every axis.
#[derive(Clone, Debug)]
pub struct Sides<const D: usize>(pub(crate) [[Side; 2]; D]);

impl<const D: usize> Sides<D> {
    /// `sides[axis][0]` is the lower side, `sides[axis][1]` the upper.
    ///
    /// # Errors
    /// [`FlowError::Boundary`] if only one side of an axis is periodic, a wall moves through
    /// itself, or a number is not finite.
    pub fn new(sides: [[Side; 2]; D]) -> Result<Self, FlowError> {
        for (a, pair) in sides.iter().enumerate() {
            if pair[0].is_periodic() != pair[1].is_periodic() {
                let what = format!("axis {a} periodic at one side only; make both periodic or neither");
                return Err(FlowError::Boundary { what });
            }
            pair.iter().try_for_each(|side| side.check(a, false))?;
        }
        Ok(Self(sides))
    }
    /// Is axis `a` periodic?
    pub fn periodic(&self, a: usize) -> bool {
        self.0[a][0].is_periodic()
    }
    /// The lower and upper side of axis `a`.
    pub fn of(&self, a: usize) -> &[Side; 2] {
        &self.0[a]
    }
    /// Whether fluid may pass the lower (`end` 0) or upper (1) side of axis `a` at `x` \[m\]: it is an inlet, an outlet or of
    /// given pressure there. The coordinate along `a` does not matter.
    pub fn is_open_at(&self, a: usize, end: usize, x: [f64; 3]) -> bool {
        match &self.0[a][end] {
            Side::Patches(patches) => {
                patches.iter().find(|p| p.holds::<D>(a, &x)).is_some_and(|p| !p.side.is_closed())
            }
            side => !side.is_closed(),
        }
    }
    /// Does nothing flow through any bounded side?
    pub fn closed(&self) -> bool {
        self.0.iter().flatten().all(Side::is_closed)
    }
}
