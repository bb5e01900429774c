//! What walls make of the cells: faces that are not wholly open, cells without a velocity, regions that are cut off.
use crate::CartesianGrid;
use crate::boundary::{Boundaries, FaceKind};
use crate::grid::GHOSTS;
use crate::metrics::Metrics;
use interfaces::CutWalls;
use std::collections::{BTreeMap, HashMap, HashSet};

/// The cells as the pressure equation sees them.
pub(super) struct Regions {
    /// Cells of the fluid with faces that are not wholly open, in order.
    pub(super) cells: Vec<CutCell>,
    /// Cells of which no velocity is computed, in order.
    pub(super) orphans: Vec<Orphan>,
    /// Dense numbers of the cells with closed faces only, in order.
    pub(super) solid: Vec<usize>,
    /// No pressure is given at any side.
    pub(super) floating: bool,
    /// Per component, in the order of its faces that are not wholly open: how the pressure acts on them.
    pub(super) passages: Vec<Vec<Passage>>,
}

/// Action of the pressure on a face that is not wholly open.
#[derive(Clone, Copy)]
pub(super) struct Passage {
    /// Dense numbers of the cells below and above.
    pub(super) cells: [usize; 2],
    /// Open share over the distance of their centres \[1/m\].
    pub(super) weight: f64,
}

/// A cell of the fluid with faces that are not wholly open.
pub(super) struct CutCell {
    /// Its dense number.
    pub(super) cell: usize,
    /// Volume \[m³\].
    pub(super) volume: f64,
    /// Dense numbers of the neighbours behind those faces, and the closed part of A/d over the cell's volume.
    pub(super) closed: Vec<(usize, f64)>,
    /// Sum of A/d of all its faces over that of the open parts.
    pub(super) scale: f64,
    /// Does nothing but itself fix the pressure's level in its region?
    pub(super) floats: bool,
}

/// A cell of which no velocity is computed.
pub(super) struct Orphan {
    /// Its storage index.
    pub(super) cell: usize,
    /// Those of the neighbours it takes its pressure from, with weights.
    pub(super) neighbours: Vec<(usize, f64)>,
}

impl Regions {
    pub(super) fn new<const D: usize>(
        cuts: &CutWalls,
        grid: &CartesianGrid<D>,
        metrics: &Metrics<D>,
        boundaries: &Boundaries<D>,
    ) -> Self {
        let n = grid.cells();
        let mut cut = Vec::new();
        let none = Passage { cells: [0; 2], weight: 0.0 };
        let mut passages: Vec<Vec<Passage>> =
            cuts.components.iter().take(D).map(|component| vec![none; component.faces.len()]).collect();
        for (c, component) in cuts.components.iter().enumerate().take(D) {
            for (number, face) in component.faces.iter().enumerate() {
                let Some(above) = grid.cell_at(face.index) else { continue };
                let mut below = above;
                below[c] = if above[c] == 0 { n[c] - 1 } else { above[c] - 1 };
                let cells = [grid.index(below), grid.index(above)];
                let conductance = metrics.conductance(c, above);
                cut.push(Cut { axis: c, number, cells, open: face.open, conductance });
            }
        }
        let solid = solid_cells(&cut, grid, metrics);
        let orphans = orphans(cuts, grid, metrics, &mut cut);
        for &Cut { axis, number, cells, open, .. } in &cut {
            let above = grid.cell(cells[1])[axis];
            let weight = open * metrics.of(Some(axis), axis).inv_volume[GHOSTS + above];
            passages[axis][number] = Passage { cells, weight };
        }
        cut.retain(|face| face.open < 1.0 && !face.cells.iter().all(|cell| solid.contains(cell)));
        let roots = Roots::new(&cut, &solid, grid, metrics, boundaries);
        // A region that hangs on a closed face sees through it what is behind.
        let mut closed: BTreeMap<usize, Vec<(usize, f64)>> = BTreeMap::new();
        for (f, face) in cut.iter().enumerate() {
            for [cell, neighbour] in [face.cells, [face.cells[1], face.cells[0]]] {
                if !solid.contains(&cell) && roots.hangs.get(&f) != Some(&cell) {
                    closed.entry(cell).or_default().push((neighbour, (1.0 - face.open) * face.conductance));
                }
            }
        }
        let cells = closed.into_iter().map(|(cell, mut closed)| {
            let at = grid.cell(cell);
            let volume = grid.cell_volume(at);
            let whole: f64 =
                inner_faces(at, grid, metrics).map(|(a, above)| metrics.conductance(a, above)).sum();
            let shut: f64 = closed.iter().map(|c| c.1).sum();
            closed.iter_mut().for_each(|c| c.1 /= volume);
            CutCell { cell, volume, closed, scale: whole / (whole - shut), floats: roots.floats(cell) }
        });
        let cells = cells.collect();
        let mut solid: Vec<usize> = solid.into_iter().collect();
        solid.sort_unstable();
        Self { cells, orphans, solid, floating: roots.floating.is_some(), passages }
    }
}

/// A face that is not wholly open.
struct Cut {
    axis: usize,
    /// Its place among the faces of that component.
    number: usize,
    /// Dense numbers of the cells below and above.
    cells: [usize; 2],
    open: f64,
    /// Its area over the distance of the cells' centres.
    conductance: f64,
}

/// The faces of a cell that are no sides of the box: axis and the cell above.
fn inner_faces<const D: usize>(
    cell: [usize; D],
    grid: &CartesianGrid<D>,
    metrics: &Metrics<D>,
) -> impl Iterator<Item = (usize, [usize; D])> {
    let n = grid.cells();
    let periodic: [bool; D] = std::array::from_fn(|a| metrics.periodic[a]);
    (0..D).flat_map(move |a| {
        let mut above = cell;
        above[a] = (cell[a] + 1) % n[a];
        let lower = (periodic[a] || cell[a] > 0).then_some((a, cell));
        let upper = (periodic[a] || cell[a] + 1 < n[a]).then_some((a, above));
        lower.into_iter().chain(upper)
    })
}

/// The cells of which every face is closed.
fn solid_cells<const D: usize>(cut: &[Cut], grid: &CartesianGrid<D>, metrics: &Metrics<D>) -> HashSet<usize> {
    let mut closed: HashMap<usize, usize> = HashMap::new();
    for cell in cut.iter().filter(|face| face.open == 0.0).flat_map(|face| face.cells) {
        *closed.entry(cell).or_default() += 1;
    }
    let all = |cell: usize| inner_faces(grid.cell(cell), grid, metrics).count();
    closed.into_iter().filter(|&(cell, count)| count == all(cell)).map(|(cell, _)| cell).collect()
}

/// The cells with no velocity node in the fluid, and where their pressure comes from. What passes through them passes on to
/// neighbours in the same step, however narrow their openings are: those are widened until the widest of a cell is a whole face.
fn orphans<const D: usize>(
    cuts: &CutWalls,
    grid: &CartesianGrid<D>,
    metrics: &Metrics<D>,
    cut: &mut [Cut],
) -> Vec<Orphan> {
    let solid: [HashSet<usize>; D] =
        std::array::from_fn(|c| cuts.components[c].solid.iter().map(|point| point.index).collect());
    let n = grid.cells();
    let place = |index: usize| grid.place(grid.cell(index));
    let orphan = |index: usize| {
        let cell = grid.cell(index);
        (0..D).all(|a| {
            let mut above = cell;
            above[a] = (cell[a] + 1) % n[a];
            let side = |end: usize| !metrics.periodic[a] && cell[a] == end;
            (side(0) || solid[a].contains(&grid.place(cell)))
                && (side(n[a] - 1) || solid[a].contains(&grid.place(above)))
        })
    };
    let mut sources: BTreeMap<usize, Vec<(usize, f64)>> = BTreeMap::new();
    for face in cut.iter().filter(|face| face.open > 0.0) {
        for [cell, neighbour] in [face.cells, [face.cells[1], face.cells[0]]] {
            if orphan(cell) {
                sources.entry(cell).or_default().push((place(neighbour), face.open * face.conductance));
            }
        }
    }
    let mut widest: HashMap<usize, f64> = HashMap::new();
    for face in cut.iter() {
        for cell in face.cells.iter().filter(|cell| sources.contains_key(cell)) {
            let widest = widest.entry(*cell).or_default();
            *widest = widest.max(face.open);
        }
    }
    for face in cut.iter_mut() {
        let factor = |cell: &usize| widest.get(cell).map_or(1.0, |widest| 1.0 / widest);
        face.open *= face.cells.iter().map(factor).fold(1.0, f64::max);
    }
    let mean = |(cell, mut neighbours): (usize, Vec<(usize, f64)>)| {
        let sum: f64 = neighbours.iter().map(|n| n.1).sum();
        neighbours.iter_mut().for_each(|n| n.1 /= sum);
        Orphan { cell: place(cell), neighbours }
    };
    sources.into_iter().map(mean).collect()
}

/// What fixes the level of the pressure in each region that the walls separate: given pressures, or the neighbour behind one closed
/// face, through which nothing flows as long as what enters the region leaves it. Where no pressure is given at all, the largest
/// region of the fluid is on its own.
struct Roots {
    regions: Sets,
    /// Faces that regions hang on: their number, and the cell of that region.
    hangs: HashMap<usize, usize>,
    /// The region on its own.
    floating: Option<usize>,
}

impl Roots {
    fn new<const D: usize>(
        cut: &[Cut],
        solid: &HashSet<usize>,
        grid: &CartesianGrid<D>,
        metrics: &Metrics<D>,
        boundaries: &Boundaries<D>,
    ) -> Self {
        let mut regions = Sets((0..grid.n_cells()).collect());
        let closed: HashSet<(usize, usize)> =
            cut.iter().filter(|face| face.open == 0.0).map(|face| (face.axis, face.cells[1])).collect();
        for above in 0..grid.n_cells() {
            let cell = grid.cell(above);
            for (a, _) in inner_faces(cell, grid, metrics).filter(|face| face.1 == cell) {
                let mut below = cell;
                below[a] = if cell[a] == 0 { grid.cells()[a] - 1 } else { cell[a] - 1 };
                if !closed.contains(&(a, above)) {
                    regions.join(grid.index(below), above);
                }
            }
        }
        let mut reached: Vec<usize> =
            given_pressures(grid, boundaries).into_iter().map(|cell| regions.find(cell)).collect();
        reached.sort_unstable();
        reached.dedup();
        let mut floating = None;
        if reached.is_empty() {
            let mut sizes: BTreeMap<usize, usize> = BTreeMap::new();
            for cell in (0..grid.n_cells()).filter(|cell| !solid.contains(cell)) {
                *sizes.entry(regions.find(cell)).or_default() += 1;
            }
            floating = sizes.into_iter().max_by_key(|region| region.1).map(|region| region.0);
            reached.extend(floating);
        }
        // From region to region through closed faces.
        let mut doors: HashMap<usize, Vec<(usize, [usize; 2])>> = HashMap::new();
        for (f, face) in cut.iter().enumerate().filter(|(_, face)| face.open == 0.0) {
            for cells in [face.cells, [face.cells[1], face.cells[0]]] {
                doors.entry(regions.find(cells[0])).or_default().push((f, cells));
            }
        }
        let mut seen: HashSet<usize> = reached.iter().copied().collect();
        let mut hangs = HashMap::new();
        while let Some(region) = reached.pop() {
            for &(f, [_, behind]) in doors.get(&region).into_iter().flatten() {
                let other = regions.find(behind);
                if seen.insert(other) {
                    reached.push(other);
                    if !solid.contains(&behind) {
                        hangs.insert(f, behind);
                    }
                }
            }
        }
        // What is asked later is answered at once.
        (0..grid.n_cells()).for_each(|cell| regions.0[cell] = regions.find(cell));
        Self { regions, hangs, floating }
    }

    fn floats(&self, cell: usize) -> bool {
        self.floating == Some(self.regions.0[cell])
    }
}

/// The cells beside given pressures.
fn given_pressures<const D: usize>(grid: &CartesianGrid<D>, boundaries: &Boundaries<D>) -> Vec<usize> {
    let n = grid.cells();
    let mut cells = Vec::new();
    for (a, [lower, upper]) in (0..D).filter_map(|a| Some((a, boundaries.kinds(a)?))) {
        for (end, kinds) in [(0, lower), (n[a] - 1, upper)] {
            let beside = (0..grid.n_cells()).filter(|&cell| grid.cell(cell)[a] == end);
            cells.extend(
                beside.zip(kinds).filter(|(_, kind)| *kind == FaceKind::Pressure).map(|(cell, _)| cell),
            );
        }
    }
    cells
}

/// Disjoint sets of cells.
struct Sets(Vec<usize>);

impl Sets {
    fn find(&mut self, mut i: usize) -> usize {
        while self.0[i] != i {
            self.0[i] = self.0[self.0[i]];
            i = self.0[i];
        }
        i
    }
    /// Makes one set of two; were they two?
    fn join(&mut self, a: usize, b: usize) -> bool {
        let (a, b) = (self.find(a), self.find(b));
        self.0[a.max(b)] = a.min(b);
        a != b
    }
}
