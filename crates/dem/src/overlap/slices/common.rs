//! What slices of two tubes share.
use super::flat::Flat;
use super::lanes::{Lanes, Places, WIDTH};
use super::slice::Place;
use super::sliced_tube::SlicedTube;
use super::sums::{Sampled, Sums, Weighted};
use super::vertex::{Curve, Vertex};
use pulp::{Arch, Simd, WithSimd};

/// Corners of a common outline and pieces, at most.
const PIECES: usize = 16;
/// Corners of both bodies, and two crossings of any curve of either.
const VERTICES: usize = 40;
/// Where outlines are looked for between two heights, one after the other until one is closed.
const PLACES: [f64; 3] = [0.5, 0.43, 0.61];

/// Two tubes that are not parallel, and all places that were met where pieces of their slices' common outline end.
pub(super) struct Common {
    tubes: [SlicedTube; 2],
    curves: [[Curve; 4]; 2],
    vertices: [Vertex; VERTICES],
    /// Those that are known, a bit each.
    known: u64,
}

/// The outline of what slices share, the same from one height at which pieces of it come or go to the next: which pieces of both outlines
/// lie within the other, and where these end.
#[derive(Clone, Copy, Default)]
pub(super) struct Outline {
    /// Vertices.
    keys: [u8; PIECES],
    /// How many pieces start in each less how many end there.
    open: [i8; PIECES],
    n: usize,
    parts: [Part; PIECES],
    m: usize,
    full: bool,
}

/// A piece of an outline, counter-clockwise.
#[derive(Clone, Copy, Default)]
struct Part {
    body: u8,
    curve: u8,
    /// Places in the list of vertices.
    start: u8,
    end: u8,
}

/// Where a piece starts or ends: where its curve crosses another of the other's, or else the corner of its body at the end and on the
/// side of these numbers.
#[derive(Clone, Copy, Debug)]
pub(super) enum Stop {
    Corner { end: usize, side: usize },
    Crossing { curve: usize, near: Place },
}

impl Common {
    #[inline]
    pub(super) fn new(a: &SlicedTube, b: &SlicedTube) -> Self {
        let (tubes, curves) = ([*a, *b], [Curve::all(a), Curve::all(b)]);
        Self { tubes, curves, vertices: [Vertex::NONE; VERTICES], known: 0 }
    }
    /// The outline between two heights.
    pub(super) fn between(&mut self, [low, high]: [f64; 2]) -> Outline {
        let mut outline = Outline::default();
        for share in PLACES {
            outline = Outline::default();
            let h = low + (high - low) * share;
            let [a, b] = [Flat::new(&self.tubes[0], h), Flat::new(&self.tubes[1], h)];
            a.within(&b, |curve, from, to| outline.push(self, 0, curve, from, to));
            b.within(&a, |curve, from, to| outline.push(self, 1, curve, from, to));
            if outline.is_closed() {
                break;
            }
        }
        outline
    }
    /// The number of a vertex.
    fn vertex(&mut self, body: usize, curve: usize, stop: Stop) -> usize {
        let (first, second, near) = match stop {
            Stop::Corner { end, side } => {
                let key = body * 4 + end * 2 + side;
                if self.known >> key & 1 == 0 {
                    let tube = &self.tubes[body];
                    let along = if end == 0 { tube.axis } else { -tube.axis };
                    let right = Place::new(tube.axis.y, -tube.axis.x);
                    let mut by = [Place::zeros(); 2];
                    by[body] = if side == 0 { right } else { -right };
                    self.vertices[key] = Vertex::Moving { from: tube.centre + along * tube.half, by };
                    self.known |= 1 << key;
                }
                return key;
            }
            Stop::Crossing { curve: other, near } if body == 0 => (curve, other, near),
            Stop::Crossing { curve: other, near } => (other, curve, near),
        };
        let [p, q] = [&self.curves[0][first], &self.curves[1][second]];
        let left = Vertex::is_left(p, q, near);
        let key = 8 + 2 * (4 * first + second) + usize::from(left);
        if self.known >> key & 1 == 0 {
            self.vertices[key] = Vertex::crossing(p, q, left);
            self.known |= 1 << key;
        }
        key
    }
    /// Sums over slices of an outline: integrals over the region that they share, by Green's theorem over the pieces of both outlines
    /// within the other, in any order, and over the first one's pieces.
    pub(super) fn sums<const N: usize>(
        &self,
        outline: &Outline,
        heights: &[f64; WIDTH],
        weights: &[[f64; WIDTH]; N],
    ) -> Sampled<N> {
        Arch::new().dispatch(Slices { common: self, outline, heights, weights })
    }
}

impl Outline {
    pub(super) fn is_empty(&self) -> bool {
        self.m == 0
    }
    /// Whether each piece begins where one ends.
    pub(super) fn is_closed(&self) -> bool {
        !self.full && self.open[..self.n].iter().all(|open| *open == 0)
    }
    /// Whether there are pieces of the first and the second body.
    pub(super) fn bodies(&self) -> [bool; 2] {
        let of = |body| self.parts[..self.m].iter().any(|part| part.body == body);
        [of(0), of(1)]
    }
    fn push(&mut self, common: &mut Common, body: usize, curve: usize, from: Stop, to: Stop) {
        if self.n + 2 > PIECES || self.m == PIECES {
            self.full = true;
            return;
        }
        let start = self.place(common.vertex(body, curve, from));
        let end = self.place(common.vertex(body, curve, to));
        self.open[start] += 1;
        self.open[end] -= 1;
        self.parts[self.m] =
            Part { body: body as u8, curve: curve as u8, start: start as u8, end: end as u8 };
        self.m += 1;
    }
    /// Where a vertex is in the list; both pieces that meet there ask for it.
    fn place(&mut self, key: usize) -> usize {
        let key = key as u8;
        if let Some(known) = self.keys[..self.n].iter().position(|k| *k == key) {
            return known;
        }
        self.keys[self.n] = key;
        self.n += 1;
        self.n - 1
    }
}

/// Slices of a common outline, in the widest vectors that the processor has.
struct Slices<'a, const N: usize> {
    common: &'a Common,
    outline: &'a Outline,
    heights: &'a [f64; WIDTH],
    weights: &'a [[f64; WIDTH]; N],
}

impl<const N: usize> WithSimd for Slices<'_, N> {
    type Output = Sampled<N>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Sampled<N> {
        let mut sums = Weighted::new(simd, self.weights);
        let mut places = [Places::splat(simd, Place::zeros()); PIECES];
        for (i, h) in S::as_simd_f64s(self.heights).0.iter().enumerate() {
            sums.add(i, self.common.slice(simd, self.outline, Lanes::new(simd, *h), &mut places));
        }
        sums.finish()
    }
}

impl Common {
    /// Slices at some heights; `places` are those of the vertices.
    #[inline(always)]
    fn slice<S: Simd>(
        &self,
        simd: S,
        outline: &Outline,
        h: Lanes<S>,
        places: &mut [Places<S>; PIECES],
    ) -> [S::f64s; 10] {
        let [a, b] = &self.tubes;
        let widths = [width(a, h), width(b, h)];
        // −∂width/∂h, finite where the slice is a line.
        let slope = (h - 0.5 * (a.low + a.high)) / widths[0].max(h.all(1e-100 * a.radius));
        for (place, key) in places.iter_mut().zip(&outline.keys[..outline.n]) {
            *place = self.vertices[usize::from(*key)].places(simd, widths);
        }
        let mut sums = Sums::zero(simd);
        // So that nothing cancels.
        let origin = places[0];
        for part in &outline.parts[..outline.m] {
            let ends = [places[usize::from(part.start)], places[usize::from(part.end)]];
            let (body, first) = (usize::from(part.body), part.body == 0);
            match self.curves[body][usize::from(part.curve)] {
                Curve::Line { normal, moves, .. } => {
                    sums.line(origin, ends, Places::splat(simd, normal), slope * moves, first);
                }
                Curve::Circle { centre } => {
                    sums.arc(origin, ends, (Places::splat(simd, centre), widths[body]), slope, first);
                }
            }
        }
        sums.about(origin).all(h)
    }
}

/// Of a tube's slices.
#[inline(always)]
fn width<S: Simd>(tube: &SlicedTube, h: Lanes<S>) -> Lanes<S> {
    ((h - tube.low) * (h.all(tube.high) - h)).max(h.all(0.0)).sqrt()
}
