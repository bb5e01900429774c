//! Loads on bodies, with means, amplitudes and frequencies.
use super::Watch;
use super::table::{Pace, Table};
use super::trajectories::called;
use crate::setup::Forces;
use crate::view::View;
use coupling::{CouplingError, StepInfo};
use fv_mesh::Fluid;
use interfaces::{BodyId, Checkpoint, RestartError, Wrench};
use serde_json::{Value, json};
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// Writes the fluid's loads on every body to `forces.csv` and keeps sums of those that were there from the start.
pub(crate) struct ForcesWatch {
    forces: Forces,
    table: Table,
    pace: Pace,
    names: Vec<String>,
    fluid: Fluid,
    sums: Vec<Sums>,
    /// Pressure and friction at the end.
    parts: Vec<[Wrench; 2]>,
}

/// Statistics of one body's load (fx, fy, fz and the torque's components) since means began.
#[derive(Clone, Copy, Debug)]
struct Sums {
    seconds: f64,
    mean: [f64; 6],
    /// ∫ (f − mean)² dt, which rounding does not spoil where loads hardly vary (Welford 1962, weighted: West 1979).
    square: [f64; 6],
    low: [f64; 6],
    high: [f64; 6],
    last: [f64; 6],
    /// Of the component across the flow (y): the means' crossings upwards — how many, when the first and the last was — and the value
    /// before; relative to the running mean.
    crossings: [f64; 4],
}

const NUMBERS: usize = 6 * 5 + 5;

impl Default for Sums {
    fn default() -> Self {
        Self {
            seconds: 0.0,
            mean: [0.0; 6],
            square: [0.0; 6],
            low: [f64::INFINITY; 6],
            high: [f64::NEG_INFINITY; 6],
            last: [0.0; 6],
            crossings: [0.0; 4],
        }
    }
}

impl Sums {
    fn add(&mut self, load: [f64; 6], time: f64, dt: f64) {
        self.seconds += dt;
        for i in 0..6 {
            let off = load[i] - self.mean[i];
            self.mean[i] += off * dt / self.seconds;
            self.square[i] += dt * off * (load[i] - self.mean[i]);
            self.low[i] = self.low[i].min(load[i]);
            self.high[i] = self.high[i].max(load[i]);
        }
        // Where the lift crosses its mean upwards, found linearly within the step.
        let now = load[1] - self.mean[1];
        let before = self.crossings[3];
        if before < 0.0 && now >= 0.0 {
            let at = time - dt * now / (now - before);
            if self.crossings[0] == 0.0 {
                self.crossings[1] = at;
            }
            self.crossings[2] = at;
            self.crossings[0] += 1.0;
        }
        self.crossings[3] = now;
    }
    fn numbers(&self) -> [f64; NUMBERS] {
        let mut out = [0.0; NUMBERS];
        let parts = [&self.mean, &self.square, &self.low, &self.high, &self.last];
        for (k, part) in parts.into_iter().enumerate() {
            out[6 * k..6 * k + 6].copy_from_slice(part);
        }
        out[30] = self.seconds;
        out[31..].copy_from_slice(&self.crossings);
        out
    }
    fn of(n: &[f64; NUMBERS]) -> Self {
        let part = |k: usize| std::array::from_fn(|i| n[6 * k + i]);
        Self {
            mean: part(0),
            square: part(1),
            low: part(2),
            high: part(3),
            last: part(4),
            seconds: n[30],
            crossings: [n[31], n[32], n[33], n[34]],
        }
    }
    /// Frequency of the lift \[1/s\], if it went to and fro twice at least, and by more than round-off.
    fn frequency(&self) -> Option<f64> {
        let [count, first, last, _] = self.crossings;
        let largest = self.high.iter().zip(&self.low).map(|(h, l)| h.abs().max(l.abs())).fold(0.0, f64::max);
        let swings = self.high[1] - self.low[1] > 1e-6 * largest;
        (swings && count > 2.0 && last > first).then(|| (count - 1.0) / (last - first))
    }
}

impl ForcesWatch {
    pub(crate) fn new(
        folder: &Path,
        forces: Forces,
        names: Vec<String>,
        fluid: Fluid,
        resume: Option<f64>,
    ) -> Result<Self, CouplingError> {
        let mut header =
            "# time s; f N and t N m (plane scenes per m of depth): load of the fluid without buoyancy"
                .to_owned();
        if forces.parts {
            header += "; p and v N: its pressure and its friction";
        }
        header += "\ntime,body,fx,fy,fz,tx,ty,tz";
        if forces.parts {
            header += ",px,py,pz,vx,vy,vz";
        }
        let table = Table::open(&folder.join("forces.csv"), &header, resume)?;
        let names: Vec<String> = names.into_iter().map(|name| name.replace([',', '\n', '"'], "_")).collect();
        let sums = vec![Sums::default(); names.len()];
        let parts = Vec::new();
        Ok(Self { pace: Pace::new(forces.every), forces, table, names, fluid, sums, parts })
    }
}

impl ForcesWatch {
    /// Dynamic viscosity \[Pa s\].
    fn viscosity(&self) -> f64 {
        self.fluid.density * self.fluid.viscosity
    }
}

impl Checkpoint for ForcesWatch {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        sink("sums", &self.sums.iter().flat_map(Sums::numbers).collect::<Vec<_>>());
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        let numbers = RestartError::take(source, "sums", NUMBERS * self.sums.len())?;
        self.sums = numbers.as_chunks::<NUMBERS>().0.iter().map(Sums::of).collect();
        Ok(())
    }
}

impl Watch for ForcesWatch {
    fn name(&self) -> &'static str {
        "forces"
    }
    fn tables(&self) -> Vec<String> {
        vec!["forces.csv".into()]
    }
    fn step(&mut self, view: &mut dyn View, info: &StepInfo) -> Result<(), CouplingError> {
        let due = self.pace.due(info.time, info.dt);
        for b in (0..view.bodies().n_bodies()).map(BodyId) {
            let [load, _] = view.loads(b, info.dt);
            let values: [f64; 6] =
                std::array::from_fn(|i| if i < 3 { load.force[i] } else { load.torque[i - 3] });
            let serial = view.serial(b);
            if let Some(sums) = self.sums.get_mut(serial as usize) {
                sums.last = values;
                if info.time > self.forces.start {
                    sums.add(values, info.time, info.dt);
                }
            }
            if due {
                let parts =
                    if self.forces.parts { Some(view.load_parts(b, self.viscosity())?) } else { None };
                let parts = parts.iter().flatten().flat_map(|part| part.force.iter().copied());
                self.table.row(
                    info.time,
                    Some(&called(&self.names, serial)),
                    values.into_iter().chain(parts),
                )?;
            }
        }
        Ok(())
    }
    fn finish(&mut self, view: &mut dyn View, _: &AtomicBool) -> Result<(), CouplingError> {
        if self.forces.parts {
            let all = (0..view.bodies().n_bodies()).map(BodyId);
            let parts = all.map(|b| view.load_parts(b, self.viscosity()));
            self.parts = parts.collect::<Result<_, _>>()?;
        }
        Ok(())
    }
    fn flush(&mut self) -> Result<(), CouplingError> {
        self.table.flush()
    }
    fn results(&self) -> Option<Value> {
        let scale = self.forces.reference.map(|(u, a)| 2.0 / (self.fluid.density * u * u * a));
        let of = |sums: &Sums, factor: f64, n: usize| {
            let column = |f: &dyn Fn(usize) -> f64| (0..n).map(|i| factor * f(i)).collect::<Vec<f64>>();
            if sums.seconds == 0.0 {
                return json!({ "last": column(&|i| sums.last[i]) });
            }
            if self.forces.steady {
                return json!({ "last": column(&|i| sums.last[i]), "mean": column(&|i| sums.mean[i]) });
            }
            let variance = |i: usize| sums.square[i] / sums.seconds;
            json!({
                "last": column(&|i| sums.last[i]),
                "mean": column(&|i| sums.mean[i]),
                // About the mean: C′ of the literature (Norberg 2003).
                "deviation": column(&|i| variance(i).sqrt()),
                "rms": column(&|i| sums.mean[i].hypot(variance(i).sqrt())),
                "amplitude": column(&|i| 0.5 * (sums.high[i] - sums.low[i])),
                "lowest": column(&|i| sums.low[i]),
                "highest": column(&|i| sums.high[i]),
            })
        };
        let body = |(number, (name, sums)): (usize, (&String, &Sums))| {
            let mut out = json!({ "body": name, "load": of(sums, 1.0, 6) });
            if !self.forces.steady {
                out["seconds"] = json!(sums.seconds);
            }
            if let Some([pressure, friction]) = self.parts.get(number) {
                let part = |part: &Wrench, factor: f64| -> Vec<f64> {
                    part.force.iter().map(|f| factor * f).collect()
                };
                out["pressure"] = json!({ "last": part(pressure, 1.0) });
                out["friction"] = json!({ "last": part(friction, 1.0) });
                if let Some(scale) = scale {
                    out["pressure"]["coefficients"] = json!(part(pressure, scale));
                    out["friction"]["coefficients"] = json!(part(friction, scale));
                }
            }
            if let Some(scale) = scale {
                out["coefficients"] = of(sums, scale, 3);
                out["coefficient_per_newton"] = json!(scale);
            }
            if let Some(frequency) = sums.frequency() {
                out["frequency"] = json!(frequency);
                if let (Some((u, _)), Some(length)) = (self.forces.reference, self.forces.length) {
                    out["strouhal"] = json!(frequency * length / u);
                }
            }
            out
        };
        Some(json!(self.names.iter().zip(&self.sums).enumerate().map(body).collect::<Vec<Value>>()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sine about a mean that is 10⁹ times larger, in steps that differ: mean, deviation about it and amplitude.
    #[test]
    fn loads_that_hardly_vary_have_their_deviation() {
        let (mean, amplitude) = (1e6, 1e-3);
        let mut sums = Sums::default();
        let steps = 4000;
        let mut time = 0.0;
        for i in 0..steps {
            let dt = if i % 2 == 0 { 0.5e-3 } else { 1.5e-3 };
            time += dt;
            let load = mean + amplitude * (std::f64::consts::TAU * 5.0 * (time - 0.5 * dt)).sin();
            sums.add([load; 6], time, dt);
        }
        assert!((sums.mean[0] / mean - 1.0).abs() < 1e-14, "{}", sums.mean[0]);
        let deviation = (sums.square[0] / sums.seconds).sqrt();
        assert!((deviation / (amplitude / 2.0_f64.sqrt()) - 1.0).abs() < 1e-3, "{deviation}");
    }
}
