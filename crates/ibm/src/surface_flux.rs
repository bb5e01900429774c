//! What the surfaces of bodies give off to a scalar.
use crate::reconstruction::corners;
use crate::surface_elements;
use interfaces::{Bodies, BodyId, Lattice, SurfaceElement};

/// A flux q of a scalar given on the surfaces of bodies, moving or not, as a source in the cells around:
///
/// ```text
/// S_P = (q/V_P) Σ_m A_m w_P(x_m),   Σ_P S_P V_P = q Σ_m A_m
/// ```
///
/// over [elements](surface_elements) of area A_m at x_m, w the weights of multilinear interpolation: what the scalar gains is what the surfaces give, to
/// rounding. Bodies have no other part in the scalar: inside them it is conducted as in the fluid and carried by what moves there, so they store heat and pass it on
/// as bodies of the fluid's own capacity and conductivity do.
#[derive(Clone, Debug, Default)]
pub struct SurfaceFlux {
    /// Of each body, in its own frame.
    elements: Vec<Vec<SurfaceElement>>,
    /// Storage indices of cells and Σ A w/V \[1/m\].
    sources: Vec<(usize, f64)>,
    area: f64,
}

impl SurfaceFlux {
    /// Of no bodies yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes note of where the bodies are on `lattice`. A body keeps its number; others may be added after it.
    pub fn place(&mut self, lattice: &Lattice, bodies: &dyn Bodies) {
        let Self { elements, sources, area } = self;
        sources.clear();
        *area = 0.0;
        for b in (0..bodies.n_bodies()).map(BodyId) {
            let (solid, pose) = (bodies.solid(b), bodies.pose(b));
            if b.0 == elements.len() {
                let widths = lattice.widths(lattice.locate(pose.position).0);
                let cell = widths[..lattice.dim].iter().copied().fold(f64::INFINITY, f64::min);
                elements.push(surface_elements(solid, cell, 0.0));
            }
            for element in &elements[b.0] {
                let x = pose.position + pose.orientation * element.point.coords;
                let inside = || corners(lattice, x).filter_map(|(i, w)| Some((i?, w)));
                // Beside a side of the box some of the cells are not there.
                let all: f64 = inside().map(|(_, w)| w).sum();
                if all > 0.0 {
                    *area += element.area;
                    let per_area = element.area / all;
                    sources
                        .extend(inside().map(|(i, w)| (i, w * per_area / lattice.volume(lattice.node(i)))));
                }
            }
        }
    }

    /// Area of the surfaces in the box \[m²\]; length in a plane.
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Adds the source of the flux `q` \[unit m/s\] to `source` \[unit/s\], which has the storage of the lattice's fields.
    pub fn add(&self, q: f64, source: &mut [f64]) {
        self.sources.iter().for_each(|&(i, per_flux)| source[i] += q * per_flux);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::StaticBodies;
    use crate::testing::{Ball, Plain};
    use interfaces::{Nodes, Pose};

    /// All that is given arrives, wherever the body is, and where its surface is.
    #[test]
    fn all_of_a_flux_arrives_around_the_surface() {
        let n = 20;
        let axis = || Nodes::uniform(0.025, 0.05, n, true);
        let lattice = Lattice::new([axis(), axis()], 0, [1, n]);
        let disc = || Plain(Ball { dim: 2, radius: 0.2 });
        for x in [0.5, 0.513, 0.97] {
            let bodies = StaticBodies::new().with(disc(), Pose::at([x, 0.43, 0.0]));
            let (mut flux, mut source) = (SurfaceFlux::new(), vec![0.0; n * n]);
            flux.place(&lattice, &bodies);
            flux.add(3.0, &mut source);
            let given: f64 = source.iter().sum::<f64>() * 0.05 * 0.05;
            assert!((given / (3.0 * flux.area()) - 1.0).abs() < 1e-14, "{x}: {given}");
            assert!((flux.area() / (0.4 * std::f64::consts::PI) - 1.0).abs() < 1e-3, "{}", flux.area());
            for (i, s) in source.iter().enumerate().filter(|(_, s)| **s != 0.0) {
                let at = lattice.position(lattice.node(i));
                let across = (at[0] - x + 0.5).rem_euclid(1.0) - 0.5;
                let distance = (across.hypot(at[1] - 0.43) - 0.2).abs();
                assert!(*s > 0.0 && distance < 0.05 * 1.5, "{x}: {s} at {distance} from the surface");
            }
        }
    }
}
