//! Who gets the surface's area.
use crate::neighbour::inside;
use crate::reconstruction::{cell_edge, corners};
use crate::surface_elements;
use interfaces::{Aabb, Bodies, BodyId, Lattice, Nodes, Point, SurfaceElement};

/// Elements of the bodies' surfaces, found once per shape and size of the cells.
#[derive(Clone, Debug, Default)]
pub(super) struct Areas {
    bodies: Vec<Elements>,
}

#[derive(Clone, Debug, Default)]
struct Elements {
    /// The shape's box and the elements' spacing.
    of: Option<(Aabb, f64)>,
    list: Vec<SurfaceElement>,
}

/// An element that sees no row looks for one along its normal, up to so many quarters of a cell.
const STEPS: u32 = 8;

impl Areas {
    /// Takes note of how many bodies there are.
    pub(super) fn keep(&mut self, bodies: usize) {
        self.bodies.resize_with(bodies, Elements::default);
    }

    /// Shares out the surface of body `b`, so far as it is in the box and `wet`, calling
    /// `add` with the numbers of rows and their areas; `slots` are the cells' rows plus one, 0 where there is none. An element's
    /// area goes to the rows among the cells that multilinear interpolation at its centre would use, in proportion to
    /// the weights; if there are none, to those a little farther out.
    pub(super) fn share<B: Bodies + ?Sized>(
        &mut self,
        lattice: &Lattice,
        bodies: &B,
        b: BodyId,
        wet: impl Fn(Point) -> bool,
        mut add: impl FnMut(usize, f64),
        slots: &[u32],
    ) {
        let (solid, pose, bounds) = (bodies.solid(b), bodies.pose(b), bodies.aabb(b));
        let least = (0..lattice.dim)
            .map(|a| lattice.axes[a].spacings(bounds.min[a], bounds.max[a])[0])
            .fold(f64::INFINITY, f64::min);
        // Half a cell; where cells grow a power of two, so that it stays as a body moves.
        let uniform = lattice.axes[..lattice.dim].iter().all(Nodes::is_uniform);
        let spacing = if uniform { 0.5 * least } else { (0.5 * least).log2().floor().exp2() };
        let elements = &mut self.bodies[b.0];
        let of = Some((solid.aabb(), spacing));
        if elements.of != of {
            elements.list = surface_elements(solid, spacing, 0.0);
            elements.of = of;
        }
        for element in &elements.list {
            let x = pose.to_world(element.point);
            if !inside(lattice, x) || !wet(x) {
                continue;
            }
            let normal = pose.orientation * element.normal;
            let h = cell_edge(lattice, lattice.locate(x).0, normal);
            for step in 0..=STEPS {
                let (mut rows, mut sum) = ([(0, 0.0); 8], 0.0);
                let near = corners(lattice, x + normal * (0.25 * h * f64::from(step)));
                for (slot, (cell, weight)) in rows.iter_mut().zip(near) {
                    if let Some(row) = cell.and_then(|cell| slots[cell].checked_sub(1)) {
                        *slot = (row as usize, weight);
                        sum += weight;
                    }
                }
                if sum > 0.0 {
                    let shares = rows.iter().filter(|(_, weight)| *weight > 0.0);
                    shares.for_each(|&(row, weight)| add(row, element.area * weight / sum));
                    break;
                }
            }
        }
    }
}
