//! Who is near a place: one grid for every octave of sizes.
use interfaces::{Aabb, Point, Vector};

/// A sphere that is already there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    pub(super) centre: Point,
    pub(super) radius: f64,
    /// Whose it is.
    pub(super) id: u32,
}

/// Balls in cells that are larger than themselves; periodic axes wrap around.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    low: Point,
    periodic: [bool; 3],
    largest: f64,
    levels: Vec<Level>,
}

/// Balls of radii from half of the largest one up to it.
#[derive(Clone, Debug)]
struct Level {
    largest: f64,
    counts: [i64; 3],
    width: Vector,
    /// First ball of a cell; cells that share a slot share the list.
    heads: Vec<u32>,
    /// Next ball in the same slot.
    next: Vec<u32>,
    balls: Vec<Ball>,
}

const NONE: u32 = u32::MAX;
/// Cells along an axis, at most.
const MOST_CELLS: f64 = 1e6;

impl Grid {
    /// An empty one for balls of these `radii`, which keep `gap`.
    pub(super) fn new(bounds: &Aabb, periodic: [bool; 3], radii: &[f64], gap: f64) -> Self {
        let largest = radii.iter().copied().fold(0.0, f64::max);
        let (low, extent) = (bounds.min, bounds.extent());
        let mut grid = Self { low, periodic, largest, levels: Vec::new() };
        let mut members = Vec::new();
        for &radius in radii {
            let level = grid.level(radius);
            members.resize(members.len().max(level + 1), 0_usize);
            members[level] += 1;
        }
        grid.levels = (0..members.len())
            .map(|k| {
                let largest = largest * 0.5_f64.powi(k as i32);
                let cells = |e: f64| (e / (2.0 * largest + gap)).floor().clamp(1.0, MOST_CELLS);
                let counts = extent.map(cells);
                let slots = (2 * members[k]).next_power_of_two();
                Level {
                    largest,
                    counts: [0, 1, 2].map(|a| counts[a] as i64),
                    width: extent.component_div(&counts),
                    heads: vec![NONE; if members[k] == 0 { 0 } else { slots }],
                    next: Vec::new(),
                    balls: Vec::with_capacity(members[k]),
                }
            })
            .collect();
        grid
    }
    /// Which octave below the largest radius.
    fn level(&self, radius: f64) -> usize {
        let (mut level, mut bound) = (0, 0.5 * self.largest);
        while radius < bound {
            bound *= 0.5;
            level += 1;
        }
        level
    }
    /// Adds a ball of one of the radii that were told.
    pub(super) fn add(&mut self, ball: Ball) {
        let k = self.level(ball.radius);
        let (low, periodic) = (self.low, self.periodic);
        let level = &mut self.levels[k];
        let cell = [0, 1, 2].map(|a| {
            let (i, n) = (index(ball.centre[a] - low[a], level.width[a]), level.counts[a]);
            if periodic[a] { i.rem_euclid(n) } else { i.clamp(0, n - 1) }
        });
        let slot = level.slot(cell);
        level.next.push(level.heads[slot]);
        level.heads[slot] = level.balls.len() as u32;
        level.balls.push(ball);
    }
    /// Whether `test` is true of any ball whose surface is within `reach` of a place; it may be asked about others, too, and about one twice.
    pub(super) fn any(&self, place: Point, reach: f64, mut test: impl FnMut(&Ball) -> bool) -> bool {
        self.levels.iter().filter(|level| !level.balls.is_empty()).any(|level| {
            let reach = reach + level.largest;
            let mut ranges = [(0, 0); 3];
            let mut cells = 1.0;
            for a in 0..3 {
                let x = place[a] - self.low[a];
                let (from, to) = (index(x - reach, level.width[a]), index(x + reach, level.width[a]));
                let last = level.counts[a] - 1;
                ranges[a] = if !self.periodic[a] {
                    (from.clamp(0, last), to.clamp(0, last))
                } else if to - from >= last {
                    (0, last)
                } else {
                    (from, to)
                };
                cells *= (ranges[a].1 - ranges[a].0 + 1) as f64;
            }
            if cells > level.balls.len() as f64 {
                return level.balls.iter().any(&mut test);
            }
            // From the place's own cell outwards: in a crowd, whoever is in the way is most often there.
            let x = place - self.low;
            for k in outward(x.z / level.width.z, ranges[2]) {
                for j in outward(x.y / level.width.y, ranges[1]) {
                    for i in outward(x.x / level.width.x, ranges[0]) {
                        let [nx, ny, nz] = level.counts;
                        let cell = [turned(i, nx), turned(j, ny), turned(k, nz)];
                        let mut at = level.heads[level.slot(cell)];
                        while at != NONE {
                            if test(&level.balls[at as usize]) {
                                return true;
                            }
                            at = level.next[at as usize];
                        }
                    }
                }
            }
            false
        })
    }
}

impl Level {
    /// Cells are numbered along x first; where there are more of them than slots, they are scattered (Fibonacci hashing).
    fn slot(&self, [i, j, k]: [i64; 3]) -> usize {
        let number = (i + self.counts[0] * (j + self.counts[1] * k)) as u64;
        let slots = self.heads.len() as u64;
        if self.counts.iter().product::<i64>() as u64 <= slots {
            return number as usize;
        }
        // There are two slots at least, a power of two.
        (number.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> (64 - slots.trailing_zeros())) as usize
    }
}

/// The shortest of a vector's images.
pub(super) fn nearest(v: Vector, periods: &Vector) -> Vector {
    v.zip_map(periods, |x, l| if l > 0.0 { x - l * (x / l).round() } else { x })
}
/// Whether `test` is true of any image of a vector that is shorter than `reach`.
pub(super) fn images(
    shortest: Vector,
    periods: &Vector,
    reach: f64,
    mut test: impl FnMut(Vector) -> bool,
) -> bool {
    let most = periods.map(|l| if l > 0.0 { (reach / l + 0.5).floor() } else { 0.0 });
    let range = |a: usize| -(most[a] as i64)..=most[a] as i64;
    for k in range(2) {
        for j in range(1) {
            for i in range(0) {
                let v = shortest + Vector::new(i as f64, j as f64, k as f64).component_mul(periods);
                if v.norm_squared() < reach * reach && test(v) {
                    return true;
                }
            }
        }
    }
    false
}

/// The cell of a place; far outside it is as if it were at the border of numbers.
fn index(x: f64, width: f64) -> i64 {
    if width > 0.0 { (x / width).floor().clamp(-1e9, 1e9) as i64 } else { 0 }
}
/// All of a range, from where `x` is outwards, the nearer side first.
fn outward(x: f64, (from, to): (i64, i64)) -> impl Iterator<Item = i64> {
    let (own, up) = (x.floor(), x - x.floor() >= 0.5);
    // A plane grid has no width along z, and x is not a number then.
    let own = (own as i64).clamp(from, to);
    let most = 2 * (own - from).max(to - own);
    let step = move |t: i64| if (t & 1 == 1) == up { (t + 1) / 2 } else { -((t + 1) / 2) };
    (0..=most).map(move |t| own + step(t)).filter(move |i| (from..=to).contains(i))
}
/// A cell's number once it is turned back into the box; only a period away at most.
fn turned(i: i64, count: i64) -> i64 {
    if i < 0 {
        i + count
    } else if i >= count {
        i - count
    } else {
        i
    }
}
