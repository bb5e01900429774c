//! Values along a line.
use super::{Quantity, SampleError, Sampler};
use std::io::{self, Write};

/// Samples at points evenly spread over a straight line, ends included: a table with the distance from the
/// first point, the place and one column per quantity (a velocity makes one per component).
#[derive(Clone, Debug)]
pub struct Line<'s, const D: usize> {
    sampler: &'s Sampler<D>,
    points: Vec<[f64; D]>,
    columns: Vec<(String, Vec<f64>)>,
}

impl<const D: usize> Sampler<D> {
    /// A line of `points` ≥ 2 points from `from` to `to` \[m\]. It may cross periodic sides.
    ///
    /// # Errors
    /// [`SampleError::Points`] for less than two points, [`SampleError::Outside`] if one is beyond a bounded side.
    pub fn line(&self, from: [f64; D], to: [f64; D], points: usize) -> Result<Line<'_, D>, SampleError> {
        if points < 2 {
            return Err(SampleError::Points { found: points, least: 2 });
        }
        // A box that holds both ends holds the line.
        self.inside(from)?;
        self.inside(to)?;
        let last = points - 1;
        let place = |i: usize| {
            let s = i as f64 / last as f64;
            let between = |a: usize| {
                let (low, high) = (from[a].min(to[a]), from[a].max(to[a]));
                (from[a] + s * (to[a] - from[a])).clamp(low, high)
            };
            if i == last { to } else { std::array::from_fn(between) }
        };
        Ok(Line { sampler: self, points: (0..points).map(place).collect(), columns: Vec::new() })
    }
}

impl<const D: usize> Line<'_, D> {
    /// Samples a field or a velocity along the line.
    ///
    /// # Errors
    /// [`SampleError::Grid`] if it lives on another grid.
    pub fn with<'q>(mut self, name: &str, quantity: impl Into<Quantity<'q, D>>) -> Result<Self, SampleError> {
        let quantity = quantity.into();
        self.sampler.check(&quantity)?;
        for (c, name) in quantity.columns(name).enumerate() {
            let mut column = Vec::with_capacity(self.points.len());
            for &x in &self.points {
                column.push(self.sampler.component(&quantity, c, self.sampler.inside(x)?));
            }
            self.columns.push((name, column));
        }
        Ok(self)
    }

    /// The points \[m\].
    pub fn points(&self) -> &[[f64; D]] {
        &self.points
    }

    /// Distance of each point from the first \[m\].
    pub fn distance(&self) -> impl Iterator<Item = f64> + '_ {
        self.points.iter().map(|x| (0..D).map(|a| (x[a] - self.points[0][a]).powi(2)).sum::<f64>().sqrt())
    }

    /// The column of this name.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.columns.iter().find(|(n, _)| n == name).map(|(_, c)| c.as_slice())
    }

    /// Writes the table as CSV: `s,x,y[,z]` and the columns, one row per point, numbers with all digits.
    ///
    /// # Errors
    /// What the writer answers.
    pub fn write_csv(&self, out: &mut impl Write) -> io::Result<()> {
        write!(out, "s,{}", ["x", "y", "z"][..D].join(","))?;
        for (name, _) in &self.columns {
            write!(out, ",{}", csv_name(name))?;
        }
        writeln!(out)?;
        for (i, (s, x)) in self.distance().zip(&self.points).enumerate() {
            write!(out, "{s:e}")?;
            let values = x.iter().chain(self.columns.iter().map(|(_, c)| &c[i]));
            for v in values {
                write!(out, ",{v:e}")?;
            }
            writeln!(out)?;
        }
        Ok(())
    }
}

/// A column's name as CSV wants it: in quotes if it holds a comma, a quote or a line end.
pub(super) fn csv_name(name: &str) -> String {
    if name.contains(['"', ',', '\n', '\r']) {
        format!("\"{}\"", name.replace('"', "\"\""))
    } else {
        name.to_owned()
    }
}
