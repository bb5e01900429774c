//! Bodies for ParaView.
use crate::{ContactLaw, Form, RigidBodies};
use interfaces::vtk::{self, DataArray};
use interfaces::{Bodies, BodyId, Kinematics, Point, Vector};
use std::f64::consts::{PI, TAU};
use std::io::{self, Write};

/// Corners of a drawn disc, and of a drawn sphere's equator.
const CORNERS: usize = 64;

impl<L: ContactLaw> RigidBodies<L> {
    /// Writes the bodies as one `.vtp` file (VTK polygonal data): discs as polygons with a line from centre to
    /// rim that shows how far they have turned, polygons by their corners, bodies made of triangles by these, others as three such ellipses along their axes, as long as their boxes. Periodic bodies are drawn at
    /// their image next after `corner`. Cell data: body number, velocity \[m/s\], angular velocity \[rad/s\].
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
        let mut connectivity = Vec::new();
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
                    connectivity.extend(ring.map(|i| (first + i as usize) as i64));
                    lines.push(connectivity.len());
                    owners.push(b);
                }
                continue;
            }
            if let Form::Polygon(polygon) = shape.form() {
                let first = points.len();
                points.extend(polygon.corners().iter().map(|c| world(Vector::new(c.x, c.y, 0.0))));
                connectivity.extend((first..points.len()).chain([first]).map(|i| i as i64));
                lines.push(connectivity.len());
                owners.push(b);
                continue;
            }
            let half = 0.5 * shape.aabb().extent();
            let axis = |a: usize| Vector::ith(a, half[a]);
            let planes: &[[Vector; 2]] = match shape.form() {
                Form::Disc(_) => &[[axis(0), axis(1)]],
                _ => &[[axis(0), axis(1)], [axis(1), axis(2)], [axis(2), axis(0)]],
            };
            for [e1, e2] in planes {
                let first = points.len();
                points.push(centre);
                for i in 0..CORNERS {
                    let (sin, cos) = (TAU * i as f64 / CORNERS as f64).sin_cos();
                    points.push(world(e1 * cos + e2 * sin));
                }
                // From the centre to the rim and once round.
                connectivity.extend((first..first + CORNERS + 1).map(|i| i as i64));
                connectivity.push(first as i64 + 1);
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
        let coordinates = points.iter().flat_map(|p| <[f64; 3]>::from(*p)).collect::<Vec<_>>();
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
                ("Points", "", vec![DataArray::float64("points", 3, coordinates)]),
                (
                    "Lines",
                    "",
                    vec![
                        DataArray::int64("connectivity", connectivity),
                        DataArray::int64("offsets", lines.iter().map(|&l| l as i64)),
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

#[cfg(test)]
mod tests;
