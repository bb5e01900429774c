//! Where straight lines meet the pieces of shapes, and the check of lengths.
use crate::DemError;

/// `value` if it is a length.
pub(super) fn length(what: &'static str, value: f64) -> Result<f64, DemError> {
    if value.is_finite() && value > 0.0 { Ok(value) } else { Err(DemError::Length { what, value }) }
}

/// The t with a t² + 2bt + c ≤ 0, a ≥ 0; all of them where a = b = 0 and c ≤ 0.
#[inline]
pub(super) fn quadratic(a: f64, b: f64, c: f64) -> Option<[f64; 2]> {
    let root = b * b - a * c;
    if a == 0.0 {
        return (c <= 0.0).then_some([f64::NEG_INFINITY, f64::INFINITY]);
    }
    if root < 0.0 {
        return None;
    }
    // The sum that does not cancel.
    let q = -(b + root.sqrt().copysign(b));
    let (one, two) = (q / a, if q == 0.0 { 0.0 } else { c / q });
    // Not the sign of b, which may be −0.
    Some(if q > 0.0 { [two, one] } else { [one, two] })
}

/// The t with |o + ut| ≤ half.
#[inline]
pub(super) fn slab(half: f64, o: f64, u: f64) -> Option<[f64; 2]> {
    if u == 0.0 {
        return (o.abs() <= half).then_some([f64::NEG_INFINITY, f64::INFINITY]);
    }
    let (one, two) = ((-half - o) / u, (half - o) / u);
    Some([one.min(two), one.max(two)])
}
