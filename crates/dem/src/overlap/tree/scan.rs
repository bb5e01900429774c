//! The search for all regions that two bodies share.
use super::deepest::Search;
use interfaces::Vector;

/// How often boxes are halved before the first regions are looked for.
const COARSE: u8 = 2;
/// And all in all: regions that a box of this share of what the bodies' boxes share would hold are found.
const FINE: u8 = 5;
/// Boxes along each axis then.
const GRID: usize = 1 << COARSE;

/// How much more a distance may be off a linear model in a box than at its eight centres and in its middle.
const CURVED: f64 = 1.0;
/// What is off by less than this share of what it changes by is all but linear.
const STRAIGHT: f64 = 0.35;
/// And besides, as a share of what a box reaches.
const SLACK: f64 = 0.02;

/// A box in which both bodies may be.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cell {
    pub(crate) centre: Vector,
    /// How often it was halved.
    level: u8,
    /// d_A and d_B at the centre \[m\].
    distances: [f64; 2],
    /// Are both all but linear in it? What they share there then hangs together.
    straight: bool,
}

impl Cell {
    fn depth(&self) -> f64 {
        self.distances[0].max(self.distances[1])
    }
}

/// Finds places and keeps the memory of it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scan {
    cells: Vec<Cell>,
    /// Boxes that had to be looked at more closely.
    seen: Vec<Vector>,
}

/// What a box tells of the eight in it.
struct Divided {
    centres: [Vector; 8],
    distances: [[f64; 8]; 2],
    may_share: [bool; 8],
    straight: bool,
}

impl Scan {
    /// Divides what the bodies' boxes share; the centres of boxes that are deeper than those around, deepest first, and how large
    /// the boxes are.
    pub(crate) fn begin(&mut self, search: &Search<'_>, starts: &mut Vec<Vector>) -> f64 {
        self.cells.clear();
        self.seen.clear();
        starts.clear();
        self.cells.push(Cell { centre: Vector::zeros(), level: 0, distances: [0.0; 2], straight: false });
        let mut first = 0;
        // Breadth first.
        while self.cells.get(first).is_some_and(|cell| cell.level < COARSE) {
            let cell = self.cells[first];
            self.divide(search, &cell);
            first += 1;
        }
        self.cells.drain(..first);
        let mut depths = [f64::INFINITY; GRID * GRID * GRID];
        let half = search.half / GRID as f64;
        let number = |x: Vector| {
            let at = |a: usize| (0.5 * ((x[a] + search.half[a]) / half[a] - 1.0)).round() as usize;
            at(0) + GRID * (at(1) + GRID * at(2))
        };
        self.cells.iter().for_each(|cell| depths[number(cell.centre)] = cell.depth());
        // The deepest comes last and is the first to be looked at.
        self.cells.sort_by(|p, q| q.depth().total_cmp(&p.depth()));
        let least = self.cells.iter().filter(|cell| is_least(&depths, number(cell.centre)));
        starts.extend(least.rev().map(|cell| cell.centre));
        half.norm()
    }

    /// Goes on to the next box that may hold a region but is not `known`: its centre.
    pub(crate) fn next(
        &mut self,
        search: &Search<'_>,
        known: impl Fn(Vector, f64, bool) -> bool,
    ) -> Option<Vector> {
        while let Some(cell) = self.cells.pop() {
            let reach = search.size() * 0.5_f64.powi(cell.level.into());
            if known(cell.centre, reach, cell.straight || cell.level == FINE) {
                continue;
            }
            if cell.level < FINE && cell.depth() > -reach {
                self.divide(search, &cell);
            } else if !self.seen.iter().any(|seen| (cell.centre - seen).norm() < 3.0 * reach) {
                self.seen.push(cell.centre);
                return Some(cell.centre);
            }
        }
        None
    }

    /// Adds those of eight boxes in `cell` in which the bodies may share something.
    fn divide(&mut self, search: &Search<'_>, cell: &Cell) {
        if let Some(divided) = search.divided(cell) {
            for i in (0..8).filter(|i| divided.may_share[*i]) {
                let (centre, distances) = (divided.centres[i], divided.distances.map(|d| d[i]));
                self.cells.push(Cell {
                    centre,
                    level: cell.level + 1,
                    distances,
                    straight: divided.straight,
                });
            }
        }
    }
}

impl Search<'_> {
    /// The distances in eight boxes exclude those that are farther from either body than they reach: distances change by no
    /// more than the way gone. Small boxes are excluded, too, if a weighted mean w·d_A + (1 − w)·d_B is positive all over
    /// them: between surfaces that face one another it changes by far less. It is taken for linear but for [`CURVED`] times what
    /// the eight centres and the middle are off.
    fn divided(&self, cell: &Cell) -> Option<Divided> {
        let half = self.half * 0.5_f64.powi(i32::from(cell.level) + 1);
        let reach = half.norm();
        let mut centres = [cell.centre; 8];
        for (i, centre) in centres.iter_mut().enumerate() {
            for a in 0..3 {
                centre[a] += if i >> a & 1 == 1 { half[a] } else { -half[a] };
            }
        }
        let mut d = [[0.0; 8]; 2];
        for (d, body) in d.iter_mut().zip(&self.bodies) {
            *d = body.distances(&centres, 8.0 * reach);
            if d.iter().all(|d| *d > reach) {
                return None;
            }
        }
        let mut may_share = [false; 8];
        for i in 0..8 {
            may_share[i] = d[0][i].max(d[1][i]) <= reach;
        }
        let models = [linear(&d[0], cell.distances[0]), linear(&d[1], cell.distances[1])];
        let straight =
            cell.level > 0 && models.iter().all(|(slope, off)| *off <= STRAIGHT * slope.abs().sum());
        if cell.level >= COARSE - 1 {
            let [(a, p), (b, q)] = models;
            let mut above = [f64::NEG_INFINITY; 8];
            for w in 1..8 {
                let w = f64::from(w) / 8.0;
                let v = 1.0 - w;
                let most = (w * a + v * b).abs().sum() + CURVED * (w * p + v * q) + SLACK * reach;
                for i in 0..8 {
                    let gap = w * d[0][i] + v * d[1][i] - most;
                    above[i] = if gap > above[i] { gap } else { above[i] };
                }
            }
            for i in 0..8 {
                may_share[i] &= above[i] <= 0.0;
            }
        }
        Some(Divided { centres, distances: d, may_share, straight })
    }
}

/// g of m + g·s, s from −1 to 1 along each axis, through distances `d` at the centres of eight boxes, and what they and that in the
/// `middle` are off.
#[inline]
fn linear(d: &[f64; 8], middle: f64) -> (Vector, f64) {
    let mean = 0.125 * (((d[0] + d[1]) + (d[2] + d[3])) + ((d[4] + d[5]) + (d[6] + d[7])));
    let slope = 0.125
        * Vector::new(
            ((d[1] - d[0]) + (d[3] - d[2])) + ((d[5] - d[4]) + (d[7] - d[6])),
            ((d[2] - d[0]) + (d[3] - d[1])) + ((d[6] - d[4]) + (d[7] - d[5])),
            ((d[4] - d[0]) + (d[5] - d[1])) + ((d[6] - d[2]) + (d[7] - d[3])),
        );
    let mut most = 0.0_f64;
    for (i, d) in d.iter().enumerate() {
        let side = |a: usize| if i >> a & 1 == 1 { slope[a] } else { -slope[a] };
        most = most.max((d - mean - (side(0) + side(1) + side(2))).abs());
    }
    (slope, most + (mean - middle).abs())
}

/// Is value `i` of a grid no more than those around?
fn is_least(levels: &[f64], i: usize) -> bool {
    let at = [i % GRID, i / GRID % GRID, i / (GRID * GRID)];
    let range = |a: usize| at[a].saturating_sub(1)..=(at[a] + 1).min(GRID - 1);
    for z in range(2) {
        for y in range(1) {
            for x in range(0) {
                let other = x + GRID * (y + GRID * z);
                // Of equals the first.
                if levels[other] < levels[i] || (levels[other] == levels[i] && other < i) {
                    return false;
                }
            }
        }
    }
    true
}
