//! Where the flow behind a body turns back.
use crate::Outcome;

/// The longest wake that is looked for.
const LONGEST: f64 = 10.0;

/// From the rear of a body to where `speed(distance)` along the axis behind it turns from negative to positive, linear between
/// steps; zero if it does not.
///
/// # Errors
/// Those of `speed`.
pub fn wake_length(speed: impl Fn(f64) -> Outcome<f64>, from: f64, step: f64) -> Outcome<f64> {
    let (mut distance, mut last) = (from, speed(from)?);
    while distance < LONGEST {
        let next = speed(distance + step)?;
        if last < 0.0 && next >= 0.0 {
            return Ok(distance + step * last / (last - next));
        }
        (distance, last) = (distance + step, next);
    }
    Ok(0.0)
}
