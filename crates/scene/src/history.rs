//! Steps, energies and budgets over a run: `history.csv`.
use crate::view::View;
use crate::watch::{Pace, Table};
use coupling::{CouplingError, LedgerReport, StepInfo};
use std::path::Path;

/// Name of the table in the folder.
pub(crate) const HISTORY: &str = "history.csv";
/// Rows of a run, or steps if there are fewer: a point for every second pixel of a plot.
const ROWS: f64 = 300.0;
/// Columns that need no ledger.
const STEPS: &str = "time,step,dt,courant,kinetic_energy";
/// Columns of the ledger, in the order of [`budgets`].
const BUDGETS: &str = "energy_gained,work,side_work,driving_work,inner_work,dissipation,eddy_dissipation,forcing_loss,contact_work,brought,energy_residual,momentum_residual,divergence";

/// Columns of a flow at a given flow rate.
const FLOW_RATE: &str = "mean_velocity,force";

/// Writes a row at every 300th of the run and after 1, 2, 4, 8, … steps.
pub(crate) struct History {
    table: Table,
    pace: Pace,
    /// Axis of a flow at a given flow rate.
    flow_rate: Option<usize>,
}

impl History {
    /// A new table, or the one that is there up to time `resume` \[s\]; of a run that ends at `end`
    /// \[s\].
    pub(crate) fn open(
        folder: &Path,
        end: f64,
        ledger: bool,
        flow_rate: Option<usize>,
        resume: Option<f64>,
    ) -> Result<Self, CouplingError> {
        let path = folder.join(HISTORY);
        let mut header =
            "# time s; dt s; courant 1; energies and works J since the start (plane scenes per m of depth)"
                .to_owned();
        if ledger {
            header += "; momentum_residual 1: momentum gained less impulses, over the impulses; divergence 1: largest |div u| dt of a step so far";
        }
        if flow_rate.is_some() {
            header += "; mean_velocity m/s, force m/s²: along the axis of flow_rate";
        }
        let columns = [Some(STEPS), ledger.then_some(BUDGETS), flow_rate.map(|_| FLOW_RATE)];
        let columns: Vec<&str> = columns.into_iter().flatten().collect();
        header = format!("{header}\n{}", columns.join(","));
        // States of versions without this table can be resumed.
        let resume = resume.filter(|_| path.exists());
        Ok(Self { table: Table::open(&path, &header, resume)?, pace: Pace::new(Some(end / ROWS)), flow_rate })
    }

    /// Writes a row if one is due.
    pub(crate) fn step(
        &mut self,
        view: &mut dyn View,
        info: &StepInfo,
        ledger: Option<&LedgerReport>,
    ) -> Result<(), CouplingError> {
        // A run that diverges early has rows, too.
        if !(info.step.is_power_of_two() || self.pace.due(info.time, info.dt)) {
            return Ok(());
        }
        let steps = [info.step as f64, info.dt, info.courant, view.kinetic_energy()];
        let driven = self.flow_rate.map(|axis| {
            let volume: f64 = (0..view.dim()).map(|a| view.axis(a).length()).product();
            let mean = view.statistics().map_or(0.0, |flow| flow.volume_flow[axis] / volume);
            [mean, view.body_force()[axis]]
        });
        let values = steps.into_iter().chain(ledger.into_iter().flat_map(budgets));
        self.table.row(info.time, None, values.chain(driven.into_iter().flatten()))
    }

    pub(crate) fn flush(&mut self) -> Result<(), CouplingError> {
        self.table.flush()
    }
}

fn budgets(l: &LedgerReport) -> [f64; 13] {
    [
        l.energy[1] - l.energy[0],
        l.work,
        l.side_work,
        l.driving_work,
        l.inner_work,
        l.dissipation,
        l.eddy_dissipation,
        l.forcing_loss,
        l.contact_work,
        l.brought,
        l.energy_residual,
        l.momentum_total,
        l.divergence,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_budget_has_a_column() {
        assert_eq!(BUDGETS.split(',').count(), budgets(&LedgerReport::default()).len());
    }
}
