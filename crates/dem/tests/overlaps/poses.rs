//! Random poses of pairs, and what is measured of an overlap.
use crate::draw::Draw;
use crate::kinds::{Body, draw};
use crate::reference;
use dem::{Overlap, OverlapSolver};
use interfaces::{Point, Pose, Vector};

/// Case number `case` of the kinds `i` and `j`; the second body's size is a share `ratio` of the first one's.
pub(crate) fn pose(i: usize, j: usize, ratio: f64, case: u64) -> (Body, Body, Pose, Pose) {
    let mut random = Draw((i as u64 * 1000 + j as u64) << 40 | case << 8 | 11);
    (0..8).for_each(|_| {
        random.next();
    });
    let (a, b) = (draw(i, 1.0, &mut random), draw(j, ratio, &mut random));
    let at_a = Pose { position: Point::from(random.direction()), orientation: random.turn() };
    let apart = if ratio < 1.0 {
        at_a.orientation * on_surface(&a, &mut random)
            + random.direction() * (b.shape.bounding_radius() * random.next())
    } else {
        let reach = a.shape.bounding_radius() + b.shape.bounding_radius();
        random.direction() * (reach * 0.9 * random.next())
    };
    let at_b = Pose { position: at_a.position + apart, orientation: random.turn() };
    (a, b, at_a, at_b)
}

/// A point on the surface of a body, in its frame.
fn on_surface(body: &Body, random: &mut Draw) -> Vector {
    let distance = |x: Vector| body.shape.signed_distance(x.into(), f64::INFINITY);
    let mut outside = random.direction() * (2.0 * body.shape.bounding_radius());
    let mut inside = random.direction() * (body.shape.bounding_radius() * random.next());
    while distance(inside) >= 0.0 {
        inside = random.direction() * (body.shape.bounding_radius() * random.next().powi(3));
    }
    for _ in 0..60 {
        let middle = 0.5 * (inside + outside);
        if distance(middle) < 0.0 { inside = middle } else { outside = middle }
    }
    inside
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
    let moved = at_a.position + Vector::new(0.6, -0.64, 0.48) * (step * smaller.cbrt());
    // As coordinates round it.
    let step = moved - at_a.position;
    let moved = Pose { position: moved, ..*at_a };
    let (after, gradient_after) = total(solver.solve(p, &moved, q, at_b).expect("an overlap"));
    let mean = 0.5 * (gradient + gradient_after);
    Measured {
        volume,
        smaller,
        of_body: (volume - expected).abs() / smaller,
        gradient: (after - volume - mean.dot(&step)).abs() / smaller,
    }
}
