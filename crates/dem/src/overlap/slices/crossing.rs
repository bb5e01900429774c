//! Straight parts of tubes that cross.
use super::adaptive;
use super::lanes::WIDTH;
use super::piece::Piece;
use super::sums::Sampled;
use crate::Overlap;
use crate::overlap::integrals::Integrals;
use crate::overlap::tube::Tube;

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
    // Half-widths where they are largest.
    let widest = |radius: f64, axis: f64| {
        let h = axis.clamp(low, high) - axis;
        ((radius - h) * (radius + h)).max(0.0).sqrt()
    };
    let (most_u, most_v) = (widest(a.radius, 0.0), widest(b.radius, d));
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
    let mut strips = Strips { radii: [a.radius, b.radius], apart: d, per: 4.0 / sin, base };
    let sums = adaptive::integrate::<1>(Integrals::default(), &[piece], tolerance, &mut strips);
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
        pivot: nalgebra::Matrix3::zeros(),
    })
}

/// Strips that two tubes are in slices along both.
struct Strips {
    radii: [f64; 2],
    /// Height of the second axis above the first.
    apart: f64,
    /// What they share, per half-width of either.
    per: f64,
    /// Where moments are counted from.
    base: f64,
}

impl adaptive::Slices for Strips {
    fn sums<const N: usize>(
        &mut self,
        _: usize,
        heights: &[f64; WIDTH],
        weights: &[[f64; WIDTH]; N],
    ) -> Sampled<N> {
        let [r, s] = self.radii;
        let (mut areas, mut upward) = ([0.0; WIDTH], [0.0; WIDTH]);
        for (i, h) in heights.iter().enumerate() {
            let above = h - self.apart;
            let u = ((r - h) * (r + h)).max(0.0).sqrt();
            let v = ((s - above) * (s + above)).max(0.0).sqrt();
            areas[i] = self.per * u * v;
            upward[i] = if u > 0.0 { self.per * v * h / u } else { 0.0 };
        }
        let mut sums = [Integrals::default(); N];
        for (sums, weights) in sums.iter_mut().zip(weights) {
            for (i, weight) in weights.iter().enumerate() {
                let part = areas[i] * weight;
                sums.volume += part;
                sums.first.z += (heights[i] - self.base) * part;
                sums.area.z += upward[i] * weight;
            }
        }
        Sampled { areas, sums }
    }
}
