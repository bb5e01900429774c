//! How well cells resolve layers on walls.
use super::gradients::corners;
use super::openings::Openings;
use super::stress::{Probe, Stresses};
use crate::Field;
use crate::across_stream::{LEAST, spared};

/// Places at which a layer is seen: so many times the cell's extent along the normal from the wall.
const PLACES: [f64; 3] = [1.0, 2.0, 3.0];
/// A layer whose velocity rises less than this from the second place to the third, over that from the first to the second, is thinner than what cells resolve.
/// A logarithmic one has ln 1.5/ln 2 = 0.58, a straight one 1.
const THIN: f64 = 0.3;

/// Layers that are several cells thick are resolved up to so many times the y+ up to which sublayers are: as far as gradients hear the wall's own velocity, of which a
/// logarithmic layer knows nothing. Sparing beyond that brings little, and layers in bends keep to walls (docs/results.md, "Where logarithmic layers begin").
const HEARD: f64 = 4.0;

/// How well cells resolve the layers on pieces of wall: those whose sublayer they resolve, and those that are several cells thick.
pub(super) struct Layers {
    /// The nodes around the places, and their weights.
    terms: Vec<(usize, f64)>,
    /// Where the terms of a component begin, by piece and place; at last where all end.
    starts: Vec<usize>,
    /// Per piece from 0, thinner than cells resolve, to 1.
    pub(super) resolved: Vec<f64>,
}

impl Layers {
    pub(super) fn new<const D: usize>(openings: &Openings<D>, stresses: &Stresses<D>) -> Self {
        let probes = &stresses.probes;
        let (mut terms, mut starts) = (Vec::new(), vec![0]);
        for (probe, wall) in probes.iter().zip(openings.walls) {
            for times in PLACES {
                let x = std::array::from_fn(|a| wall.foot[a] + 2.0 * times * probe.half * wall.normal[a]);
                for c in 0..D {
                    terms.extend(corners(openings, Some(c), x, probe.cell, |o| openings.alive(c, o)));
                    starts.push(terms.len());
                }
            }
        }
        Self { terms, starts, resolved: vec![0.0; probes.len()] }
    }

    /// Do cells resolve any?
    pub(super) fn any(&self) -> bool {
        self.resolved.iter().any(|share| *share > 0.0)
    }

    /// Looks at the flow, but not where y+ alone decides.
    pub(super) fn update<const D: usize>(
        &mut self,
        velocity: &[Field<D>; D],
        stresses: &Stresses<D>,
        nu: f64,
    ) {
        for piece in 0..self.resolved.len() {
            let y_plus = stresses.y_plus(piece, nu);
            let (sublayer, most) = (spared(y_plus), spared(y_plus / HEARD));
            self.resolved[piece] = match sublayer < most {
                true => sublayer.max(most * share(self.speeds(piece, velocity, &stresses.probes[piece]))),
                false => sublayer,
            };
        }
    }

    /// Along the wall, against it, at the three places \[m/s\].
    fn speeds<const D: usize>(&self, piece: usize, velocity: &[Field<D>; D], probe: &Probe) -> [f64; 3] {
        std::array::from_fn(|place| {
            let mut u = -probe.velocity;
            for (c, velocity) in velocity.iter().enumerate() {
                let start = (PLACES.len() * piece + place) * D + c;
                let terms = &self.terms[self.starts[start]..self.starts[start + 1]];
                u[c] += terms.iter().map(|&(o, w)| w * velocity.data()[o]).sum::<f64>();
            }
            (u - probe.normal * probe.normal.dot(&u)).norm()
        })
    }
}

/// How well cells resolve a layer with these speeds along the wall at the three places \[m/s\].
fn share([near, middle, far]: [f64; 3]) -> f64 {
    let share = (far - middle) / (THIN * (middle - near));
    // Nor of fluid at rest.
    if middle > near && share >= LEAST { share.min(1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::{PLACES, share};

    #[test]
    fn layers_that_rise_beyond_the_second_cell_are_resolved() {
        assert_eq!(share([1.0, 2.0, 3.0]), 1.0);
        assert_eq!(share(PLACES.map(f64::ln)), 1.0);
        // (y/1.7)^(1/7) up to the stream's 1: 0.927, 1, 1.
        assert_eq!(share([0.927, 1.0, 1.0]), 0.0);
        assert!((share([0.0, 1.0, 1.15]) - 0.5).abs() < 1e-12);
        // Beyond the layer a stream that slows down; at rest; nothing that is a number.
        for speeds in [[0.9, 1.0, 0.98], [1.0, 0.9, 1.0], [0.0; 3], [f64::NAN; 3]] {
            assert_eq!(share(speeds), 0.0, "{speeds:?}");
        }
    }
}
