//! Files of a run: fields and bodies for ParaView, trajectories for everyone.
use crate::{CouplingError, FlowSolver, Observer, Particles, Simulation, StepInfo, Strategy};
use dem::{BodyFrames, RigidDynamics};
use fv_mesh::{CellWriter, TimeSeries};
use ibm::{Forcing, SolidFraction};
use interfaces::{BodyId, Kinematics, Point};
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Writes at every snapshot `fields/NNNNN.vti` (`.vtr` on a stretched grid: λ, velocity, pressure at the cell centres) and
/// `bodies/NNNNN.vtp` ([`BodyFrames`]), the series `fields.pvd` and `bodies.pvd`, and a line per body to
/// `trajectories.csv` under the body's [serial number](Particles::serial). What is listed is complete; the lists lag a second behind at most, and the
/// output must be finished or dropped at the end.
pub struct FileOutput {
    folder: PathBuf,
    csv: BufWriter<File>,
    series: [TimeSeries; 2],
    bodies: BodyFrames,
    fraction: SolidFraction,
    lambda: Vec<f64>,
    seconds: f64,
    /// When the series were written last.
    listed: Option<Instant>,
}

/// Series are written again at most this often, and when the output is dropped.
const LIST_EVERY: Duration = Duration::from_secs(1);

/// The series of the fields and of the bodies.
const SERIES: [&str; 2] = ["fields.pvd", "bodies.pvd"];

const CSV_HEADER: &str = "\
# units: time s; x,y,z m (not wrapped into a periodic box); v m/s; q 1 (unit quaternion); w rad/s; \
f,fc N (plane scenes N per m of depth); t,tc N m. f,t: load of the fluid without buoyancy; fc,tc: contacts, mean of the last step
time,body,x,y,z,vx,vy,vz,qw,qx,qy,qz,wx,wy,wz,fx,fy,fz,tx,ty,tz,fcx,fcy,fcz,tcx,tcy,tcz";

impl FileOutput {
    /// Makes the folder and the files in it; what an earlier run listed there is listed no more.
    ///
    /// # Errors
    /// [`CouplingError::Output`] when the folder cannot be made or written to.
    pub fn new(folder: &Path) -> Result<Self, CouplingError> {
        let at = |what: &str| {
            let what = format!(
                "{what} in {} (choose a folder that you may write to, with room on its disk)",
                folder.display()
            );
            move |source| CouplingError::Output { what, source }
        };
        std::fs::create_dir_all(folder.join("fields")).map_err(at("making the output folder"))?;
        let bodies = BodyFrames::new(folder, "bodies").map_err(at("making the output folder"))?;
        let mut csv = BufWriter::new(
            File::create(folder.join("trajectories.csv")).map_err(at("making trajectories.csv"))?,
        );
        writeln!(csv, "{CSV_HEADER}").map_err(at("writing trajectories.csv"))?;
        Ok(Self::with(folder, csv, SERIES.map(|name| TimeSeries::new(folder.join(name))), bodies))
    }

    /// Goes on in a folder that an earlier run wrote up to `time` \[s\] at least; what it wrote
    /// later is dropped.
    ///
    /// # Errors
    /// [`CouplingError::Output`] when its files cannot be read or written.
    pub fn resume(folder: &Path, time: f64) -> Result<Self, CouplingError> {
        if time <= 0.0 {
            // Nothing but the start was shown, and that is shown again.
            return Self::new(folder);
        }
        let path = folder.join("trajectories.csv");
        let go_on = || {
            // Times are written with ten digits.
            let past = |t: &str| t.parse::<f64>().is_ok_and(|t| t > time * (1.0 + 1e-9));
            let text = std::fs::read_to_string(&path)?;
            let mut csv = BufWriter::new(File::create(&path)?);
            for line in text.lines().filter(|l| !l.split(',').next().is_some_and(past)) {
                writeln!(csv, "{line}")?;
            }
            csv.flush()?;
            let [fields, bodies] = SERIES.map(|name| TimeSeries::resume(folder.join(name), time));
            let series = [fields?, bodies?];
            Ok(Self::with(folder, csv, series, BodyFrames::resume(folder, "bodies")?))
        };
        go_on().map_err(|source| CouplingError::Output {
            what: format!("going on in {} (was a run interrupted there?)", folder.display()),
            source,
        })
    }

    fn with(folder: &Path, csv: BufWriter<File>, series: [TimeSeries; 2], bodies: BodyFrames) -> Self {
        let folder = folder.into();
        Self {
            folder,
            csv,
            series,
            bodies,
            fraction: SolidFraction::new(),
            lambda: Vec::new(),
            seconds: 0.0,
            listed: None,
        }
    }

    /// λ at the cell centres at the last snapshot, x fastest.
    pub fn lambda(&self) -> &[f64] {
        &self.lambda
    }
    /// Wall seconds spent on writing.
    pub fn seconds(&self) -> f64 {
        self.seconds
    }

    /// Writes the series that list all snapshots so far.
    fn list(&mut self) -> io::Result<()> {
        self.series.iter().try_for_each(TimeSeries::save)?;
        self.listed = Some(Instant::now());
        Ok(())
    }

    /// Brings the series up to date at the end of a run; dropping does it too, but cannot say that it failed.
    ///
    /// # Errors
    /// [`CouplingError::Output`] when they cannot be written.
    pub fn finish(&mut self) -> Result<(), CouplingError> {
        self.list().map_err(|source| CouplingError::Output {
            what: format!("listing the snapshots in {}", self.folder.display()),
            source,
        })
    }

    fn write<const D: usize, F: Forcing, B: RigidDynamics, S: Strategy, A: FlowSolver<D>>(
        &mut self,
        simulation: &Simulation<D, Particles<F, B, S>, A>,
        index: usize,
        info: &StepInfo,
    ) -> io::Result<()> {
        let (flow, particles) = (&simulation.flow, &simulation.particles);
        let grid = flow.grid();
        let image = CellWriter::new(grid);
        let name = format!("fields/{index:05}.{}", image.extension());
        let mut file = BufWriter::new(File::create(self.folder.join(&name))?);
        image
            .scalar("lambda", self.lambda.iter().copied())
            .vector("velocity", std::array::from_fn(|c| flow.centred_velocity(c)))
            .scalar("pressure", flow.pressure().values())
            .write(&mut file)?;
        file.flush()?;

        let corner = grid.origin();
        let corner = Point::from(std::array::from_fn(|a| corner.get(a).copied().unwrap_or(0.0)));
        let bodies = particles.bodies.rigid_bodies();
        let frame = self.bodies.write(bodies, corner, bodies.ids(), index)?;
        for (series, name) in self.series.iter_mut().zip([name, frame]) {
            series.add(info.time, name)?;
        }
        if self.listed.is_none_or(|t| t.elapsed() > LIST_EVERY) {
            self.list()?;
        }

        for b in (0..particles.bodies.n_bodies()).map(BodyId) {
            let (pose, twist) = (particles.bodies.pose(b), particles.bodies.twist(b));
            let loads = particles.report(b, if info.dt > 0.0 { info.dt } else { 1.0 });
            let serial = particles.serial(b).unwrap_or(b.0 as u64);
            write!(self.csv, "{:.9e},{serial}", info.time)?;
            let q = pose.orientation;
            let columns = [
                pose.position.coords.as_slice(),
                twist.linear.as_slice(),
                &[q.w, q.i, q.j, q.k],
                twist.angular.as_slice(),
                loads.hydrodynamic.force.as_slice(),
                loads.hydrodynamic.torque.as_slice(),
                loads.contact.force.as_slice(),
                loads.contact.torque.as_slice(),
            ];
            for v in columns.into_iter().flatten() {
                write!(self.csv, ",{v:.9e}")?;
            }
            writeln!(self.csv)?;
        }
        self.csv.flush()
    }
}

impl Drop for FileOutput {
    fn drop(&mut self) {
        // An error here has no one to go to; `finish` tells it.
        let _ = self.list();
    }
}

impl<const D: usize, F: Forcing, B: RigidDynamics, S: Strategy, A: FlowSolver<D>>
    Observer<Simulation<D, Particles<F, B, S>, A>> for FileOutput
{
    fn snapshot(
        &mut self,
        simulation: &mut Simulation<D, Particles<F, B, S>, A>,
        index: usize,
        info: &StepInfo,
    ) -> Result<(), CouplingError> {
        let start = Instant::now();
        let lattice = simulation.flow.grid().lattice(None, simulation.flow.sides());
        self.fraction.update(&lattice, &simulation.particles.bodies)?;
        self.lambda.clear();
        self.lambda.resize(simulation.flow.grid().n_cells(), 0.0);
        self.fraction.add_to_dense(&lattice, &mut self.lambda);
        let written = self.write(simulation, index, info).map_err(|source| CouplingError::Output {
            what: format!("writing snapshot {index} to {}", self.folder.display()),
            source,
        });
        self.seconds += start.elapsed().as_secs_f64();
        written
    }
}
