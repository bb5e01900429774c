//! Paths of bodies.
use super::table::Table;
use super::Watch;
use crate::view::View;
use coupling::{CouplingError, StepInfo};
use interfaces::{BodyId, Checkpoint, RestartError};
use std::path::Path;

/// Writes a line per body and snapshot to `trajectories.csv`.
pub(crate) struct TrajectoriesWatch {
    table: Table,
    /// Names of the bodies at the start.
    names: Vec<String>,
}

const HEADER: &str = "\
# units: time s; x,y,z m (not wrapped into a periodic box); v m/s; q 1 (unit quaternion); w rad/s; f,fc N and t,tc N m (plane scenes per m of depth). \
f,t: load of the fluid without buoyancy; fc,tc: contacts, mean of the last step
time,body,x,y,z,vx,vy,vz,qw,qx,qy,qz,wx,wy,wz,fx,fy,fz,tx,ty,tz,fcx,fcy,fcz,tcx,tcy,tcz";

/// What a body is called: its name, or, if it came in later, its serial number.
pub(crate) fn called(names: &[String], serial: u64) -> String {
    names.get(serial as usize).cloned().unwrap_or_else(|| serial.to_string())
}

impl TrajectoriesWatch {
    pub(crate) fn new(folder: &Path, names: Vec<String>, resume: Option<f64>) -> Result<Self, CouplingError> {
        let names = names.into_iter().map(|name| name.replace([',', '\n', '"'], "_")).collect();
        Ok(Self { table: Table::open(&folder.join("trajectories.csv"), HEADER, resume.filter(|t| *t > 0.0))?, names })
    }
}

impl Checkpoint for TrajectoriesWatch {
    fn save(&self, _: &mut dyn FnMut(&str, &[f64])) {}
    fn restore<'a>(&mut self, _: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        Ok(())
    }
}

impl Watch for TrajectoriesWatch {
    fn name(&self) -> &'static str {
        "trajectories"
    }
    fn snapshot(&mut self, view: &mut dyn View, _: &[f64], _: usize, info: &StepInfo) -> Result<(), CouplingError> {
        let dt = if info.dt > 0.0 { info.dt } else { 1.0 };
        for b in (0..view.bodies().n_bodies()).map(BodyId) {
            let (pose, twist) = (view.bodies().pose(b), view.bodies().twist(b));
            let [fluid, contact] = view.loads(b, dt);
            let q = pose.orientation;
            let columns = [
                pose.position.coords,
                twist.linear,
                twist.angular,
                fluid.force,
                fluid.torque,
                contact.force,
                contact.torque,
            ];
            let of = |i: usize| columns[i].iter().copied();
            let values = of(0).chain(of(1)).chain([q.w, q.i, q.j, q.k]).chain((2..7).flat_map(of));
            self.table.row(info.time, Some(&called(&self.names, view.serial(b))), values)?;
        }
        Ok(())
    }
    fn flush(&mut self) -> Result<(), CouplingError> {
        self.table.flush()
    }
}
