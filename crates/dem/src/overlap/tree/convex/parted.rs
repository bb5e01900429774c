//! Regions parted into convex pieces along flat faces at inward edges, as those of angles and grooves.
//!
//! Where a body goes on in front of the plane of one of its faces, it is what of it is behind that plane and what is before it. Of
//! either part the plane is a face, so what the parts share with the other body is measured one by one, parted again where that is
//! not convex, and added: where only parts of a body touch, ∫n dA and ∫x × n dA over its surface cancel. Planes part all that is
//! measured after them, so pieces share nothing. All pieces that hang together meet on the planes and are found there: squares are
//! divided until distances prove them empty.
use super::super::around::{Oriented, tangents};
use super::super::deepest::{Deepest, Search};
use super::super::seen::Behind;
use super::{Circumscribed, Convex, Failure, Totals, Which, outside};
use interfaces::Vector;
use nalgebra::Matrix3;

/// Pieces of all regions of a pair at most.
const MOST: usize = 40;
/// Planes at most.
const MOST_FACES: usize = 16;
/// Pieces so thin, as a share of the tolerance, of the depth of the deepest place, are nothing.
const THIN: f64 = 1e-3;
/// How often a square of a plane is divided.
const LEVELS: u8 = 5;

/// A flat face of a body, by a place on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    pub(super) body: usize,
    pub(super) normal: Vector,
    pub(super) foot: Vector,
}

impl Face {
    /// As a frame sees it in which the axes of this one are the columns of `axes`, its origin is at `centre`.
    pub(super) fn seen(&self, axes: &Matrix3<f64>, centre: Vector) -> Self {
        Self { normal: axes * self.normal, foot: axes * self.foot + centre, ..*self }
    }
}

/// A convex part of a region.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    /// A box around it.
    pub(super) root: Oriented,
    pub(super) totals: Totals,
}

/// What is asked of a region's pieces.
#[derive(Clone, Copy)]
struct Asked {
    tolerance: f64,
    /// No piece is deeper than this, unless it is nothing \[m\].
    least: f64,
}

impl Circumscribed {
    /// Forgets all regions.
    pub(crate) fn clear(&mut self) {
        self.planes.clear();
        self.pieces.clear();
        self.faces.clear();
    }

    /// The region around a deepest place, if it is convex or flat faces part it into a few convex pieces, to a relative error of its
    /// volume of about `tolerance`; its gradient's error is held to a few times this.
    pub(crate) fn measure(
        &mut self,
        search: &Search<'_>,
        deepest: &Deepest,
        tolerance: f64,
        which: Which,
    ) -> Option<Convex> {
        let [planes, pieces, faces] = [self.planes.len(), self.pieces.len(), self.faces.len()];
        let asked = Asked { tolerance, least: THIN * tolerance * deepest.level };
        if self.collect(search, deepest, which, asked).is_none() {
            self.planes.truncate(planes);
            self.pieces.truncate(pieces);
            self.faces.truncate(faces);
            return None;
        }
        let (one, others) = self.pieces[pieces..].split_first()?;
        let (mut root, mut totals) = (one.root, one.totals);
        for other in others {
            let [low, high] = root.reach(&other.root);
            root.set(low.inf(&-root.half), high.sup(&root.half));
            totals.add(&other.totals);
        }
        Some(Convex { root, centre: deepest.at, totals, planes: [planes, self.planes.len()] })
    }

    /// Adds the pieces that hang together with a deepest place.
    fn collect(&mut self, search: &Search<'_>, deepest: &Deepest, which: Which, asked: Asked) -> Option<()> {
        let first = self.planes.len();
        if self.faces.is_empty() {
            match self.piece(search, deepest, asked.tolerance, which) {
                Ok(piece) => {
                    self.pieces.push(piece);
                    return Some(());
                }
                Err(Failure::Inward(face)) => self.faces.push(face),
                Err(_) => return None,
            }
        }
        self.around(search, deepest.at, deepest.level, asked)?;
        // Again if there was something of which it was not known yet whether it hangs together with what is known.
        loop {
            let (mut open, n) = (false, self.pieces.len());
            let mut number = 0;
            while let Some(Face { normal, .. }) = self.faces.get(number).copied() {
                let mut section = Section::new(search, &self.faces[number]);
                while let Some((x, level)) = section.next(search) {
                    if level > asked.least {
                        continue;
                    }
                    let sides = [0.5, -0.5].map(|s| x + s * level * normal);
                    match sides.map(|x| outside(x, &self.planes[first..]) <= 0.0) {
                        [true, true] => {}
                        [true, false] => self.around(search, sides[1], level, asked)?,
                        [false, true] => self.around(search, sides[0], level, asked)?,
                        [false, false] => open = true,
                    }
                }
                number += 1;
            }
            if !open || self.pieces.len() == n {
                return Some(());
            }
        }
    }

    /// Adds what is around `x`, about as deep as the size of `level`, between the planes that are known, unless it is known already.
    fn around(&mut self, search: &Search<'_>, x: Vector, level: f64, asked: Asked) -> Option<()> {
        while outside(x, &self.planes) > 0.0 {
            if self.pieces.len() == MOST || self.faces.len() == MOST_FACES {
                return None;
            }
            let parts = [0, 1].map(|body| self.part(search, body, x));
            let bodies = [0, 1].map(|body| search.bodies[body].of(&parts[body]));
            let part = Search { bodies, half: search.half };
            let new = |d: &Deepest| outside(d.at, &self.planes) > 0.0;
            let deepest = part.descend(x, -level).map(|d| part.central(d)).filter(new);
            // Ways down may lead across gaps, to what is known.
            let Some(deepest) = deepest.or_else(|| part.stay(x)) else { return Some(()) };
            if deepest.level > asked.least {
                return Some(());
            }
            match self.piece(&part, &deepest, asked.tolerance, Which::All) {
                Ok(piece) => self.pieces.push(piece),
                Err(Failure::Inward(face)) => self.faces.push(face),
                Err(_) => return None,
            }
        }
        Some(())
    }

    /// What of a body is on the same side of all its planes as `x`.
    fn part<'a>(&self, search: &Search<'a>, body: usize, x: Vector) -> Behind<'a, MOST_FACES> {
        let mut part = search.bodies[body].whole();
        for face in self.faces.iter().filter(|face| face.body == body) {
            let before = face.normal.dot(&(x - face.foot)) > 0.0;
            part.cut(&search.bodies[body], if before { -face.normal } else { face.normal }, face.foot);
        }
        part
    }
}

/// Places on a plane that are within both bodies.
struct Section {
    middle: Vector,
    /// Half-widths of the plane's part in the box of the search.
    across: [Vector; 2],
    /// Squares that are to be looked at: where their middles are, in half-widths, and how often they were divided.
    squares: [([f64; 2], u8); 3 * LEVELS as usize + 1],
    n: usize,
}

impl Section {
    fn new(search: &Search<'_>, &Face { normal, foot, .. }: &Face) -> Self {
        let across = tangents(normal).map(|e| e.abs().dot(&search.half) * e);
        let squares = [([0.0; 2], 0); 3 * LEVELS as usize + 1];
        Self { middle: normal.dot(&foot) * normal, across, squares, n: 1 }
    }

    /// The next one, and the larger one of both distances there.
    fn next(&mut self, search: &Search<'_>) -> Option<(Vector, f64)> {
        while self.n > 0 {
            self.n -= 1;
            let ([s, t], level) = self.squares[self.n];
            let [u, v] = self.across;
            let x = self.middle + s * u + t * v;
            let [a, b] = search.distances(x);
            let depth = a.max(b);
            let size = 0.5_f64.powi(level.into());
            if level < LEVELS && depth.abs() < size * u.norm().hypot(v.norm()) {
                for [i, j] in [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]] {
                    self.squares[self.n] = ([s + size * i, t + size * j], level + 1);
                    self.n += 1;
                }
            }
            if depth < 0.0 {
                return Some((x, depth));
            }
        }
        None
    }
}
