//! Regions of any form that parallel rays across the contact enter once: creases, edges that are not convex, saddles.
//!
//! Rays stand on a plane along the contact, at the corners and in the middle of squares. On each of them, where the larger of both
//! distances is least, m = min_t max(d_A, d_B), and where it is zero on either side of that. Volume, centroid and the integrals of n
//! and x × n over both surfaces are sums over the squares, by a rule that is exact for quadratics where all five rays meet the
//! region, and over triangles up to the line m = 0 where some do. The sides of the region along the rays, which none of them meet,
//! come in along that line. Squares are divided, those with the largest errors first, until the volume is known; edges and rims
//! cost an error of the square of the rays' distance there.
mod ray;
mod square;

use super::around::Oriented;
use super::columns::Sums;
use super::deepest::{Deepest, Search};
use crate::Overlap;
use interfaces::{Point, Vector};
use nalgebra::Matrix3;
use ray::{Caster, Ray};
use square::{Integrals, Square};

/// Squares along either side at first.
const FIRST: u16 = 6;
/// How often a square may be halved.
const LEVELS: u16 = 5;
/// Steps of the finest lattice, on which middles lie, too.
const LATTICE: u16 = FIRST << (LEVELS + 1);
/// Rays at most.
const MOST: usize = 2000;
/// With half of them it must be so near to its goal, in tolerances: sides along the rays, which stay far from it, are left to boxes.
const NEAR: f64 = 4.0;
/// How often the plane may be widened.
const ROUNDS: usize = 6;
/// No ray.
const NONE: u32 = u32::MAX;
/// What is left, as a share of what the last divisions changed: where all rays meet the region, and where it ends.
const LEFT: [f64; 2] = [0.12, 0.6];
/// The part of a square's bend that its rule may miss, whatever the divisions around it changed.
const UNSEEN: [f64; 2] = [0.01, 0.06];
/// By how much the surfaces of both bodies may fail to close, as a share of the larger one, and the volumes that the sides enclose,
/// at most.
const OPEN: [f64; 2] = [0.05, 0.1];

/// What was found of a region.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bundle {
    /// A box around it.
    pub(crate) root: Oriented,
    /// Of the frame along the box's axes in which the sums are.
    pub(crate) centre: Vector,
    sums: Sums,
}

impl Bundle {
    /// How far a place is from its box, no more than that; negative within.
    pub(crate) fn outside(&self, x: Vector) -> f64 {
        (self.root.local(x).abs() - self.root.half).max()
    }
    /// As a frame sees it in which this one's axes are the columns of `axes`.
    pub(crate) fn turn(&mut self, axes: &Matrix3<f64>) {
        self.centre = axes * self.centre;
        self.root.turn(axes);
    }
    /// As the world sees it, whose place `origin` is that of the search's frame.
    pub(crate) fn overlap(&self, origin: Point, between: Vector) -> Overlap {
        Oriented { centre: self.centre, ..self.root }.overlap(&self.sums, origin, between)
    }
}

/// Casts rays and keeps the memory of it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rays {
    /// By place on the lattice.
    number: Vec<u32>,
    rays: Vec<Ray>,
    squares: Vec<Square>,
    /// Numbers of those that are not divided.
    open: Vec<u32>,
    /// Of those that are divided next.
    due: Vec<u32>,
    /// By ray, another one that meets the same.
    group: Vec<u32>,
}

/// Why there is no answer.
enum Failure {
    /// The region comes to these ends of the plane: lower and upper along u and v.
    Small([[bool; 2]; 2]),
    /// Rays do not see it as one.
    Other,
}

impl Rays {
    /// The region around a deepest place to a relative error of its volume of about `tolerance`, if rays across the contact enter it
    /// once and nothing else.
    pub(crate) fn measure(
        &mut self,
        search: &Search<'_>,
        deepest: &Deepest,
        tolerance: f64,
    ) -> Option<Bundle> {
        let around = search.around(deepest);
        let axes = around.axes;
        let frame = Oriented { centre: deepest.at, axes, half: Vector::zeros() };
        let whole = Oriented { centre: Vector::zeros(), axes: Matrix3::identity(), half: 1.01 * search.half };
        let limit = frame.reach(&whole);
        let [low, high] = frame.reach(&Oriented { half: 1.1 * around.half, ..around });
        let (mut low, mut high) = (low.sup(&limit[0]), high.inf(&limit[1]));
        for _ in 0..ROUNDS {
            (low.z, high.z) = (limit[0].z, limit[1].z);
            let caster = Caster::new(search, deepest, &axes, [low, high], tolerance);
            let result = self.sum(&caster, tolerance);
            self.forget();
            match result {
                Ok((sums, [least, largest])) => {
                    let centre = deepest.at + axes * (0.5 * (least + largest));
                    let root = Oriented { centre, axes, half: 0.5 * (largest - least) };
                    return Some(Bundle { root, centre: deepest.at, sums });
                }
                Err(Failure::Small(touched)) => {
                    let size = high - low;
                    for a in 0..2 {
                        if touched[a][0] {
                            low[a] = (low[a] - 0.4 * size[a]).max(limit[0][a]);
                        }
                        if touched[a][1] {
                            high[a] = (high[a] + 0.4 * size[a]).min(limit[1][a]);
                        }
                    }
                    if high - low == size {
                        return None;
                    }
                }
                Err(Failure::Other) => return None,
            }
        }
        None
    }

    fn forget(&mut self) {
        for ray in &self.rays {
            self.number[ray.key()] = NONE;
        }
        self.rays.clear();
        self.squares.clear();
        self.open.clear();
    }

    /// Integrals, and the lower and upper corner of the region.
    fn sum(&mut self, caster: &Caster<'_>, tolerance: f64) -> Result<(Sums, [Vector; 2]), Failure> {
        let width = usize::from(LATTICE) + 1;
        self.number.resize(width * width, NONE);
        let step = 1 << (LEVELS + 1);
        for j in 0..=FIRST {
            for i in 0..=FIRST {
                self.cast(caster, [i * step, j * step], &[])?;
            }
        }
        self.is_within()?;
        for j in 0..FIRST {
            for i in 0..FIRST {
                self.open(caster, [i * step, j * step], 0)?;
            }
        }
        self.is_one(caster)?;
        let mut total = Integrals::default();
        for square in &mut self.squares {
            // Nothing is known of what divisions would change.
            square.error = 0.3 * square.bend;
            total.add_share(&square.integrals, 1.0);
        }
        loop {
            let (mut left, mut most, mut doubtful) = (0.0, 0.0_f64, false);
            for square in self.open.iter().map(|n| &self.squares[*n as usize]) {
                left += square.error;
                doubtful |= square.is_doubtful;
                if square.level < LEVELS {
                    most = most.max(square.error);
                }
            }
            let is_near = |tolerance: f64| {
                left <= tolerance * total.sums.volume
                    && total.is_closed(OPEN[0].min(10.0 * tolerance), OPEN[1].min(20.0 * tolerance))
            };
            if !doubtful && is_near(tolerance) {
                break;
            }
            let n = self.rays.len();
            if n > MOST || (n > MOST / 2 && !is_near(NEAR * tolerance)) {
                return Err(Failure::Other);
            }
            self.due.clear();
            let (squares, due) = (&self.squares, &mut self.due);
            self.open.retain(|n| {
                let square = &squares[*n as usize];
                let is_due = square.is_doubtful || (square.level < LEVELS && square.error > 0.4 * most);
                if is_due {
                    due.push(*n);
                }
                !is_due
            });
            if self.due.is_empty() {
                return Err(Failure::Other);
            }
            for i in 0..self.due.len() {
                self.divide(caster, self.due[i], &mut total)?;
            }
        }
        self.is_within()?;
        self.is_one(caster)?;
        Ok((total.sums, self.bounds(caster)))
    }

    /// Does no ray on the plane's ends meet the region?
    fn is_within(&self) -> Result<(), Failure> {
        let mut touched = [[false; 2]; 2];
        for ray in self.rays.iter().filter(|r| r.meets()) {
            for (a, touched) in touched.iter_mut().enumerate() {
                touched[0] |= ray.at[a] == 0;
                touched[1] |= ray.at[a] == LATTICE;
            }
        }
        if touched.as_flattened().contains(&true) { Err(Failure::Small(touched)) } else { Ok(()) }
    }

    /// Number of the ray at a place of the lattice, near some whose numbers are given.
    fn cast(&mut self, caster: &Caster<'_>, at: [u16; 2], near: &[u32]) -> Result<u32, Failure> {
        let key = Ray::key_of(at);
        if self.number[key] != NONE {
            return Ok(self.number[key]);
        }
        let ray = if near.is_empty() {
            caster.trace(at)
        } else {
            caster.cast(at, near.iter().map(|n| &self.rays[*n as usize]))
        };
        self.rays.push(ray.ok_or(Failure::Other)?);
        self.number[key] = self.rays.len() as u32 - 1;
        Ok(self.number[key])
    }

    /// A new square whose corners have rays.
    fn open(&mut self, caster: &Caster<'_>, at: [u16; 2], level: u16) -> Result<u32, Failure> {
        let size = 1 << (LEVELS + 1 - level);
        let corners = [[0, 0], [size, 0], [size, size], [0, size]]
            .map(|d: [u16; 2]| self.number[Ray::key_of([at[0] + d[0], at[1] + d[1]])]);
        let middle = [at[0] + size / 2, at[1] + size / 2];
        let near: &[u32] = if level == 0 { &[] } else { &corners };
        let middle = self.cast(caster, middle, near)?;
        let rays = [corners[0], corners[1], corners[2], corners[3], middle];
        let square = Square::new(caster, at, level, rays, |n| &self.rays[n as usize]);
        self.squares.push(square);
        let number = self.squares.len() as u32 - 1;
        self.open.push(number);
        Ok(number)
    }

    fn divide(&mut self, caster: &Caster<'_>, n: u32, total: &mut Integrals) -> Result<(), Failure> {
        let parent = self.squares[n as usize];
        let [p, q, r, s, _] = parent.rays;
        let half = 1 << (LEVELS - parent.level);
        let [i, j] = parent.at;
        for (at, near) in [
            ([i + half, j], [p, q]),
            ([i + 2 * half, j + half], [q, r]),
            ([i + half, j + 2 * half], [r, s]),
            ([i, j + half], [s, p]),
        ] {
            self.cast(caster, at, &near)?;
        }
        let mut sum = Integrals::default();
        let mut bend = 0.0;
        let mut children = [0; 4];
        for (child, [di, dj]) in children.iter_mut().zip([[0, 0], [half, 0], [half, half], [0, half]]) {
            *child = self.open(caster, [i + di, j + dj], parent.level + 1)?;
            let square = &self.squares[*child as usize];
            sum.add_share(&square.integrals, 1.0);
            bend += square.bend;
        }
        let changed = (sum.sums.volume - parent.integrals.sums.volume).abs();
        total.add_share(&parent.integrals, -1.0);
        total.add_share(&sum, 1.0);
        for child in children {
            let square = &mut self.squares[child as usize];
            let share = if bend > 0.0 { square.bend / bend } else { 0.25 };
            let kind = usize::from(square.is_rim);
            square.error = (LEFT[kind] * changed * share).max(UNSEEN[kind] * square.bend);
        }
        Ok(())
    }

    /// Do the rays meet one thing? Those of a square do where their spans are no farther apart than they are.
    fn is_one(&mut self, caster: &Caster<'_>) -> Result<(), Failure> {
        self.group.clear();
        self.group.extend(0..self.rays.len() as u32);
        for n in 0..self.open.len() {
            let square = self.squares[self.open[n] as usize];
            let [low, high] = caster.corners(square.at, square.level);
            let way = (high[0] - low[0]).hypot(high[1] - low[1]);
            for (i, p) in square.rays.into_iter().enumerate() {
                for q in square.rays.into_iter().skip(i + 1) {
                    let [a, b] = [p, q].map(|r| &self.rays[r as usize]);
                    let apart = (a.span[0] - b.span[1]).max(b.span[0] - a.span[1]);
                    if a.meets() && b.meets() && apart <= way {
                        let [p, q] = [p, q].map(|r| self.leader(r));
                        self.group[p.max(q) as usize] = p.min(q);
                    }
                }
            }
        }
        let mut of_all =
            (0..self.rays.len()).filter(|r| self.rays[*r].meets()).map(|r| self.leader(r as u32));
        let first = of_all.next().ok_or(Failure::Other)?;
        if of_all.all(|leader| leader == first) { Ok(()) } else { Err(Failure::Other) }
    }

    /// The ray that stands for all that meet what this one does.
    fn leader(&self, mut ray: u32) -> u32 {
        while self.group[ray as usize] != ray {
            ray = self.group[ray as usize];
        }
        ray
    }

    fn bounds(&self, caster: &Caster<'_>) -> [Vector; 2] {
        let (mut low, mut high) = (Vector::repeat(f64::INFINITY), Vector::repeat(f64::NEG_INFINITY));
        for n in &self.open {
            let square = &self.squares[*n as usize];
            for ray in square.rays.map(|r| self.rays[r as usize]).iter().filter(|r| r.meets()) {
                let [least, most] = caster.corners(square.at, square.level);
                let ends = ray.span;
                low = low.inf(&Vector::new(least[0], least[1], ends[0]));
                high = high.sup(&Vector::new(most[0], most[1], ends[1]));
            }
        }
        [low, high]
    }
}
