//! What walls make of the cells: faces that are not wholly open, cells without a velocity, regions that are cut off.
use crate::CartesianGrid;
use crate::grid::GHOSTS;
use crate::metrics::Metrics;
use interfaces::CutWalls;
use std::collections::{BTreeMap, HashMap, HashSet};

/// The cells as the pressure equation sees them.
pub(super) struct Regions {
    /// Faces that are not wholly open, but for those inside the solid.
    pub(super) cut: Vec<Cut>,
    /// Cells of which no velocity is computed, in order.
    pub(super) orphans: Vec<Orphan>,
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
    ) -> Self {
        let n = grid.cells();
        let mut cut = Vec::new();
        // Closed faces of every cell.
        let mut closed = vec![0; grid.n_cells()];
        for (c, component) in cuts.components.iter().enumerate().take(D) {
            for face in &component.faces {
                let Some(above) = grid.cell_at(face.index) else { continue };
                let mut below = above;
                below[c] = if above[c] == 0 { n[c] - 1 } else { above[c] - 1 };
                let area: f64 =
                    (0..D).filter(|&a| a != c).map(|a| metrics.axes[a].width[GHOSTS + above[a]]).product();
                let cells = [grid.index(below), grid.index(above)];
                if face.open == 0.0 {
                    cells.iter().for_each(|&cell| closed[cell] += 1);
                }
                cut.push(Cut {
                    axis: c,
                    cells,
                    open: face.open,
                    conductance: area / metrics.axes[c].faces.volume[GHOSTS + above[c]],
                });
            }
        }
        let inner_faces = |index: usize| -> usize {
            let cell = grid.cell(index);
            let sides = |a: usize| usize::from(cell[a] == 0) + usize::from(cell[a] + 1 == n[a]);
            (0..D).map(|a| 2 - if metrics.periodic[a] { 0 } else { sides(a) }).sum()
        };
        let solid = |index: usize| closed[index] > 0 && closed[index] == inner_faces(index);
        let orphans = orphans(cuts, grid, metrics, &mut cut);
        cut.retain(|face| !face.cells.iter().all(|&cell| solid(cell)));
        hang_regions(&mut cut, grid, metrics);
        Self { cut, orphans }
    }
}

/// A face that is not wholly open.
pub(super) struct Cut {
    axis: usize,
    /// Dense numbers of the cells below and above.
    pub(super) cells: [usize; 2],
    pub(super) open: f64,
    /// Its area over the distance of the cells' centres.
    pub(super) conductance: f64,
}

/// The cells with no velocity node in the fluid, and where their pressure comes from. What passes through them passes on to
/// neighbours in the same step, however narrow their openings are: those are widened until the widest of a cell is a whole face.
fn orphans<const D: usize>(
    cuts: &CutWalls,
    grid: &CartesianGrid<D>,
    metrics: &Metrics<D>,
    cut: &mut Vec<Cut>,
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
    cut.retain(|face| face.open < 1.0);
    let mean = |(cell, mut neighbours): (usize, Vec<(usize, f64)>)| {
        let sum: f64 = neighbours.iter().map(|n| n.1).sum();
        neighbours.iter_mut().for_each(|n| n.1 /= sum);
        Orphan { cell: place(cell), neighbours }
    };
    sources.into_iter().map(mean).collect()
}

/// Opens one closed face per region that the walls separate from the rest.
fn hang_regions<const D: usize>(cut: &mut Vec<Cut>, grid: &CartesianGrid<D>, metrics: &Metrics<D>) {
    let n = grid.cells();
    let mut regions = Sets((0..grid.n_cells()).collect());
    let closed: HashSet<(usize, usize)> =
        cut.iter().filter(|face| face.open == 0.0).map(|face| (face.axis, face.cells[1])).collect();
    for above in 0..grid.n_cells() {
        let cell = grid.cell(above);
        for a in 0..D {
            let mut below = cell;
            below[a] = match (cell[a], metrics.periodic[a]) {
                (0, false) => continue,
                (0, true) => n[a] - 1,
                (i, _) => i - 1,
            };
            if !closed.contains(&(a, above)) {
                regions.join(grid.index(below), above);
            }
        }
    }
    cut.retain(|face| face.open > 0.0 || !regions.join(face.cells[0], face.cells[1]));
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
