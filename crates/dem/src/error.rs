//! What can go wrong.
use crate::{Partner, Refinement, Route};
use interfaces::BodyId;

/// Cause of the longest sub-step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SubStepLimit {
    /// The tether of a body.
    Tether(BodyId),
    /// Contacts of a body with its like or a wall.
    Material(BodyId),
    /// The stiffest contact at present.
    Contact,
    /// The speed at which bodies approach.
    Speed,
}

impl std::fmt::Display for SubStepLimit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Tether(b) => {
                write!(f, "the tether of body {}; give it less stiffness or damping", b.0)
            }
            Self::Material(b) => write!(
                f,
                "contacts of body {}; give its material a smaller Young's modulus, a Poisson's ratio well above -1 or less damping",
                b.0
            ),
            Self::Contact => f.write_str("the stiffest contact; give softer materials"),
            Self::Speed => f.write_str("bodies as fast as these; give slower ones"),
        }
    }
}

/// Why a shape, a body or a step could not be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DemError {
    /// A size is not a length.
    #[error("the {what} is {value} m; give a positive, finite length")]
    Length {
        /// Which size.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A direction has no length.
    #[error("the normal {normal:?} has no direction; give a finite vector that is not zero")]
    Direction {
        /// The vector.
        normal: [f64; 3],
    },
    /// Too few points for a convex hull.
    #[error("{points} points have no convex hull with volume; give four or more")]
    TooFewPoints {
        /// Their number.
        points: usize,
    },
    /// A point is not finite, or absurd.
    #[error("point {point} is at {position:?} m; give finite coordinates of no more than 1e50 m")]
    PointNotFinite {
        /// Its number, from 0.
        point: usize,
        /// Its place.
        position: [f64; 3],
    },
    /// All points are on a line, or at one place.
    #[error(
        "the points are on a line: none is farther than {width:.3e} m from it, though they are {size:.3e} m apart; give points around a volume"
    )]
    PointsOnLine {
        /// Largest distance from the line \[m\].
        width: f64,
        /// Largest extent \[m\].
        size: f64,
    },
    /// All points are on a plane.
    #[error(
        "the points are on a plane: none is farther than {height:.3e} m from it, though they are {size:.3e} m apart; give points around a volume"
    )]
    PointsOnPlane {
        /// Largest distance from the plane \[m\].
        height: f64,
        /// Largest extent \[m\].
        size: f64,
    },
    /// A body is on its way through another one, or through a wall: the contact, soft as it is, could not stop it.
    #[error(
        "body {} went through {partner}: both share {:.0} % of the smaller one and it is no longer pushed back; give a larger Young's modulus, less load or less speed, or a start without such an overlap",
        body.0, 100.0 * share
    )]
    PassedThrough {
        /// The body.
        body: BodyId,
        /// What it went through.
        partner: Partner,
        /// Part of the smaller one's volume that both share.
        share: f64,
    },
    /// Thresholds of sleep are not positive.
    #[error("bodies would sleep below {speed} m/s after {time} s; give positive, finite numbers")]
    Sleep {
        /// The speed.
        speed: f64,
        /// The time.
        time: f64,
    },
    /// A material property is not physical.
    #[error("the {property} of the material is {value}; {remedy}")]
    Material {
        /// Which property.
        property: &'static str,
        /// Its value.
        value: f64,
        /// What to give instead.
        remedy: &'static str,
    },
    /// The factor of the characteristic length is not positive.
    #[error("the factor of the contact length is {factor}; give a positive, finite number (4 is usual)")]
    LengthFactor {
        /// Its value.
        factor: f64,
    },
    /// A polygon makes no sense.
    #[error("corner {corner} of the polygon {what}")]
    Polygon {
        /// Its number.
        corner: usize,
        /// What is wrong with it.
        what: &'static str,
    },
    /// A repulsion makes no sense.
    #[error("the repulsion's {what} is {value}; give a positive, finite number")]
    Repulsion {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A film of fluid makes no sense.
    #[error("the film's {what} is {value}; give a positive, finite number, of a roughness no more than 1")]
    Film {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A tether makes no sense.
    #[error("the tether of body {} has stiffness {stiffness} N/m and damping {damping} N s/m; give a stiffness and a damping that are finite and not negative, and finite places", body.0)]
    Tether {
        /// The body.
        body: BodyId,
        /// Its stiffness \[N/m\].
        stiffness: f64,
        /// Its damping \[N s/m\].
        damping: f64,
    },
    /// Start position or orientation is not finite.
    #[error("body {} would start at {position:?} m, and position or orientation is not finite; give finite numbers", body.0)]
    Start {
        /// The body.
        body: BodyId,
        /// Where.
        position: [f64; 3],
    },
    /// Start velocity or angular velocity is not finite.
    #[error("body {} would start with velocity {linear:?} m/s and angular velocity {angular:?} rad/s; give finite numbers", body.0)]
    StartMotion {
        /// The body.
        body: BodyId,
        /// Velocity.
        linear: [f64; 3],
        /// Angular velocity.
        angular: [f64; 3],
    },
    /// Near pairs could not be listed.
    #[error(transparent)]
    Pairs(#[from] crate::PairListError),
    /// A step would take too many sub-steps.
    #[error(
        "a step of {dt:.3e} s would take more than 1e8 sub-steps: no more than {longest:.3e} s is stable for {limit}"
    )]
    SubSteps {
        /// Cause.
        limit: SubStepLimit,
        /// The step \[s\].
        dt: f64,
        /// The longest sub-step \[s\].
        longest: f64,
    },
    /// A body is longer than a period by more than [`interfaces::LENGTH_PRECISION`] of it.
    #[error(
        "body {} is {size:.3e} m long along axis {axis}, more than the period of {period:.3e} m, so it would overlap itself: take a smaller body or a longer period", body.0)]
    Period {
        /// The body.
        body: BodyId,
        /// Axis, 0 for x.
        axis: usize,
        /// Extent \[m\].
        size: f64,
        /// Period \[m\].
        period: f64,
    },
    /// Two bodies overlap before the first step.
    #[error("bodies {} and {} overlap by {depth:.3e} m at the start; move them at least that much apart", a.0, b.0)]
    OverlappingStart {
        /// One body.
        a: BodyId,
        /// The other one.
        b: BodyId,
        /// How far \[m\].
        depth: f64,
    },
    /// A body stands in a wall before the first step.
    #[error("body {} stands {depth:.3e} m deep in wall {wall} at the start; move it out by at least that much", body.0)]
    InWall {
        /// The body.
        body: BodyId,
        /// Number of the wall.
        wall: usize,
        /// How deep \[m\].
        depth: f64,
    },
    /// No formula for this pair of shapes.
    #[error(
        "a {a} and a {b} have no overlap that could be computed: discs meet discs and plane walls only, and two walls share no finite volume; use bodies of one dimension"
    )]
    Unsupported {
        /// One shape.
        a: &'static str,
        /// The other one.
        b: &'static str,
    },
    /// Faces that make no convex body.
    #[error(
        "face {face} (from 0) of the polyhedron {what}; give flat faces, counter-clockwise seen from outside, of a closed convex body"
    )]
    Polyhedron {
        /// The face.
        face: usize,
        /// What is wrong with it.
        what: &'static str,
    },
    /// A union of nothing.
    #[error("a union without parts was asked for; give at least one")]
    NoParts,
    /// Parts of a union overlap.
    #[error(
        "parts {a} and {b} of the union overlap by {volume:.3e} m³, which would count twice; move them apart until they only touch, or make an implicit shape of them"
    )]
    OverlappingParts {
        /// One part.
        a: usize,
        /// The other one.
        b: usize,
        /// What they share \[m³\].
        volume: f64,
    },
    /// A pose is not finite.
    #[error(
        "the {name} is at {position:?} m, and position or orientation is not finite; give finite numbers"
    )]
    Pose {
        /// Which shape.
        name: &'static str,
        /// Where.
        position: [f64; 3],
    },
    /// An overlap that no two bodies can have.
    #[error(
        "a {a} and a {b} seem to share {volume:.3e} m³, but the boxes around them {most:.3e} m³: a surface crosses itself; look at its admission report"
    )]
    Impossible {
        /// One shape.
        a: &'static str,
        /// The other one.
        b: &'static str,
        /// What came out \[m³\].
        volume: f64,
        /// What the boxes share \[m³\].
        most: f64,
    },
    /// A route was asked for that does not lead to this pair's overlap.
    #[error(
        "the overlap of a {a} and a {b} cannot be had by {route}; leave the choice of the route to the solver"
    )]
    Route {
        /// One shape.
        a: &'static str,
        /// The other one.
        b: &'static str,
        /// The route.
        route: Route,
    },
    /// The adaptive tree cannot go so far.
    #[error(
        "the adaptive tree was asked for {refinement:?}; give 1 to 8 levels or a tolerance from 1e-8 to 1"
    )]
    Refinement {
        /// What was asked for.
        refinement: Refinement,
    },
    /// The adaptive tree has as many boxes as it may have.
    #[error(
        "{boxes} boxes of the adaptive tree bring the error of the volume of {what} down to {error:.1e} of it only; ask for a larger tolerance"
    )]
    Boxes {
        /// The body or bodies.
        what: String,
        /// How many boxes there are.
        boxes: usize,
        /// The relative error of the volume, about.
        error: f64,
    },
    /// A solid's box has no volume.
    #[error(
        "the box around the {name} is {extent:?} m large; give one with a positive, finite extent along all axes"
    )]
    Bounds {
        /// Which solid.
        name: &'static str,
        /// Its extent \[m\].
        extent: [f64; 3],
    },
    /// A solid has no inside.
    #[error(
        "nothing of the {name} was found within its box of {extent:?} m; is its distance negative inside, and the box around it?"
    )]
    Empty {
        /// Which solid.
        name: &'static str,
        /// Extent of its box \[m\].
        extent: [f64; 3],
    },
    /// A signed distance is not finite.
    #[error(
        "the signed distance of the {name} at {point:?} m is {value}; it must be finite all over its box"
    )]
    Distance {
        /// Which solid.
        name: &'static str,
        /// Where \[m\].
        point: [f64; 3],
        /// Its value \[m\].
        value: f64,
    },
    /// The step's length is unusable.
    #[error("a step of {dt} s was asked for; give a positive, finite number of seconds")]
    TimeStep {
        /// The step \[s\].
        dt: f64,
    },
    /// There is no wall of this number.
    #[error(
        "there is no wall {wall}: the numbers of the {walls} walls go from 0, in the order in which they were added"
    )]
    NoSuchWall {
        /// The number.
        wall: usize,
        /// How many there are.
        walls: usize,
    },
    /// A wall's surface can slide only.
    #[error("the surface of wall {wall} cannot move with ({:e}, {:e}, {:e}) m/s: its normal is ({:.6}, {:.6}, {:.6}), and walls keep their place; give a finite velocity along the plane, or take a body that cannot be moved (Freedom::NONE) and moves", velocity[0], velocity[1], velocity[2], normal[0], normal[1], normal[2])]
    WallVelocity {
        /// Number of the wall.
        wall: usize,
        /// The velocity \[m/s\].
        velocity: [f64; 3],
        /// The wall's normal.
        normal: [f64; 3],
    },
    /// There is no body of this number.
    #[error("there is no body {}: the numbers of the {bodies} bodies go from 0, and change when bodies are taken away", body.0)]
    NoSuchBody {
        /// The number.
        body: BodyId,
        /// How many there are.
        bodies: usize,
    },
    /// A body is so fast that it passes the box again and again before anybody could look whom it meets.
    #[error("body {} at {speed:.3e} m/s would come {way:.3e} m far before contacts are looked for again, {:.0} periods of the box along axis {axis}: the run diverges, or what pulls it is far too strong; check loads, densities and units, then take a smaller time step", body.0, way / period)]
    TooFast {
        /// The body.
        body: BodyId,
        /// Its speed \[m/s\].
        speed: f64,
        /// How far it would come \[m\].
        way: f64,
        /// Axis, 0 for x.
        axis: usize,
        /// The period \[m\].
        period: f64,
    },
    /// A body is lost.
    #[error("the motion of body {} is no longer finite (velocity {velocity:?} m/s); check the loads, then take a smaller time step or softer contacts", body.0)]
    Diverged {
        /// The body.
        body: BodyId,
        /// Its velocity.
        velocity: [f64; 3],
    },
}
