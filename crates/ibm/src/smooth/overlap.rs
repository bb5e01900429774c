//! Relaxation of passes where sheets of markers of one body overlap.
//!
//! A pass changes the velocity by Eᵀ D (U − E u), D being the markers' volumes over c. With the
//! overlaps K = E Eᵀ, whose entries are not negative, ρ = K D 1 is the number of sheets around each
//! marker: 1 on a single smooth one; 2 where two surfaces of a body, or a surface and its own
//! periodic image, are close; more at edges of such gaps. Passes leave the share (1 − λ)ⁿ of a
//! mode, λ being the eigenvalues of D K. With λ above 1 a pass overshoots, an odd number of them
//! reverses the mode, and with the pressure of the next step the run diverges, earlier the shorter
//! the step.
//!
//! With D / max(1, ρ) for D no mode overshoots: (D/max(1, ρ)) K (D 1) = D ρ/max(1, ρ) ≤ D 1, so 1
//! bounds the spectral radius (Collatz–Wielandt). Other bodies need no part in it: they are forced
//! one after the other, and a product of contractions is one.
use super::SmoothForcing;
use crate::neighbour::Neighbour;
use interfaces::{Bodies, BodyId, Pose, VelocityField};

/// Least number of overlapping sheets that is relaxed. Single convex bodies have up to 1.3 (a cube
/// of four cells at its corners), two coincident sheets 2. Moved by a third down, cubes are relaxed
/// (`passes_do_not_overshoot_where_sheets_overlap`); up, blocks half a cell from their images
/// overshoot (same test).
const SHEETS: f64 = 1.5;

/// Precision of coordinates in parts of the period: files of shapes hold single-precision numbers.
const PRECISION: f64 = 4.0 * f32::EPSILON as f64;

impl SmoothForcing {
    /// Whether markers of body `b` reach others of its own over a periodic side, as it is turned or
    /// without a turn.
    pub(super) fn meets_itself(&self, velocity: &dyn VelocityField, bodies: &dyn Bodies, b: BodyId) -> bool {
        let (dim, bounds) = (velocity.dim(), bodies.aabb(b));
        let extent = bounds.extent().sup(&bodies.solid(b).aabb().extent());
        let reach = 2.0 * self.kernel(dim).reach();
        velocity.lattice(0).axes[..dim].iter().enumerate().any(|(a, nodes)| {
            let [_, widest] = nodes.spacings(bounds.min[a], bounds.max[a]);
            nodes.period().is_some_and(|period| period - extent[a] <= reach * widest)
        })
    }

    /// Finds the overlaps of the markers of body `b` at this pose, for which they are turned
    /// already, and at their full depth, where they overlap most. With `images` those on surfaces
    /// that its own periodic images cover are left out: the surface is closed there.
    pub(super) fn find_overlaps(
        &mut self,
        velocity: &dyn VelocityField,
        bodies: &dyn Bodies,
        (b, pose): (BodyId, Pose),
        images: bool,
    ) {
        let dim = velocity.dim();
        let (kernel, density) = (self.kernel(dim), self.density);
        let Self { bodies: all, neighbours, places, values: [found, weights, _], scratch, .. } = self;
        let markers = &mut all[b.0];
        let h = markers.cell.powf(1.0 / dim as f64);
        markers.stand(0.0, density * h / kernel.self_overlap(), dim);
        markers.set_stencils(kernel, velocity, &pose, places);
        markers.overlaps.clear();
        markers.overlaps.resize(markers.arms.len(), 1.0);
        let lattice = velocity.lattice(0);
        Neighbour::list(lattice, bodies, b, 1.0, std::iter::once(b).filter(|_| images), neighbours);
        let periods = lattice.axes[..dim].iter().filter_map(|nodes| nodes.period());
        let outwards = PRECISION * periods.fold(0.0, f64::max);
        for (m, overlap) in markers.overlaps.iter_mut().enumerate() {
            let x = pose.position + markers.surface[m] + outwards * markers.slip.normal(m);
            if neighbours
                .iter()
                .any(|image| image.may_hold(x, 0.0) && image.distance(bodies, x, outwards) < 0.0)
            {
                *overlap = f64::INFINITY;
            }
        }
        let mut most = 0.0_f64;
        let closed = markers.overlaps.iter().any(|overlap| *overlap > 1.0);
        for c in 0..dim {
            weights.clear();
            let volumes = markers.masses.iter().zip(&markers.stencils.relax[c]).zip(&markers.overlaps);
            weights.extend(volumes.map(|((mass, relax), overlap)| {
                if overlap.is_finite() { mass * relax / (density * markers.cell) } else { 0.0 }
            }));
            scratch.resize(velocity.component(c).len(), 0.0);
            markers.stencils.overlaps(c, velocity.lattice(c), weights, scratch, found);
            for (overlap, found) in
                markers.overlaps.iter_mut().zip(&*found).filter(|(overlap, _)| overlap.is_finite())
            {
                most = most.max(*found);
                *overlap = overlap.max(*found);
            }
        }
        if most < SHEETS && !closed {
            markers.overlaps.clear();
        }
    }
}
