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
        let (mut found, mut beyond) = (0, None);
        let kept =
            values.into_iter().take(expected.saturating_add(1)).enumerate().filter_map(|(i, value)| {
                found += 1;
                let wanted = i < expected && keep.is_none_or(|k| k[i / components]);
                if wanted
                    && precision == Precision::Single
                    && value.is_finite()
                    && !(value as f32).is_finite()
                {
                    beyond.get_or_insert(value);
                }
                wanted.then_some(value)
            });
        let array = DataArray::float(name, components, precision, kept);
        if found != expected {
            let found = found.div_ceil(components);
            return Err(OutputError::Count { name: name.into(), expected: cells, found });
        }
        if let Some(value) = beyond {
            return Err(OutputError::Range { name: name.into(), value });
        }
        self.names.push(name);
        self.arrays.push(array);
        Ok(())
    }

    pub(super) fn into_section(self) -> Vec<DataArray<'a>> {
        self.arrays
    }
}
