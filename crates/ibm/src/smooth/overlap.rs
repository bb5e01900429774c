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
//! bounds the spectral radius (Collatz–Wielandt).
//!
//! Passes of several bodies one after the other are a product of contractions, which is one. But
//! where coincident sheets of two bodies of velocities v and v' are forced in turn, every pass
//! reverses the last: n passes give (2n − 1) m (v' − v) to the relative motion, m being the fluid at
//! the sheet, of which the bodies' linear systems foresee m. Light bodies diverge by that. Such
//! bodies are forced at once instead, relaxed by the ρ of all markers: the fluid takes the mean of
//! v and v' in the first pass, and n passes give ½ n m (v' − v). What passes after the first give is
//! [`Layer::shared`](crate::Layer).
use super::SmoothForcing;
use super::markers::Markers;
use crate::crowd::Crowd;
use crate::neighbour::Neighbour;
use interfaces::{Bodies, BodyId, LENGTH_PRECISION, Pose, VelocityField};

/// Least number of overlapping sheets that is relaxed. Single convex bodies have up to 1.3 (a cube
/// of four cells at its corners), two coincident sheets 2. Moved by a third down, cubes are relaxed
/// (`passes_do_not_overshoot_where_sheets_overlap`); up, blocks half a cell from their images
/// overshoot (same test).
const SHEETS: f64 = 1.5;

/// Least number of overlapping sheets of several bodies that are forced at once. Flat faces that
/// touch have 1.7; spheres of 12 cells a twentieth of a cell apart, whose films are tabulated as they
/// are in turn ([`SmoothFilm`](crate::SmoothFilm)), 1.54. Moved by a third down, these are forced at once
/// (`tabulated_films_are_those_of_bodies_in_turn`); up, no bodies are
/// (`sheets_of_several_bodies_are_forced_at_once`).
const JOINT_SHEETS: f64 = 1.6;

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
        let outwards = LENGTH_PRECISION * periods.fold(0.0, f64::max);
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
            markers.find_volumes(c, density, weights);
            scratch.resize(velocity.component(c).len(), 0.0);
            let lattice = velocity.lattice(c);
            markers.stencils.spread(c, lattice, weights, scratch);
            markers.stencils.read(c, lattice, scratch, found);
            markers.stencils.clear(c, lattice, scratch);
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

    /// Whether markers of body `b`, which is placed, may overlap with those of other bodies.
    pub(super) fn crowds(&self, b: usize) -> bool {
        crowds(&self.crowd, b, &self.bodies[b])
    }

    /// Finds the bodies whose sheets overlap with those of others, which are forced at once, and
    /// relaxes them by the overlaps of all.
    pub(super) fn find_joint_overlaps(&mut self, velocity: &dyn VelocityField) {
        let dim = velocity.dim();
        let Self { bodies: all, crowd, density, values: [found, weights, _], scratch, .. } = self;
        for markers in all.iter_mut().filter(|markers| !markers.joint.is_empty()) {
            markers.joint.clear();
            markers.stencils.reset_relaxation(dim);
            if !markers.overlaps.is_empty() {
                markers.stencils.relax_by(&markers.overlaps);
            }
        }
        for c in 0..dim {
            let lattice = velocity.lattice(c);
            scratch.resize(velocity.component(c).len(), 0.0);
            for (_, markers) in all.iter().enumerate().filter(|(b, markers)| crowds(crowd, *b, markers)) {
                markers.find_volumes(c, *density, weights);
                markers.stencils.spread(c, lattice, weights, scratch);
            }
            for (_, markers) in all.iter_mut().enumerate().filter(|(b, markers)| crowds(crowd, *b, markers)) {
                let Markers { stencils, changes: [most, ..], .. } = markers;
                stencils.read(c, lattice, scratch, found);
                if c == 0 {
                    most.clone_from(found);
                } else {
                    most.iter_mut().zip(&*found).for_each(|(most, found)| *most = most.max(*found));
                }
            }
            for (_, markers) in all.iter().enumerate().filter(|(b, markers)| crowds(crowd, *b, markers)) {
                markers.stencils.clear(c, lattice, scratch);
            }
        }
        for b in 0..all.len() {
            if crowds(crowd, b, &all[b]) && all[b].changes[0].iter().any(|overlap| *overlap >= JOINT_SHEETS) {
                for BodyId(b) in crowd.others(b).chain(std::iter::once(BodyId(b))) {
                    let joins = crowds(crowd, b, &all[b]) && all[b].joint.is_empty();
                    if joins {
                        let Markers { stencils, joint, changes: [most, ..], .. } = &mut all[b];
                        joint.extend(most.iter().map(|overlap| overlap.max(1.0)));
                        stencils.relax_by(joint);
                    }
                }
            }
        }
    }
}

/// Whether body `b` has a body within two cells: others' sheets are too far from its own to overlap
/// with them.
fn crowds(crowd: &Crowd, b: usize, markers: &Markers) -> bool {
    markers.share == 0.0 && crowd.others(b).next().is_some()
}

impl Markers {
    /// Volumes over c of the markers, in cells, relaxed as bounded sides need; zero where the surface
    /// is closed.
    fn find_volumes(&self, c: usize, density: f64, out: &mut Vec<f64>) {
        let per_cell = 1.0 / (density * self.cell);
        let closed = |m: usize| self.overlaps.get(m).is_some_and(|overlap| overlap.is_infinite());
        let relax = &self.stencils.relax[c];
        out.clear();
        out.extend(
            (0..self.masses.len()).map(
                |m| {
                    if closed(m) { 0.0 } else { self.masses[m] * relax[m] * per_cell }
                },
            ),
        );
    }
}
