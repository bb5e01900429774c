//! What smooth forcing leaves of films.
use crate::IbmError;
use interfaces::UnresolvedFilm;

/// What a flow on cells of one size, with bodies forced by [`SmoothForcing`](crate::SmoothForcing), leaves of the films between bodies, and between bodies and the sides of its box: measured
/// (`cargo bench --bench lubrication`) with spheres of 6 to 24 cells per diameter and the kernel for space, against Brenner's (1961, Chem. Eng. Sci. 16, 242) series.
///
/// With q the share by which the flow's own film is stronger than 1/δ, −q/δ is left. Markers that reach across the film make it stronger below two cells (q up to
/// 0.6 at a wall, 1 between bodies, whose markers reach from both sides), and below a quarter of a cell ever weaker: there the flow knows no
/// film thinner than the markers' blur. q hardly depends on how bodies stand in their cells (2 % of the force at a wall, 5 % between bodies). Of ln(1/δ) nothing is left above a fifth of a cell, and
/// 0.88 of what is thinner. From two to three cells the model fades out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothFilm {
    spacing: f64,
}

impl SmoothFilm {
    /// On cells of this `spacing` \[m\] where bodies are.
    ///
    /// # Errors
    /// [`IbmError::Spacing`] unless it is positive and finite.
    pub fn new(spacing: f64) -> Result<Self, IbmError> {
        if spacing > 0.0 && spacing.is_finite() {
            Ok(Self { spacing })
        } else {
            Err(IbmError::Spacing { spacing })
        }
    }
}

/// Gaps in cells.
const GAPS: [f64; 10] = [0.05, 0.1, 0.2, 0.3, 0.4, 0.6, 0.9, 1.2, 2.0, 3.0];
/// Reduced radii in cells, and q at these gaps: at walls, between bodies.
const WALLS: [(f64, [f64; 10]); 4] = [
    (3.0, [-0.491, -0.100, 0.377, 0.547, 0.545, 0.401, 0.285, 0.258, 0.217, 0.199]),
    (4.0, [-0.450, -0.032, 0.466, 0.623, 0.588, 0.385, 0.227, 0.190, 0.146, 0.126]),
    (6.0, [-0.563, -0.230, 0.181, 0.346, 0.367, 0.272, 0.170, 0.138, 0.095, 0.073]),
    (8.0, [-0.653, -0.384, -0.034, 0.134, 0.190, 0.179, 0.133, 0.114, 0.077, 0.060]),
];
const BODIES: [(f64, [f64; 10]); 2] = [
    (2.0, [-0.530, -0.141, 0.410, 0.700, 0.894, 0.968, 0.840, 0.700, 0.470, 0.300]),
    (3.0, [-0.549, -0.165, 0.396, 0.690, 0.885, 0.926, 0.740, 0.593, 0.352, 0.220]),
];
/// How far beyond the largest measured radius the tables are trusted: they change with the logarithm of the radius.
const BEYOND: f64 = 2.0;
/// Gaps, in cells, between which the model fades out.
pub(crate) const FADES: [f64; 2] = [2.0, 3.0];
/// Below this gap, in cells, this share of ln(1/δ) is not resolved.
const SHEARED: (f64, f64) = (0.21, 0.88);

/// Between the two values of an ascending series that `x` lies between: the number of the first, and how far it is to the second; ends hold on.
fn between(x: f64, at: impl Fn(usize) -> f64, n: usize) -> (usize, f64) {
    let i = (1..n - 1).take_while(|&i| at(i) <= x).last().unwrap_or(0);
    (i, (x / at(i)).ln() / (at(i + 1) / at(i)).ln())
}

/// q at a gap and a reduced radius, in cells.
fn excess(table: &[(f64, [f64; 10])], gap: f64, radius: f64) -> f64 {
    let thin = gap.max(GAPS[0]);
    let (g, part) = between(thin, |i| GAPS[i], GAPS.len());
    let (least, most) = (table[0].0, table[table.len() - 1].0 * BEYOND);
    let (r, share) = between(radius.clamp(least, most), |i| table[i].0, table.len());
    let at = |r: usize| table[r].1[g] + part.min(1.0) * (table[r].1[g + 1] - table[r].1[g]);
    let q = at(r) + share * (at(r + 1) - at(r));
    // Films thinner than the thinnest measured are to the flow as thick as that.
    (1.0 + q) * (gap / thin) - 1.0
}

impl UnresolvedFilm for SmoothFilm {
    fn reach(&self) -> f64 {
        FADES[1] * self.spacing
    }
    fn squeeze(&self, gap: f64, radius: f64, wall: bool) -> f64 {
        let cells = gap / self.spacing;
        if cells >= FADES[1] {
            return 0.0;
        }
        let table: &[_] = if wall { &WALLS } else { &BODIES };
        let fade = ((FADES[1] - cells) / (FADES[1] - FADES[0])).min(1.0);
        -excess(table, cells, radius / self.spacing).max(-1.0) * fade / gap
    }
    fn shear(&self, gap: f64) -> f64 {
        SHEARED.1 * (SHEARED.0 * self.spacing / gap).ln().max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_met_and_ends_hold_on() {
        let film = SmoothFilm::new(1.0).unwrap();
        for (radius, row) in WALLS {
            for (gap, q) in GAPS.into_iter().zip(row).filter(|(gap, _)| *gap <= 2.0) {
                assert!((film.squeeze(gap, radius, true) * gap + q).abs() < 1e-12, "{gap} {radius}");
            }
        }
        for (radius, row) in BODIES {
            assert!((film.squeeze(0.6, radius, false) * 0.6 + row[5]).abs() < 1e-12);
        }
        assert_eq!(film.squeeze(3.0, 4.0, true), 0.0);
        assert!(film.squeeze(2.999, 4.0, true).abs() < 1e-3);
        // What is very thin is not resolved at all.
        assert!((film.squeeze(1e-4, 4.0, true) * 1e-4 - 1.0).abs() < 2e-3);
        assert_eq!(film.squeeze(0.1, 1e3, true), film.squeeze(0.1, 1e4, true));
        assert!(film.squeeze(0.1, 0.01, true).is_finite());
        // Lengths scale.
        let fine = SmoothFilm::new(0.1).unwrap();
        assert!((fine.squeeze(0.05, 0.5, false) - 10.0 * film.squeeze(0.5, 5.0, false)).abs() < 1e-12);
        assert!((fine.shear(0.001) - film.shear(0.01)).abs() < 1e-12 && film.shear(0.5) == 0.0);
    }

    #[test]
    fn it_has_no_jumps() {
        let film = SmoothFilm::new(1.0).unwrap();
        for wall in [true, false] {
            for radius in [1.0, 2.5, 5.0, 7.0, 20.0] {
                let values: Vec<f64> = (1..3200)
                    .map(|i| 1e-3 * f64::from(i))
                    .map(|g| g * film.squeeze(g, radius, wall))
                    .collect();
                assert!(values.windows(2).all(|v| (v[1] - v[0]).abs() < 0.02), "{wall} {radius}");
            }
        }
    }

    #[test]
    fn senseless_spacings_are_refused() {
        for spacing in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(SmoothFilm::new(spacing), Err(IbmError::Spacing { .. })), "{spacing}");
        }
    }
}
