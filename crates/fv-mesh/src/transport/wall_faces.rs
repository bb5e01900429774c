//! The walls of the box as turbulence models see them.
use super::sides::part_at;
use crate::boundary::Lines;
use crate::eddy_stress::{EddyStress, Friction, OnWall};
use crate::grid::GHOSTS;
use crate::metrics::Metrics;
use crate::{CartesianGrid, Side, Sides, Velocity, VelocityFunction};
use interfaces::{Vector, WallRow};

/// The faces of walls: a row for each, and the velocity nodes that its friction acts on.
#[derive(Clone, Debug)]
pub(crate) struct WallFaces<const D: usize> {
    rows: Vec<WallRow>,
    faces: Vec<WallFace>,
    nodes: [Vec<WallNode>; D],
    /// Number and centre of the faces of moving walls, and the wall's velocity.
    moving: Vec<(usize, [f64; 3], VelocityFunction)>,
    stride: [usize; D],
}

#[derive(Clone, Copy, Debug)]
struct WallFace {
    axis: usize,
    /// Lower (0) or upper side, and the number of the line that ends there.
    end: usize,
    line: usize,
    /// Storage index of the cell before it, and of the ghost behind it.
    inside: usize,
    ghost: usize,
    /// Storage index of the next cell, and its part in the velocity on the face between; `None` if there is none.
    next: Option<(usize, f64)>,
    /// Velocity of the wall \[m/s\].
    velocity: [f64; 3],
}

#[derive(Clone, Copy, Debug)]
struct WallNode {
    row: usize,
    /// Number of the dense cell of the node, and its storage index.
    cell: usize,
    place: usize,
    /// Area that is the node's over its volume \[1/m\].
    share: f64,
}

impl<const D: usize> WallFaces<D> {
    pub(crate) fn new(grid: &CartesianGrid<D>, metrics: &Metrics<D>, sides: &Sides<D>) -> Self {
        let mut new = Self {
            rows: Vec::new(),
            faces: Vec::new(),
            nodes: std::array::from_fn(|_| Vec::new()),
            moving: Vec::new(),
            stride: grid.stride(),
        };
        for axis in (0..D).filter(|&a| !sides.periodic(a)) {
            let lines = Lines::new(grid, axis);
            let ends = [grid.axis(axis).lower(), grid.axis(axis).upper()];
            for (upper, at) in ends.into_iter().enumerate() {
                for (l, o) in lines.starts().enumerate().filter(|&(l, _)| lines.inside(l)) {
                    let x = lines.face_centre(grid, at, l);
                    let part = part_at::<D>(&sides.of(axis)[upper], axis, x);
                    let Some((part, velocity)) = part.and_then(|p| Some((p, p.wall_velocity(x, 0.0)?)))
                    else {
                        continue;
                    };
                    if let Side::MovingWall(u) = part {
                        new.moving.push((new.faces.len(), x, u.clone()));
                    }
                    let cell = lines.end_cell(grid, l, upper == 1);
                    let (inside, ghost) = lines.ends(o, upper);
                    let (first, second) =
                        if upper == 1 { (lines.cells - 1, lines.cells.wrapping_sub(2)) } else { (0, 1) };
                    let width = |i| grid.axis(axis).width(i);
                    let (y, share) = (0.5 * width(first), width(first));
                    let next = (lines.cells > 1).then(|| {
                        let place = if upper == 1 { inside - lines.step } else { inside + lines.step };
                        (place, share / (share + width(second)))
                    });
                    let area = lines.face_area(metrics, l);
                    new.rows.push(WallRow { cell, y, area, ..WallRow::default() });
                    new.faces.push(WallFace { axis, end: upper, line: l, inside, ghost, next, velocity });
                    new.add_nodes(grid, metrics, axis, cell);
                }
            }
        }
        new
    }

    /// The nodes beside the last row, whose cell is `cell`.
    fn add_nodes(&mut self, grid: &CartesianGrid<D>, metrics: &Metrics<D>, axis: usize, cell: usize) {
        let (row, n, at) = (self.rows.len() - 1, grid.cells(), grid.cell(cell));
        for c in (0..D).filter(|&c| c != axis) {
            for upper in 0..2 {
                let mut node = at;
                node[c] += upper;
                match (metrics.periodic[c], node[c]) {
                    (true, i) => node[c] = i % n[c],
                    // Those on the sides of the box are given.
                    (false, i) if i == 0 || i == n[c] => continue,
                    _ => {}
                }
                let volume: f64 = (0..D).map(|b| metrics.of(Some(c), b).volume[GHOSTS + node[b]]).product();
                let share = 0.5 * self.rows[row].area / volume;
                let (cell, place) = (grid.index(node), grid.place(node));
                self.nodes[c].push(WallNode { row, cell, place, share });
            }
        }
    }

    pub(crate) fn rows(&self) -> &[WallRow] {
        &self.rows
    }

    /// Sets the velocities of moving walls to those at `time` \[s\].
    pub(crate) fn move_to(&mut self, time: f64) {
        for (face, x, velocity) in &self.moving {
            self.faces[*face].velocity = velocity.at(*x, time);
        }
    }

    /// Fills the rows with what the flow is at the cells.
    pub(crate) fn fill(&mut self, velocity: &Velocity<D>, k: Option<&[f64]>, nu: f64) -> &[WallRow] {
        let u = velocity.components.each_ref().map(|u| u.data());
        for (row, face) in self.rows.iter_mut().zip(&self.faces) {
            let along = |place: usize| {
                let mut along = Vector::zeros();
                for c in (0..D).filter(|&c| c != face.axis) {
                    along[c] = 0.5 * (u[c][place] + u[c][place + self.stride[c]]) - face.velocity[c];
                }
                along
            };
            let here = along(face.inside);
            (row.u_t, row.nu) = (here.norm(), nu);
            row.shear = face
                .next
                .map(|(place, share)| (here * (1.0 - share) + along(place) * share).norm() / (2.0 * row.y));
            row.k = k.map_or(0.0, |k| k[row.cell]);
            row.tangent = here.try_normalize(0.0).unwrap_or_default();
        }
        &self.rows
    }

    /// Friction (ν + ν_t) u_t/y of every row, with ν_t = `on_walls`, instead of what else goes through the walls. Ghosts behind
    /// the walls of periodic axes are left to be filled.
    pub(crate) fn rub(&self, on_walls: &[f64], viscosity: f64, stress: &mut EddyStress<D>) {
        let eddy = stress.eddy.data_mut();
        for face in &self.faces {
            eddy[face.ghost] = -2.0 * viscosity - eddy[face.inside];
        }
        stress.walls.clear();
        stress.walls.extend(self.faces.iter().zip(on_walls).map(|(face, &eddy)| {
            let WallFace { axis, end, line, inside, ghost, .. } = *face;
            OnWall { axis, end, line, inside, ghost, eddy }
        }));
        for (c, friction) in stress.friction.iter_mut().enumerate() {
            friction.clear();
            friction.extend(self.nodes[c].iter().map(|node| Friction {
                cell: node.cell,
                place: node.place,
                rate: node.share * (viscosity + on_walls[node.row]) / self.rows[node.row].y,
                wall: self.faces[node.row].velocity[c],
            }));
        }
    }
}
