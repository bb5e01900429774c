//! Models in files.
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// First bytes of every file, with the version of the format.
const MAGIC: &[u8; 16] = b"siltflow model 1";

/// A model as a tree of named arrays and words: what is saved, and what it is loaded from.
///
/// In a file: 16 bytes with the version, the entries (length of the name, name, tag, length, values; little-endian), and a 64-bit
/// FNV-1a checksum of all that.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    entries: BTreeMap<String, Entry>,
}

#[derive(Clone, Debug, PartialEq)]
enum Entry {
    Word(String),
    Numbers(Vec<f64>),
}

/// Why a model could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The file could not be written or read.
    #[error("the model in {}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The bytes are not a model, are cut off, or were changed.
    #[error("{bytes} bytes are not a whole model ({what}); save it again")]
    Corrupt {
        /// How many were read.
        bytes: usize,
        /// What is wrong.
        what: &'static str,
    },
    /// Another kind of model.
    #[error("the record is of `{found}` where {expected} is needed")]
    Kind {
        /// What it is.
        found: String,
        /// What it must be.
        expected: String,
    },
    /// An entry is not there.
    #[error("the record of `{kind}` has no `{name}`; it was written by another version")]
    Missing {
        /// Of the record.
        kind: String,
        /// Of the entry.
        name: String,
    },
    /// An entry has an impossible length or value.
    #[error("`{name}` in the record of `{kind}` {what}; it was written by another version, or changed")]
    Entry {
        /// Of the record.
        kind: String,
        /// Of the entry.
        name: String,
        /// What is wrong.
        what: String,
    },
}

/// 64-bit FNV-1a.
fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |h, &b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3))
}

impl Record {
    /// An empty one of a model of this kind.
    #[must_use]
    pub fn new(kind: &str) -> Self {
        Self { entries: BTreeMap::from([("kind".to_owned(), Entry::Word(kind.into()))]) }
    }
    /// Of the model.
    #[must_use]
    pub fn kind(&self) -> &str {
        self.word("kind").unwrap_or_default()
    }
    /// Adds numbers under a name; those that were there are replaced.
    #[must_use]
    pub fn with(mut self, name: &str, values: impl IntoIterator<Item = f64>) -> Self {
        self.entries.insert(name.into(), Entry::Numbers(values.into_iter().collect()));
        self
    }
    /// Adds a word under a name.
    #[must_use]
    pub fn with_word(mut self, name: &str, word: &str) -> Self {
        self.entries.insert(name.into(), Entry::Word(word.into()));
        self
    }
    /// Adds all of another record under a name.
    #[must_use]
    pub fn with_record(mut self, name: &str, record: &Self) -> Self {
        self.entries.extend(record.entries.iter().map(|(n, entry)| (format!("{name}/{n}"), entry.clone())));
        self
    }

    fn get(&self, name: &str) -> Result<&Entry, RecordError> {
        let missing = || RecordError::Missing { kind: self.kind().into(), name: name.into() };
        self.entries.get(name).ok_or_else(missing)
    }
    /// That an entry is wrong.
    #[must_use]
    pub fn wrong(&self, name: &str, what: String) -> RecordError {
        RecordError::Entry { kind: self.kind().into(), name: name.into(), what }
    }
    /// The numbers under a name.
    ///
    /// # Errors
    /// [`RecordError::Missing`], [`RecordError::Entry`] if there is a word.
    pub fn numbers(&self, name: &str) -> Result<&[f64], RecordError> {
        match self.get(name)? {
            Entry::Numbers(values) => Ok(values),
            Entry::Word(_) => Err(self.wrong(name, "is a word".into())),
        }
    }
    /// That many numbers under a name.
    ///
    /// # Errors
    /// As [`numbers`](Self::numbers), and [`RecordError::Entry`] if there are more or fewer.
    pub fn numbers_of(&self, name: &str, length: usize) -> Result<&[f64], RecordError> {
        let values = self.numbers(name)?;
        if values.len() == length {
            Ok(values)
        } else {
            Err(self.wrong(name, format!("has {} entries instead of {length}", values.len())))
        }
    }
    /// The one number under a name.
    ///
    /// # Errors
    /// As [`numbers_of`](Self::numbers_of).
    pub fn number(&self, name: &str) -> Result<f64, RecordError> {
        Ok(self.numbers_of(name, 1)?[0])
    }
    /// The numbers under a name as counts.
    ///
    /// # Errors
    /// As [`numbers`](Self::numbers), and [`RecordError::Entry`] if one of them is no whole number from 0 to 2⁵³.
    pub fn counts(&self, name: &str) -> Result<Vec<usize>, RecordError> {
        let whole = |v: &f64| (0.0..9e15).contains(v) && v.fract() == 0.0;
        let values = self.numbers(name)?;
        match values.iter().find(|v| !whole(v)) {
            Some(v) => Err(self.wrong(name, format!("has {v} where a count is needed"))),
            None => Ok(values.iter().map(|&v| v as usize).collect()),
        }
    }
    /// The one count under a name.
    ///
    /// # Errors
    /// As [`counts`](Self::counts) and [`number`](Self::number).
    pub fn count(&self, name: &str) -> Result<usize, RecordError> {
        self.number(name)?;
        Ok(self.counts(name)?[0])
    }
    /// The word under a name.
    ///
    /// # Errors
    /// [`RecordError::Missing`], [`RecordError::Entry`] if there are numbers.
    pub fn word(&self, name: &str) -> Result<&str, RecordError> {
        match self.entries.get(name) {
            Some(Entry::Word(word)) => Ok(word),
            Some(Entry::Numbers(_)) => Err(RecordError::Entry {
                kind: String::new(),
                name: name.into(),
                what: "is not a word".into(),
            }),
            None => Err(RecordError::Missing { kind: String::new(), name: name.into() }),
        }
    }
    /// The record under a name.
    ///
    /// # Errors
    /// [`RecordError::Missing`].
    pub fn record(&self, name: &str) -> Result<Self, RecordError> {
        let prefix = format!("{name}/");
        let inside = self
            .entries
            .iter()
            .filter_map(|(n, entry)| Some((n.strip_prefix(&prefix)?.to_owned(), entry.clone())));
        let record = Self { entries: inside.collect() };
        record
            .word("kind")
            .map_err(|_| RecordError::Missing { kind: self.kind().into(), name: name.into() })?;
        Ok(record)
    }
    /// That it is of this kind.
    ///
    /// # Errors
    /// [`RecordError::Kind`].
    pub fn expect(&self, kind: &str) -> Result<(), RecordError> {
        if self.kind() == kind {
            Ok(())
        } else {
            Err(RecordError::Kind { found: self.kind().into(), expected: format!("`{kind}`") })
        }
    }

    /// As a file holds it.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        for (name, entry) in &self.entries {
            bytes.extend((name.len() as u64).to_le_bytes());
            bytes.extend(name.as_bytes());
            match entry {
                Entry::Word(word) => {
                    bytes.push(b'w');
                    bytes.extend((word.len() as u64).to_le_bytes());
                    bytes.extend(word.as_bytes());
                }
                Entry::Numbers(values) => {
                    bytes.push(b'n');
                    bytes.extend((values.len() as u64).to_le_bytes());
                    bytes.extend(values.iter().flat_map(|v| v.to_le_bytes()));
                }
            }
        }
        bytes.extend(checksum(&bytes).to_le_bytes());
        bytes
    }
    /// What [`to_bytes`](Self::to_bytes) made.
    ///
    /// # Errors
    /// [`RecordError::Corrupt`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, RecordError> {
        let corrupt = |what| RecordError::Corrupt { bytes: bytes.len(), what };
        let (body, sum) = bytes.split_last_chunk::<8>().ok_or_else(|| corrupt("too short"))?;
        if checksum(body) != u64::from_le_bytes(*sum) {
            return Err(corrupt("wrong checksum"));
        }
        let mut rest = body.strip_prefix(MAGIC.as_slice()).ok_or_else(|| corrupt("unknown version"))?;
        let mut entries = BTreeMap::new();
        while !rest.is_empty() {
            let mut take = |n: usize| rest.split_off(..n).ok_or_else(|| corrupt("cut off"));
            let length = |b: &[u8]| b.try_into().map(u64::from_le_bytes).unwrap_or(0) as usize;
            let text = |b: &[u8]| String::from_utf8(b.to_vec()).map_err(|_| corrupt("unreadable name"));
            let n = length(take(8)?);
            let name = text(take(n)?)?;
            let tag = take(1)?[0];
            let n = length(take(8)?);
            let entry = match tag {
                b'w' => Entry::Word(text(take(n)?)?),
                b'n' => {
                    let values = take(n.checked_mul(8).ok_or_else(|| corrupt("cut off"))?)?;
                    Entry::Numbers(values.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect())
                }
                _ => return Err(corrupt("unknown entry")),
            };
            entries.insert(name, entry);
        }
        let record = Self { entries };
        record.word("kind").map_err(|_| corrupt("no kind"))?;
        Ok(record)
    }
    /// Writes it to a file: beside it first, then renamed, so that a file of this name is always whole.
    ///
    /// # Errors
    /// [`RecordError::Io`].
    pub fn save(&self, path: &Path) -> Result<(), RecordError> {
        let mut beside = path.as_os_str().to_owned();
        beside.push(".part");
        std::fs::write(&beside, self.to_bytes())
            .and_then(|()| std::fs::rename(&beside, path))
            .map_err(|source| RecordError::Io { path: path.into(), source })
    }
    /// Reads it from a file.
    ///
    /// # Errors
    /// [`RecordError::Io`], [`RecordError::Corrupt`].
    pub fn load(path: &Path) -> Result<Self, RecordError> {
        let bytes = std::fs::read(path).map_err(|source| RecordError::Io { path: path.into(), source })?;
        Self::from_bytes(&bytes)
    }
}

#[cfg(test)]
mod tests;
