//! Wall functions on rows.
use super::functions::share;
use super::statistics::WallSample;
use crate::two_equation::NOTHING;
use crate::{Scale, WallFunctions, WallShear, YPlus};
use interfaces::{SolveError, WallRow};

/// The cells beside walls.
#[derive(Clone, Debug)]
pub(crate) struct WallLayer {
    pub(crate) functions: WallFunctions,
    /// y+_lam of the functions.
    pub(crate) laminar: f64,
    /// Rows, those of a cell together.
    order: Vec<usize>,
    pub(crate) cells: Vec<WallCell>,
    /// Cells and the value of ω or ε there.
    pub(crate) pins: Vec<(usize, f64)>,
    /// The same, with the weight in between, of cells that the wall functions have a part of only.
    pub(crate) blends: Vec<(usize, f64, f64)>,
    /// ν_t on the wall of every row \[m²/s\].
    pub(crate) viscosity: Vec<f64>,
    /// Is `viscosity` that of a saved state, whose rows are still to come?
    restored: bool,
}

/// A cell beside one or several walls, and what these do to it: means over its rows, weighted by area.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct WallCell {
    pub(crate) cell: usize,
    /// Its rows in `order`.
    first: usize,
    rows: usize,
    /// Part of the logarithmic layer.
    pub(crate) share: f64,
    /// Production there, times the part \[m²/s³\].
    pub(crate) production: f64,
    /// Σ A ν/y of the viscous sublayer's flux of k, times its part \[m³/s\].
    pub(crate) conductance: f64,
    /// |∂u_t/∂n| \[1/s\].
    pub(crate) shear: Option<f64>,
    /// Share of the model's own equations.
    pub(crate) free: f64,
    /// [`WallFunctions::layer_k`] \[m²/s²\].
    pub(crate) k: f64,
}

impl WallLayer {
    pub(crate) fn new(functions: WallFunctions) -> Self {
        Self {
            laminar: functions.y_plus_laminar(),
            functions,
            order: Vec::new(),
            cells: Vec::new(),
            pins: Vec::new(),
            blends: Vec::new(),
            viscosity: Vec::new(),
            restored: false,
        }
    }

    /// ν_t on the walls as it was saved.
    pub(crate) fn restore(&mut self, viscosity: &[f64]) {
        self.viscosity.clear();
        self.viscosity.extend_from_slice(viscosity);
        self.order.clear();
        self.restored = true;
    }

    /// Sorts the rows by cell, if they are not as they were. Is there no ν_t on the walls yet?
    fn sort(&mut self, rows: &[WallRow], n: usize) -> Result<bool, SolveError> {
        let Self { order, cells, viscosity, .. } = self;
        let known = order.len() == rows.len()
            && cells.iter().all(|w| order[w.first..][..w.rows].iter().all(|&r| rows[r].cell == w.cell));
        if known {
            return Ok(false);
        }
        if let Some(row) = rows.iter().find(|r| r.cell >= n || !(r.y.is_finite() && r.y > 0.0)) {
            let (what, range) = ("the distance of a row from its wall", "positive, in a cell of the flow");
            return Err(SolveError::Value { what, cell: Some(row.cell), value: row.y, range });
        }
        order.clear();
        order.extend(0..rows.len());
        order.sort_by_key(|&r| rows[r].cell);
        cells.clear();
        for (i, &r) in order.iter().enumerate() {
            match cells.last_mut() {
                Some(last) if last.cell == rows[r].cell => last.rows += 1,
                _ => cells.push(WallCell { cell: rows[r].cell, first: i, rows: 1, ..WallCell::default() }),
            }
        }
        let fresh = !std::mem::take(&mut self.restored) || viscosity.len() != rows.len();
        if fresh {
            viscosity.clear();
            viscosity.resize(rows.len(), 0.0);
        }
        Ok(fresh)
    }

    /// [`WallFunctions::turbulent_share`].
    pub(crate) fn turbulent_share(&self, y_star: f64) -> f64 {
        share(y_star, self.laminar)
    }

    /// What the walls do, from the velocity in the rows, k of every cell and the ν_t on walls of before.
    pub(crate) fn update(
        &mut self,
        rows: &[WallRow],
        k: &[f64],
        nu: f64,
        scale: Scale,
    ) -> Result<(), SolveError> {
        if self.sort(rows, k.len())? {
            self.refresh(rows, k, nu);
        }
        let Self { functions: f, laminar, order, cells, pins, blends, viscosity, .. } = self;
        pins.clear();
        blends.clear();
        for w in cells.iter_mut() {
            let own = &order[w.first..][..w.rows];
            let (own_k, area) = (k[w.cell], own.iter().map(|&r| rows[r].area).sum::<f64>());
            let mut value = 0.0;
            (w.share, w.production, w.conductance, w.shear, w.free, w.k) =
                (0.0, 0.0, 0.0, Some(0.0), 0.0, 0.0);
            for &r in own {
                let row = &rows[r];
                let part = if area > 0.0 { row.area / area } else { 1.0 / own.len() as f64 };
                let k = f.layer_k([row.y, row.u_t], own_k, nu);
                w.k += part * k;
                let share = share(f.y_star(row.y, k, nu), *laminar);
                let friction = friction(row, nu + viscosity[r]);
                let given = match scale {
                    Scale::Omega => f.omega(row.y, k, nu),
                    Scale::Epsilon => f.epsilon(row.y, k, nu),
                };
                value += part * given;
                w.share += part * share;
                // By the shear of the law with the velocity's share in it: so k follows a flow that speeds up.
                let (place, k_there) = seen(row, own_k);
                let of_layer = f.y_star(place[0], f.layer_k(place, k_there, nu), nu);
                let shear = if of_layer > 0.0 { f.shared_y_star(place, k_there, nu) / of_layer } else { 1.0 };
                w.production += part * share * shear * f.production(scale, given, k, friction);
                w.conductance += (1.0 - share) * row.area * nu / row.y;
                let shear = match f.shear {
                    WallShear::Mean if row.seen.is_none() => row.shear,
                    // That on the line to where the flow is seen is not the mean over any cell.
                    _ => row.shear.map(|mean| share * f.log_shear(row.y, k) + (1.0 - share) * mean),
                };
                w.shear = w.shear.zip(shear).map(|(sum, shear)| sum + part * shear);
                w.free += part * row.free;
            }
            // Where k has died out ε would be below the least value, and draw that of cells behind it there.
            let value = value.max(NOTHING);
            if w.free > 0.0 {
                blends.push((w.cell, 1.0 - w.free.min(1.0), value));
            } else {
                pins.push((w.cell, value));
            }
        }
        Ok(())
    }

    /// Brings ν_t on the walls up to date with k and the velocity.
    pub(crate) fn refresh(&mut self, rows: &[WallRow], k: &[f64], nu: f64) {
        for (viscosity, row) in self.viscosity.iter_mut().zip(rows) {
            let (place, k) = seen(row, k[row.cell]);
            let y_star = self.functions.shared_y_star(place, k, nu);
            *viscosity = nu * self.functions.viscosity_ratio(y_star);
        }
    }

    /// The same of rows that may be others than before.
    pub(crate) fn see(&mut self, rows: &[WallRow], k: &[f64], nu: f64) -> Result<(), SolveError> {
        self.sort(rows, k.len())?;
        self.refresh(rows, k, nu);
        Ok(())
    }

    /// y+ of the rows, of a model that holds from y+ `from` on.
    pub(crate) fn y_plus(&self, rows: &[WallRow], nu: f64, from: f64) -> YPlus {
        let laminar = nu * self.functions.viscosity_ratio(self.laminar);
        let samples = rows.iter().zip(&self.viscosity).map(|(row, nu_t)| {
            let y = row.seen.map_or(row.y, |seen| seen.y);
            let y_plus = y * friction(row, nu + nu_t).sqrt() / nu;
            WallSample { y_plus, area: row.area, laminar: *nu_t < laminar }
        });
        YPlus::of(samples, from)
    }
}

/// Distance and tangential velocity where a row sees the flow, and k there, `k` at the centre.
fn seen(row: &WallRow, k: f64) -> ([f64; 2], f64) {
    row.seen.map_or(([row.y, row.u_t], k), |seen| ([seen.y, seen.u_t], seen.k))
}

/// τ_w/ρ \[m²/s²\], with the viscosity on the wall where it is not known.
fn friction(row: &WallRow, viscosity: f64) -> f64 {
    let ([y, u_t], _) = seen(row, row.k);
    row.friction.unwrap_or(viscosity * u_t / y)
}
