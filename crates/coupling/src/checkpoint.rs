//! State on disk.
use interfaces::{Checkpoint, RestartError};
use std::collections::HashMap;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// First bytes of every file, with the version of the format.
const MAGIC: &[u8; 16] = b"siltflow state 1";

/// Why a state could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    /// The file could not be written or read.
    #[error("the state in {}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The file is not a state, is cut off, or was changed.
    #[error("{} is not a whole saved state ({what}); {}", path.display(), remedy(older))]
    Corrupt {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        what: &'static str,
        /// The state saved before it, if there is one.
        older: Option<PathBuf>,
    },
    /// The state belongs to another set-up.
    #[error(transparent)]
    Mismatch(#[from] RestartError),
}

fn remedy(older: &Option<PathBuf>) -> String {
    match older {
        Some(older) => format!("the one saved before it is {}: load that", older.display()),
        None => "there is no older one beside it: start from the beginning".into(),
    }
}

/// Where the state is that [`save`] found under the name `path` when it wrote a new one.
pub fn previous(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".previous");
    path.with_file_name(name)
}

/// 64-bit FNV-1a.
fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |h, &b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3))
}

/// Writes the state of `of` to `path`: first beside it, then renamed, so that a state of that name
/// is always whole. The one that was there before is kept as [`previous`].
///
/// # Errors
/// [`CheckpointError::Io`].
pub fn save(path: &Path, of: &(impl Checkpoint + ?Sized)) -> Result<(), CheckpointError> {
    let mut bytes = MAGIC.to_vec();
    of.save(&mut |name, values| {
        bytes.extend((name.len() as u64).to_le_bytes());
        bytes.extend(name.as_bytes());
        bytes.extend((values.len() as u64).to_le_bytes());
        bytes.extend(values.iter().flat_map(|v| v.to_le_bytes()));
    });
    bytes.extend(checksum(&bytes).to_le_bytes());
    let write = || {
        let beside = path.with_extension("part");
        let mut file = std::fs::File::create(&beside)?;
        file.write_all(&bytes)?;
        file.sync_all()?;
        if path.exists() {
            // A second name, so that there is a state under the first at any time; a copy where files cannot have two.
            let older = previous(path);
            let _ = std::fs::remove_file(&older);
            std::fs::hard_link(path, &older).or_else(|_| std::fs::copy(path, &older).map(drop))?;
        }
        std::fs::rename(&beside, path)
    };
    write().map_err(|source| CheckpointError::Io { path: path.into(), source })
}

/// A state that [`save`] wrote, in memory.
#[derive(Clone, Debug)]
pub struct SavedState {
    arrays: HashMap<String, Vec<f64>>,
}

impl SavedState {
    /// Reads the state in `path`.
    ///
    /// # Errors
    /// [`CheckpointError`] when the file cannot be read or is not whole (it then names the one
    /// saved before).
    pub fn read(path: &Path) -> Result<Self, CheckpointError> {
        let older = || Some(previous(path)).filter(|older| older.exists());
        let corrupt = |what| CheckpointError::Corrupt { path: path.into(), what, older: older() };
        let bytes =
            std::fs::read(path).map_err(|source| CheckpointError::Io { path: path.into(), source })?;
        let (body, sum) = bytes.split_last_chunk::<8>().ok_or_else(|| corrupt("too short"))?;
        if checksum(body) != u64::from_le_bytes(*sum) {
            return Err(corrupt("wrong checksum"));
        }
        let mut rest = body.strip_prefix(MAGIC.as_slice()).ok_or_else(|| corrupt("unknown version"))?;
        let mut arrays = HashMap::new();
        while !rest.is_empty() {
            let mut take = |n: usize| rest.split_off(..n).ok_or_else(|| corrupt("cut off"));
            let length = |b: &[u8]| b.try_into().map(u64::from_le_bytes).unwrap_or(0) as usize;
            let n = length(take(8)?);
            let name = std::str::from_utf8(take(n)?).map_err(|_| corrupt("unreadable name"))?.to_owned();
            let n = length(take(8)?);
            let values = take(n.checked_mul(8).ok_or_else(|| corrupt("cut off"))?)?;
            let values: Vec<f64> = values.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect();
            arrays.insert(name, values);
        }
        Ok(Self { arrays })
    }

    /// The array of this name.
    pub fn get(&self, name: &str) -> Option<&[f64]> {
        self.arrays.get(name).map(Vec::as_slice)
    }

    /// Restores `into`.
    ///
    /// # Errors
    /// [`RestartError`] when the state belongs to another set-up.
    pub fn restore(&self, into: &mut (impl Checkpoint + ?Sized)) -> Result<(), RestartError> {
        into.restore(&|name| self.get(name))
    }
}

/// Reads the state that [`save`] wrote.
///
/// # Errors
/// [`CheckpointError`] when the file cannot be read, is not whole (it then names the one saved before), or belongs to another set-up.
pub fn load(path: &Path, into: &mut (impl Checkpoint + ?Sized)) -> Result<(), CheckpointError> {
    Ok(SavedState::read(path)?.restore(into)?)
}
