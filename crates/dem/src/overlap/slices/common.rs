//! What slices of two tubes share.
use super::eight::{Eight, Sums};
use super::flat::Flat;
use super::lanes::{Lanes, Places, WIDTH};
use super::slice::Place;
use super::tube::SlicedTube;
use super::vertex::{Curve, Vertex};
use pulp::{Arch, Simd, WithSimd};

/// Corners and pieces of a common outline, at most.
const PIECES: usize = 24;
/// Where outlines are looked for between two heights, one after the other until one is closed.
const PLACES: [f64; 3] = [0.5, 0.43, 0.61];

/// The outline of what slices of two tubes that are not parallel share, from one height at which pieces of it come or go to the next: which
/// pieces of both outlines lie within the other, and where these end.
pub(super) struct Common {
    tubes: [SlicedTube; 2],
    curves: [[Curve; 4]; 2],
    vertices: [Vertex; PIECES],
    /// Tell the vertices apart.
    keys: [usize; PIECES],
    /// How many pieces start in each less how many end there.
    open: [i8; PIECES],
    n: usize,
    parts: [Part; PIECES],
    m: usize,
    full: bool,
}

/// A piece of an outline, counter-clockwise.
#[derive(Clone, Copy)]
struct Part {
    body: usize,
    curve: usize,
    /// Numbers of vertices.
    start: usize,
    end: usize,
}

/// Where a piece starts or ends: where its curve crosses another of the other's, or else the corner of its body at the end and on the
/// side of these numbers.
#[derive(Clone, Copy, Debug)]
pub(super) enum Stop {
    Corner { end: usize, side: usize },
    Crossing { curve: usize, near: Place },
}

impl Common {
    pub(super) fn new(a: &SlicedTube, b: &SlicedTube) -> Self {
        Self {
            tubes: [*a, *b],
            curves: [a, b].map(Curve::all),
            vertices: [Vertex::NONE; PIECES],
            keys: [0; PIECES],
            open: [0; PIECES],
            n: 0,
            parts: [Part { body: 0, curve: 0, start: 0, end: 0 }; PIECES],
            m: 0,
            full: false,
        }
    }
    /// Looks for it between two heights; answers whether there is anything.
    pub(super) fn find_between(&mut self, [low, high]: [f64; 2]) -> bool {
        for share in PLACES {
            self.find(low + (high - low) * share);
            if self.is_closed() {
                break;
            }
        }
        self.m > 0
    }
    fn find(&mut self, h: f64) {
        (self.n, self.m, self.full) = (0, 0, false);
        let [a, b] = [0, 1].map(|body| Flat::new(&self.tubes[body], h));
        a.within(&b, |curve, from, to| self.push(0, curve, from, to));
        b.within(&a, |curve, from, to| self.push(1, curve, from, to));
    }
    /// Whether each piece begins where one ends.
    pub(super) fn is_closed(&self) -> bool {
        !self.full && self.open[..self.n].iter().all(|open| *open == 0)
    }
    /// Whether there are pieces of the first and the second body.
    pub(super) fn bodies(&self) -> [bool; 2] {
        [0, 1].map(|body| self.parts[..self.m].iter().any(|part| part.body == body))
    }
    /// What slices of this outline add per height: integrals over the region that they share, by Green's theorem over the pieces of both
    /// outlines within the other, in any order, and over the first one's pieces.
    pub(super) fn slices(&self, heights: &[f64; WIDTH]) -> Eight {
        Arch::new().dispatch(Slices { common: self, heights })
    }

    fn push(&mut self, body: usize, curve: usize, from: Stop, to: Stop) {
        if self.n + 2 > PIECES || self.m == PIECES {
            self.full = true;
            return;
        }
        let [start, end] = [from, to].map(|stop| self.vertex(body, curve, stop));
        self.open[start] += 1;
        self.open[end] -= 1;
        self.parts[self.m] = Part { body, curve, start, end };
        self.m += 1;
    }
    /// The number of a vertex; both pieces that meet there ask for it.
    fn vertex(&mut self, body: usize, curve: usize, stop: Stop) -> usize {
        let (key, vertex) = match stop {
            Stop::Corner { end, side } => {
                let tube = &self.tubes[body];
                let along = if end == 0 { tube.axis } else { -tube.axis };
                let right = Place::new(tube.axis.y, -tube.axis.x);
                let mut by = [Place::zeros(); 2];
                by[body] = if side == 0 { right } else { -right };
                let from = tube.centre + along * tube.half;
                (body * 4 + end * 2 + side, Vertex::Moving { from, by })
            }
            Stop::Crossing { curve: other, near } => {
                let [first, second] = if body == 0 { [curve, other] } else { [other, curve] };
                let (vertex, left) = Vertex::crossing(&self.curves[0][first], &self.curves[1][second], near);
                (8 + 2 * (4 * first + second) + usize::from(left), vertex)
            }
        };
        if let Some(known) = self.keys[..self.n].iter().position(|k| *k == key) {
            return known;
        }
        (self.keys[self.n], self.vertices[self.n], self.open[self.n]) = (key, vertex, 0);
        self.n += 1;
        self.n - 1
    }
}

/// Slices of a common outline, in the widest vectors that the processor has.
struct Slices<'a> {
    common: &'a Common,
    heights: &'a [f64; WIDTH],
}

impl WithSimd for Slices<'_> {
    type Output = Eight;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Eight {
        let mut all = Eight::default();
        let mut places = [Places::splat(simd, Place::zeros()); PIECES];
        for (i, h) in S::as_simd_f64s(self.heights).0.iter().enumerate() {
            all.set::<S>(i, self.common.slice(simd, Lanes::new(simd, *h), &mut places));
        }
        all
    }
}

impl Common {
    /// Slices at some heights; `places` are those of the vertices.
    #[inline(always)]
    fn slice<S: Simd>(&self, simd: S, h: Lanes<S>, places: &mut [Places<S>; PIECES]) -> [S::f64s; 10] {
        let [a, b] = &self.tubes;
        let widths = [width(a, h), width(b, h)];
        // −∂width/∂h, finite where the slice is a line.
        let slope = (h - 0.5 * (a.low + a.high)) / widths[0].max(h.all(1e-100 * a.radius));
        for (place, vertex) in places.iter_mut().zip(&self.vertices[..self.n]) {
            *place = vertex.places(simd, widths);
        }
        let mut sums = Sums::zero(simd);
        // So that nothing cancels.
        let origin = places[0];
        for part in &self.parts[..self.m] {
            let ends = [places[part.start], places[part.end]];
            match self.curves[part.body][part.curve] {
                Curve::Line { normal, moves, .. } => {
                    sums.line(origin, ends, Places::splat(simd, normal), slope * moves, part.body == 0);
                }
                Curve::Circle { centre } => {
                    let circle = (Places::splat(simd, centre), widths[part.body]);
                    sums.arc(origin, ends, circle, slope, part.body == 0);
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
