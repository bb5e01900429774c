//! Ducts without ends that are turned against the grid.
use crate::Outcome;
use fv_mesh::{Axis, CartesianGrid, Simple};
use interfaces::{Aabb, CutCells, Point, Pose, Solid, Vector};

/// The solid between plane ducts side by side, in a box that is periodic along both axes.
#[derive(Clone, Copy, Debug)]
pub struct TurnedDucts {
    /// Height of a duct \[m\].
    pub height: f64,
    /// Thickness of the solid between two \[m\].
    thickness: f64,
    /// Sine and cosine of the angle.
    turn: [f64; 2],
    /// How far the first lower wall is from the origin \[m\].
    shift: f64,
    /// Middle of the box \[m\].
    middle: [f64; 2],
}

impl TurnedDucts {
    /// Ducts of a `height` turned by an `angle` \[rad\], and their box with cells of about `h`; the first lower wall is `shift` cells from the
    /// origin.
    ///
    /// # Errors
    /// Those of the axes.
    pub fn new(height: f64, angle: f64, h: f64, shift: f64) -> Outcome<(Self, CartesianGrid<2>)> {
        let thickness = 0.3 * height;
        let (s, c) = angle.sin_cos();
        let axis = |length: f64| Axis::uniform((length / h).round() as usize, 0.0, length);
        let period = height + thickness;
        let grid =
            CartesianGrid::from_axes([axis(if s > 0.0 { period / s } else { 4.0 * h })?, axis(period / c)?])?;
        let middle = [0, 1].map(|a| 0.5 * grid.axis(a).length());
        Ok((Self { height, thickness, turn: [s, c], shift: shift * h, middle }, grid))
    }

    /// Where the body is.
    pub fn pose(&self) -> Pose {
        Pose::at([self.middle[0], self.middle[1], 0.0])
    }

    /// Along the ducts.
    pub fn along(&self) -> [f64; 2] {
        [self.turn[1], self.turn[0]]
    }

    /// Height over the lower wall of a duct \[m\].
    pub fn height_of(&self, [x, y]: [f64; 2]) -> f64 {
        (self.turn[1] * y - self.turn[0] * x - self.shift).rem_euclid(self.height + self.thickness)
    }

    /// Distance from the nearest wall, positive in the fluid \[m\].
    pub fn distance(&self, x: [f64; 2]) -> f64 {
        let y = self.height_of(x);
        if y < self.height + 0.5 * self.thickness {
            y.min(self.height - y)
        } else {
            y - self.height - self.thickness
        }
    }

    /// Area of the fluid in the box \[m²\].
    pub fn area(&self) -> f64 {
        4.0 * self.middle[0] * self.middle[1] * self.height / (self.height + self.thickness)
    }

    /// What the open faces make of that: less by some 10⁻⁵, as vertices a little before a wall are on it. \[m²\]
    pub fn open_area(&self, flow: &Simple<2>, cuts: &CutCells) -> f64 {
        let grid = flow.grid();
        let of = |c: usize| {
            let shut: f64 = cuts.faces[c].iter().map(|face| 1.0 - face.open).sum();
            (grid.n_cells() as f64 - shut) * grid.cell_volume([0; 2])
        };
        let [along, up] = self.along();
        along * along * of(0) + up * up * of(1)
    }

    /// Mean velocity along the ducts \[m/s\], of what passes the open parts of the faces.
    pub fn mean_velocity(&self, flow: &Simple<2>, cuts: &CutCells) -> f64 {
        let grid = flow.grid();
        let [columns, rows] = grid.cells();
        let volume = grid.axis(0).width(0) * grid.axis(1).width(0);
        let of = |c: usize| {
            let u = flow.velocity().field(c);
            let whole: f64 = (0..rows).flat_map(|j| &u.row(j)[..columns]).sum();
            let shut: f64 = cuts.faces[c].iter().map(|face| (1.0 - face.open) * u.data()[face.index]).sum();
            (whole - shut) * volume
        };
        let [along, up] = self.along();
        (along * of(0) + up * of(1)) / self.area()
    }

    /// Velocity along the ducts at a cell's centre \[m/s\], the mean of those on its faces.
    pub fn speed(&self, flow: &Simple<2>, [i, j]: [usize; 2]) -> f64 {
        let ([columns, rows], [along, up]) = (flow.grid().cells(), self.along());
        let [u, v] = [0, 1].map(|c| flow.velocity().field(c));
        let mean = 0.5 * (u.row(j)[i] + u.row(j)[(i + 1) % columns]);
        along * mean + up * 0.5 * (v.row(j)[i] + v.row((j + 1) % rows)[i])
    }

    /// What the fluid does to the walls along the ducts, friction and pressure \[N/m\].
    pub fn drag(&self, flow: &Simple<2>) -> f64 {
        let [along, up] = self.along();
        let forces = flow.wall_friction().into_iter().chain(flow.wall_pressure_force());
        forces.map(|w| along * w.force.x + up * w.force.y).sum()
    }

    /// Friction of the lower walls, which rise along the ducts, and of the upper ones, which recede: its mean along the ducts \[Pa\].
    pub fn friction_of_each(&self, flow: &Simple<2>, cuts: &CutCells) -> [f64; 2] {
        let [along, up] = self.along();
        let (mut sums, mut areas) = ([0.0; 2], [0.0; 2]);
        for (wall, traction) in cuts.walls.iter().zip(flow.wall_tractions()) {
            let height = self.height_of([wall.foot.x, wall.foot.y]);
            let upper = (height - self.height).abs() < 0.5 * self.thickness;
            sums[usize::from(upper)] += wall.area * (along * traction.x + up * traction.y);
            areas[usize::from(upper)] += wall.area;
        }
        [0, 1].map(|wall| sums[wall] / areas[wall])
    }
}

impl Solid for TurnedDucts {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        self.distance([x.x + self.middle[0], x.y + self.middle[1]])
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), Vector::new(self.middle[0], self.middle[1], 0.0))
    }
}
