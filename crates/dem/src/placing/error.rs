//! What can go wrong when bodies are placed.
use crate::DemError;
use interfaces::Pose;

/// Why sizes or places could not be had.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlacingError {
    /// A parameter makes no sense.
    #[error("the {what} is {value}; {remedy}")]
    Parameter {
        /// Which one.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What to give instead.
        remedy: &'static str,
    },
    /// Bounds of sizes that hold nothing.
    #[error("sizes from {low} to {high} m were asked for; {remedy}")]
    Sizes {
        /// Lower bound \[m\].
        low: f64,
        /// Upper bound \[m\].
        high: f64,
        /// What to give instead.
        remedy: &'static str,
    },
    /// Bounds that cut off nearly all of a distribution.
    #[error(
        "only {share:.1e} of the distribution is between {low} and {high} m, and what is drawn outside is drawn again; widen the bounds until they hold 1e-3 of it"
    )]
    Tail {
        /// Lower bound \[m\].
        low: f64,
        /// Upper bound \[m\].
        high: f64,
        /// What they hold.
        share: f64,
    },
    /// A table of sizes that is no distribution.
    #[error("row {row} (from 0) of the table of sizes, {size} m and {fraction}, {problem}")]
    Table {
        /// The row.
        row: usize,
        /// Its size \[m\].
        size: f64,
        /// Its cumulative fraction.
        fraction: f64,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// More than can be stored.
    #[error("{number:.1e} {what} were asked for; no more than {most:.1e} can be made")]
    TooMany {
        /// Of what.
        what: &'static str,
        /// How many.
        number: f64,
        /// Largest number.
        most: f64,
    },
    /// A box without inside.
    #[error(
        "the region goes from {min:?} to {max:?} m; give finite corners, the upper one above the lower one, and in plane scenes z = 0 for both"
    )]
    Region {
        /// Lower corner \[m\].
        min: [f64; 3],
        /// Upper corner \[m\].
        max: [f64; 3],
    },
    /// Plane and solid bodies in one scene.
    #[error(
        "body {body} is {}, but the region is {}; place discs in plane regions and solid bodies in others",
        if *flat { "flat" } else { "solid" },
        if *flat { "not" } else { "plane" }
    )]
    Dimension {
        /// The body.
        body: usize,
        /// Whether it has no extent along z.
        flat: bool,
    },
    /// A body has no room at all.
    #[error(
        "body {body} with its gap is {size:.3e} m long, and the region along axis {axis} only {room:.3e} m; take a smaller body or a larger region"
    )]
    TooLarge {
        /// The body.
        body: usize,
        /// Axis, 0 for x.
        axis: usize,
        /// Diameter of the sphere around the body, and the gap \[m\].
        size: f64,
        /// What there is \[m\].
        room: f64,
    },
    /// The position or orientation of an obstacle is not finite.
    #[error(
        "obstacle {obstacle} is at {position:?} m, and position or orientation is not finite; give finite numbers"
    )]
    Obstacle {
        /// Its number, from 0.
        obstacle: usize,
        /// Where.
        position: [f64; 3],
    },
    /// An orientation for all bodies that they cannot have.
    #[error(
        "all bodies should be turned by the quaternion {quaternion:?} (w, x, y, z); give a finite one, about z in plane regions"
    )]
    Orientation {
        /// w, x, y, z.
        quaternion: [f64; 4],
    },
    /// No room for all bodies.
    #[error(transparent)]
    Jammed(#[from] Jammed),
    /// A shape could not be made.
    #[error(transparent)]
    Shape(#[from] DemError),
}

/// What random addition came to before there was no more room.
#[derive(Clone, PartialEq, thiserror::Error)]
#[error(
    "{} of {asked} bodies are placed, a volume fraction of {fraction:.4}, and {attempts} attempts found no place for body {body}; ask for fewer (spheres of one size jam near 0.38, discs near 0.547), a smaller gap, more attempts, or tight placing if they are not round", .placed.len()
)]
pub struct Jammed {
    /// The bodies that have a place, by their number in the list of shapes, in the order in which they were placed.
    pub placed: Vec<(usize, Pose)>,
    /// How many there should have been.
    pub asked: usize,
    /// The body that found no place.
    pub body: usize,
    /// How many places were tried for it.
    pub attempts: usize,
    /// Share of the region that the placed bodies fill.
    pub fraction: f64,
}

impl std::fmt::Debug for Jammed {
    /// Without the poses, which may be very many.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Jammed({self})")
    }
}

/// A finite number above zero, or what to say.
pub(super) fn positive(what: &'static str, value: f64) -> Result<f64, PlacingError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(PlacingError::Parameter { what, value, remedy: "give a positive, finite number" })
    }
}
/// A finite number that is not negative, or what to say.
pub(crate) fn not_negative(what: &'static str, value: f64) -> Result<f64, PlacingError> {
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err(PlacingError::Parameter { what, value, remedy: "give zero or a positive, finite number" })
    }
}
/// A finite number, or what to say.
pub(super) fn finite(what: &'static str, value: f64) -> Result<f64, PlacingError> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(PlacingError::Parameter { what, value, remedy: "give a finite number" })
    }
}
