//! How long a run is.
use crate::problem::Problem;
use crate::reader::Reader;

/// Snapshots of a run unless told.
const SNAPSHOTS: usize = 50;
/// No run makes more steps of a length that is given.
const MOST_STEPS: f64 = 1e12;

/// End of a run, and the intervals that its snapshots cut it into.
pub(super) struct Span {
    /// \[s\].
    pub(super) end: f64,
    pub(super) snapshots: usize,
}

impl Span {
    /// Time of a steady scene: one instant.
    pub(super) const STEADY: Self = Self { end: 1.0, snapshots: 1 };

    /// Of the tables `time` and `output`. So many `steps` have to be cut into equal numbers of them.
    pub(super) fn read(time: &Reader<'_>, output: &Reader<'_>) -> Result<Self, Problem> {
        let (end, steps, dt) = (time.number("end"), time.whole("steps"), time.number("dt"));
        let asked = output.whole("snapshots");
        let Some(steps) = steps else {
            let missing = "how long is the run? Give `end` in s, or `steps` and `dt`";
            let end = end.ok_or_else(|| time.fail_here(missing))?;
            if let Some(dt) = dt.filter(|dt| end / dt > MOST_STEPS) {
                let (steps, least) = (end / dt, end / MOST_STEPS);
                return Err(
                    time.fail("dt", format!("{steps:.0e} steps to time.end; give {least:e} s at least"))
                );
            }
            return Ok(Self { end, snapshots: asked.unwrap_or(SNAPSHOTS) });
        };
        if end.is_some() {
            return Err(time.fail("steps", "`end` is given already; leave out one of the two"));
        }
        if time.flag("ramp") == Some(true) {
            return Err(
                time.fail("ramp", "so many `steps` are of equal length; leave this out, or give `end`")
            );
        }
        let dt = dt.ok_or_else(|| time.fail("steps", "of which length? Give `dt`, too"))?;
        let even = |n: usize| n == 0 || steps.is_multiple_of(n);
        let snapshots = match asked {
            Some(n) if even(n) => n,
            Some(n) => {
                let near = (1..=n).rev().find(|n| even(*n)).unwrap_or(1);
                let message = format!(
                    "{n} equal intervals of {steps} steps; give a number that divides them, {near} for instance"
                );
                return Err(output.fail("snapshots", message));
            }
            None => (1..=SNAPSHOTS).rev().find(|n| even(*n)).unwrap_or(1),
        };
        Ok(Self { end: steps as f64 * dt, snapshots })
    }
}
