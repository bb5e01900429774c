//! Numbers of several slices against the standard library's, one by one.
use super::super::lanes::{Lanes, WIDTH};
use crate::draw::Draw;
use pulp::{Arch, Scalar, Simd, WithSimd};
use std::f64::consts::PI;

/// Angles of (cosine, sine) and areas of their segments.
struct Angles {
    sin: [f64; WIDTH],
    cos: [f64; WIDTH],
}

impl WithSimd for Angles {
    type Output = [[f64; WIDTH]; 2];
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let mut found = [[0.0; WIDTH]; 2];
        let of = |x: &[f64; WIDTH], i: usize| Lanes::new(simd, S::as_simd_f64s(x).0[i]);
        for i in 0..WIDTH / S::F64_LANES {
            let (angle, product) = of(&self.sin, i).angle(of(&self.cos, i));
            S::as_mut_simd_f64s(&mut found[0]).0[i] = angle.raw();
            S::as_mut_simd_f64s(&mut found[1]).0[i] = angle.segment(product).raw();
        }
        found
    }
}

/// α − sin α cos α; by all terms of its series that count where the difference would cancel.
fn segment(angle: f64) -> f64 {
    if angle > 0.5 {
        return angle - angle.sin() * angle.cos();
    }
    let (mut term, mut sum, mut k) = (2.0 * angle, 0.0, 1.0);
    while k < 30.0 {
        term *= -4.0 * angle * angle / ((2.0 * k) * (2.0 * k + 1.0));
        sum -= 0.5 * term;
        k += 1.0;
    }
    sum
}

#[test]
fn angles_and_segments() {
    let mut draw = Draw(11);
    for round in 0..20_000 {
        let (mut sin, mut cos, mut angles) = ([0.0; WIDTH], [0.0; WIDTH], [0.0; WIDTH]);
        for i in 0..WIDTH {
            // From 1e-9 to π − 1e-9, and quarters, eighths and the ends themselves.
            let angle = match (round + i) % 4 {
                0 => draw.between(1e-9, 1.0),
                1 => PI - draw.between(1e-9, 1.0),
                2 => PI * draw.next(),
                _ => PI / 8.0 * (8.0 * draw.next()).round(),
            };
            let size = draw.between(1e-12, 1e6);
            (sin[i], cos[i]) = ((size * angle.sin()).max(0.0), size * angle.cos());
            angles[i] = sin[i].atan2(cos[i]);
        }
        let widest = Arch::new().dispatch(Angles { sin, cos });
        let single = Angles { sin, cos }.with_simd(Scalar);
        for found in [widest, single] {
            for (i, angle) in angles.iter().enumerate() {
                let [error, of_area] = [found[0][i] - angle, found[1][i] - segment(*angle)];
                assert!(error.abs() <= 5e-16 * angle, "{angle} {error}");
                assert!(of_area.abs() <= 3e-14 * segment(*angle), "{angle} {of_area}");
            }
        }
    }
    // Nothing at all.
    let none = Arch::new().dispatch(Angles { sin: [0.0; WIDTH], cos: [0.0; WIDTH] });
    assert_eq!(none, [[0.0; WIDTH]; 2]);
}
