//! A scalar beside walls at rest inside the box, in steady flow.
use super::Scalar;
use super::thermal_law::ThermalLaw;
use crate::grid::GHOSTS;
use crate::linear::StencilMatrix;
use crate::{CartesianGrid, FlowError, Velocity};
use interfaces::{CutCells, LawOfTheWall, WallPiece};
use std::collections::HashMap;

/// From where walls see φ, and the least distance of a centre from its wall, in extents of the cell along the normal.
const DISTANCE: f64 = 0.5;
const NEAREST: f64 = 0.1;

/// What walls leave of the cells, and what they give off.
#[derive(Clone, Debug)]
pub(super) struct Walls<const D: usize> {
    /// Faces that are cut: where their velocity is stored, and how much of them is open.
    open: [Vec<(usize, f64)>; D],
    shut: Vec<Shut>,
    films: Vec<Film>,
    /// Cells in the fluid that touch a shut face, and their storage indices.
    beside: Vec<(usize, usize)>,
    dry: Vec<Dry>,
    /// φ on the walls.
    value: f64,
    law: Option<ThermalLaw>,
}

/// The shut part of a face of a cell in the fluid.
#[derive(Clone, Copy, Debug)]
struct Shut {
    /// Number and storage index of the cell.
    cell: usize,
    place: usize,
    axis: usize,
    upper: bool,
    share: f64,
    /// Is it on a side of the box, whose equation is another?
    side: bool,
}

/// A piece of wall, the cell in the fluid that it gives off to, and from where it sees φ.
#[derive(Clone, Debug)]
struct Film {
    cell: usize,
    /// Area over the cell's volume \[1/m\], and that volume \[m³\].
    area: f64,
    volume: f64,
    /// Cells around the place that is seen: number, storage index, weight, distance from the wall \[m\].
    seen: Vec<Seen>,
    /// What passes over Σ w (φ_w − φ) \[1/s\].
    rate: f64,
}

#[derive(Clone, Copy, Debug)]
struct Seen {
    cell: usize,
    place: usize,
    weight: f64,
    y: f64,
}

impl Film {
    /// Σ w (φ_w − φ).
    fn drop(&self, value: f64, phi: &[f64]) -> f64 {
        self.seen.iter().map(|seen| seen.weight * (value - phi[seen.place])).sum()
    }
}

/// A cell without fluid at its centre, and those with, beside it.
#[derive(Clone, Debug)]
struct Dry {
    place: usize,
    from: Vec<usize>,
}

/// Where the walls are on a grid.
struct Geometry<'a, const D: usize> {
    grid: &'a CartesianGrid<D>,
    periodic: [bool; D],
    open: [HashMap<usize, f64>; D],
    pieces: HashMap<usize, &'a WallPiece>,
}

impl<const D: usize> Geometry<'_, D> {
    /// The cell below or above this one along `axis`, if there is one.
    fn beside(&self, mut cell: [usize; D], axis: usize, upper: bool) -> Option<[usize; D]> {
        let n = self.grid.cells()[axis];
        cell[axis] = match (cell[axis], upper) {
            (i, true) if i + 1 < n => i + 1,
            (i, false) if i > 0 => i - 1,
            (_, true) if self.periodic[axis] => 0,
            (_, false) if self.periodic[axis] => n - 1,
            _ => return None,
        };
        Some(cell)
    }
    /// How much of a face of the cell is open.
    fn open(&self, cell: [usize; D], axis: usize, upper: bool) -> f64 {
        let place = match self.beside(cell, axis, true) {
            Some(next) if upper => self.grid.place(next),
            _ => self.grid.place(cell) + if upper { self.grid.stride()[axis] } else { 0 },
        };
        self.open[axis].get(&place).copied().unwrap_or(1.0)
    }
    /// A difference along an axis, of the nearest image where it is periodic \[m\].
    fn nearest(&self, axis: usize, d: f64) -> f64 {
        let length = self.grid.axis(axis).length();
        if self.periodic[axis] { d - length * (d / length).round() } else { d }
    }
    /// How far the centre is from the wall in the cell `at`, along that wall's normal \[m\]; periodic images count.
    fn height(&self, cell: [usize; D], wall: &WallPiece) -> f64 {
        let x = self.grid.centre(cell);
        (0..D).map(|a| self.nearest(a, x[a] - wall.foot[a]) * wall.normal[a]).sum()
    }
    /// Is the centre in the fluid?
    fn wet(&self, cell: [usize; D]) -> bool {
        let opens = (0..D).any(|a| [false, true].into_iter().any(|upper| self.open(cell, a, upper) > 0.0));
        let wall = self.pieces.get(&self.grid.index(cell));
        opens && wall.is_none_or(|wall| self.height(cell, wall) > 0.0)
    }
    /// The cells in the fluid around the place that a piece of wall, whose own or next cell in the fluid is `before`, sees, with weights of linear interpolation.
    fn seen(&self, wall: &WallPiece, extent: f64, before: [usize; D]) -> Vec<Seen> {
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
                out.push(Seen { cell: self.grid.index(c), place: self.grid.place(c), weight, y });
            }
        }
        out
    }
    /// The cell in the fluid that a piece of wall gives off to: its own, or the one before it.
    fn before(&self, wall: &WallPiece) -> Option<[usize; D]> {
        let own = self.grid.cell(wall.cell);
        let mut axes: Vec<usize> = (0..D).collect();
        axes.sort_by(|&a, &b| wall.normal[b].abs().total_cmp(&wall.normal[a].abs()));
        let nexts = axes.iter().filter_map(|&a| self.beside(own, a, wall.normal[a] > 0.0));
        std::iter::once(own).chain(nexts).find(|&cell| self.wet(cell))
    }
}

impl<const D: usize> Scalar<D> {
    /// Puts walls at rest, on which φ is `value`, into the steady equations ([`settle`](Self::settle), [`approach`](Self::approach)), or takes them out:
    /// nothing is carried or conducted through what they shut, and each gives off
    ///
    /// ```text
    /// Γ (φ_w − φ)/y   or, where turbulence is modelled,   u_τ (φ_w − φ)/T+(u_τ y/ν),   u_τ = C_μ^¼ √k
    /// ```
    ///
    /// per area to the cell before it; φ is that half a cell before the wall, as on sides of the box, if it has the profile of the law, and T+ as in
    /// [`mix`](Self::mix); k comes from [`rub`](Self::rub).
    ///
    /// # Errors
    /// [`FlowError::Parameter`] for walls on another grid.
    pub fn set_walls(&mut self, walls: Option<(&CutCells, f64)>) -> Result<(), FlowError> {
        self.walls = None;
        let Some((cuts, value)) = walls else { return Ok(()) };
        let grid = &self.grid;
        let beyond = cuts.faces.iter().flatten().map(|face| face.index).find(|i| *i >= grid.storage());
        let beyond = beyond.or(cuts.walls.iter().map(|wall| wall.cell).find(|cell| *cell >= grid.n_cells()));
        if let Some(index) = beyond {
            let range = "an index on the scalar's grid: make the walls from the velocity that carries it";
            return Err(FlowError::Parameter {
                name: "an index of immersed walls",
                value: index as f64,
                range,
            });
        }
        let geometry = Geometry {
            grid,
            periodic: self.boundaries.periodic(),
            open: std::array::from_fn(|a| cuts.faces[a].iter().map(|face| (face.index, face.open)).collect()),
            pieces: cuts.walls.iter().map(|wall| (wall.cell, wall)).collect(),
        };
        let mut made = Walls {
            open: std::array::from_fn(|a| cuts.faces[a].iter().map(|face| (face.index, face.open)).collect()),
            shut: Vec::new(),
            films: Vec::new(),
            beside: Vec::new(),
            dry: Vec::new(),
            value,
            law: None,
        };
        for a in (0..D).filter(|&a| geometry.periodic[a]) {
            // The same faces at the other end.
            let [n, s] = [grid.cells()[a], grid.stride()[a]];
            let first = made.open[a].clone().into_iter();
            made.open[a].extend(
                first
                    .filter(|&(o, _)| grid.cell_at(o).is_some_and(|cell| cell[a] == 0))
                    .map(|(o, open)| (o + n * s, open)),
            );
        }
        let wet: Vec<bool> = (0..grid.n_cells()).map(|i| geometry.wet(grid.cell(i))).collect();
        for number in 0..grid.n_cells() {
            let (cell, place) = (grid.cell(number), grid.place(grid.cell(number)));
            let faces = || (0..D).flat_map(|a| [(a, false), (a, true)]);
            let next = |(a, upper)| geometry.beside(cell, a, upper);
            if !wet[number] {
                let open = faces().filter(|&(a, upper)| geometry.open(cell, a, upper) > 0.0);
                let from = open.filter_map(next).filter(|&c| wet[grid.index(c)]).map(|c| grid.place(c));
                made.dry.push(Dry { place, from: from.collect() });
                continue;
            }
            let before = made.shut.len();
            for (axis, upper) in faces() {
                let other = next((axis, upper));
                let dry = other.is_some_and(|c| !wet[grid.index(c)]);
                let share = if dry { 1.0 } else { 1.0 - geometry.open(cell, axis, upper) };
                if share > 0.0 {
                    made.shut.push(Shut { cell: number, place, axis, upper, share, side: other.is_none() });
                }
            }
            if made.shut.len() > before {
                made.beside.push((number, place));
            }
        }
        for wall in &cuts.walls {
            let Some(cell) = geometry.before(wall) else { continue };
            let width = |a: usize| self.metrics.axes[a].width[GHOSTS + cell[a]];
            let extent: f64 = (0..D).map(|a| wall.normal[a].abs() * width(a)).sum();
            let volume: f64 = (0..D).map(width).product();
            let seen = geometry.seen(wall, extent, cell);
            let (cell, area) = (grid.index(cell), wall.area / volume);
            let far: f64 = seen.iter().map(|seen| seen.weight * seen.y).sum();
            let rate = if far > 0.0 { area * self.diffusivity / far } else { 0.0 };
            made.films.push(Film { cell, area, volume, seen, rate });
        }
        self.walls = Some(Box::new(made));
        Ok(())
    }

    /// Tells the walls of k \[m²/s²\] in every cell, x fastest, in a fluid of this viscosity \[m²/s\]: what they give off is then that of the law of the wall.
    pub fn rub(&mut self, k: &[f64], viscosity: f64) {
        let Some(walls) = self.walls.as_deref_mut().filter(|_| viscosity > 0.0) else { return };
        let prandtl = viscosity / self.diffusivity;
        let law = walls.law.get_or_insert_with(|| ThermalLaw::new(prandtl, self.turbulent_prandtl));
        for film in &mut walls.films {
            let sum =
                |of: &dyn Fn(&Seen) -> f64| film.seen.iter().map(|seen| seen.weight * of(seen)).sum::<f64>();
            let energy = sum(&|seen| k.get(seen.cell).copied().unwrap_or(0.0)) / sum(&|_| 1.0);
            let speed = LawOfTheWall::friction_velocity(energy) / viscosity;
            // y over the conductivity that the law has up to there.
            let resistance = sum(&|seen| {
                let plus = speed * seen.y;
                let ratio = if plus > 0.0 { plus / LawOfTheWall::USUAL.u_plus(plus) } else { 1.0 };
                seen.y / (viscosity * law.ratio(ratio))
            });
            film.rate = if resistance.is_finite() && resistance > 0.0 { film.area / resistance } else { 0.0 };
        }
    }

    /// What the walls of [`set_walls`](Self::set_walls) give off in all \[φ m³/s; plane φ m²/s\], if there are any.
    pub fn given_off(&self) -> Option<f64> {
        let of = |walls: &Walls<D>| -> f64 {
            let from = |film: &Film| film.rate * film.volume * film.drop(walls.value, self.phi.data());
            walls.films.iter().map(from).sum()
        };
        self.walls.as_deref().map(of)
    }

    /// The velocity as means over whole faces, if walls shut parts of them.
    pub(super) fn through(&self, velocity: &Velocity<D>) -> Option<Velocity<D>> {
        let walls = self.walls.as_deref()?;
        let mut shown = velocity.clone();
        for (u, open) in shown.components.iter_mut().zip(&walls.open) {
            open.iter().for_each(|&(o, open)| u.data_mut()[o] *= open);
        }
        Some(shown)
    }

    /// Storage indices of the cells in walls.
    pub(super) fn dry(&self) -> impl Iterator<Item = usize> + use<'_, D> {
        self.walls.iter().flat_map(|walls| walls.dry.iter().map(|dry| dry.place))
    }

    /// Cells in walls go along with those beside them, so that what passes through their open corners brings nothing.
    pub(super) fn wet_through(&mut self) {
        let Some(walls) = self.walls.as_deref() else { return };
        let phi = self.phi.data_mut();
        for Dry { place, from } in &walls.dry {
            let sum: f64 = from.iter().map(|&o| phi[o]).sum();
            phi[*place] = if from.is_empty() { walls.value } else { sum / from.len() as f64 };
        }
        self.boundaries.fill_ghosts(&mut self.phi);
    }

    /// (Γ + D_t) over the squared spacing at a face of a cell, times the share that is shut \[1/s\].
    fn conductance(&self, &Shut { cell, place, axis, upper, share, .. }: &Shut) -> f64 {
        let (nodes, q) = (&self.metrics.axes[axis].centres, GHOSTS + self.grid.cell(cell)[axis]);
        let stride = self.grid.stride()[axis];
        let eddies =
            self.mixing.as_ref().map_or([0.0; 2], |m| m.on_faces(&self.metrics, axis, stride, place, q));
        let metric = if upper { nodes.up[q] } else { nodes.down[q] };
        share * metric * (self.diffusivity + eddies[usize::from(upper)])
    }

    /// Takes what does not pass out of the balance of the cells beside walls, and puts in what walls give off.
    pub(super) fn shut(&self, velocity: &Velocity<D>, rest: &mut [f64]) {
        let Some(walls) = self.walls.as_deref() else { return };
        let (phi, s) = (self.phi.data(), self.grid.stride());
        for shut in &walls.shut {
            let step = s[shut.axis];
            let other = if shut.upper { shut.place + step } else { shut.place - step };
            rest[shut.cell] -= self.conductance(shut) * (phi[other] - phi[shut.place]);
        }
        for &(cell, o) in &walls.beside {
            let at = self.grid.cell(cell);
            let leaves = |a: usize| {
                let u = velocity.components[a].data();
                self.metrics.axes[a].centres.inv_volume[GHOSTS + at[a]] * (u[o + s[a]] - u[o])
            };
            // Outlets pass what they pass.
            rest[cell] += phi[o] * (0..D).map(leaves).sum::<f64>();
        }
        for film in &walls.films {
            rest[film.cell] += film.rate * film.drop(walls.value, phi);
        }
    }

    /// The same of the matrix.
    pub(super) fn shut_matrix(&self, matrix: &mut StencilMatrix<D>) {
        let Some(walls) = self.walls.as_deref() else { return };
        let (centre, lower, upper) = matrix.parts_mut();
        let sides = [lower, upper];
        for shut in walls.shut.iter().filter(|shut| !shut.side) {
            let kept = self.conductance(shut);
            sides[usize::from(shut.upper)][shut.axis][shut.cell] += kept;
            centre[shut.cell] -= kept;
        }
        for film in &walls.films {
            centre[film.cell] += film.rate;
        }
    }
}
