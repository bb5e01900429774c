//! Bodies for ParaView.
use crate::{ContactLaw, Form, RigidBodies};
use interfaces::vtk::{self, DataArray};
use interfaces::{BodyId, Kinematics, Point, Vector};
use std::f64::consts::TAU;
use std::io::{self, Write};

/// Corners of a drawn disc, and of a drawn sphere's equator.
const CORNERS: usize = 64;

impl<L: ContactLaw> RigidBodies<L> {
    /// Writes the bodies as one `.vtp` file (VTK polygonal data): discs as polygons with a line from centre to
    /// rim that shows how far they have turned, bodies made of triangles by these, others as three such ellipses along their axes, as long as their boxes. Periodic bodies are drawn at
    /// their image next after `corner`. Cell data: body number, velocity \[m/s\], angular velocity \[rad/s\].
    ///
    /// # Errors
    /// What the writer answers.
    pub fn write_vtp(&self, out: &mut impl Write, corner: Point) -> io::Result<()> {
        let (mut points, mut lines, mut owners) = (Vec::<Point>::new(), Vec::<usize>::new(), Vec::new());
        let mut connectivity = Vec::new();
        for b in 0..self.n_bodies() {
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
}

#[cfg(test)]
mod tests;
