//! Wall distances in a slab of the box.
use interfaces::{Aabb, Bodies, BodyId, Lattice, Point, Vector};
use std::ops::Range;

/// The number of the sides of the box among what may be nearest.
pub(super) const SIDE: u32 = u32::MAX;
/// Cells along the edges of a block that is not halved any more, in the plane and in space.
const BLOCK: [usize; 2] = [8, 4];
/// Blocks along the last axis of a slab.
const LAYERS: usize = 4;

/// A body as it repeats.
#[derive(Clone, Copy, Debug)]
pub(super) struct Image {
    pub(super) body: BodyId,
    /// From where it is to where it repeats.
    pub(super) shift: Vector,
    /// The box around it there.
    pub(super) bounds: Aabb,
}

/// What all slabs share.
pub(super) struct Scene<'a, B: ?Sized> {
    pub(super) lattice: &'a Lattice,
    pub(super) bodies: &'a B,
    pub(super) images: &'a [Image],
    /// Which bodies moved; `None` if everything is to be computed.
    pub(super) moved: Option<&'a [bool]>,
    /// Where the sides across each axis are that are walls.
    pub(super) sides: [[Option<f64>; 2]; 3],
}

impl<B: ?Sized> Scene<'_, B> {
    /// Distance from the sides that are walls.
    fn side(&self, x: Point) -> f64 {
        let gaps = (0..3).flat_map(|a| self.sides[a].iter().flatten().map(move |at| (x[a] - at).abs()));
        gaps.fold(f64::INFINITY, f64::min)
    }
}

/// Cells along the last axis that a slab has at most, and cells in one layer of them.
pub(super) fn layers(lattice: &Lattice) -> (usize, usize) {
    let [nx, ny, _] = lattice.shape();
    (LAYERS * BLOCK[lattice.dim - 2], if lattice.dim == 2 { nx } else { nx * ny })
}

/// The memory that a slab's computation takes.
#[derive(Clone, Debug, Default)]
pub(super) struct Slab {
    /// Images that may be the nearest somewhere, those of a part after those of the part it is in.
    candidates: Vec<Image>,
    /// Their distances from the part's centre.
    distances: Vec<f64>,
    /// Images of bodies that moved.
    movers: Vec<Image>,
    /// Blocks along each axis; which of them may have changed, and how far a wall is from their cells at most.
    shape: [usize; 3],
    changed: Vec<bool>,
    farthest: Vec<f64>,
    points: Vec<Point>,
    local: Vec<Point>,
    answers: Vec<f64>,
}

/// A slab at work.
struct Work<'a, B: ?Sized> {
    scene: &'a Scene<'a, B>,
    memory: &'a mut Slab,
    values: &'a mut [f64],
    nearest: &'a mut [u32],
    /// Its first cell along the last axis.
    first: usize,
    done: u64,
}

/// Cells of a part of the box, along each axis.
type Part = [Range<usize>; 3];

impl Slab {
    /// Computes the distances in the slab that begins with layer `first`; tells how many.
    pub(super) fn update<B: Bodies + ?Sized>(
        &mut self,
        scene: &Scene<'_, B>,
        first: usize,
        values: &mut [f64],
        nearest: &mut [u32],
    ) -> u64 {
        let (_, layer) = layers(scene.lattice);
        let mut part = scene.lattice.shape().map(|n| 0..n);
        part[scene.lattice.dim - 1] = first..first + values.len() / layer;
        self.candidates.clear();
        self.candidates.extend(scene.images);
        let mut work = Work { scene, memory: self, values, nearest, first, done: 0 };
        if work.note_changes(&part) {
            work.halve(part, 0);
        }
        work.done
    }
}

impl<B: Bodies + ?Sized> Work<'_, B> {
    /// The centres' box: its middle and half its diagonal.
    fn around(&self, part: &Part) -> (Aabb, Point, f64) {
        let place = |i: [usize; 3]| Point::from(self.scene.lattice.position(i.map(|i| i as isize)));
        let min = place([0, 1, 2].map(|a| part[a].start));
        let max = place([0, 1, 2].map(|a| part[a].end - 1));
        (Aabb { min, max }, nalgebra::center(&min, &max), 0.5 * (max - min).norm())
    }
    /// Where the cells of a part's row are in the slab.
    fn row(&self, part: &Part, j: usize, k: usize) -> Range<usize> {
        let [nx, ny, _] = self.scene.lattice.shape();
        let (j, k) = if self.scene.lattice.dim == 2 { (j - self.first, 0) } else { (j, k - self.first) };
        let start = nx * (j + ny * k);
        start + part[0].start..start + part[0].end
    }

    /// The blocks of a part, in the slab.
    fn blocks(&self, part: &Part) -> Part {
        let block = BLOCK[self.scene.lattice.dim - 2];
        let last = self.scene.lattice.dim - 1;
        std::array::from_fn(|a| {
            let first = if a == last { self.first } else { 0 };
            (part[a].start - first) / block..(part[a].end - first).div_ceil(block)
        })
    }

    /// Notes in which blocks of the slab the distances may have changed: those where a body that moved was the nearest or is
    /// now no farther than what is. False if there are none.
    fn note_changes(&mut self, slab: &Part) -> bool {
        let Some(moved) = self.scene.moved else { return true };
        let (dim, shape) = (self.scene.lattice.dim, self.blocks(slab).map(|r| r.len()));
        self.memory.shape = shape;
        let mut changed = std::mem::take(&mut self.memory.changed);
        let mut far = std::mem::take(&mut self.memory.farthest);
        changed.clear();
        changed.resize(shape.iter().product(), false);
        far.clear();
        far.resize(changed.len(), 0.0);
        let block = BLOCK[dim - 2];
        for (k, j) in slab[2].clone().flat_map(|k| slab[1].clone().map(move |j| (k, j))) {
            let row = self.row(slab, j, k);
            let [_, beside, above] = self.blocks(&[0..1, j..j + 1, k..k + 1]).map(|r| r.start);
            let blocks = shape[0] * (beside + shape[1] * above)..;
            let cells = self.nearest[row.clone()].chunks(block).zip(self.values[row].chunks(block));
            for (at, (owners, values)) in blocks.zip(cells) {
                changed[at] |= owners.iter().any(|&owner| owner != SIDE && moved[owner as usize]);
                far[at] = values.iter().fold(far[at], |far, d| far.max(*d));
            }
        }
        // Images of bodies that moved, first those near the slab.
        let (bounds, ..) = self.around(slab);
        let farthest = far.iter().fold(0.0, |far: f64, d| far.max(*d));
        let Slab { movers, .. } = &mut *self.memory;
        movers.clear();
        let images = self.scene.images.iter().filter(|i| moved[i.body.0]);
        movers.extend(images.filter(|i| apart(&bounds, &i.bounds, dim) <= farthest));
        if !self.memory.movers.is_empty() {
            for at in 0..changed.len() {
                let number = [at % shape[0], at / shape[0] % shape[1], at / (shape[0] * shape[1])];
                let part = std::array::from_fn(|a| {
                    let start = slab[a].start + number[a] * block;
                    start..(start + block).min(slab[a].end)
                });
                let (bounds, ..) = self.around(&part);
                let mut movers = self.memory.movers.iter();
                changed[at] = changed[at] || movers.any(|m| apart(&bounds, &m.bounds, dim) <= far[at]);
            }
        }
        let any = changed.contains(&true);
        (self.memory.changed, self.memory.farthest) = (changed, far);
        any
    }

    /// May the distances in a part have changed?
    fn has_changed(&self, part: &Part) -> bool {
        if self.scene.moved.is_none() {
            return true;
        }
        let ([nx, ny, _], [x, y, z]) = (self.memory.shape, self.blocks(part));
        let mut rows = z.flat_map(|k| y.clone().map(move |j| nx * (j + ny * k)));
        rows.any(|row| self.memory.changed[row + x.start..row + x.end].contains(&true))
    }

    /// Computes a part, given the images from number `from` on that may be the nearest there.
    fn halve(&mut self, part: Part, from: usize) {
        let block = BLOCK[self.scene.lattice.dim - 2];
        let blocks = [0, 1, 2].map(|a| part[a].len().div_ceil(block));
        if blocks.contains(&0) {
            return;
        }
        let longest = (0..3).max_by_key(|&a| blocks[a]).unwrap_or(0);
        let whole = blocks[longest] == 1;
        if !self.has_changed(&part) {
            return;
        }
        let (_, centre, half) = self.around(&part);
        let end = self.memory.candidates.len();
        match self.nearest_at(centre, half, from..end) {
            Found::Inside(body) => self.fill_inside(&part, body),
            Found::Least(least) if whole => self.fill(&part, end, least + half),
            Found::Least(_) => {
                let middle = part[longest].start + blocks[longest].div_ceil(2) * block;
                let (mut low, mut high) = (part.clone(), part);
                low[longest].end = middle;
                high[longest].start = middle;
                self.halve(low, end);
                self.halve(high, end);
            }
        }
        self.memory.candidates.truncate(end);
    }

    /// Of the images `from`, lists behind them those that may be the nearest within `half` of `centre`.
    fn nearest_at(&mut self, centre: Point, half: f64, from: Range<usize>) -> Found {
        let Scene { lattice, bodies, .. } = *self.scene;
        let Slab { candidates, distances, .. } = &mut *self.memory;
        let mut least = self.scene.side(centre);
        for image in &candidates[from.clone()] {
            least = least.min(farthest_corner(centre, &image.bounds));
        }
        distances.clear();
        for image in &candidates[from.clone()] {
            let gap = apart(&Aabb { min: centre, max: centre }, &image.bounds, lattice.dim);
            let reach = beyond(least, half);
            let mut d = gap;
            if gap <= reach {
                let x = bodies.pose(image.body).to_body(centre - image.shift);
                d = bodies.solid(image.body).signed_distance(x, reach.max(2.0 * half + f64::MIN_POSITIVE));
                if d <= -half {
                    return Found::Inside(image.body);
                }
                least = least.min(d);
            }
            distances.push(d);
        }
        let reach = beyond(least, half);
        for at in 0..distances.len() {
            if distances[at] <= reach {
                candidates.push(candidates[from.start + at]);
            }
        }
        Found::Least(least)
    }

    fn fill_inside(&mut self, part: &Part, body: BodyId) {
        for k in part[2].clone() {
            for j in part[1].clone() {
                let row = self.row(part, j, k);
                self.done += row.len() as u64;
                self.values[row.clone()].fill(0.0);
                self.nearest[row].fill(body.0 as u32);
            }
        }
    }

    /// Computes a block's cells from the images from number `from` on; none is farther from a wall than `far`.
    fn fill(&mut self, part: &Part, from: usize, far: f64) {
        let Scene { lattice, bodies, .. } = *self.scene;
        let band = far.max(f64::MIN_POSITIVE) * (1.0 + 1e-9);
        self.memory.points.clear();
        for k in part[2].clone() {
            for j in part[1].clone() {
                let row = self.row(part, j, k);
                self.done += row.len() as u64;
                for (i, at) in part[0].clone().zip(row) {
                    let x = Point::from(lattice.position([i, j, k].map(|i| i as isize)));
                    self.memory.points.push(x);
                    (self.values[at], self.nearest[at]) = (self.scene.side(x), SIDE);
                }
            }
        }
        for candidate in from..self.memory.candidates.len() {
            let Slab { candidates, points, local, answers, .. } = &mut *self.memory;
            let Image { body, shift, .. } = candidates[candidate];
            let pose = bodies.pose(body);
            let turn = pose.orientation.inverse().to_rotation_matrix();
            local.clear();
            local.extend(points.iter().map(|x| Point::from(turn * (x - shift - pose.position))));
            answers.resize(local.len(), 0.0);
            bodies.solid(body).signed_distances(local, band, answers);
            let mut answer = 0;
            for k in part[2].clone() {
                for j in part[1].clone() {
                    for at in self.row(part, j, k) {
                        let d = self.memory.answers[answer].max(0.0);
                        if d < self.values[at] {
                            (self.values[at], self.nearest[at]) = (d, body.0 as u32);
                        }
                        answer += 1;
                    }
                }
            }
        }
    }
}

/// What is near a part's centre.
enum Found {
    /// All of the part is inside this body.
    Inside(BodyId),
    /// The least signed distance there.
    Least(f64),
}

/// What is farther from the centre of a part than this is nowhere the nearest in it, `least` being the nearest there; with room
/// for round-off.
fn beyond(least: f64, half: f64) -> f64 {
    least + 2.0 * half + 1e-9 * (least.abs() + half)
}

/// No less than this is the distance between what two boxes hold.
fn apart(a: &Aabb, b: &Aabb, dim: usize) -> f64 {
    let gap = |axis: usize| (a.min[axis] - b.max[axis]).max(b.min[axis] - a.max[axis]).max(0.0);
    (0..dim).map(|axis| gap(axis) * gap(axis)).sum::<f64>().sqrt()
}

/// The farthest that something in a box may be from `x`.
fn farthest_corner(x: Point, bounds: &Aabb) -> f64 {
    (x - bounds.min).abs().sup(&(bounds.max - x).abs()).norm()
}
