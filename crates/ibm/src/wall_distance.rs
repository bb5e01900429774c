//! How far the nearest wall is.
mod slab;

use crate::IbmError;
use crate::neighbour::ends;
use crate::solid_fraction::check;
use interfaces::{Aabb, Bodies, BodyId, Lattice, Pose, Vector};
use rayon::prelude::*;
use slab::{Image, Scene, Slab};

/// Lattices of fewer cells are not handed to threads.
const WORTH_THREADS: usize = 4096;

/// The distance of every cell's centre from the nearest surface of any body and, if told, from sides of the box that are walls:
/// what turbulence models ask for ([`interfaces::Transport::wall_distance`]).
///
/// It is as exact as the bodies' signed distances, which are asked for with as large a band as they take (a shape has to keep
/// [`interfaces::Solid`]'s promise for any band), at any distance and over periodic sides. Cells whose centre is inside a body
/// have the distance 0, and no others but those with the centre on a wall: who divides by it has to leave them out. Bodies beyond
/// a bounded side count as well. Without bodies and walls the distance is infinite.
///
/// The box is halved again and again down to blocks of 64 cells. On the way bodies are dropped that are farther from a part's
/// centre than the nearest one by more than the part is wide, so that of many bodies a cell asks one or two. When bodies
/// move, only blocks are worked on to which one of them was or becomes the nearest; when none moves, nothing is.
#[derive(Clone, Debug, Default)]
pub struct WallDistance {
    walls: [[bool; 2]; 3],
    lattice: Option<Lattice>,
    bodies: Vec<(Pose, Aabb)>,
    values: Vec<f64>,
    /// What is nearest to every cell: a body's number or `SIDE`.
    nearest: Vec<u32>,
    slabs: Vec<Slab>,
    images: Vec<Image>,
    moved: Vec<bool>,
    updates: u64,
}

impl WallDistance {
    /// From bodies only.
    pub fn new() -> Self {
        Self::default()
    }
    /// From sides of the box, too: `walls[a]` says whether the lower and the upper side across axis a are walls.
    #[must_use]
    pub fn with_walls(mut self, walls: [[bool; 2]; 3]) -> Self {
        self.walls = walls;
        self.lattice = None;
        self
    }

    /// Brings the distances of the nodes of `lattice`, those of cell centres, up to date with the bodies' poses.
    ///
    /// # Errors
    /// [`IbmError::NoSide`] for walls across a periodic axis, [`IbmError::Lost`] and [`IbmError::TooLarge`] for bodies that stand
    /// nowhere or are longer than a period. The distances are then those of the last update.
    pub fn update<B: Bodies + ?Sized>(&mut self, lattice: &Lattice, bodies: &B) -> Result<(), IbmError> {
        let bounded = |a: usize| a < lattice.dim && !lattice.axes[a].is_periodic();
        if let Some(axis) = (0..3).find(|&a| self.walls[a].contains(&true) && !bounded(a)) {
            return Err(IbmError::NoSide { axis });
        }
        let n = bodies.n_bodies();
        let place = |b: usize| (bodies.pose(BodyId(b)), bodies.solid(BodyId(b)).aabb());
        let fresh = self.lattice.as_ref() != Some(lattice);
        self.moved.clear();
        self.moved
            .extend((0..n.max(self.bodies.len())).map(|b| b >= n || self.bodies.get(b) != Some(&place(b))));
        if !fresh && !self.moved.contains(&true) {
            return Ok(());
        }
        for b in (0..n).map(BodyId) {
            check(lattice, bodies, b)?;
        }
        self.bodies.clear();
        self.bodies.extend((0..n).map(place));
        if fresh {
            self.lattice = Some(lattice.clone());
            self.values.clear();
            self.values.resize(lattice.shape().iter().product(), f64::INFINITY);
            self.nearest.clear();
            self.nearest.resize(self.values.len(), slab::SIDE);
        }
        self.images.clear();
        for b in (0..n).map(BodyId) {
            images(lattice, bodies, b, &mut self.images);
        }
        let (layers, layer) = slab::layers(lattice);
        let size = (layers * layer).max(1);
        self.slabs.resize_with(self.values.len().div_ceil(size), Slab::default);
        let scene = Scene {
            lattice,
            bodies,
            images: &self.images,
            moved: if fresh { None } else { Some(&self.moved) },
            sides: std::array::from_fn(|a| {
                let [low, high] = ends(lattice, a);
                let side = |k: usize, at| self.walls[a][k].then_some(at);
                [side(0, low), side(1, high)]
            }),
        };
        let least = if self.values.len() < WORTH_THREADS { usize::MAX } else { 1 };
        let parts = self.values.par_chunks_mut(size).zip(self.nearest.par_chunks_mut(size));
        self.updates += parts
            .zip(&mut self.slabs)
            .enumerate()
            .with_min_len(least)
            .map(|(s, ((values, nearest), slab))| slab.update(&scene, s * layers, values, nearest))
            .sum::<u64>();
        Ok(())
    }

    /// The distance of every cell \[m\], x fastest.
    pub fn values(&self) -> &[f64] {
        &self.values
    }
    /// How many cells' distances were computed so far: with bodies at rest they count once.
    pub fn updates(&self) -> u64 {
        self.updates
    }
}

/// Body `b` as it repeats around the box: from its middle within the first period one period to both sides. Farther images are
/// nowhere the nearest, since no body is longer than a period.
fn images<B: Bodies + ?Sized>(lattice: &Lattice, bodies: &B, b: BodyId, out: &mut Vec<Image>) {
    let bounds = bodies.aabb(b);
    let period = |a: usize| if a < lattice.dim { lattice.axes[a].period() } else { None };
    let home = Vector::from_fn(|a, _| {
        period(a).map_or(0.0, |length| {
            let middle = 0.5 * (bounds.min[a] + bounds.max[a]);
            -length * ((middle - ends(lattice, a)[0]) / length).floor()
        })
    });
    let turns = |a: usize| if period(a).is_some() { -1..=1 } else { 0..=0 };
    for k in turns(2) {
        for j in turns(1) {
            for i in turns(0) {
                let turn = Vector::new(f64::from(i), f64::from(j), f64::from(k));
                let shift = home + Vector::from_fn(|a, _| period(a).unwrap_or(0.0) * turn[a]);
                let bounds = Aabb { min: bounds.min + shift, max: bounds.max + shift };
                out.push(Image { body: b, shift, bounds });
            }
        }
    }
}

#[cfg(test)]
mod tests;
