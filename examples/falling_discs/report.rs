//! The closing table and `result.json`.
use crate::observers::{Fall, History};
use example_support::scene::{FLUID, Scene};
use example_support::table::{Table, grouped, number, write_json};
use render::cpu::{self, Elapsed};
use serde_json::json;
use siltflow::coupling::{LedgerReport, Module, RunSummary, Schedule};
use siltflow::ibm::Forcing;
use siltflow::interfaces::{Bodies, BodyId, Kinematics, Vector};
use std::io::{self, Write};
use std::path::Path;

/// All there is to tell about a run.
pub(crate) struct Outcome<'a, F> {
    pub(crate) scene: &'a Scene,
    pub(crate) schedule: &'a Schedule,
    pub(crate) summary: RunSummary,
    pub(crate) simulation: &'a mut Fall<F>,
    pub(crate) ledger: &'a LedgerReport,
    pub(crate) history: &'a History,
    pub(crate) elapsed: Elapsed,
    pub(crate) output_seconds: f64,
    pub(crate) threads: usize,
    pub(crate) out: &'a Path,
}

impl<F: Forcing> Outcome<'_, F> {
    pub(crate) fn tell(self) -> io::Result<()> {
        let (flow, particles) = (&self.simulation.flow, &self.simulation.particles);
        let [nx, ny] = self.scene.cells();
        let cells = nx * ny;
        let steps = self.summary.steps.max(1);
        let timings = self.simulation.timings();
        let in_steps: f64 = Module::ALL.into_iter().map(|m| timings.seconds(m)).sum();
        let us_per_cell_step = 1e6 * in_steps / (cells as f64 * steps as f64);
        let (l, h) = (self.ledger, self.history);
        let volume = flow.grid().volume();
        let bodies: Vec<_> = (0..particles.bodies.n_bodies()).map(BodyId).collect();
        let nominal: Vector = bodies
            .iter()
            .map(|&b| {
                let i = particles.bodies.inertia(b);
                (i.mass - FLUID.density * i.volume) * particles.gravity()
            })
            .sum();
        let gap = (h.smallest_gap.0.is_finite()).then_some(h.smallest_gap.0);

        let mut t = Table::new();
        t.section("Run");
        t.row("cells", format!("{nx} × {ny} = {}", grouped(cells as u64)), "");
        t.row("steps", grouped(self.summary.steps), "");
        t.row("simulated time", number(flow.time()), "s");
        t.row("longest time step", number(1e3 * self.summary.dt[1]), "ms");
        t.row("largest Courant number", number(self.summary.courant), "");
        t.section("Cost");
        t.row("processor time", number(self.elapsed.cpu), "s");
        t.row("wall time", number(self.elapsed.wall), "s");
        t.row("per cell and step", number(us_per_cell_step), "µs");
        for module in Module::ALL {
            t.row(&format!("  {}", module.name()), number(timings.seconds(module)), "s");
        }
        t.row("  output", number(self.output_seconds), "s");
        if let Some(bytes) = cpu::peak_memory() {
            t.row("peak memory", number(bytes as f64 / 1e6), "MB");
        }
        t.section("Ledger");
        t.row("divergence × time step", number(l.divergence), "");
        t.row("momentum residual of a step / Σ|impulse|", number(l.momentum_step), "");
        t.row("momentum residual of the run / Σ|impulse|", number(l.momentum_total), "");
        t.row("momentum between fluid and bodies", number(l.in_transit), "N s");
        t.row("kinetic energy gained", number(l.energy[1] - l.energy[0]), "J");
        t.row("work of net weight and body force", number(l.work), "J");
        t.row("work of contacts", number(l.contact_work), "J");
        t.row("viscous dissipation", number(l.dissipation), "J");
        t.row("energy not accounted for / work", number(l.energy_residual / l.work.abs().max(1e-300)), "");
        t.section("Bodies");
        if !self.scene.floor {
            t.row("body force that holds the net weight", number(h.body_force), "m/s²");
            t.row("  −Σ(ρs−ρ)Vg/(ρ V_Ω)", number(nominal.norm() / (FLUID.density * volume)), "m/s²");
            t.row("largest |mean of u over fluid and solid| / speed", number(h.mean_flow), "");
        }
        t.row("largest slip at the surfaces / speed", number(h.slip), "");
        if let Some(gap) = gap {
            t.row("smallest gap", number(1e6 * gap), "µm");
            t.row("  in cells", number(gap / flow.grid().spacing()[0]), "");
            t.row("  at", number(h.smallest_gap.1), "s");
        }
        t.row("time in contact", number(h.contact_seconds), "s");
        let rows = bodies.iter().map(|&b| {
            let (pose, twist) = (particles.bodies.pose(b), particles.bodies.twist(b));
            let density = self.scene.densities[b.0 % self.scene.densities.len()];
            let values = [
                density,
                1e3 * pose.position.x,
                1e3 * pose.position.y,
                1e3 * twist.linear.x,
                1e3 * twist.linear.y,
                twist.angular.z,
            ];
            std::iter::once(b.0.to_string()).chain(values.map(number)).collect()
        });
        t.matrix(
            &["body", "ρ kg/m³", "x mm", "y mm", "vx mm/s", "vy mm/s", "ω rad/s"],
            rows.take(12).collect(),
        );
        t.note(&format!("files are in {}", self.out.display()));
        let end_state: Vec<_> = bodies
            .iter()
            .map(|&b| {
                let (pose, twist) = (particles.bodies.pose(b), particles.bodies.twist(b));
                let q = pose.orientation;
                json!({
                    "density": self.scene.densities[b.0 % self.scene.densities.len()],
                    "position": pose.position.coords.as_slice(),
                    "velocity": twist.linear.as_slice(),
                    "speed": twist.linear.norm(),
                    "orientation_wxyz": [q.w, q.i, q.j, q.k],
                    "angular_velocity": twist.angular.as_slice(),
                })
            })
            .collect();
        let modules: serde_json::Map<_, _> = Module::ALL
            .into_iter()
            .map(|m| (m.name().to_owned(), json!(timings.seconds(m))))
            .chain([("output".to_owned(), json!(self.output_seconds))])
            .collect();
        let ledger = json!({
            "divergence_dt": l.divergence,
            "momentum_residual_step": l.momentum_step,
            "momentum_residual_total": l.momentum_total,
            "impulses": l.impulses,
            "momentum_in_transit": l.in_transit,
            "volume_flow": l.volume_flow.as_slice(),
            "kinetic_energy": l.energy,
            "work": l.work,
            "contact_work": l.contact_work,
            "dissipation": l.dissipation,
            "energy_residual": l.energy_residual,
        });
        let result = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "cells": cells,
            "cells_xy": [nx, ny],
            "cells_per_diameter": self.scene.cells_per_diameter,
            "bodies": self.scene.bodies,
            "densities": self.scene.densities,
            "diameter": self.scene.diameter,
            "floor": self.scene.floor,
            "snapshots": self.schedule.intervals + 1,
            "units": "SI, per metre of depth",
            "steps": self.summary.steps,
            "stopped": self.summary.stopped,
            "time": flow.time(),
            "end": self.schedule.end,
            "dt": self.summary.dt,
            "largest_courant": self.summary.courant,
            "threads": self.threads,
            "cpu_seconds": self.elapsed.cpu,
            "wall_seconds": self.elapsed.wall,
            "us_per_cell_step": us_per_cell_step,
            "seconds_by_module": modules,
            "peak_memory_bytes": cpu::peak_memory(),
            "end_state": end_state,
            "smallest_gap": gap,
            "smallest_gap_time": gap.map(|_| h.smallest_gap.1),
            "contact_seconds": h.contact_seconds,
            "largest_slip_over_speed": h.slip,
            "body_force": h.body_force,
            "net_weight_over_mass_of_box": nominal.norm() / (FLUID.density * volume),
            "largest_mean_flow_over_speed": h.mean_flow,
            "ledger": ledger,
        });
        let path = self.out.join("result.json");
        write_json(&path, &result)
            .map_err(|e| io::Error::new(e.kind(), format!("writing {}: {e}", path.display())))?;
        // Whoever reads the table may have stopped reading; the run is none the worse for it.
        let _ = writeln!(io::stdout(), "{t}");
        Ok(())
    }
}
