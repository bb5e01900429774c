//! Where walls are among the cells of a scalar.
use super::{DISTANCE, NEAREST, Seen};
use crate::CartesianGrid;
use crate::neighbours::neighbour;
use crate::operators::Operators;
use interfaces::{CutCells, OpenFace, WallPiece};
use std::collections::HashMap;

/// Where the walls are on a grid.
pub(super) struct Geometry<'a, const D: usize> {
    pub(super) grid: &'a CartesianGrid<D>,
    pub(super) periodic: [bool; D],
    pub(super) ops: Operators<D>,
    faces: [HashMap<usize, &'a OpenFace>; D],
    pieces: HashMap<usize, &'a WallPiece>,
}

impl<'a, const D: usize> Geometry<'a, D> {
    pub(super) fn new(grid: &'a CartesianGrid<D>, periodic: [bool; D], cuts: &'a CutCells) -> Self {
        Self {
            grid,
            periodic,
            ops: Operators::new(grid, periodic),
            faces: std::array::from_fn(|a| cuts.faces[a].iter().map(|face| (face.index, face)).collect()),
            pieces: cuts.walls.iter().map(|wall| (wall.cell, wall)).collect(),
        }
    }
    /// The cell below or above this one along `axis`, if there is one.
    pub(super) fn beside(&self, cell: [usize; D], axis: usize, upper: bool) -> Option<[usize; D]> {
        neighbour(&self.ops, cell, axis, upper).map(|other| self.grid.cell(other))
    }
    /// How much of a face of the cell is open.
    pub(super) fn open(&self, cell: [usize; D], axis: usize, upper: bool) -> f64 {
        self.faces[axis].get(&self.face(cell, axis, upper)).map_or(1.0, |face| face.open)
    }
    /// Storage index of a face of the cell; at both ends of a periodic axis that of the first.
    pub(super) fn face(&self, cell: [usize; D], axis: usize, upper: bool) -> usize {
        match self.beside(cell, axis, true) {
            Some(next) if upper => self.grid.place(next),
            _ => self.grid.place(cell) + if upper { self.grid.stride()[axis] } else { 0 },
        }
    }
    /// Area of a whole face of the cell \[m²\].
    pub(super) fn area(&self, cell: [usize; D], axis: usize) -> f64 {
        (0..D).filter(|&a| a != axis).map(|a| self.grid.axis(a).width(cell[a])).product()
    }
    /// Volume of the cell's fluid \[m³\], by Gauss' theorem: ∮ x·n dA/D over its open faces and its wall.
    pub(super) fn fluid(&self, cell: [usize; D]) -> f64 {
        let width = |a: usize| self.grid.axis(a).width(cell[a]);
        let open = |a: usize| self.open(cell, a, false) + self.open(cell, a, true);
        let faces: f64 = (0..D).map(|a| 0.5 * width(a) * self.area(cell, a) * open(a)).sum();
        let wall =
            self.pieces.get(&self.grid.index(cell)).map_or(0.0, |wall| wall.area * self.height(cell, wall));
        ((faces + wall) / D as f64).clamp(0.0, self.grid.cell_volume(cell))
    }
    /// The middle of the open part of the cell's lower face.
    pub(super) fn middle(&self, cell: [usize; D], axis: usize) -> [f64; D] {
        let mut x = self.grid.centre(cell);
        x[axis] -= 0.5 * self.grid.axis(axis).width(cell[axis]);
        let face = self.faces[axis].get(&self.face(cell, axis, false)).filter(|face| face.open > 0.0);
        face.map_or(x, |face| std::array::from_fn(|a| face.centre[a]))
    }
    /// The nearest image of `x` around `from`.
    pub(super) fn image(&self, x: [f64; D], from: [f64; D]) -> [f64; D] {
        std::array::from_fn(|a| from[a] + self.nearest(a, x[a] - from[a]))
    }
    /// The cells that all that passes through a cell belongs to, by their dense numbers: themselves if the fluid is at their centre, else the one that
    /// their wall gives off to, or the one behind their most open face. None where nothing passes.
    pub(super) fn owners(&self, wet: &[bool]) -> Vec<Option<usize>> {
        let sides = || (0..D).flat_map(|a| [(a, false), (a, true)]);
        let mut owners: Vec<Option<usize>> = (0..wet.len()).map(|i| wet[i].then_some(i)).collect();
        let mut left: Vec<usize> = (0..wet.len())
            .filter(|&i| !wet[i] && sides().any(|(a, upper)| self.open(self.grid.cell(i), a, upper) > 0.0))
            .collect();
        // From cells with an owner to those behind them.
        while !left.is_empty() {
            let found: Vec<(usize, usize)> = left
                .iter()
                .filter_map(|&i| {
                    let cell = self.grid.cell(i);
                    let wall = self.pieces.get(&i);
                    let before = wall.and_then(|wall| {
                        let first = self.before(wall).into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
                        first.map(|(cell, _)| self.grid.index(cell))
                    });
                    let behind = |(a, upper)| {
                        let owner = owners[self.grid.index(self.beside(cell, a, upper)?)]?;
                        Some((owner, self.open(cell, a, upper))).filter(|&(_, open)| open > 0.0)
                    };
                    let open = || sides().filter_map(behind);
                    let most = || open().max_by(|a, b| a.1.total_cmp(&b.1)).map(|(owner, _)| owner);
                    Some((i, before.filter(|&b| open().any(|(owner, _)| owner == b)).or_else(most)?))
                })
                .collect();
            if found.is_empty() {
                break;
            }
            found.iter().for_each(|&(i, owner)| owners[i] = Some(owner));
            left.retain(|&i| owners[i].is_none());
        }
        owners
    }
    /// A difference along an axis, of the nearest image where it is periodic \[m\].
    pub(super) fn nearest(&self, axis: usize, d: f64) -> f64 {
        let length = self.grid.axis(axis).length();
        if self.periodic[axis] { d - length * (d / length).round() } else { d }
    }
    /// How far the centre is from the wall in the cell `at`, along that wall's normal \[m\]; periodic images count.
    pub(super) fn height(&self, cell: [usize; D], wall: &WallPiece) -> f64 {
        let x = self.grid.centre(cell);
        (0..D).map(|a| self.nearest(a, x[a] - wall.foot[a]) * wall.normal[a]).sum()
    }
    /// Is the centre in the fluid?
    pub(super) fn wet(&self, cell: [usize; D]) -> bool {
        let opens = (0..D).any(|a| [false, true].into_iter().any(|upper| self.open(cell, a, upper) > 0.0));
        let wall = self.pieces.get(&self.grid.index(cell));
        opens && wall.is_none_or(|wall| self.height(cell, wall) > 0.0)
    }
    /// The cells in the fluid around the place that a piece of wall, whose own or next cell in the fluid is `before`, sees, with weights of linear interpolation.
    pub(super) fn seen(&self, wall: &WallPiece, extent: f64, before: [usize; D]) -> Vec<Seen> {
        let x = |a: usize| wall.foot[a] + DISTANCE * extent * wall.normal[a];
        let centre = self.grid.centre(before);
        // The corners are `before` and its neighbours towards the place.
        let towards: [(bool, f64); D] = std::array::from_fn(|a| {
            let d = self.nearest(a, x(a) - centre[a]);
            let next = self.beside(before, a, d > 0.0).map_or(centre[a], |c| self.grid.centre(c)[a]);
            let gap = self.nearest(a, next - centre[a]);
            (d > 0.0, if gap == 0.0 { 0.0 } else { (d / gap).clamp(0.0, 1.0) })
        });
        let mut out = Vec::new();
        for corner in 0..1_usize << D {
            let (mut cell, mut weight) = (Some(before), 1.0);
            for (a, &(upper, share)) in towards.iter().enumerate() {
                let moved = corner >> a & 1 == 1;
                weight *= if moved { share } else { 1.0 - share };
                cell = cell.and_then(|c| if moved { self.beside(c, a, upper) } else { Some(c) });
            }
            if let Some(c) = cell.filter(|&c| weight > 0.0 && self.wet(c)) {
                let y = self.height(c, wall).max(NEAREST * extent);
                out.push(Seen { place: self.grid.place(c), weight, y });
            }
        }
        out
    }
    /// The cells in the fluid that a piece of wall gives off to, and how much of it: its own, or those before it along the axes a, with weights n_a².
    pub(super) fn before(&self, wall: &WallPiece) -> Vec<([usize; D], f64)> {
        let own = self.grid.cell(wall.cell);
        if self.wet(own) {
            return vec![(own, 1.0)];
        }
        let next = |a: usize| Some((self.beside(own, a, wall.normal[a] > 0.0)?, wall.normal[a].powi(2)));
        let found: Vec<_> = (0..D).filter_map(next).filter(|&(cell, _)| self.wet(cell)).collect();
        let sum: f64 = found.iter().map(|(_, weight)| weight).sum();
        found
            .into_iter()
            .map(|(cell, weight)| (cell, weight / sum))
            .filter(|(_, weight)| *weight > 0.0)
            .collect()
    }
}
