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

    /// Adds an array of `components` numbers per cell for `cells` cells, of which those flagged by `keep` are taken: all
    /// numbers in one of `parts`, cell after cell, or each component in a part of its own; components without one are 0.
    pub(crate) fn add<I: IntoIterator<Item = f64>, const N: usize>(
        &mut self,
        name: &'a str,
        components: usize,
        cells: usize,
        precision: Precision,
        keep: Option<&[bool]>,
        parts: [I; N],
    ) -> Result<(), OutputError> {
        if name.is_empty() || self.names.contains(&name) {
            return Err(OutputError::Name { name: name.into() });
        }
        let mut beyond = None;
        let single = |v: f64| {
            let short = v as f32;
            if short.is_infinite() {
                note(&mut beyond, v);
            }
            short.to_le_bytes()
        };
        let count = |found| OutputError::Count { name: name.into(), expected: cells, found };
        let mut bytes = match precision {
            Precision::Single => collect(components, cells, parts, single),
            Precision::Double => collect(components, cells, parts, f64::to_le_bytes),
        }
        .map_err(count)?;
        let width = bytes.len() / cells.max(1);
        if let Some(value) = beyond {
            return Err(OutputError::Range { name: name.into(), value });
        }
        if let Some(keep) = keep {
            let mut kept = 0;
            for cell in (0..cells).filter(|&cell| keep[cell]) {
                bytes.copy_within(cell * width..(cell + 1) * width, kept);
                kept += width;
            }
            bytes.truncate(kept);
        }
        self.names.push(name);
        self.arrays.push(DataArray::of_bytes(name, components, precision, bytes));
        Ok(())
    }

    pub(super) fn into_section(self) -> Vec<DataArray<'a>> {
        self.arrays
    }
}

/// Keeps the first finite value that single precision does not hold; seldom called, which keeps the loop over numbers short.
#[cold]
fn note(beyond: &mut Option<f64>, value: f64) {
    if value.is_finite() {
        beyond.get_or_insert(value);
    }
}

/// The bytes of all numbers, cell after cell; an error is for how many cells there are numbers, at most one too many.
fn collect<I: IntoIterator<Item = f64>, const N: usize, const W: usize>(
    components: usize,
    cells: usize,
    parts: [I; N],
    mut bytes_of: impl FnMut(f64) -> [u8; W],
) -> Result<Vec<u8>, usize> {
    // How many numbers of a part are those of a cell, and how far apart two of them are.
    let (per_cell, width) = if N == 1 { (components, W) } else { (1, components * W) };
    let expected = cells * per_cell;
    let mut bytes = vec![0; expected * width];
    for (p, part) in parts.into_iter().enumerate() {
        // Where the next number comes.
        let next = part.into_iter().try_fold(p * W, |place, value| {
            bytes.get_mut(place..place + W)?.copy_from_slice(&bytes_of(value));
            Some(place + width)
        });
        let found = next.map_or(expected + 1, |place| place / width);
        if found != expected {
            return Err(found.div_ceil(per_cell));
        }
    }
    Ok(bytes)
}
