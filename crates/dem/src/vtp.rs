//! Bodies for ParaView, as VTK polygonal data (`.vtp`).
mod body_frames;
mod marching_tetrahedra;
mod polygon_surface;
mod shape_surfaces;

pub use body_frames::BodyFrames;

use crate::{ContactLaw, RigidBodies};
use interfaces::vtk::{self, DataArray, Section};
use interfaces::{Bodies, BodyId, Kinematics, Point, Twist, Vector};
use polygon_surface::{PolygonSurface, ScaledSurface};
use shape_surfaces::ShapeSurfaces;
use std::f64::consts::PI;
use std::io::{self, Write};

impl<L: ContactLaw> RigidBodies<L> {
    /// Writes the surfaces of all bodies as one `.vtp` file: polygons, counter-clockwise seen from
    /// outside, closed in 3D. Circles have 32 edges, which depart from them by 0.5 % of the radius,
    /// so have the meridians and parallels of spheres, ellipsoids, capsules and cylinders;
    /// flat-faced bodies are written by their faces, others by marching tetrahedra (parts thinner
    /// than 1/32 of their length may be missing). Discs have a line from the centre to the rim that
    /// shows their angle.
    ///
    /// Periodic bodies are at their image next after `corner`. Cell data: body number, velocity
    /// \[m/s\], angular velocity \[rad/s\]. Numbers are in single precision.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write_vtp(&self, out: &mut impl Write, corner: Point) -> io::Result<()> {
        self.write_vtp_of(out, corner, self.ids())
    }

    /// Writes the surfaces of some bodies, as [`write_vtp`](Self::write_vtp) does.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write_vtp_of(
        &self,
        out: &mut impl Write,
        corner: Point,
        which: impl IntoIterator<Item = BodyId>,
    ) -> io::Result<()> {
        let which: Vec<BodyId> = which.into_iter().collect();
        let mut surfaces = ShapeSurfaces::default();
        surfaces.update(which.iter().map(|&b| self.shared_shape(b)));
        self.write_surfaces(out, corner, which.iter().map(|&b| (b, surfaces.of(self.shared_shape(b)))))
    }

    fn write_surfaces<'a>(
        &self,
        out: &mut impl Write,
        corner: Point,
        bodies: impl Iterator<Item = (BodyId, &'a ScaledSurface)>,
    ) -> io::Result<()> {
        let (mut all, mut of_lines, mut of_polygons) = (PolygonSurface::default(), Vec::new(), Vec::new());
        for (b, own) in bodies {
            let pose = self.pose(b);
            let centre = self.periods().wrap(pose.position, corner);
            let turn = pose.orientation.to_rotation_matrix();
            let (point, end) = (all.points.len(), all.corners.len());
            all.points.extend(own.points().map(|p| centre + turn * p));
            let surface = &own.surface;
            all.corners.extend(surface.corners.iter().map(|i| point + i));
            all.ends.extend(surface.ends.iter().map(|i| end + i));
            all.lines.extend(surface.lines.iter().map(|line| line.map(|i| point + i)));
            of_lines.resize(all.lines.len(), b);
            of_polygons.resize(all.ends.len(), b);
        }
        // Cells are numbered lines first.
        let owners: Vec<BodyId> = of_lines.into_iter().chain(of_polygons).collect();
        write_polygons(out, &all, self.motion(&owners))
    }

    /// Writes some bodies as one `.vtp` file of points: in ParaView the filter "Glyph" draws them,
    /// spheres by `diameter`. Point data: body number, diameter of a sphere of the same volume
    /// \[m\] (of a plane body: of a disc of the same area), edges of the box around the body in its
    /// own frame \[m\], orientation (quaternion w, x, y, z), velocity \[m/s\], angular velocity
    /// \[rad/s\], in single precision. Periodic bodies are at their image next after `corner`.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write_vtp_points(
        &self,
        out: &mut impl Write,
        corner: Point,
        which: impl IntoIterator<Item = BodyId>,
    ) -> io::Result<()> {
        self.write_points(out, corner, &which.into_iter().collect::<Vec<_>>(), Vec::new())
    }

    fn write_points(
        &self,
        out: &mut impl Write,
        corner: Point,
        bodies: &[BodyId],
        shapes: Vec<DataArray<'_>>,
    ) -> io::Result<()> {
        let diameter = |b: &BodyId| {
            let volume = self.inertia(*b).volume;
            if self.shape(*b).form().is_plane() {
                2.0 * (volume / PI).sqrt()
            } else {
                (6.0 * volume / PI).cbrt()
            }
        };
        let turns = bodies.iter().flat_map(|b| {
            let q = self.pose(*b).orientation;
            [q.w, q.i, q.j, q.k]
        });
        let places = bodies.iter().map(|&b| self.periods().wrap(self.pose(b).position, corner).coords);
        let extents = bodies.iter().map(|&b| self.shape(b).aabb().extent());
        let mut point_data = self.motion(bodies);
        point_data.extend([
            DataArray::float32("diameter", 1, bodies.iter().map(diameter)),
            vectors("extent", extents),
            DataArray::float32("orientation", 4, turns),
        ]);
        point_data.extend(shapes);
        let n = bodies.len();
        let verts = vec![
            DataArray::indices("connectivity", &(0..n).collect::<Vec<_>>()),
            DataArray::indices("offsets", &(1..=n).collect::<Vec<_>>()),
        ];
        write_poly_data(
            out,
            [n, n, 0, 0],
            &[
                ("PointData", "", point_data),
                ("Points", "", vec![vectors("points", places)]),
                ("Verts", "", verts),
            ],
        )
    }

    /// Number, velocity and angular velocity of bodies.
    fn motion(&self, bodies: &[BodyId]) -> Vec<DataArray<'static>> {
        let of = |pick: fn(Twist) -> Vector| bodies.iter().map(move |&b| pick(self.twist(b)));
        vec![
            DataArray::indices("body", &bodies.iter().map(|b| b.0).collect::<Vec<_>>()),
            vectors("velocity", of(|t| t.linear)),
            vectors("angular_velocity", of(|t| t.angular)),
        ]
    }
}

fn vectors(name: &'static str, values: impl Iterator<Item = Vector>) -> DataArray<'static> {
    DataArray::float32(name, 3, values.flat_map(<[f64; 3]>::from))
}

/// Writes lines and polygons with data of these cells.
fn write_polygons(
    out: &mut impl Write,
    surface: &PolygonSurface,
    cell_data: Vec<DataArray<'_>>,
) -> io::Result<()> {
    let line_ends: Vec<usize> = (1..=surface.lines.len()).map(|i| 2 * i).collect();
    let cells = |corners: &[usize], ends: &[usize]| {
        vec![DataArray::indices("connectivity", corners), DataArray::indices("offsets", ends)]
    };
    write_poly_data(
        out,
        [surface.points.len(), 0, surface.lines.len(), surface.ends.len()],
        &[
            ("CellData", "", cell_data),
            ("Points", "", vec![vectors("points", surface.points.iter().map(|p| p.coords))]),
            ("Lines", "", cells(surface.lines.as_flattened(), &line_ends)),
            ("Polys", "", cells(&surface.corners, &surface.ends)),
        ],
    )
}

fn write_poly_data(
    out: &mut impl Write,
    [points, verts, lines, polygons]: [usize; 4],
    sections: &[Section<'_>],
) -> io::Result<()> {
    let piece = format!(
        "NumberOfPoints=\"{points}\" NumberOfVerts=\"{verts}\" NumberOfLines=\"{lines}\" \
         NumberOfStrips=\"0\" NumberOfPolys=\"{polygons}\""
    );
    vtk::write(out, "PolyData", "", &piece, sections)
}

#[cfg(test)]
mod tests;
