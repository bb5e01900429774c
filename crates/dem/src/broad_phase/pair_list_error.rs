//! What can be wrong with boxes.

/// Why pairs could not be listed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PairListError {
    /// A corner is not finite, or the lower one is not the lower one.
    #[error(
        "the box of body {body} runs from {min:?} to {max:?} m; give finite corners, the lower one first"
    )]
    Box {
        /// The body.
        body: usize,
        /// Lower corner \[m\].
        min: [f64; 3],
        /// Upper corner \[m\].
        max: [f64; 3],
    },
    /// Lists of different lengths.
    #[error(
        "there are {boxes} boxes, but for {movable} bodies it is said whether they are movable; give as many"
    )]
    Movable {
        /// How many boxes.
        boxes: usize,
        /// How many bodies.
        movable: usize,
    },
    /// A body that does not exist is said to have changed.
    #[error("body {body} is said to have changed, but there are only {boxes} boxes; give numbers below that")]
    Changed {
        /// The body.
        body: u32,
        /// How many boxes.
        boxes: usize,
    },
    /// Numbers of 31 bits do not suffice.
    #[error("{boxes} boxes are more than can be numbered; give fewer than 2^31")]
    TooMany {
        /// How many boxes.
        boxes: usize,
    },
    /// A period is not a length.
    #[error("the period along axis {axis} is {period} m; give a positive, finite length")]
    Period {
        /// Axis, 0 for x.
        axis: usize,
        /// Its value \[m\].
        period: f64,
    },
    /// A box is so large that it meets too many images.
    #[error(
        "the box of body {body} is {size:.3e} m long along axis {axis}, more than 250 periods of {period:.3e} m; give a longer period"
    )]
    Size {
        /// The body.
        body: usize,
        /// Axis, 0 for x.
        axis: usize,
        /// Extent \[m\].
        size: f64,
        /// Period \[m\].
        period: f64,
    },
    /// A body has gone so far that its image cannot be counted.
    #[error(
        "the box of body {body} is {periods:.3e} periods away along axis {axis}, more than can be counted (5e8); move it back by whole periods"
    )]
    Far {
        /// The body.
        body: usize,
        /// Axis, 0 for x.
        axis: usize,
        /// How many periods.
        periods: f64,
    },
}
