//! How far to go in a direction.
use super::lbfgs::{Objective, dot};

/// Share of the decrease the slope promises that must be reached.
const DECREASE: f64 = 1e-4;
/// Share of the slope that may be left.
const CURVATURE: f64 = 0.9;

/// θ + α d, from where to look.
pub(super) struct Line<'a> {
    pub(super) theta: &'a [f64],
    pub(super) direction: &'a [f64],
    /// f(θ).
    pub(super) value: f64,
    /// dᵀ∂f/∂θ < 0.
    pub(super) slope: f64,
}

/// A place on the line.
pub(super) struct Place {
    pub(super) theta: Vec<f64>,
    pub(super) gradient: Vec<f64>,
    pub(super) value: f64,
    pub(super) slope: f64,
    pub(super) step: f64,
}

/// A step with its value and slope.
#[derive(Clone, Copy)]
struct End {
    step: f64,
    value: f64,
    slope: f64,
}

impl Line<'_> {
    fn go<O: Objective>(&self, objective: &mut O, step: f64, place: &mut Place) -> End {
        for ((to, from), d) in place.theta.iter_mut().zip(self.theta).zip(self.direction) {
            *to = from + step * d;
        }
        place.value = objective.evaluate(&place.theta, &mut place.gradient);
        place.slope = dot(&place.gradient, self.direction);
        place.step = step;
        End { step, value: place.value, slope: place.slope }
    }
    fn is_low(&self, end: End) -> bool {
        end.value <= self.value + DECREASE * end.step * self.slope
    }
    fn is_flat(&self, end: End) -> bool {
        end.slope.abs() <= -CURVATURE * self.slope
    }
}

/// A place that obeys the strong conditions of Wolfe (Nocedal & Wright 2006, algorithms 3.5 and 3.6), or else a lower one; false if
/// none was found. The last evaluation is the one at this place.
pub(super) fn search<O: Objective>(
    objective: &mut O,
    line: &Line<'_>,
    first: f64,
    place: &mut Place,
) -> bool {
    let mut low = End { step: 0.0, value: line.value, slope: line.slope };
    let mut step = first;
    for tried in 0..25 {
        let end = line.go(objective, step, place);
        let above = !(end.value.is_finite() && end.slope.is_finite());
        if above || !line.is_low(end) || (tried > 0 && end.value >= low.value) {
            return narrow(objective, line, low, end, place);
        }
        if line.is_flat(end) {
            return true;
        }
        if end.slope >= 0.0 {
            return narrow(objective, line, end, low, place);
        }
        let further = minimum(low, end).filter(|s| s.is_finite()).unwrap_or(0.0);
        step = further.clamp(1.5 * step, 10.0 * step);
        low = end;
    }
    true
}

/// Between a low end and one that is high or slopes back.
fn narrow<O: Objective>(
    objective: &mut O,
    line: &Line<'_>,
    mut low: End,
    mut high: End,
    place: &mut Place,
) -> bool {
    for _ in 0..25 {
        let [a, b] = [low.step.min(high.step), low.step.max(high.step)];
        if b - a <= 1e-14 * b {
            break;
        }
        let inside = (a + 0.1 * (b - a))..(b - 0.1 * (b - a));
        let finite = high.value.is_finite() && high.slope.is_finite();
        let guess = if finite { minimum(low, high).filter(|s| inside.contains(s)) } else { None };
        let end = line.go(
            objective,
            guess.unwrap_or(if finite { 0.5 * (a + b) } else { 0.9 * a + 0.1 * b }),
            place,
        );
        let above = !(end.value.is_finite() && end.slope.is_finite());
        if above || !line.is_low(end) || end.value >= low.value {
            high = end;
            continue;
        }
        if line.is_flat(end) {
            return true;
        }
        if end.slope * (high.step - low.step) >= 0.0 {
            high = low;
        }
        low = end;
    }
    low.step > 0.0 && low.value < line.value && {
        line.go(objective, low.step, place);
        true
    }
}

/// Where the cubic through two values with two slopes is smallest.
fn minimum(a: End, b: End) -> Option<f64> {
    let d1 = a.slope + b.slope - 3.0 * (a.value - b.value) / (a.step - b.step);
    let root = d1 * d1 - a.slope * b.slope;
    let d2 = (root >= 0.0).then(|| root.sqrt())? * (b.step - a.step).signum();
    let step = b.step - (b.step - a.step) * (b.slope + d2 - d1) / (b.slope - a.slope + 2.0 * d2);
    step.is_finite().then_some(step)
}
