//! Straight parts of tubes that cross.
use super::adaptive;
use super::eight::Eight;
use super::piece::Piece;
use super::tube::Tube;
use crate::Overlap;
use crate::overlap::integrals::Integrals;

/// Sine of the angle between axes below which their straight parts are not taken for crossing.
const STEEP: f64 = 1e-3;

/// What two tubes share where that is all between their straight parts; `None` where it is not, or not for sure.
///
/// In slices along both axes these are strips of half-widths u = √(r² − h²) and v, which share a parallelogram of area
/// 4uv/sin ω. It stays within both tubes if its corners, (v + u cos ω)/sin ω along the first axis from where the
/// axes cross, do. In the angle of a half circle over the heights all is smooth. By symmetry S leads along the
/// slices' normal, and so does the moment, ∂V/∂ω = −V cot ω.
pub(super) fn overlap(a: &Tube, b: &Tube, tolerance: f64) -> Option<Overlap> {
    let cross = a.axis.cross(&b.axis);
    let sin = cross.norm();
    if sin < STEEP || a.half == 0.0 || b.half == 0.0 {
        return None;
    }
    let n = cross / sin;
    let cos = a.axis.dot(&b.axis);
    let apart = b.at.position - a.at.position;
    // Heights from the first axis.
    let d = n.dot(&apart);
    let (low, high) = ((d - b.radius).max(-a.radius), (d + b.radius).min(a.radius));
    if low.is_nan() || high.is_nan() || low >= high {
        return None;
    }
    let u = |h: f64| (a.radius - h) * (a.radius + h);
    let v = |h: f64| (b.radius - (h - d)) * (b.radius + (h - d));
    let widest = |square: &dyn Fn(f64) -> f64, middle: f64| square(middle.clamp(low, high)).max(0.0).sqrt();
    let (most_u, most_v) = (widest(&u, 0.0), widest(&v, d));
    // Where the axes cross: a.at + s a.axis below b.at + t b.axis.
    let [along_a, along_b] = [a.axis.dot(&apart), b.axis.dot(&apart)];
    let per = 1.0 / (sin * sin);
    let (s, t) = ((along_a - cos * along_b) * per, (cos * along_a - along_b) * per);
    let reach_a = (most_v + most_u * cos.abs()) / sin;
    let reach_b = (most_u + most_v * cos.abs()) / sin;
    if s.abs() + reach_a > a.half || t.abs() + reach_b > b.half {
        return None;
    }
    let base = 0.5 * (low + high);
    let piece = Piece::between((low, true), (high, true));
    let sums = adaptive::integrate::<1>(Integrals::default(), &[piece], tolerance, |_, heights| {
        let mut slices = Eight::default();
        for (i, h) in heights.iter().enumerate() {
            let [u, v] = [u(*h), v(*h)].map(|square| square.max(0.0).sqrt());
            let volume = 4.0 / sin * u * v;
            let upward = if u > 0.0 { 4.0 / sin * v * h / u } else { 0.0 };
            slices.set_upright(i, volume, h - base, upward);
        }
        slices
    });
    if sums.volume.is_nan() || sums.volume <= 0.0 {
        return None;
    }
    let gradient = n * sums.area.z;
    let centroid = a.at.position + a.axis * s + n * (base + sums.first.z / sums.volume);
    Some(Overlap {
        volume: sums.volume,
        centroid,
        normal: (-gradient).try_normalize(0.0).unwrap_or(if d > 0.0 { -n } else { n }),
        gradient,
        moment: n * (sums.volume * cos / sin),
    })
}
