//! Random poses of pairs, and what is measured of an overlap.
use crate::draw::Draw;
use crate::kinds::{Body, draw};
use crate::reference;
use dem::{Overlap, OverlapSolver};
use interfaces::{Point, Pose, Vector};

/// Case number `case` of the kinds `i` and `j`.
pub(crate) fn pose(i: usize, j: usize, case: u64) -> (Body, Body, Pose, Pose) {
    let mut random = Draw((i as u64 * 1000 + j as u64) << 40 | case << 8 | 11);
    (0..8).for_each(|_| {
        random.next();
    });
    let (a, b) = (draw(i, &mut random), draw(j, &mut random));
    let reach = a.shape.bounding_radius() + b.shape.bounding_radius();
    let at_a = Pose { position: Point::from(random.direction()), orientation: random.turn() };
    let apart = random.direction() * (reach * 0.9 * random.next());
    let at_b = Pose { position: at_a.position + apart, orientation: random.turn() };
    (a, b, at_a, at_b)
}

/// An overlap beside its reference.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measured {
    /// Volume found, and that of the smaller body \[m³\].
    pub(crate) volume: f64,
    pub(crate) smaller: f64,
    /// Error of the volume as a share of the smaller body's.
    pub(crate) of_body: f64,
    /// V(x + dx) − V(x) − S·dx as a share of the smaller body's volume, S the mean of both ends.
    pub(crate) gradient: f64,
}

fn total(patches: &[Overlap]) -> (f64, Vector) {
    (patches.iter().map(|p| p.volume).sum(), patches.iter().map(|p| p.gradient).sum())
}

/// Measures the overlap of a pair. The first body moves by a share `step` of the cube root of the smaller volume.
pub(crate) fn measure(
    solver: &mut OverlapSolver,
    step: f64,
    (a, at_a): (&Body, &Pose),
    (b, at_b): (&Body, &Pose),
) -> Measured {
    let (p, q) = (&*a.shape, &*b.shape);
    let (volume, gradient) = total(solver.solve(p, at_a, q, at_b).expect("an overlap"));
    let smaller = a.volume().min(b.volume());
    let expected = reference::volume(a, at_a, b, at_b);
    let step = Vector::new(0.6, -0.64, 0.48) * (step * smaller.cbrt());
    let moved = Pose { position: at_a.position + step, ..*at_a };
    let (after, gradient_after) = total(solver.solve(p, &moved, q, at_b).expect("an overlap"));
    let mean = 0.5 * (gradient + gradient_after);
    Measured {
        volume,
        smaller,
        of_body: (volume - expected).abs() / smaller,
        gradient: (after - volume - mean.dot(&step)).abs() / smaller,
    }
}
