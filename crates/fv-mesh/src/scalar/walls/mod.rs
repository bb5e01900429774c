//! A scalar beside walls at rest inside the box, in steady flow.
mod geometry;
mod passing;

use super::Scalar;
use super::thermal_law::ThermalLaw;
use crate::grid::GHOSTS;
use crate::linear::StencilMatrix;
use crate::{FlowError, Velocity};
use geometry::Geometry;
use interfaces::{CutCells, LawOfTheWall};
use passing::Passing;

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
    passing: Passing<D>,
    /// Storage indices of cells without fluid at their centre, and of those that what passes through them belongs to.
    dry: Vec<(usize, Option<usize>)>,
    /// φ on the walls, and the number of their pieces.
    value: f64,
    pieces: usize,
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
    /// Number of the piece.
    piece: usize,
    cell: usize,
    /// Area over the cell's volume \[1/m\], and that volume \[m³\].
    area: f64,
    volume: f64,
    /// Cells around the place that is seen: storage index, weight, distance from the wall \[m\].
    seen: Vec<Seen>,
    /// What passes over Σ w (φ_w − φ) \[1/s\].
    rate: f64,
}

#[derive(Clone, Copy, Debug)]
struct Seen {
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

impl<const D: usize> Scalar<D> {
    /// Puts walls at rest, on which φ is `value`, into the steady equations ([`settle`](Self::settle), [`approach`](Self::approach)), or takes them out:
    /// nothing is carried or conducted through what they shut, what passes through the rest of a cell without fluid at its centre belongs to the cell before it, so
    /// that what leaves a cell enters another; and each wall gives off
    ///
    /// ```text
    /// Γ (φ_w − φ)/y   or, where turbulence is modelled,   u_τ (φ_w − φ)/T+(u_τ y/ν)
    /// ```
    ///
    /// per area to the cell before it; φ is that half a cell before the wall, as on sides of the box, if it has the profile of the law, and T+ as in
    /// [`mix`](Self::mix); u_τ comes from [`rub`](Self::rub).
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
        let geometry = Geometry::new(grid, self.boundaries.periodic(), cuts);
        let mut open: [Vec<(usize, f64)>; D] =
            std::array::from_fn(|a| cuts.faces[a].iter().map(|face| (face.index, face.open)).collect());
        for a in (0..D).filter(|&a| geometry.periodic[a]) {
            // The same faces at the other end.
            let [n, s] = [grid.cells()[a], grid.stride()[a]];
            let first = |o: usize| grid.cell_at(o).is_some_and(|cell| cell[a] == 0);
            let again: Vec<_> =
                open[a].iter().filter(|&&(o, _)| first(o)).map(|&(o, open)| (o + n * s, open)).collect();
            open[a].extend(again);
        }
        let wet: Vec<bool> = (0..grid.n_cells()).map(|i| geometry.wet(grid.cell(i))).collect();
        let owners = geometry.owners(&wet);
        let place = |i: usize| grid.place(grid.cell(i));
        let (mut shut, mut dry, mut films) = (Vec::new(), Vec::new(), Vec::new());
        for number in 0..grid.n_cells() {
            let cell = grid.cell(number);
            if !wet[number] {
                dry.push((place(number), owners[number].map(place)));
                continue;
            }
            for (axis, upper) in (0..D).flat_map(|a| [(a, false), (a, true)]) {
                let other = geometry.beside(cell, axis, upper);
                let closed = other.is_some_and(|c| !wet[grid.index(c)]);
                let share = if closed { 1.0 } else { 1.0 - geometry.open(cell, axis, upper) };
                if share > 0.0 {
                    let side = other.is_none();
                    shut.push(Shut { cell: number, place: place(number), axis, upper, share, side });
                }
            }
        }
        for (piece, wall) in cuts.walls.iter().enumerate() {
            for (cell, weight) in geometry.before(wall) {
                let width = |a: usize| self.metrics.axes[a].width[GHOSTS + cell[a]];
                let extent: f64 = (0..D).map(|a| wall.normal[a].abs() * width(a)).sum();
                let volume: f64 = (0..D).map(width).product();
                let seen = geometry.seen(wall, extent, cell);
                let (cell, area) = (grid.index(cell), weight * wall.area / volume);
                let far: f64 = seen.iter().map(|seen| seen.weight * seen.y).sum();
                let rate = if far > 0.0 { area * self.diffusivity / far } else { 0.0 };
                films.push(Film { piece, cell, area, volume, seen, rate });
            }
        }
        let passing = Passing::new(&geometry, &wet, &owners, &shut);
        self.walls = Some(Box::new(Walls {
            open,
            shut,
            films,
            passing,
            dry,
            value,
            pieces: cuts.walls.len(),
            law: None,
        }));
        Ok(())
    }

    /// Tells the walls of the friction velocity u_τ \[m/s\] at every piece, in the order of [`set_walls`](Self::set_walls), in a fluid of this viscosity \[m²/s\]
    /// ([`Simple::wall_friction_velocities`](crate::Simple::wall_friction_velocities)): what they give off is then that of the law of the wall.
    ///
    /// # Errors
    /// [`FlowError::Parameter`] for another number of pieces.
    pub fn rub(&mut self, friction_velocity: &[f64], viscosity: f64) -> Result<(), FlowError> {
        let Some(walls) = self.walls.as_deref_mut().filter(|_| viscosity > 0.0) else { return Ok(()) };
        if friction_velocity.len() != walls.pieces {
            let range = "one for every piece of wall that set_walls was given";
            let value = friction_velocity.len() as f64;
            return Err(FlowError::Parameter { name: "the number of friction velocities", value, range });
        }
        let prandtl = viscosity / self.diffusivity;
        let law = walls.law.get_or_insert_with(|| ThermalLaw::new(prandtl, self.turbulent_prandtl));
        for film in &mut walls.films {
            let speed = friction_velocity[film.piece] / viscosity;
            // y over the conductivity that the law has up to there.
            let resistance: f64 = film
                .seen
                .iter()
                .map(|seen| {
                    let plus = speed * seen.y;
                    let ratio = if plus > 0.0 { plus / LawOfTheWall::USUAL.u_plus(plus) } else { 1.0 };
                    seen.weight * seen.y / (viscosity * law.ratio(ratio))
                })
                .sum();
            film.rate = if resistance.is_finite() && resistance > 0.0 { film.area / resistance } else { 0.0 };
        }
        Ok(())
    }

    /// What the walls of [`set_walls`](Self::set_walls) give off in all \[φ m³/s; plane φ m²/s\], if there are any.
    pub fn given_off(&self) -> Option<f64> {
        let of = |walls: &Walls<D>| -> f64 {
            let from = |film: &Film| film.rate * film.volume * film.drop(walls.value, self.phi.data());
            walls.films.iter().map(from).sum()
        };
        self.walls.as_deref().map(of)
    }

    /// The velocity as means over whole faces, if walls shut parts of them, and without those through which [`Passing`] carries.
    pub(super) fn through(&self, velocity: &Velocity<D>) -> Option<[Velocity<D>; 2]> {
        let walls = self.walls.as_deref()?;
        let mut whole = velocity.clone();
        for (u, open) in whole.components.iter_mut().zip(&walls.open) {
            open.iter().for_each(|&(o, open)| u.data_mut()[o] *= open);
        }
        let mut far = whole.clone();
        walls.passing.closed.iter().for_each(|&(a, o)| far.components[a].data_mut()[o] = 0.0);
        Some([whole, far])
    }

    /// Storage indices of the cells in walls.
    pub(super) fn dry(&self) -> impl Iterator<Item = usize> + use<'_, D> {
        self.walls.iter().flat_map(|walls| walls.dry.iter().map(|&(place, _)| place))
    }

    /// Cells in walls have what those have that they belong to.
    pub(super) fn wet_through(&mut self) {
        let Some(walls) = self.walls.as_deref() else { return };
        let phi = self.phi.data_mut();
        for &(place, owner) in &walls.dry {
            phi[place] = owner.map_or(walls.value, |owner| phi[owner]);
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

    /// Takes what does not pass out of the balance of the cells beside walls, and puts in what is carried there by the velocity over whole faces and what walls
    /// give off.
    pub(super) fn shut(&mut self, velocity: &Velocity<D>, rest: &mut [f64]) {
        let Some(mut walls) = self.walls.take() else { return };
        let (phi, s) = (self.phi.data(), self.grid.stride());
        for shut in &walls.shut {
            let step = s[shut.axis];
            let other = if shut.upper { shut.place + step } else { shut.place - step };
            rest[shut.cell] -= self.conductance(shut) * (phi[other] - phi[shut.place]);
        }
        walls.passing.add(velocity, self.carrier.scheme(), &self.phi, rest);
        if let Some(source) = &self.source {
            walls.passing.add_source(source, rest);
        }
        for film in &walls.films {
            rest[film.cell] += film.rate * film.drop(walls.value, phi);
        }
        self.walls = Some(walls);
    }

    /// The same of the matrix.
    pub(super) fn shut_matrix(&self, velocity: &Velocity<D>, matrix: &mut StencilMatrix<D>) {
        let Some(walls) = self.walls.as_deref() else { return };
        let (centre, lower, upper) = matrix.parts_mut();
        let sides = [lower, upper];
        for shut in walls.shut.iter().filter(|shut| !shut.side) {
            let kept = self.conductance(shut);
            sides[usize::from(shut.upper)][shut.axis][shut.cell] += kept;
            centre[shut.cell] -= kept;
        }
        walls.passing.implicit(velocity, centre);
        for film in &walls.films {
            centre[film.cell] += film.rate;
        }
    }
}
