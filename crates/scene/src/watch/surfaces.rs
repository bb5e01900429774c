//! Coefficients along the surfaces of plane walls.
use super::table::Table;
use super::{Solids, Watch, output};
use crate::view::View;
use coupling::{CouplingError, StepInfo};
use fv_mesh::Fluid;
use interfaces::{BodyId, Checkpoint, RestartError};
use std::path::Path;

/// Writes pressure, shear stress, c_p and c_f to `surfaces/BODY.csv` at snapshots, by the angle about
/// the centre of mass.
pub(crate) struct SurfacesWatch {
    tables: Vec<(String, Table)>,
    fluid: Fluid,
    /// Speed \[m/s\] and reference pressure \[Pa\] of the coefficients.
    reference: [f64; 2],
}

impl SurfacesWatch {
    pub(crate) fn new(
        folder: &Path,
        names: Vec<String>,
        fluid: Fluid,
        reference: [f64; 2],
        resume: Option<f64>,
    ) -> Result<Self, CouplingError> {
        let folder = folder.join("surfaces");
        std::fs::create_dir_all(&folder).map_err(output("making", &folder))?;
        // Nothing but the start is written before the first step, and it is written again.
        let resume = resume.filter(|time| *time > 0.0);
        let open = |name: String| {
            let name = name.replace(['/', '\\', ',', '"', '\n'], "_");
            let header = "# time s; angle rad about the centre of mass; x,y m; p Pa; tau Pa, positive anticlockwise\ntime,angle,x,y,p,tau,cp,cf";
            let table = Table::open(&folder.join(format!("{name}.csv")), header, resume)?;
            Ok((name, table))
        };
        Ok(Self {
            tables: names.into_iter().map(open).collect::<Result<_, CouplingError>>()?,
            fluid,
            reference,
        })
    }
}

impl Checkpoint for SurfacesWatch {
    fn save(&self, _: &mut dyn FnMut(&str, &[f64])) {}
    fn restore<'a>(&mut self, _: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        Ok(())
    }
}

impl Watch for SurfacesWatch {
    fn name(&self) -> &'static str {
        "surfaces"
    }
    fn tables(&self) -> Vec<String> {
        self.tables.iter().map(|(name, _)| format!("surfaces/{name}.csv")).collect()
    }
    fn snapshot(
        &mut self,
        view: &mut dyn View,
        _: &Solids,
        _: usize,
        info: &StepInfo,
    ) -> Result<(), CouplingError> {
        let Fluid { density, viscosity } = self.fluid;
        let [speed, pressure] = self.reference;
        let scale = 2.0 / (density * speed * speed);
        for (b, (_, table)) in self.tables.iter_mut().enumerate() {
            let centre = view.bodies().pose(BodyId(b)).position;
            let mut rows: Vec<[f64; 7]> = view
                .surface(BodyId(b), density * viscosity)?
                .points
                .iter()
                .map(|point| {
                    let (x, n) = (centre + point.arm, point.normal);
                    let tau = n.x * point.friction.y - n.y * point.friction.x;
                    let angle = point.arm.y.atan2(point.arm.x);
                    [angle, x.x, x.y, point.pressure, tau, scale * (point.pressure - pressure), scale * tau]
                })
                .collect();
            rows.sort_by(|a, b| a[0].total_cmp(&b[0]));
            rows.into_iter().try_for_each(|row| table.row(info.time, None, row))?;
        }
        Ok(())
    }
    fn flush(&mut self) -> Result<(), CouplingError> {
        self.tables.iter_mut().try_for_each(|(_, table)| table.flush())
    }
}
