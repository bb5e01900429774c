//! Where grains start.
use super::grains::Grain;
use crate::Outcome;
use clap::ValueEnum;
use dem::Shape;
use dem::placing::{CrystalLattice, LatticeKind, Orientations, PlacingError, RandomAddition, Region};
use interfaces::{Aabb, Pose};

/// How grains are arranged at first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Start {
    /// At random, without overlap.
    Random,
    /// On a cubic lattice, not quite in order.
    Lattice,
    /// On a close-packed lattice, as near as spheres around them allow.
    Dense,
}

/// Solid fraction of the first attempt at random, and by how much the box then grows.
const LOOSE: f64 = 0.30;
const HIGHER: f64 = 1.15;
/// Places that are tried for a body before the box grows.
const ATTEMPTS: usize = 3000;
/// Gap between the spheres around bodies on lattices, in radii.
const GAP: f64 = 0.04;

/// Poses of the grains above the floor of `room`, as high as it takes (the box's own height does not matter).
///
/// # Errors
/// If not even one fits.
pub fn starts(
    grains: &[Grain],
    room: Aabb,
    periodic: [bool; 2],
    start: Start,
    seed: u64,
) -> Outcome<Vec<Pose>> {
    let radius = grains.iter().map(|g| g.shape.bounding_radius()).fold(0.0, f64::max);
    let kind = match start {
        Start::Random => return random(grains, room, periodic, seed),
        Start::Lattice => LatticeKind::SimpleCubic,
        Start::Dense => LatticeKind::HexagonalClosePacked,
    };
    let lattice = CrystalLattice::new(kind, (2.0 + GAP) * radius)?;
    let play = lattice.play(2.0 * radius, 0.25 * GAP * radius)?;
    let mut room = room;
    room.max.z = room.min.z + 2.0 * (radius + play) + lattice.cell().z;
    loop {
        let mut points = lattice.in_box(&room, radius + play)?;
        if points.is_empty() {
            return Err(format!("no grain of radius {radius} m fits beside the walls: {room:?}").into());
        }
        if points.len() >= grains.len() {
            points.sort_by(|a, b| a.z.total_cmp(&b.z));
            points.truncate(grains.len());
            lattice.jitter(&mut points, play, seed)?;
            let turns = Orientations::Random.of(seed);
            return Ok(points
                .into_iter()
                .zip(turns)
                .map(|(position, orientation)| Pose { position, orientation })
                .collect());
        }
        let share = grains.len() as f64 / points.len() as f64;
        room.max.z += (lattice.cell().z).max((share - 1.0) * room.extent().z);
    }
}

fn random(grains: &[Grain], mut room: Aabb, [x, y]: [bool; 2], seed: u64) -> Outcome<Vec<Pose>> {
    let shapes: Vec<&dyn Shape> = grains.iter().map(|g| &*g.shape as &dyn Shape).collect();
    let volume: f64 = shapes.iter().map(|s| s.inertia(1.0).volume).sum();
    // The spheres around them are what keeps apart.
    let around: f64 = shapes.iter().map(|s| 4.19 * s.bounding_radius().powi(3)).sum();
    let largest = shapes.iter().map(|s| s.bounding_radius()).fold(0.0, f64::max);
    let area = room.extent().x * room.extent().y;
    let mut height = (volume.max(around) / (LOOSE * area)).max(2.5 * largest);
    loop {
        room.max.z = room.min.z + height;
        let region = Region::cuboid(room, [x, y, false])?;
        match RandomAddition::new(region).with_attempts(ATTEMPTS).place(&shapes, seed) {
            Err(PlacingError::Jammed(jammed)) if !jammed.placed.is_empty() => height *= HIGHER,
            other => return Ok(other?),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dem::Sphere;
    use std::sync::Arc;

    #[test]
    fn all_are_apart_and_inside() {
        let grain = Grain { shape: Arc::new(Sphere::new(0.5).unwrap()), size: 1.0, kind: "sphere" };
        let room = Aabb { min: [0.0, 0.0, 1.0].into(), max: [5.0, 4.0, 1.0].into() };
        for start in [Start::Random, Start::Lattice, Start::Dense] {
            let poses = starts(&vec![grain.clone(); 60], room, [false; 2], start, 3).unwrap();
            for (i, p) in poses.iter().enumerate() {
                let p = p.position;
                assert!((0.5..=4.5).contains(&p.x) && (0.5..=3.5).contains(&p.y) && p.z >= 1.5, "{p}");
                assert!(poses[..i].iter().all(|q| (q.position - p).norm() >= 1.0), "{start:?}");
            }
        }
        let narrow = Aabb { max: [0.9, 4.0, 1.0].into(), ..room };
        assert!(starts(&vec![grain.clone(); 60], narrow, [false; 2], Start::Lattice, 3).is_err());
        assert!(starts(&vec![grain; 60], narrow, [false; 2], Start::Random, 3).is_err());
    }
}
