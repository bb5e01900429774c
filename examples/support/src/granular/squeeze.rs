//! Bodies at random, denser than random addition gets them.
use super::grains::Grain;
use crate::Outcome;
use dem::placing::{PlacingError, RandomAddition, Region};
use dem::{HalfSpace, Material, RigidBodies, Shape};
use interfaces::{Aabb, Dynamics, Freedom, Kinematics, Periods, Point, Pose, Twist, Vector};

/// Solid fraction with which random addition begins, and by how much the box grows if that is too much.
const LOOSE: f64 = 0.32;
const HIGHER: f64 = 1.06;
/// Places that are tried for a body before the box grows.
const ATTEMPTS: usize = 2000;
/// By how much the lid comes down at a time.
const LOWERED: f64 = 0.985;
/// Two bodies count as apart when they share less than this part of the volume of a cube with the edge of the smallest size.
const SHARED: f64 = 2e-5;
/// Stable steps of one push, and pushes before the room counts as full.
const STEPS: f64 = 25.0;
const PUSHES: usize = 2000;

/// Poses in `room`, at random and apart, for grains that fill more of it than random addition can: they are added at random to a higher box, whose
/// lid then comes down. Each time it is a little lower all grains move in proportion, and those that then overlap push one another apart, without
/// weight and friction. Nothing moves in between, so the lid heaps up nothing before it. Walls are at the floor, the lid and, unless `periodic`, the sides.
///
/// # Errors
/// Those of placing and pushing; if grains cannot be pushed apart.
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
    while height > size.z {
        let lower = (LOWERED * height).max(size.z);
        for pose in &mut poses {
            pose.position.z = room.min.z + (pose.position.z - room.min.z) * lower / height;
        }
        height = lower;
        let lid = Aabb { max: Point::new(room.max.x, room.max.y, room.min.z + height), ..room };
        poses = apart(grains, &poses, lid, periodic)?;
    }
    Ok(poses)
}

/// The same bodies, pushed until they are apart.
fn apart(grains: &[Grain], poses: &[Pose], room: Aabb, periodic: [bool; 2]) -> Outcome<Vec<Pose>> {
    let smooth = Material { friction: 0.0, ..Material::default() };
    let size = room.extent();
    let period = |axis: usize| periodic[axis].then_some(size[axis]);
    let mut bodies = RigidBodies::new(Periods::new([period(0), period(1), None]));
    for axis in 0..3 {
        if axis == 2 || !periodic[axis] {
            let normal = Vector::ith(axis, 1.0);
            bodies.add_wall(HalfSpace::new(room.min, normal)?, smooth)?;
            bodies.add_wall(HalfSpace::new(room.max, -normal)?, smooth)?;
        }
    }
    for (grain, pose) in grains.iter().zip(poses) {
        bodies.add(grain.shape.clone(), smooth, *pose, Twist::default(), Freedom::FREE)?;
    }
    let smallest = grains.iter().map(|g| g.size).fold(f64::INFINITY, f64::min);
    for _ in 0..PUSHES {
        bodies.advance(STEPS * bodies.stable_dt())?;
        if bodies.contacts().all(|c| c.volume < SHARED * smallest.powi(3)) {
            return Ok(bodies.ids().map(|b| bodies.pose(b)).collect());
        }
    }
    let volume: f64 = grains.iter().map(|g| g.shape.inertia(1.0).volume).sum();
    let fraction = volume / (size.x * size.y * size.z);
    Err(format!("at a solid fraction of {fraction:.3} grains cannot be pushed apart any more: take fewer").into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::granular::Kind;
    use dem::OverlapSolver;

    /// Denser than addition gets; nowhere do two share more than what counts as nothing, and all are within the walls.
    #[test]
    fn polyhedra_fill_two_fifths() {
        let grains = Kind::Polyhedron.grains(&[1.0, 1.1, 0.9, 1.0, 1.05].repeat(6)).unwrap();
        let volume: f64 = grains.iter().map(|g| g.shape.inertia(1.0).volume).sum();
        let edge = (volume / 0.42).cbrt();
        let room = Aabb { min: Point::origin(), max: [edge; 3].into() };
        for periodic in [[false; 2], [true; 2]] {
            let poses = squeezed(&grains, room, periodic, 4).unwrap();
            let mut solver = OverlapSolver::new();
            for (i, (a, p)) in grains.iter().zip(&poses).enumerate() {
                let bounds = a.shape.aabb().posed(p);
                for axis in (0..3).filter(|&a| a == 2 || !periodic[a]) {
                    assert!(bounds.min[axis] > -0.02 && bounds.max[axis] < edge + 0.02, "{bounds:?}");
                }
                for (b, q) in grains[..i].iter().zip(&poses) {
                    let shared: f64 =
                        solver.solve(&*a.shape, p, &*b.shape, q).unwrap().iter().map(|o| o.volume).sum();
                    assert!(shared < 1e-4, "{shared}");
                }
            }
        }
        let small = Aabb { max: [(volume / 0.8).cbrt(); 3].into(), ..room };
        assert!(squeezed(&grains[..20], Aabb { max: [0.5; 3].into(), ..small }, [false; 2], 4).is_err());
    }
}
