//! Velocity at the start, from a snapshot of another run.
use fv_mesh::Axis;
use mor::snapshots::VtkFile;
use std::path::Path;

/// Velocity at the centres of equal cells, interpolated linearly in between.
#[derive(Clone, Debug)]
pub(crate) struct StartField {
    cells: [usize; 3],
    spacing: [f64; 3],
    /// Centre of the first cell \[m\].
    first: [f64; 3],
    periodic: [bool; 3],
    /// Components, x fastest \[m/s\].
    velocity: [Vec<f64>; 3],
}

/// Share of a cell by which boxes may differ.
const ROUND_OFF: f64 = 1e-3;

impl StartField {
    /// Reads the velocity at cells of the image at `path` for a box with these `axes`, `periodic` or
    /// not.
    ///
    /// # Errors
    /// A file that is no image with a velocity, is of other dimensions or does not cover the box.
    pub(crate) fn read(path: &Path, axes: &[Axis], periodic: &[bool]) -> Result<Self, String> {
        let file = VtkFile::open(path).map_err(|e| e.to_string())?;
        let grid = file.grid().ok_or("this is no image of equal cells; give a .vti file")?;
        let (cells, spacing) = (grid.cells(), grid.spacing());
        let first: [f64; 3] = grid.first().coords.into();
        if (cells[2] == 1) != (axes.len() == 2) {
            return Err("plane and spatial fields do not go together; give one of as many axes".into());
        }
        let mut out = Self { cells, spacing, first, periodic: [false; 3], velocity: Default::default() };
        for (a, axis) in axes.iter().enumerate() {
            let [from, to] = out.ends(a);
            let slack = ROUND_OFF * spacing[a];
            if axis.lower() < from - slack || axis.upper() > to + slack {
                return Err(format!(
                    "the field reaches from {from} to {to} m along {}, the box from {} to {} m; \
                     give a field that covers the box",
                    ["x", "y", "z"][a],
                    axis.lower(),
                    axis.upper()
                ));
            }
            out.periodic[a] = periodic[a] && (axis.length() - (to - from)).abs() <= slack;
        }
        let values = file.field("velocity").map_err(|e| e.to_string())?;
        let n: usize = cells.iter().product();
        if values.len() != 3 * n {
            return Err(format!("the velocity has {} values; {} are needed", values.len(), 3 * n));
        }
        if let Some(value) = values.iter().find(|u| !u.is_finite()) {
            return Err(format!("the velocity is {value} somewhere; give a field of finite values"));
        }
        let (u, rest) = values.split_at(n);
        let (v, w) = rest.split_at(n);
        out.velocity = [u, v, w].map(<[f64]>::to_vec);
        Ok(out)
    }

    /// Ends of its box along axis `a` \[m\].
    fn ends(&self, a: usize) -> [f64; 2] {
        let from = self.first[a] - 0.5 * self.spacing[a];
        [from, from + self.cells[a] as f64 * self.spacing[a]]
    }

    /// Velocity at a place \[m/s\].
    pub(crate) fn at(&self, x: [f64; 3]) -> [f64; 3] {
        // Cells on both sides along each axis, and the weight of the second.
        let sides: [(usize, usize, f64); 3] = std::array::from_fn(|a| {
            let n = self.cells[a];
            let place = (x[a] - self.first[a]) / self.spacing[a];
            if n == 1 {
                return (0, 0, 0.0);
            }
            if self.periodic[a] {
                let place = place.rem_euclid(n as f64);
                let low = (place as usize).min(n - 1);
                return (low, (low + 1) % n, place - low as f64);
            }
            let place = place.clamp(0.0, (n - 1) as f64);
            let low = (place as usize).min(n - 2);
            (low, low + 1, place - low as f64)
        });
        let mut out = [0.0; 3];
        for corner in 0..8 {
            let (mut index, mut weight) = ([0; 3], 1.0);
            for (a, (low, high, share)) in sides.iter().enumerate() {
                let second = corner >> a & 1 == 1;
                index[a] = if second { *high } else { *low };
                weight *= if second { *share } else { 1.0 - share };
            }
            if weight != 0.0 {
                let cell = index[0] + self.cells[0] * (index[1] + self.cells[1] * index[2]);
                out.iter_mut().zip(&self.velocity).for_each(|(out, u)| *out += weight * u[cell]);
            }
        }
        out
    }

    /// The largest speed at a cell \[m/s\].
    pub(crate) fn speed(&self) -> f64 {
        let [u, v, w] = &self.velocity;
        let squares = u.iter().zip(v).zip(w).map(|((u, v), w)| u * u + v * v + w * w);
        squares.fold(0.0, f64::max).sqrt()
    }
}
