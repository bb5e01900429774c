//! What flows beside walls carry of a scalar.
use super::Shut;
use super::geometry::Geometry;
use crate::between::Between;
use crate::cell_gradients::{CellGradients, Linear};
use crate::{CartesianGrid, Convection, Field, Velocity};

/// Convection through the faces within two cells of one without fluid at its centre. All that passes through such a cell belongs to its owner, the cell before it. So it leaves one owner and
/// enters another:
///
/// ```text
/// V dφ/dt = −Σ_f F_f (φ_f − φ),   φ_f = κ φ_line + (1 − κ) φ_upwind
/// ```
///
/// F_f the flow out of owners' cells and those that belong to them, φ_f by gradients of least squares over the cells with fluid at their centre ([`Between::value`]). F_f sum up
/// to 0 but where outlets pass what they pass.
#[derive(Clone, Debug)]
pub(super) struct Passing<const D: usize> {
    gradients: CellGradients<D>,
    faces: Vec<Face<D>>,
    gates: Vec<Gate>,
    members: Vec<Member>,
    /// Axes and storage indices of the faces through which nothing passes otherwise, at both ends of periodic axes.
    pub(super) closed: Vec<(usize, usize)>,
    values: Vec<Linear<D>>,
}

/// A face between two owners' cells or those that belong to them: below and above.
#[derive(Clone, Debug)]
struct Face<const D: usize> {
    axis: usize,
    index: usize,
    owners: [Owner; 2],
    between: Between<D>,
}

#[derive(Clone, Copy, Debug)]
struct Owner {
    /// Its number, and its place among the gradients.
    cell: usize,
    place: usize,
    /// Area of the whole face over the owner's volume \[1/m\].
    area: f64,
    /// Is the face another cell's, which belongs to it?
    by_member: bool,
}

/// The face on a side of the box of a cell that belongs to another one.
#[derive(Clone, Copy, Debug)]
struct Gate {
    axis: usize,
    index: usize,
    upper: bool,
    /// Storage indices of the cell and of the ghost behind the face.
    across: [usize; 2],
    owner: usize,
    place: usize,
    area: f64,
}

/// A cell whose balance is that of its owner.
#[derive(Clone, Copy, Debug)]
struct Member {
    place: usize,
    /// Its volume, and what of it is fluid beyond what counts without walls, over the volume of the owner.
    volume: f64,
    fluid: f64,
    owner: usize,
    owner_place: usize,
}

fn volume<const D: usize>(grid: &CartesianGrid<D>, cell: usize) -> f64 {
    grid.cell_volume(grid.cell(cell))
}

impl<const D: usize> Passing<D> {
    pub(super) fn new(geometry: &Geometry<D>, wet: &[bool], owners: &[Option<usize>], shut: &[Shut]) -> Self {
        let grid = geometry.grid;
        let dry: Vec<bool> = wet.iter().map(|wet| !wet).collect();
        let mut new = Self {
            gradients: CellGradients::new(wet.len()),
            faces: Vec::new(),
            gates: Vec::new(),
            members: Vec::new(),
            closed: Vec::new(),
            values: Vec::new(),
        };
        let place = |i: usize| grid.place(grid.cell(i));
        for above in 0..wet.len() {
            let cell = grid.cell(above);
            for axis in 0..D {
                let Some(lower) = geometry.beside(cell, axis, false) else { continue };
                let below = grid.index(lower);
                let far = [geometry.beside(lower, axis, false), geometry.beside(cell, axis, true)];
                let near = far.into_iter().flatten().any(|c| dry[grid.index(c)]);
                if !(near || dry[below] || dry[above]) {
                    continue;
                }
                if geometry.open(cell, axis, false) == 0.0 {
                    continue;
                }
                let index = geometry.face(cell, axis, false);
                new.closed.push((axis, index));
                if cell[axis] == 0 {
                    new.closed.push((axis, index + grid.cells()[axis] * grid.stride()[axis]));
                }
                let [Some(low), Some(high)] = [owners[below], owners[above]] else { continue };
                if low == high {
                    continue;
                }
                let area = geometry.area(cell, axis);
                let mut owner = |owner: usize, of: usize| Owner {
                    cell: owner,
                    place: new.gradients.place(&geometry.ops, &dry, owner),
                    area: area / volume(grid, owner),
                    by_member: owner != of,
                };
                let owners = [owner(low, below), owner(high, above)];
                let x = grid.centre(grid.cell(low));
                let to = |p: [f64; D]| geometry.image(p, x);
                let middle = to(geometry.middle(cell, axis));
                let between = Between::new(x, to(grid.centre(grid.cell(high))), middle, axis);
                new.faces.push(Face { axis, index, owners, between });
            }
        }
        new.gradients.close();
        let mut members: Vec<usize> = shut.iter().map(|shut| shut.cell).collect();
        members.dedup();
        members.extend((0..wet.len()).filter(|&i| dry[i]));
        for i in members {
            let Some(owner) = owners[i] else { continue };
            let whole = volume(grid, owner);
            let counts = if dry[i] { 0.0 } else { whole };
            let (share, fluid) = (volume(grid, i) / whole, (geometry.fluid(grid.cell(i)) - counts) / whole);
            new.members.push(Member {
                place: place(i),
                volume: share,
                fluid,
                owner,
                owner_place: place(owner),
            });
            let cell = grid.cell(i);
            let sides = (0..D).flat_map(|a| [(a, false), (a, true)]);
            for (axis, upper) in
                sides.filter(|&(a, upper)| dry[i] && geometry.beside(cell, a, upper).is_none())
            {
                let s = grid.stride()[axis];
                let ghost = if upper { place(i) + s } else { place(i) - s };
                let (index, area) =
                    (geometry.face(cell, axis, upper), geometry.area(cell, axis) / volume(grid, owner));
                let gate =
                    Gate { axis, index, upper, across: [place(i), ghost], owner, place: place(owner), area };
                new.gates.push(gate);
            }
        }
        new
    }

    /// Adds what comes into the cells, per volume, by a velocity that is the mean over whole faces.
    pub(super) fn add(
        &mut self,
        velocity: &Velocity<D>,
        scheme: Convection,
        phi: &Field<D>,
        rest: &mut [f64],
    ) {
        let (grid, data) = (phi.grid(), phi.data());
        self.gradients.look(|cell| data[grid.place(grid.cell(cell))], &mut self.values);
        for Face { axis, index, owners, between } in &self.faces {
            let u = velocity.components[*axis].data()[*index];
            let [(below, g), (above, h)] = owners.map(|owner| &self.values[owner.place]);
            let value = between.value(scheme, *axis, usize::from(u < 0.0), [*below, *above], [g, h], 0.0);
            rest[owners[0].cell] -= owners[0].area * u * value;
            rest[owners[1].cell] += owners[1].area * u * value;
        }
        for gate in &self.gates {
            let inflow = gate.inflow(velocity);
            let side = 0.5 * (data[gate.across[0]] + data[gate.across[1]]);
            rest[gate.owner] += inflow * if inflow > 0.0 { side } else { data[gate.place] };
        }
        let s = grid.stride();
        for member in &self.members {
            let o = member.place;
            let at = grid.cell_at(o).unwrap_or([0; D]);
            let leaves = |a: usize| {
                let u = velocity.components[a].data();
                (u[o + s[a]] - u[o]) / grid.axis(a).width(at[a])
            };
            // Outlets pass what they pass.
            rest[member.owner] += member.volume * data[member.owner_place] * (0..D).map(leaves).sum::<f64>();
        }
    }

    /// Lets a source that counts in whole cells with fluid at their centre count where there is fluid.
    pub(super) fn add_source(&self, source: &Field<D>, rest: &mut [f64]) {
        for member in &self.members {
            rest[member.owner] += member.fluid * source.data()[member.place];
        }
    }

    /// Adds to the diagonal what comes in through the faces of cells that belong to others.
    pub(super) fn implicit(&self, velocity: &Velocity<D>, centre: &mut [f64]) {
        for Face { axis, index, owners, .. } in &self.faces {
            let u = velocity.components[*axis].data()[*index];
            for (owner, inflow) in owners.iter().zip([-u, u]).filter(|(owner, _)| owner.by_member) {
                centre[owner.cell] += owner.area * inflow.max(0.0);
            }
        }
        for gate in &self.gates {
            centre[gate.owner] += gate.inflow(velocity).max(0.0);
        }
    }
}

impl Gate {
    /// Per volume of the owner \[1/s\].
    fn inflow<const D: usize>(&self, velocity: &Velocity<D>) -> f64 {
        let u = self.area * velocity.components[self.axis].data()[self.index];
        if self.upper { -u } else { u }
    }
}
