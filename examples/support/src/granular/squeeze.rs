//! Bodies at random, denser than random addition gets them.
use super::grains::Grain;
use crate::Outcome;
use dem::placing::{PlacingError, RandomAddition, Region};
use dem::{HalfSpace, Overlap, OverlapSolver, Shape};
use interfaces::{Aabb, Periods, Point, Pose, Rotation, Vector};

/// Solid fraction with which random addition begins, and by how much the box grows if that is too much.
const LOOSE: f64 = 0.32;
const HIGHER: f64 = 1.06;
/// Places that are tried for a body before the box grows.
const ATTEMPTS: usize = 2000;
/// By how much the lid comes down at a time.
const LOWERED: f64 = 0.975;
/// Rounds in which all pairs are moved apart before the room counts as full.
const ROUNDS: usize = 500;
/// By what part of the smallest size bodies are moved farther apart than they overlap.
const FARTHER: f64 = 1e-3;
/// Arm by which turns count, in radii of the sphere around a body: about its radius of gyration.
const ARM: f64 = 0.5;

/// Poses in `room`, at random and apart, for grains that fill more of it than random addition can: they are added at random to a higher box, whose
/// lid then comes down. Each time it is a little lower all grains move in proportion, and those that then overlap are moved and turned, pair by pair, such
/// that what they share becomes less (down the gradient of its volume), until no two overlap. Walls are at the floor, the lid and, unless `periodic`, the sides.
///
/// # Errors
/// Those of placing and of the overlaps; if grains cannot be moved apart.
pub fn squeezed(grains: &[Grain], room: Aabb, periodic: [bool; 2], seed: u64) -> Outcome<Vec<Pose>> {
    let shapes: Vec<&dyn Shape> = grains.iter().map(|g| &*g.shape as &dyn Shape).collect();
    let (volume, size) = (shapes.iter().map(|s| s.inertia(1.0).volume).sum::<f64>(), room.extent());
    let mut height = (volume / (LOOSE * size.x * size.y)).max(size.z);
    let mut poses = loop {
        let mut tall = room;
        tall.max.z = room.min.z + height;
        let region = Region::cuboid(tall, [periodic[0], periodic[1], false])?;
        match RandomAddition::new(region).tight().with_attempts(ATTEMPTS).place(&shapes, seed) {
            Err(PlacingError::Jammed(jammed)) if !jammed.placed.is_empty() => height *= HIGHER,
            placed => break placed?,
        }
    };
    let mut crowd = Crowd::new(grains, room, periodic)?;
    while height > size.z {
        let lower = (LOWERED * height).max(size.z);
        for pose in &mut poses {
            pose.position.z = room.min.z + (pose.position.z - room.min.z) * lower / height;
        }
        height = lower;
        crowd.room.max.z = room.min.z + height;
        crowd.part(&mut poses)?;
    }
    Ok(poses)
}

/// Grains in a room.
struct Crowd<'a> {
    grains: &'a [Grain],
    radii: Vec<f64>,
    room: Aabb,
    periodic: [bool; 2],
    periods: Periods,
    farther: f64,
    solver: OverlapSolver,
}

impl<'a> Crowd<'a> {
    fn new(grains: &'a [Grain], room: Aabb, periodic: [bool; 2]) -> Outcome<Self> {
        let period = |axis: usize| periodic[axis].then_some(room.extent()[axis]);
        let smallest = grains.iter().map(|g| g.size).fold(f64::INFINITY, f64::min);
        Ok(Self {
            grains,
            radii: grains.iter().map(|g| g.shape.bounding_radius()).collect(),
            room,
            periodic,
            periods: Periods::new([period(0), period(1), None]),
            farther: FARTHER * smallest,
            solver: OverlapSolver::new(),
        })
    }

    /// Moves grains until none overlaps another or a wall.
    fn part(&mut self, poses: &mut [Pose]) -> Outcome<()> {
        for _ in 0..ROUNDS {
            let mut moved = false;
            for a in 0..poses.len() {
                for b in 0..a {
                    moved |= self.part_two(poses, a, b)?;
                }
                moved |= self.keep_in(poses, a)?;
            }
            if !moved {
                return Ok(());
            }
        }
        let volume: f64 = self.grains.iter().map(|g| g.shape.inertia(1.0).volume).sum();
        let size = self.room.extent();
        let fraction = volume / (size.x * size.y * size.z);
        Err(format!("at a solid fraction of {fraction:.3} grains cannot be moved apart any more: take fewer")
            .into())
    }

    /// Moves two grains apart if they overlap; did they?
    fn part_two(&mut self, poses: &mut [Pose], a: usize, b: usize) -> Outcome<bool> {
        let away = self.periods.nearest(poses[a].position - poses[b].position);
        if away.norm() >= self.radii[a] + self.radii[b] {
            return Ok(false);
        }
        // The image of the first that is next to the second.
        let image = Pose { position: poses[b].position + away, ..poses[a] };
        let patches = self.solver.solve(&*self.grains[a].shape, &image, &*self.grains[b].shape, &poses[b])?;
        let second = poses[b].position;
        for patch in patches {
            let mut slopes = [slope(patch, image.position), slope(patch, second)];
            slopes[1] = slopes[1].map(|s| -s);
            let arms = [a, b].map(|i| ARM * self.radii[i]);
            let step = step(patch, &slopes, &arms, self.farther);
            for ((i, slope), arm) in [a, b].into_iter().zip(slopes).zip(arms) {
                shift(&mut poses[i], slope, arm, step);
            }
        }
        Ok(!patches.is_empty())
    }

    /// Moves a grain out of the walls if it is in one; was it?
    fn keep_in(&mut self, poses: &mut [Pose], a: usize) -> Outcome<bool> {
        let (mut moved, arm) = (false, ARM * self.radii[a]);
        for axis in 0..3 {
            for (corner, side) in [(self.room.min, 1.0), (self.room.max, -1.0)] {
                let within = side * (poses[a].position - corner)[axis];
                if within >= self.radii[a] || (axis < 2 && self.periodic[axis]) {
                    continue;
                }
                let wall = HalfSpace::new(corner, Vector::ith(axis, side))?;
                let here = poses[a];
                let patches = self.solver.solve(&*self.grains[a].shape, &here, &wall, &Pose::at([0.0; 3]))?;
                for patch in patches {
                    let slope = slope(patch, here.position);
                    shift(&mut poses[a], slope, arm, step(patch, &[slope], &[arm], self.farther));
                }
                moved |= !patches.is_empty();
            }
        }
        Ok(moved)
    }
}

/// How the volume of a patch changes with the place and, about `centre`, with the turn of its first body.
fn slope(patch: &Overlap, centre: Point) -> [Vector; 2] {
    [patch.gradient, (patch.centroid - centre).cross(&patch.gradient) + patch.moment]
}

/// How far down these slopes a patch is gone, if its volume grows with the square of its depth as a cap's does, and a little `farther`; turns count
/// by the arms.
fn step(patch: &Overlap, slopes: &[[Vector; 2]], arms: &[f64], farther: f64) -> f64 {
    let of = |([x, turn], arm): (&[Vector; 2], &f64)| x.norm_squared() + turn.norm_squared() / (arm * arm);
    let steepness: f64 = slopes.iter().zip(arms).map(of).sum();
    if steepness > 0.0 { (2.0 * patch.volume + farther * patch.area()) / steepness } else { 0.0 }
}

/// Moves and turns a body down its slope.
fn shift(pose: &mut Pose, [x, turn]: [Vector; 2], arm: f64, step: f64) {
    pose.position -= step * x;
    pose.orientation = Rotation::from_scaled_axis(-step / (arm * arm) * turn) * pose.orientation;
    pose.orientation.renormalize();
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::granular::Kind;

    /// Denser than addition gets; no two overlap, and none a wall.
    #[test]
    fn polyhedra_fill_two_fifths() {
        let grains = Kind::Polyhedron.grains(&[1.0, 1.1, 0.9, 1.0, 1.05].repeat(6)).unwrap();
        let volume: f64 = grains.iter().map(|g| g.shape.inertia(1.0).volume).sum();
        let edge = (volume / 0.42).cbrt();
        let room = Aabb { min: Point::origin(), max: [edge; 3].into() };
        for periodic in [[false; 2], [true; 2]] {
            let poses = squeezed(&grains, room, periodic, 4).unwrap();
            let (crowd, mut solver) = (Crowd::new(&grains, room, periodic).unwrap(), OverlapSolver::new());
            for (i, (a, p)) in grains.iter().zip(&poses).enumerate() {
                for axis in (0..3).filter(|&a| a == 2 || !periodic[a]) {
                    for (corner, side) in [(room.min, 1.0), (room.max, -1.0)] {
                        let wall = HalfSpace::new(corner, Vector::ith(axis, side)).unwrap();
                        let shared = solver.solve(&*a.shape, p, &wall, &Pose::at([0.0; 3])).unwrap();
                        assert!(shared.is_empty(), "{shared:?}");
                    }
                }
                for (b, q) in grains[..i].iter().zip(&poses) {
                    let away = crowd.periods.nearest(q.position - p.position);
                    let image = Pose { position: p.position + away, ..*q };
                    let shared = solver.solve(&*a.shape, p, &*b.shape, &image).unwrap();
                    assert!(shared.is_empty(), "{shared:?}");
                }
            }
        }
        let small = Aabb { max: [(volume / 0.8).cbrt(); 3].into(), ..room };
        let error = squeezed(&grains, small, [false; 2], 4).unwrap_err().to_string();
        assert!(error.contains("moved apart"), "{error}");
    }
}
