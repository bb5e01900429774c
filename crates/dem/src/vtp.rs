//! Bodies for ParaView.
use crate::{ContactLaw, Form, RigidBodies, Shape};
use interfaces::vtk::{self, DataArray};
use interfaces::{Bodies, BodyId, Kinematics, Point, Vector};
use std::f64::consts::{PI, TAU};
use std::io::{self, Write};

/// Most and fewest corners of a drawn ellipse.
const CORNERS: [usize; 2] = [64, 24];
/// Corners of all ellipses up to which each has the most.
const ALL_CORNERS: usize = 16384;

impl<L: ContactLaw> RigidBodies<L> {
    /// Writes the bodies as one `.vtp` file (VTK polygonal data): discs as polygons with a line from centre to
    /// rim that shows how far they have turned, polygons by their corners, bodies made of triangles by these, others as three such ellipses along their axes, as long as their boxes. Ellipses
    /// have 64 corners, fewer where there are many (24 from 683 on). Periodic bodies are drawn at their image next after `corner`. Points are in single precision.
    /// Cell data: body number, velocity \[m/s\], angular velocity \[rad/s\].
    ///
    /// # Errors
    /// What the writer answers.
    pub fn write_vtp(&self, out: &mut impl Write, corner: Point) -> io::Result<()> {
        self.write_vtp_of(out, corner, self.ids())
    }

    /// The same of some bodies: walls, say, that are bodies, too.
    ///
    /// # Errors
    /// What the writer answers.
    pub fn write_vtp_of(
        &self,
        out: &mut impl Write,
        corner: Point,
        which: impl IntoIterator<Item = BodyId>,
    ) -> io::Result<()> {
        let (mut points, mut lines, mut owners) = (Vec::<Point>::new(), Vec::<usize>::new(), Vec::new());
        let mut connectivity = Vec::<usize>::new();
        let which: Vec<BodyId> = which.into_iter().collect();
        let drawn = which.iter().map(|b| ellipses(self.shape(*b)).len()).sum::<usize>().max(1);
        let corners = (ALL_CORNERS / drawn).clamp(CORNERS[1], CORNERS[0]);
        let circle: Vec<(f64, f64)> =
            (0..corners).map(|i| (TAU * i as f64 / corners as f64).sin_cos()).collect();
        for BodyId(b) in which {
            let pose = self.pose(BodyId(b));
            let centre = self.periods().wrap(pose.position, corner);
            let shape = self.shape(BodyId(b));
            let world = |p: Vector| centre + pose.orientation * p;
            if let Some(surface) = shape.polyhedron() {
                let first = points.len();
                points.extend(surface.vertices.iter().map(|p| world(p.coords)));
                for face in surface.faces {
                    let ring = [face[0], face[1], face[2], face[0]];
                    connectivity.extend(ring.map(|i| first + i as usize));
                    lines.push(connectivity.len());
                    owners.push(b);
                }
                continue;
            }
            if let Form::Polygon(polygon) = shape.form() {
                let first = points.len();
                points.extend(polygon.corners().iter().map(|c| world(Vector::new(c.x, c.y, 0.0))));
                connectivity.extend((first..points.len()).chain([first]));
                lines.push(connectivity.len());
                owners.push(b);
                continue;
            }
            let half = 0.5 * shape.aabb().extent();
            for plane in ellipses(shape) {
                let [e1, e2] = plane.map(|a| pose.orientation * Vector::ith(a, half[a]));
                let first = points.len();
                points.push(centre);
                points.extend(circle.iter().map(|(sin, cos)| centre + e1 * *cos + e2 * *sin));
                // From the centre to the rim and once round.
                connectivity.extend((first..points.len()).chain([first + 1]));
                lines.push(connectivity.len());
                owners.push(b);
            }
        }
        let twists = || owners.iter().map(|&b| self.twist(BodyId(b)));
        let vectors = |pick: fn(&interfaces::Twist) -> Vector| {
            twists().flat_map(move |t| <[f64; 3]>::from(pick(&t))).collect::<Vec<_>>()
        };
        let cell_data = vec![
            DataArray::int64("body", owners.iter().map(|&b| b as i64)),
            DataArray::float64("velocity", 3, vectors(|t| t.linear)),
            DataArray::float64("angular_velocity", 3, vectors(|t| t.angular)),
        ];
        let coordinates = points.iter().flat_map(|p| <[f64; 3]>::from(*p));
        let piece = format!(
            "NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"{}\" NumberOfStrips=\"0\" NumberOfPolys=\"0\"",
            points.len(),
            lines.len()
        );
        vtk::write(
            out,
            "PolyData",
            "",
            &piece,
            &[
                ("CellData", "", cell_data),
                ("Points", "", vec![DataArray::float32("points", 3, coordinates)]),
                (
                    "Lines",
                    "",
                    vec![
                        DataArray::indices("connectivity", &connectivity),
                        DataArray::indices("offsets", &lines),
                    ],
                ),
            ],
        )
    }

    /// Writes some bodies as one `.vtp` file of points, a hundredth as large for spheres: in ParaView the filter "Glyph" draws them, spheres by
    /// `diameter`. Point data: body number, diameter of a sphere of the same volume \[m\] (in a plane scene a disc of the same area), edges of the
    /// box around the body in its own frame \[m\], orientation (quaternion w, x, y, z), velocity \[m/s\], angular velocity \[rad/s\]. Periodic
    /// bodies are at their image next after `corner`.
    ///
    /// # Errors
    /// What the writer answers.
    pub fn write_vtp_points(
        &self,
        out: &mut impl Write,
        corner: Point,
        which: impl IntoIterator<Item = BodyId>,
    ) -> io::Result<()> {
        let ids: Vec<BodyId> = which.into_iter().collect();
        let vectors = |of: &dyn Fn(BodyId) -> Vector| -> Vec<f64> {
            ids.iter().flat_map(|b| <[f64; 3]>::from(of(*b))).collect()
        };
        let diameter = |b: &BodyId| {
            let volume = self.inertia(*b).volume;
            if self.shape(*b).form().is_plane() {
                2.0 * (volume / PI).sqrt()
            } else {
                (6.0 * volume / PI).cbrt()
            }
        };
        let turns = ids.iter().flat_map(|b| {
            let q = self.pose(*b).orientation;
            [q.w, q.i, q.j, q.k]
        });
        let places = vectors(&|b| self.periods().wrap(self.pose(b).position, corner).coords);
        let point_data = vec![
            DataArray::int64("body", ids.iter().map(|b| b.0 as i64)),
            DataArray::float64("diameter", 1, ids.iter().map(diameter)),
            DataArray::float64("extent", 3, vectors(&|b| self.shape(b).aabb().extent())),
            DataArray::float64("orientation", 4, turns),
            DataArray::float64("velocity", 3, vectors(&|b| self.twist(b).linear)),
            DataArray::float64("angular_velocity", 3, vectors(&|b| self.twist(b).angular)),
        ];
        let n = ids.len();
        let piece = format!(
            "NumberOfPoints=\"{n}\" NumberOfVerts=\"{n}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"0\""
        );
        vtk::write(
            out,
            "PolyData",
            "",
            &piece,
            &[
                ("PointData", "", point_data),
                ("Points", "", vec![DataArray::float64("points", 3, places)]),
                (
                    "Verts",
                    "",
                    vec![
                        DataArray::int64("connectivity", 0..n as i64),
                        DataArray::int64("offsets", 1..=n as i64),
                    ],
                ),
            ],
        )
    }
}

/// The axes of the ellipses that a shape is drawn by.
fn ellipses(shape: &dyn Shape) -> &'static [[usize; 2]] {
    match shape.form() {
        Form::Disc(_) => &[[0, 1]],
        Form::Polygon(_) => &[],
        _ if shape.polyhedron().is_some() => &[],
        _ => &[[0, 1], [1, 2], [2, 0]],
    }
}

#[cfg(test)]
mod tests;
