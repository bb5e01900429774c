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
///
/// [Markers on the surface](crate::SmoothForcing::with_surface_markers) reach farther across: at a wall the flow's film is up to 1.3/δ too strong at half a cell, and hardly so above one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothFilm {
    spacing: f64,
    surface_markers: bool,
}

impl SmoothFilm {
    /// On cells of this `spacing` \[m\] where bodies are.
    ///
    /// # Errors
    /// [`IbmError::Spacing`] unless it is positive and finite.
    pub fn new(spacing: f64) -> Result<Self, IbmError> {
        if spacing > 0.0 && spacing.is_finite() {
            Ok(Self { spacing, surface_markers: false })
        } else {
            Err(IbmError::Spacing { spacing })
        }
    }
    /// The same of markers [on the surface](crate::SmoothForcing::with_surface_markers).
    ///
    /// # Errors
    /// [`IbmError::Spacing`] unless it is positive and finite.
    pub fn of_surface_markers(spacing: f64) -> Result<Self, IbmError> {
        Ok(Self { surface_markers: true, ..Self::new(spacing)? })
    }

    fn tables(&self) -> &'static Tables {
        if self.surface_markers { &ON_SURFACE } else { &DEEPER }
    }
}

/// What was measured with markers of one kind: reduced radii in cells, and q at the [`GAPS`].
struct Tables {
    walls: &'static [Row],
    bodies: &'static [Row],
    /// Below this gap, in cells, this share of ln(1/δ) is not resolved.
    sheared: (f64, f64),
}
type Row = (f64, [f64; 10]);

/// Gaps in cells.
const GAPS: [f64; 10] = [0.05, 0.1, 0.2, 0.3, 0.4, 0.6, 0.9, 1.2, 2.0, 3.0];
const DEEPER: Tables = Tables {
    walls: &[
        (3.0, [-0.491, -0.100, 0.377, 0.547, 0.545, 0.401, 0.285, 0.258, 0.217, 0.199]),
        (4.0, [-0.450, -0.032, 0.466, 0.623, 0.588, 0.385, 0.227, 0.190, 0.146, 0.126]),
        (6.0, [-0.563, -0.230, 0.181, 0.346, 0.367, 0.272, 0.170, 0.138, 0.095, 0.073]),
        (8.0, [-0.653, -0.384, -0.034, 0.134, 0.190, 0.179, 0.133, 0.114, 0.077, 0.060]),
    ],
    bodies: &[
        (2.0, [-0.530, -0.141, 0.410, 0.700, 0.894, 0.968, 0.840, 0.700, 0.470, 0.300]),
        (3.0, [-0.549, -0.165, 0.396, 0.690, 0.885, 0.926, 0.740, 0.593, 0.352, 0.220]),
    ],
    sheared: (0.21, 0.88),
};
const ON_SURFACE: Tables = Tables {
    walls: &[
        (3.0, [-0.556, -0.161, 0.492, 0.978, 1.284, 1.257, 0.473, 0.122, 0.061, 0.055]),
        (4.0, [-0.632, -0.305, 0.245, 0.673, 0.968, 1.035, 0.390, 0.077, 0.023, 0.021]),
        (6.0, [-0.735, -0.508, -0.126, 0.161, 0.359, 0.441, 0.146, 0.007, 0.000, 0.004]),
    ],
    bodies: &[
        (1.5, [-0.682, -0.409, -0.001, 0.259, 0.416, 0.540, 0.519, 0.439, 0.278, 0.200]),
        (2.0, [-0.682, -0.409, -0.001, 0.259, 0.416, 0.540, 0.519, 0.439, 0.278, 0.200]),
    ],
    sheared: (0.36, 0.88),
};
/// How far beyond the largest measured radius the tables are trusted: they change with the logarithm of the radius.
const BEYOND: f64 = 2.0;
/// Gaps, in cells, between which the model fades out.
const FADES: [f64; 2] = [2.0, 3.0];

/// Between the two values of an ascending series that `x` lies between: the number of the first, and how far it is to the second; ends hold on.
fn between(x: f64, at: impl Fn(usize) -> f64, n: usize) -> (usize, f64) {
    let i = (1..n - 1).take_while(|&i| at(i) <= x).last().unwrap_or(0);
    (i, (x / at(i)).ln() / (at(i + 1) / at(i)).ln())
}

/// q at a gap and a reduced radius, in cells.
fn excess(table: &[Row], gap: f64, radius: f64) -> f64 {
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
        let Tables { walls, bodies, .. } = self.tables();
        let table = if wall { walls } else { bodies };
        let fade = ((FADES[1] - cells) / (FADES[1] - FADES[0])).min(1.0);
        -excess(table, cells, radius / self.spacing).max(-1.0) * fade / gap
    }
    fn shear(&self, gap: f64) -> f64 {
        let (below, share) = self.tables().sheared;
        share * (below * self.spacing / gap).ln().max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_met_and_ends_hold_on() {
        for (film, tables) in [
            (SmoothFilm::new(1.0).unwrap(), DEEPER),
            (SmoothFilm::of_surface_markers(1.0).unwrap(), ON_SURFACE),
        ] {
            for (table, wall) in [(tables.walls, true), (tables.bodies, false)] {
                for &(radius, row) in table {
                    for (gap, q) in GAPS.into_iter().zip(row).filter(|(gap, _)| *gap <= 2.0) {
                        assert!((film.squeeze(gap, radius, wall) * gap + q).abs() < 1e-12, "{gap} {radius}");
                    }
                }
            }
            assert!(film.shear(1.01 * tables.sheared.0) == 0.0 && film.shear(0.99 * tables.sheared.0) > 0.0);
        }
        let film = SmoothFilm::new(1.0).unwrap();
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
        for film in [SmoothFilm::new(1.0).unwrap(), SmoothFilm::of_surface_markers(1.0).unwrap()] {
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
    }

    #[test]
    fn senseless_spacings_are_refused() {
        for spacing in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(SmoothFilm::new(spacing), Err(IbmError::Spacing { .. })), "{spacing}");
        }
    }
}
