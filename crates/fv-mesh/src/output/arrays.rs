//! Arrays of a file, checked.
use super::{OutputError, Precision};
use interfaces::vtk::DataArray;

/// The arrays of a file.
#[derive(Default)]
pub(crate) struct Arrays<'a> {
    names: Vec<&'a str>,
    arrays: Vec<DataArray<'a>>,
}

impl<'a> Arrays<'a> {
    pub(crate) fn new() -> Self {
        Self::default()
    }

    /// Adds an array of `components` numbers per cell for `cells` cells, of which those flagged by `keep` are taken.
    pub(crate) fn add(
        &mut self,
        name: &'a str,
        components: usize,
        cells: usize,
        precision: Precision,
        keep: Option<&[bool]>,
        values: impl IntoIterator<Item = f64>,
    ) -> Result<(), OutputError> {
        if name.is_empty() || self.names.contains(&name) {
            return Err(OutputError::Name { name: name.into() });
        }
        let expected = cells * components;
        let mut all = Vec::with_capacity(expected);
        values.into_iter().take(expected.saturating_add(1)).for_each(|value| all.push(value));
        if all.len() != expected {
            let found = all.len().div_ceil(components);
            return Err(OutputError::Count { name: name.into(), expected: cells, found });
        }
        if let Some(keep) = keep {
            let mut number = 0;
            all.retain(|_| {
                number += 1;
                keep[(number - 1) / components]
            });
        }
        if precision == Precision::Single
            && let Some(&value) = all.iter().find(|v| v.is_finite() && !(**v as f32).is_finite())
        {
            return Err(OutputError::Range { name: name.into(), value });
        }
        let array = DataArray::float(name, components, precision, all);
        self.names.push(name);
        self.arrays.push(array);
        Ok(())
    }

    pub(super) fn into_section(self) -> Vec<DataArray<'a>> {
        self.arrays
    }
}
