//! Values on a plane.
use super::line::csv_name;
use super::{Quantity, SampleError, Sampler};
use crate::output::{OutputError, Precision, write_cells};
use std::io::{self, Write};

/// Samples on a plane normal to an axis, at the centres of the cells that it cuts along the other axes: per quantity a
/// 2-D array (in a plane grid a line of values), the lower of the other axes fastest.
#[derive(Clone, Debug)]
pub struct Plane<'s, const D: usize> {
    sampler: &'s Sampler<D>,
    axis: usize,
    at: f64,
    /// Name, components and one array per component.
    quantities: Vec<(String, Vec<Vec<f64>>)>,
}

impl<const D: usize> Sampler<D> {
    /// The plane x_axis = `at` \[m\].
    ///
    /// # Errors
    /// [`SampleError::Axis`] if there is no such axis, [`SampleError::Outside`] if the plane is beyond a bounded side.
    pub fn plane(&self, axis: usize, at: f64) -> Result<Plane<'_, D>, SampleError> {
        if axis >= D {
            return Err(SampleError::Axis { axis, axes: D });
        }
        let at = self.inside_axis(axis, at)?;
        Ok(Plane { sampler: self, axis, at, quantities: Vec::new() })
    }
}

impl<const D: usize> Plane<'_, D> {
    /// Samples a field or a velocity on the plane.
    ///
    /// # Errors
    /// [`SampleError::Grid`] if it lives on another grid.
    pub fn with<'q>(mut self, name: &str, quantity: impl Into<Quantity<'q, D>>) -> Result<Self, SampleError> {
        let quantity = quantity.into();
        self.sampler.check(&quantity)?;
        let components = (0..quantity.components())
            .map(|c| self.points().map(|x| self.sampler.component(&quantity, c, x)).collect())
            .collect();
        self.quantities.push((name.to_owned(), components));
        Ok(self)
    }

    /// The axes that the plane extends along: the first is the faster one of the arrays.
    pub fn axes(&self) -> impl Iterator<Item = usize> + use<D> {
        let normal = self.axis;
        (0..D).filter(move |&a| a != normal)
    }
    /// The coordinates of the values along axis `a` \[m\]; that of the plane along its normal.
    pub fn coordinates(&self, a: usize) -> Vec<f64> {
        let axis = self.sampler.grid().axis(a);
        if a == self.axis { vec![self.at] } else { (0..axis.cells()).map(|i| axis.centre(i)).collect() }
    }
    /// Component `c` (0 for a scalar) of the quantity of this name, as an array.
    pub fn values(&self, name: &str, c: usize) -> Option<&[f64]> {
        let (_, components) = self.quantities.iter().find(|(n, _)| n == name)?;
        components.get(c).map(Vec::as_slice)
    }
    /// The points \[m\] in the order of the arrays.
    pub fn points(&self) -> impl Iterator<Item = [f64; D]> + '_ {
        let (grid, normal, at) = (self.sampler.grid(), self.axis, self.at);
        let mut shape = grid.cells();
        shape[normal] = 1;
        (0..shape.iter().product()).map(move |mut index: usize| {
            std::array::from_fn(|a| {
                let i = index % shape[a];
                index /= shape[a];
                if a == normal { at } else { grid.axis(a).centre(i) }
            })
        })
    }

    /// Writes a table as CSV: `x,y[,z]` and one column per component, one row per point, numbers with all digits.
    ///
    /// # Errors
    /// What the writer answers.
    pub fn write_csv(&self, out: &mut impl Write) -> io::Result<()> {
        write!(out, "{}", ["x", "y", "z"][..D].join(","))?;
        for (name, components) in &self.quantities {
            for c in 0..components.len() {
                let suffix = if components.len() == 1 { "" } else { ["_x", "_y", "_z"][c] };
                write!(out, ",{}", csv_name(&format!("{name}{suffix}")))?;
            }
        }
        writeln!(out)?;
        for (i, x) in self.points().enumerate() {
            let columns = self.quantities.iter().flat_map(|(_, components)| components);
            for (k, v) in x.iter().chain(columns.map(|c| &c[i])).enumerate() {
                write!(out, "{}{v:e}", if k == 0 { "" } else { "," })?;
            }
            writeln!(out)?;
        }
        Ok(())
    }

    /// The extension of what [`write_vtk`](Self::write_vtk) writes: `vti`, or `vtr` if an axis of the plane is
    /// stretched.
    pub fn extension(&self) -> &'static str {
        if self.is_uniform() { "vti" } else { "vtr" }
    }

    fn is_uniform(&self) -> bool {
        self.axes().all(|a| self.sampler.grid().axis(a).is_uniform())
    }

    /// Writes the plane for ParaView, at its place in space.
    ///
    /// # Errors
    /// [`OutputError::Name`] for names that are empty or come twice, [`OutputError::Range`] for a value beyond single
    /// precision, [`OutputError::Io`] for what the writer answers.
    pub fn write_vtk(&self, out: &mut impl Write, precision: Precision) -> Result<(), OutputError> {
        let flat = [0.0];
        let at = [self.at];
        let faces: [&[f64]; 3] = std::array::from_fn(|a| match a {
            a if a >= D => &flat[..],
            a if a == self.axis => &at[..],
            a => self.sampler.grid().axis(a).faces(),
        });
        let mut arrays = crate::output::Arrays::new();
        for (name, components) in &self.quantities {
            let width = if components.len() == 1 { 1 } else { 3 };
            let n = components[0].len();
            let values = (0..width * n).map(|i| components.get(i % width).map_or(0.0, |c| c[i / width]));
            arrays.add(name, width, n, precision, None, [values])?;
        }
        write_cells(out, faces, self.is_uniform(), arrays)
    }
}
