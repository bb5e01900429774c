//! Paths of bodies.
use super::table::Table;
use super::{Solids, Watch};
use crate::view::View;
use coupling::{CouplingError, StepInfo};
use interfaces::{BodyId, Checkpoint, RestartError};
use serde_json::{Value, json};
use std::path::Path;

/// Writes a line per body and snapshot to `trajectories.csv`, and keeps the largest speed of those that were there from the start.
pub(crate) struct TrajectoriesWatch {
    table: Table,
    /// Names of the bodies at the start.
    names: Vec<String>,
    /// Of each the largest speed, and when it had it.
    fastest: Vec<[f64; 2]>,
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
        let names: Vec<String> = names.into_iter().map(|name| name.replace([',', '\n', '"'], "_")).collect();
        let table = Table::open(&folder.join("trajectories.csv"), HEADER, resume.filter(|t| *t > 0.0))?;
        Ok(Self { table, fastest: vec![[0.0; 2]; names.len()], names })
    }
}

impl Checkpoint for TrajectoriesWatch {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        sink("fastest", self.fastest.as_flattened());
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        let saved = RestartError::take(source, "fastest", 2 * self.fastest.len())?;
        self.fastest.copy_from_slice(saved.as_chunks().0);
        Ok(())
    }
}

impl Watch for TrajectoriesWatch {
    fn name(&self) -> &'static str {
        "trajectories"
    }
    fn tables(&self) -> Vec<String> {
        vec!["trajectories.csv".into()]
    }
    fn step(&mut self, view: &mut dyn View, info: &StepInfo) -> Result<(), CouplingError> {
        for b in (0..view.bodies().n_bodies()).map(BodyId) {
            let speed = view.bodies().twist(b).linear.norm();
            if let Some(fastest) = self.fastest.get_mut(view.serial(b) as usize).filter(|f| speed > f[0]) {
                *fastest = [speed, info.time];
            }
        }
        Ok(())
    }
    fn results(&self) -> Option<Value> {
        let row = |(name, [speed, time]): (&String, &[f64; 2])| json!({ "body": name, "largest_speed": speed, "at": time });
        Some(self.names.iter().zip(&self.fastest).map(row).collect())
    }
    fn snapshot(
        &mut self,
        view: &mut dyn View,
        _: &Solids,
        _: usize,
        info: &StepInfo,
    ) -> Result<(), CouplingError> {
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
