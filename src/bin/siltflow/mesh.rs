//! `siltflow mesh`.
use crate::outcome::{Failure, print};
use clap::Args;
use render::solids::{Form, Model, Portrait, Shape, Tint, View};
use render::{Pose, Vector};
use scene::dem::nalgebra::SymmetricEigen;
use scene::dem::{AdmissionReport, Shape as _, TriangleMesh, TriangleSoup};
use serde_json::{Value, json};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// Direction of view and margin of pictures.
const ALONG: [f64; 3] = [-1.0, 1.4, -0.8];
const MARGIN: f64 = 1.05;

#[derive(Args)]
pub(crate) struct MeshArgs {
    /// STL or OBJ file.
    file: PathBuf,
    /// Unit of length of the file [m]: 1e-3 for millimetres.
    #[arg(long, value_name = "LENGTH", default_value_t = 1.0)]
    unit: f64,
    /// Repairs faults: joins vertices, turns faces, unites parts that cross.
    #[arg(long)]
    repair: bool,
    /// Joins vertices up to this distance [m].
    #[arg(long, value_name = "LENGTH")]
    weld: Option<f64>,
    /// Width of a cell [m], with which walls and gaps are compared.
    #[arg(long, value_name = "LENGTH")]
    cell: Option<f64>,
    /// Density [kg/m³].
    #[arg(long, default_value_t = 1000.0)]
    density: f64,
    /// Writes a picture (PNG).
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
    /// Writes the mesh in metres (OBJ), repaired if that is requested.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Prints JSON: an object, SI units.
    #[arg(long)]
    json: bool,
}

impl MeshArgs {
    /// Prints the findings; returns the exit code. A mesh that is no body is an error.
    pub(crate) fn mesh(&self) -> Result<u8, Failure> {
        for (option, value) in [("density", Some(self.density)), ("cell", self.cell)] {
            if let Some(value) = value.filter(|value| !(*value > 0.0 && value.is_finite())) {
                let error = format!("--{option} {value}: give a finite number above 0");
                return Err(Failure::of_input(error));
            }
        }
        let soup = TriangleSoup::from_path(&self.file, self.unit);
        let mended = soup.and_then(|soup| soup.mended(self.weld, self.repair));
        let (soup, changes) = mended.map_err(Failure::of_input)?;
        let admission = soup.admission(self.cell);
        if let Some(path) = &self.out {
            write(path, |out| soup.write_obj(out))?;
        }
        let body = match admission.is_admissible() {
            true => Some(TriangleMesh::try_from(soup).map_err(Failure::of_input)?),
            false => None,
        };
        if let (Some(path), Some(body)) = (&self.picture, &body) {
            let title = self.file.file_stem().unwrap_or_default().to_string_lossy();
            draw(body, &title, path).map_err(|error| of_file(path, error))?;
        }
        let properties = body.as_ref().map(|body| Properties::new(body, self.density));
        if self.json {
            let value = json!({
                "file": self.file,
                "changes": changes,
                "admission": of_admission(&admission),
                "body": properties.as_ref().map(Properties::to_json),
            });
            print(&format!("{value:#}\n"))?;
        } else {
            let none = if self.repair { "nothing was to be repaired\n" } else { "" };
            let changes = changes.map_or_else(|| none.to_owned(), |changes| format!("{changes}\n"));
            let properties = properties.as_ref().map_or_else(String::new, Properties::text);
            print(&format!("{}\n{changes}{admission}{properties}", self.file.display()))?;
        }
        if body.is_some() {
            return Ok(0);
        }
        let repairable = !self.repair && admission.faults.iter().all(|fault| fault.is_repairable());
        let remedy = if repairable { "; --repair mends some such faults" } else { "" };
        let picture = self.picture.as_ref().map_or("", |_| ", so there is no picture of it");
        Err(Failure::of_input(format!("{} is no body{picture}{remedy}", self.file.display())))
    }
}

/// Failure of a file that is written.
fn of_file(path: &Path, error: std::io::Error) -> Failure {
    Failure::of_output(format!("{}: {error}", path.display()))
}

/// Writes a file.
fn write(
    path: &Path,
    content: impl FnOnce(&mut BufWriter<File>) -> std::io::Result<()>,
) -> Result<(), Failure> {
    let file = File::create(path).map(BufWriter::new);
    let written = file.and_then(|mut out| content(&mut out).and_then(|()| out.flush()));
    written.map_err(|error| of_file(path, error))
}

fn of_admission(admission: &AdmissionReport) -> Value {
    let thickness = |thinnest: &Option<scene::dem::Thinnest>| thinnest.map(|t| t.thickness);
    json!({
        "admitted": admission.is_admissible(),
        "faces": admission.faces,
        "vertices": admission.vertices,
        "parts": admission.shells.len(),
        "cavities": admission.shells.iter().filter(|shell| shell.depth % 2 == 1).count(),
        "thinnest_wall": thickness(&admission.thinnest_wall),
        "thinnest_gap": thickness(&admission.thinnest_gap),
        "slivers": admission.slivers,
        "flat_faces": admission.flat,
        "faults": admission.faults.iter().map(ToString::to_string).collect::<Vec<_>>(),
    })
}

/// Mass properties of a body.
struct Properties {
    density: f64,
    /// \[kg\].
    mass: f64,
    /// \[m³\].
    volume: f64,
    /// Centre of mass in the coordinates of the file \[m\].
    centre: [f64; 3],
    /// Largest distance from the centre \[m\].
    bounding_radius: f64,
    /// Principal moments of inertia about the centre, ascending \[kg m²\].
    moments: [f64; 3],
}

impl Properties {
    fn new(body: &TriangleMesh, density: f64) -> Self {
        let inertia = body.inertia(density);
        let mut moments: [f64; 3] = SymmetricEigen::new(inertia.tensor).eigenvalues.into();
        moments.sort_by(f64::total_cmp);
        Self {
            density,
            mass: inertia.mass,
            volume: inertia.volume,
            centre: body.origin().into(),
            bounding_radius: body.bounding_radius(),
            moments,
        }
    }

    /// Diameter of the ball of this volume \[m\].
    fn equivalent_diameter(&self) -> f64 {
        (6.0 * self.volume / std::f64::consts::PI).cbrt()
    }

    fn text(&self) -> String {
        let ([x, y, z], [a, b, c]) = (self.centre, self.moments);
        format!(
            "centre of mass: ({x:.4e}, {y:.4e}, {z:.4e}) m\n\
             radius about it: {:.4e} m; ball of the same volume: diameter {:.4e} m\n\
             mass at {} kg/m³: {:.4e} kg; principal moments of inertia: {a:.4e}, {b:.4e}, {c:.4e} kg m²\n",
            self.bounding_radius,
            self.equivalent_diameter(),
            self.density,
            self.mass,
        )
    }

    fn to_json(&self) -> Value {
        json!({
            "density": self.density,
            "mass": self.mass,
            "volume": self.volume,
            "centre": self.centre,
            "bounding_radius": self.bounding_radius,
            "equivalent_diameter": self.equivalent_diameter(),
            "principal_moments": self.moments,
        })
    }
}

/// Draws a body, seen obliquely from above.
fn draw(body: &TriangleMesh, title: &str, path: &Path) -> std::io::Result<()> {
    let bounding_radius = body.bounding_radius();
    let extent = 2.0 * MARGIN * bounding_radius;
    let models = [Model {
        shape: Shape { form: Form::Solid(body), bounding_radius },
        pose: Pose::at(body.origin().into()),
        tint: Tint::Grey(0.8),
    }];
    let view =
        View { middle: body.origin(), along: ALONG.into(), up: Vector::z(), width: extent, height: extent };
    Portrait { view, models: &models, range: (0.0, 1.0), label: None, title }.draw(path)
}
