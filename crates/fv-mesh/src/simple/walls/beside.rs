//! What wall functions and gradients see beside walls.
use super::gradients::{Gradients, around};
use super::openings::Openings;
use super::stress::Stresses;
use crate::transport::NEAREST;
use interfaces::WallRow;

/// The cells beside walls: those that a wall cuts and those that share a face with one whose centre is not in the fluid.
#[derive(Default)]
pub(super) struct Beside {
    pub(super) rows: Vec<WallRow>,
    /// The piece of wall of each, and how far from it the cell begins and ends \[m\].
    probes: Vec<(usize, [f64; 2])>,
}

impl Beside {
    pub(super) fn new<const D: usize>(openings: &Openings<D>) -> Self {
        let (grid, s) = (openings.grid, openings.grid.stride());
        let mut new = Self::default();
        for cell in 0..grid.n_cells() {
            let index = grid.place(grid.cell(cell));
            let dry = |o: usize| grid.cell_at(openings.wrap(o)).is_some() && !openings.wet[o];
            let beside = (0..D).any(|a| dry(index - s[a]) || dry(index + s[a]));
            if !openings.wet[index] || !beside && openings.piece(index).is_none() {
                continue;
            }
            let x = grid.centre(grid.cell(cell));
            let height = |o: usize| {
                let (probe, wall) = openings.piece(o)?;
                let y: f64 = (0..D).map(|a| (x[a] - wall.foot[a]) * wall.normal[a]).sum();
                let aside: f64 = (0..D).map(|a| (x[a] - wall.foot[a] - y * wall.normal[a]).powi(2)).sum();
                Some((y, aside, probe, wall))
            };
            // The piece that the centre stands over.
            let seen = around(openings, index).filter_map(height).filter(|seen| seen.0 > 0.0);
            let Some((y, _, probe, wall)) =
                seen.min_by(|a, b| (a.0 * a.0 + a.1).total_cmp(&(b.0 * b.0 + b.1)))
            else {
                continue;
            };
            let extent = openings.extent(index, &wall);
            let y = y.max(NEAREST * extent);
            new.rows.push(WallRow { cell, y, area: wall.area, ..WallRow::default() });
            new.probes.push((probe, [(y - 0.5 * extent).max(0.0), y + 0.5 * extent]));
        }
        new
    }

    /// What the flow is there: the velocity that has the wall's friction by the logarithmic law.
    pub(super) fn fill<const D: usize>(&mut self, stresses: &Stresses<D>, nu: f64) {
        for (row, &(probe, ends)) in self.rows.iter_mut().zip(&self.probes) {
            row.nu = nu;
            row.u_t = stresses.seen(probe, row.y, nu);
            row.friction = Some(stresses.of(probe));
            // Of the whole cell, as from differences over it.
            let [below, above] = ends.map(|y| stresses.seen(probe, y, nu));
            row.shear = Some((above - below) / (ends[1] - ends[0]));
        }
    }
}

/// A node in the solid, and what its velocity would be if the fluid went on: nodes in the fluid, their gradients, and the
/// steps from them.
pub(super) struct Ghost<const D: usize> {
    pub(super) node: usize,
    pub(super) from: Vec<(usize, u32, [f64; D])>,
}

/// Nodes in the solid around nodes in the fluid.
pub(super) fn ghosts<const D: usize>(
    openings: &Openings<D>,
    c: usize,
    nearest: Option<f64>,
    gradients: &mut Gradients<D>,
) -> Vec<Ghost<D>> {
    let grid = openings.grid;
    let nodes = (0..grid.n_cells()).map(|cell| grid.place(grid.cell(cell)));
    let mut out = Vec::new();
    for node in nodes.filter(|&o| !openings.alive(c, o)) {
        let x = openings.node(c, node);
        let from: Vec<_> = around(openings, node)
            .filter(|&o| openings.alive(c, o) && grid.cell_at(openings.wrap(o)).is_some())
            .map(|other| {
                let y = openings.node(c, other);
                let slot = gradients.slot(openings, c, other, nearest);
                (other, slot, std::array::from_fn(|a| x[a] - y[a]))
            })
            .collect();
        if !from.is_empty() {
            out.push(Ghost { node, from });
        }
    }
    out
}
