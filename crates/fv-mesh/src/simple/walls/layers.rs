//! How well cells resolve layers on walls.
use super::gradients::corners;
use super::openings::Openings;
use super::stress::Stresses;
use crate::Field;
use crate::across_stream::{LEAST, spared};
use interfaces::Vector;

/// Places at which a layer is seen: so many times the cell's extent along the normal from the wall.
const PLACES: [f64; 3] = [1.0, 2.0, 3.0];
/// A layer whose velocity rises less than this from the second place to the third, over that from the first to the second, is thinner than what cells resolve.
/// A logarithmic one has ln 1.5/ln 2 = 0.58, a straight one 1.
const THIN: f64 = 0.3;

/// Layers that are several cells thick are resolved up to so many times the y+ up to which sublayers are: as far as gradients hear the wall's own velocity, of which a
/// logarithmic layer knows nothing. Sparing beyond that brings little, and layers in bends keep to walls (docs/results.md, "Where logarithmic layers begin").
const HEARD: f64 = 4.0;

/// How well cells resolve the layers on pieces of wall: those whose sublayer they resolve, and those that are several cells thick.
#[derive(Default)]
pub(super) struct Layers {
    /// The nodes around the places, and their weights.
    terms: Vec<(usize, f64)>,
    /// Per piece, place and component, where its terms end.
    ends: Vec<usize>,
    /// Per piece from 0, thinner than cells resolve, to 1.
    pub(super) resolved: Vec<f64>,
}

impl Layers {
    pub(super) fn new<const D: usize>(openings: &Openings<D>, stresses: &Stresses<D>) -> Self {
        let probes = &stresses.probes;
        let mut new = Self { resolved: vec![0.0; probes.len()], ..Self::default() };
        for (probe, wall) in probes.iter().zip(openings.walls) {
            for times in PLACES {
                let x = std::array::from_fn(|a| wall.foot[a] + 2.0 * times * probe.half * wall.normal[a]);
                for c in 0..D {
                    new.terms.extend(corners(openings, Some(c), x, probe.cell, |o| openings.alive(c, o)));
                    new.ends.push(new.terms.len());
                }
            }
        }
        new
    }

    /// Do cells resolve any?
    pub(super) fn any(&self) -> bool {
        self.resolved.iter().any(|share| *share > 0.0)
    }

    /// Looks at the flow.
    pub(super) fn update<const D: usize>(
        &mut self,
        velocity: &[Field<D>; D],
        stresses: &Stresses<D>,
        nu: f64,
    ) {
        let Self { terms, ends, resolved } = self;
        let (mut first, mut ends) = (0, ends.iter());
        for (piece, (resolved, probe)) in resolved.iter_mut().zip(&stresses.probes).enumerate() {
            let speeds = PLACES.map(|_| {
                let mut u = Vector::zeros();
                for (c, &last) in ends.by_ref().take(D).enumerate() {
                    let sum: f64 = terms[first..last].iter().map(|&(o, w)| w * velocity[c].data()[o]).sum();
                    (u[c], first) = (sum - probe.velocity[c], last);
                }
                (u - probe.normal * probe.normal.dot(&u)).norm()
            });
            let y_plus = stresses.y_plus(piece, nu);
            *resolved = f64::max(spared(y_plus), share(speeds) * spared(y_plus / HEARD));
        }
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
