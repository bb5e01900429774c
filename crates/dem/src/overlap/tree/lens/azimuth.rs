//! Angles without an arc tangent.
/// The azimuth of (u, v) in eighths of a turn: whole ones, and the rest to 0.005.
pub(super) fn eighths(u: f64, v: f64) -> (usize, f64) {
    let (x, y) = (u.abs(), v.abs());
    let steep = y > x;
    let slope = if x.max(y) > 0.0 { x.min(y) / x.max(y) } else { 0.0 };
    // atan t ≈ t π/4 + 0.273 t (1 − t) (Rajan et al. 2006, IEEE Signal Process. Mag. 23, 108).
    let angle = slope * (1.0 + 0.273 * 4.0 / std::f64::consts::PI * (1.0 - slope));
    // Upwards from the u axis or downwards to it, quarter by quarter.
    let (quarter, falls) = match (u >= 0.0, v >= 0.0) {
        (true, true) => (0, false),
        (false, true) => (1, true),
        (false, false) => (2, false),
        (true, false) => (3, true),
    };
    let (second, share) = if steep != falls { (1, 1.0 - angle) } else { (0, angle) };
    (2 * quarter + second, share)
}

#[cfg(test)]
mod tests {
    use super::eighths;

    #[test]
    fn eighths_of_a_turn() {
        for i in 0..8000 {
            let angle = f64::from(i) / 1000.0;
            let (sin, cos) = (angle * std::f64::consts::FRAC_PI_4).sin_cos();
            let (k, share) = eighths(3.0 * cos, 3.0 * sin);
            let off = (k as f64 + share - angle).abs();
            assert!(
                k < 8 && (0.0..=1.0).contains(&share) && off.min(8.0 - off) < 0.006,
                "{angle}: {k} {share}"
            );
        }
        assert_eq!(eighths(0.0, 0.0), (0, 0.0));
    }
}
