//! Which piece of wall is nearest.
use super::gradients::around;
use super::openings::Openings;
use std::collections::HashMap;

/// The nearest piece of wall of cells near walls, by their dense numbers.
pub(super) type Pieces = HashMap<usize, usize>;

/// Of the cells at most so many `steps` from one that a wall cuts, handed on from cell to cell until none is nearer; where two are as near within 2 % it may be the other one.
pub(super) fn nearest_pieces<const D: usize>(openings: &Openings<D>, steps: usize) -> Pieces {
    let grid = openings.grid;
    let away = |cell: usize, piece: usize| away(openings, grid.centre(grid.cell(cell)), piece);
    let mut found: HashMap<usize, (usize, f64)> = HashMap::new();
    let mut front: Vec<usize> = openings.walls.iter().map(|wall| wall.cell).collect();
    for (piece, &cell) in front.iter().enumerate() {
        found.insert(cell, (piece, away(cell, piece)));
    }
    let mut step = 0;
    while !front.is_empty() {
        step += 1;
        let mut next = Vec::new();
        for cell in front {
            let (piece, _) = found[&cell];
            for o in around(openings, grid.place(grid.cell(cell))) {
                let Some(other) = grid.cell_at(openings.wrap(o)).map(|at| grid.index(at)) else { continue };
                let here = (piece, away(other, piece));
                if found.get(&other).map_or(step <= steps, |known| here.1 < known.1) {
                    found.insert(other, here);
                    next.push(other);
                }
            }
        }
        next.sort_unstable();
        next.dedup();
        front = next;
    }
    found.into_iter().map(|(cell, (piece, _))| (cell, piece)).collect()
}

/// Square of the distance of a place from the middle of a piece of wall \[m²\], around the ends of periodic axes.
pub(super) fn away<const D: usize>(openings: &Openings<D>, x: [f64; D], piece: usize) -> f64 {
    let foot = openings.walls[piece].foot;
    (0..D)
        .map(|a| {
            let (way, length) = (x[a] - foot[a], openings.grid.axis(a).length());
            let turns = if openings.metrics.periodic[a] { (way / length).round() } else { 0.0 };
            (way - turns * length).powi(2)
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CartesianGrid;
    use crate::metrics::Metrics;
    use interfaces::{CutCells, Point, Vector, WallPiece};
    use std::collections::HashSet;

    /// Walls across the grid that go on beyond the end of a periodic axis.
    #[test]
    fn pieces_handed_on_are_as_near_as_any_around_periodic_ends() {
        let grid = CartesianGrid::<2>::new([24, 24], [2.4, 2.4]).unwrap();
        let metrics = Metrics::new(&grid, [true, false]);
        // y = 1.2 + 0.3 sin(2π x/2.4).
        let turn = std::f64::consts::TAU / 2.4;
        let walls = (0..24_u32).map(|i| {
            let x = 0.1 * f64::from(i) + 0.03;
            let y = 1.2 + 0.3 * (turn * x).sin();
            let cell = grid.index([i as usize, (y / 0.1) as usize]);
            WallPiece {
                cell,
                body: 0,
                area: 0.1,
                normal: Vector::y(),
                foot: Point::new(x, y, 0.0),
                arm: Vector::zeros(),
                velocity: Vector::zeros(),
            }
        });
        let cuts = CutCells { walls: walls.collect(), ..CutCells::default() };
        let openings = Openings::new(&cuts, &grid, &metrics, &HashSet::new(), true).unwrap();
        let found = nearest_pieces(&openings, 4);
        assert!(found.len() > 24 * 8, "{}", found.len());
        for (&cell, &piece) in &found {
            let away = |piece| away(&openings, grid.centre(grid.cell(cell)), piece);
            let least = (0..cuts.walls.len()).map(away).fold(f64::INFINITY, f64::min);
            let (found, least) = (away(piece).sqrt(), least.sqrt());
            assert!(found <= 1.02 * least, "{:?}: {found} {least}", grid.cell(cell));
        }
        // Below the wall that rises there the first column's nearest piece is the last one.
        assert!(found.iter().any(|(&cell, &piece)| grid.cell(cell)[0] == 0 && piece == 23));
    }
}
