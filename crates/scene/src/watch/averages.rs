//! Means in time.
use super::{Watch, output};
use crate::setup::Averages;
use crate::view::View;
use coupling::{CouplingError, StepInfo};
use interfaces::{Checkpoint, RestartError};
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// Table of the means over two axes.
const PROFILE: &str = "profile.csv";

/// Keeps ∫u dt, ∫p dt and ∫uᵢuⱼ dt of every cell since means began; writes `averages.vti` and, if asked for, `profile.csv`.
pub(crate) struct AveragesWatch {
    folder: PathBuf,
    averages: Averages,
    dim: usize,
    seconds: f64,
    /// u, v, w, p, then uu, vv, ww, uv, uw, vw; of a plane flow u, v, p, uu, vv, uv.
    sums: Vec<Vec<f64>>,
    fields: Vec<Vec<f64>>,
}

/// Pairs of components whose products are kept.
fn pairs(dim: usize) -> &'static [(usize, usize)] {
    if dim == 2 { &[(0, 0), (1, 1), (0, 1)] } else { &[(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)] }
}

impl AveragesWatch {
    pub(crate) fn new(folder: &Path, averages: Averages, dim: usize, cells: usize) -> Self {
        let sums = vec![vec![0.0; cells]; dim + 1 + pairs(dim).len()];
        Self { folder: folder.into(), averages, dim, seconds: 0.0, sums, fields: vec![Vec::new(); dim + 1] }
    }

    /// Means and Reynolds stresses ⟨uᵢ′uⱼ′⟩ of every cell, in the order of the sums.
    fn means(&self) -> Vec<Vec<f64>> {
        let mut means: Vec<Vec<f64>> =
            self.sums.iter().map(|sum| sum.iter().map(|s| s / self.seconds).collect()).collect();
        for (k, &(i, j)) in pairs(self.dim).iter().enumerate() {
            let (first, rest) = means.split_at_mut(self.dim + 1);
            for (c, stress) in rest[k].iter_mut().enumerate() {
                *stress -= first[i][c] * first[j][c];
            }
        }
        means
    }

    fn profile(&self, view: &dyn View, axis: usize, means: &[Vec<f64>]) -> io::Result<()> {
        let n: [usize; 3] = [0, 1, 2].map(|a| if a < self.dim { view.axis(a).cells() } else { 1 });
        let stride = [1, n[0], n[0] * n[1]];
        // Plane means by volume; stresses are of all that differs from the plane's mean.
        let mut rows = vec![vec![0.0; means.len() + 1]; n[axis]];
        for (c, _) in means[0].iter().enumerate() {
            let cell = [0, 1, 2].map(|a| c / stride[a] % n[a]);
            let volume: f64 = (0..self.dim).map(|a| view.axis(a).width(cell[a])).product();
            let row = &mut rows[cell[axis]];
            row[means.len()] += volume;
            for (k, mean) in means.iter().enumerate() {
                let stress = k.checked_sub(self.dim + 1).map(|k| pairs(self.dim)[k]);
                let raw = stress.map_or(0.0, |(i, j)| means[i][c] * means[j][c]);
                row[k] += volume * (mean[c] + raw);
            }
        }
        let mut file = BufWriter::new(File::create(self.folder.join(PROFILE))?);
        let names = if self.dim == 2 { "u,v,p,uu,vv,uv" } else { "u,v,w,p,uu,vv,ww,uv,uw,vw" };
        writeln!(
            file,
            "# means over {:.6e} s and the other axes: place m; u m/s; p Pa; uu … Reynolds stresses m²/s²",
            self.seconds
        )?;
        writeln!(file, "{},{names}", ["x", "y", "z"][axis])?;
        for (i, row) in rows.iter_mut().enumerate() {
            let volume = row[means.len()];
            row.iter_mut().for_each(|v| *v /= volume);
            for (k, &(a, b)) in pairs(self.dim).iter().enumerate() {
                row[self.dim + 1 + k] -= row[a] * row[b];
            }
            write!(file, "{:.9e}", view.axis(axis).centre(i))?;
            row[..means.len()].iter().try_for_each(|v| write!(file, ",{v:.9e}"))?;
            writeln!(file)?;
        }
        file.flush()
    }
}

impl Checkpoint for AveragesWatch {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        sink("seconds", &[self.seconds]);
        for (k, sum) in self.sums.iter().enumerate() {
            sink(&format!("sum{k}"), sum);
        }
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.seconds = RestartError::take(source, "seconds", 1)?[0];
        for (k, sum) in self.sums.iter_mut().enumerate() {
            RestartError::fill(source, &format!("sum{k}"), sum)?;
        }
        Ok(())
    }
}

impl Watch for AveragesWatch {
    fn name(&self) -> &'static str {
        "averages"
    }
    fn tables(&self) -> Vec<String> {
        self.averages.profile.iter().map(|_| PROFILE.into()).collect()
    }
    fn step(&mut self, view: &mut dyn View, info: &StepInfo) -> Result<(), CouplingError> {
        if info.time <= self.averages.start {
            return Ok(());
        }
        self.seconds += info.dt;
        view.centred(&mut self.fields[..self.dim]);
        view.pressure(&mut self.fields[self.dim]);
        let (first, products) = self.sums.split_at_mut(self.dim + 1);
        for (sum, field) in first.iter_mut().zip(&self.fields) {
            sum.iter_mut().zip(field).for_each(|(s, v)| *s += info.dt * v);
        }
        for (sum, &(i, j)) in products.iter_mut().zip(pairs(self.dim)) {
            let both = self.fields[i].iter().zip(&self.fields[j]);
            sum.iter_mut().zip(both).for_each(|(s, (a, b))| *s += info.dt * a * b);
        }
        Ok(())
    }
    fn finish(&mut self, view: &mut dyn View, _: &AtomicBool) -> Result<(), CouplingError> {
        if self.seconds == 0.0 {
            return Ok(());
        }
        let means = self.means();
        let path = self.folder.join(format!("averages.{}", view.extension()));
        let names = ["uu", "vv", "ww", "uv", "uw", "vw"];
        let names = if self.dim == 2 { vec![names[0], names[1], names[3]] } else { names.to_vec() };
        let mut fields: Vec<(&str, Vec<&[f64]>)> = vec![
            ("velocity", means[..self.dim].iter().map(Vec::as_slice).collect()),
            ("pressure", vec![&means[self.dim]]),
        ];
        fields.extend(
            names.into_iter().zip(&means[self.dim + 1..]).map(|(name, mean)| (name, vec![mean.as_slice()])),
        );
        let write = || -> io::Result<()> {
            let mut file = BufWriter::new(File::create(&path)?);
            view.write_named(&fields, &mut file).map_err(io::Error::other)?;
            file.flush()
        };
        write().map_err(output("writing", &path))?;
        if let Some(axis) = self.averages.profile {
            let path = self.folder.join(PROFILE);
            self.profile(view, axis, &means).map_err(output("writing", &path))?;
        }
        Ok(())
    }
}
