//! Where the bodies of a case are.
use super::cases::Case;
use siltflow::interfaces::{Point, Pose, Rotation, Vector};
use validation::Outcome;

/// A pair of poses.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    pub(crate) a: Pose,
    pub(crate) b: Pose,
}

impl Placed {
    pub(crate) fn common_turn(&self) -> Rotation {
        Rotation::from_scaled_axis(Vector::new(0.4, -0.7, 1.1))
    }
}

/// Random numbers between 0 and 1, always the same.
struct Draw(u64);

impl Draw {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
    fn direction(&mut self) -> Vector {
        loop {
            let v = Vector::from_fn(|_, _| 2.0 * self.next() - 1.0);
            if v.norm() < 1.0 && v.norm() > 0.1 {
                return v.normalize();
            }
        }
    }
    fn turn(&mut self) -> Rotation {
        Rotation::from_scaled_axis(self.direction() * 3.0 * self.next())
    }
}

/// Twelve random poses in which the two share the case's part of the smaller one: the second comes along a random line until they do.
pub(crate) fn poses(case: &mut Case) -> Outcome<Vec<Placed>> {
    let (a, b) = (&*case.a, &*case.b);
    let smaller = a.inertia(1.0).volume.min(b.inertia(1.0).volume);
    let reach = a.bounding_radius() + b.bounding_radius();
    let mut draw = Draw(7);
    let mut all = Vec::new();
    while all.len() < 12 {
        let (direction, turns) = (draw.direction(), [draw.turn(), draw.turn()]);
        let at = |distance: f64| Placed {
            a: Pose { position: Point::origin(), orientation: turns[0] },
            b: Pose { position: Point::from(direction * distance), orientation: turns[1] },
        };
        let (mut near, mut far) = (0.0, reach);
        for _ in 0..30 {
            let middle = 0.5 * (near + far);
            let placed = at(middle);
            let patches = case.posing.solve(a, &placed.a, b, &placed.b)?;
            let volume: f64 = patches.iter().map(|p| p.volume).sum();
            *(if volume > case.share * smaller { &mut near } else { &mut far }) = middle;
        }
        // Rings in rings never share so much.
        if near > 0.0 {
            all.push(at(near));
        }
    }
    Ok(all)
}
