//! Identity of a scene, by which a saved state is known to be its own.
use crate::document::{Document, Fnv, is_under};
use crate::look::halves;
use crate::problem::Problem;
use crate::run::RunError;
use crate::schema::FileKey;
use coupling::SavedState;
use interfaces::RestartError;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// Keys that may change when a run goes on.
const LOOSE: [&str; 10] = [
    "title",
    "about",
    "output",
    "checkpoint",
    "references",
    "time.end",
    "time.steps",
    "time.stop",
    "flow.tolerance",
    "flow.iterations",
];

/// Hashes of a scene's values and of the files that it names.
#[derive(Clone, Debug)]
pub(crate) struct Identity {
    fingerprint: u64,
    /// One per path.
    files: Vec<NamedFile>,
}

/// A file that a scene names.
#[derive(Clone, Debug)]
struct NamedFile {
    /// The first key that names it.
    key: String,
    /// Path as written in the scene.
    written: String,
    path: PathBuf,
    hash: u64,
}

impl NamedFile {
    /// Name of its hash in a saved state.
    fn array(&self) -> String {
        format!("file.{}", self.written)
    }
}

impl Identity {
    /// The identity of `document`, whose `files` are in `folder`.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub(crate) fn new(document: &Document, files: &[FileKey], folder: &Path) -> Result<Self, Problem> {
        let mut bound: Vec<&FileKey> = files.iter().filter(|file| !is_under(&file.key, &LOOSE)).collect();
        // A stable sort: the first key of each path is kept.
        bound.sort_by(|a, b| a.path.cmp(&b.path));
        bound.dedup_by(|b, a| a.path == b.path);
        let named = |file: &FileKey| {
            let path = folder.join(&file.path);
            let unreadable = |e: io::Error| {
                let message = format!("{}: {e}; give the path of a file that can be read", path.display());
                Problem::new(file.key.clone(), file.place.clone(), message)
            };
            let hash = hash_of(&path).map_err(unreadable)?;
            Ok(NamedFile { key: file.key.clone(), written: file.path.clone(), path, hash })
        };
        Ok(Self {
            fingerprint: document.fingerprint(&LOOSE),
            files: bound.into_iter().map(named).collect::<Result<_, _>>()?,
        })
    }

    /// Passes it to `sink`, as part of a state.
    pub(crate) fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        sink("scene", &halves(self.fingerprint));
        self.files.iter().for_each(|file| sink(&file.array(), &halves(file.hash)));
    }

    /// Whether `state`, read from `path`, was saved by this scene with these files.
    ///
    /// # Errors
    /// [`RunError::OtherScene`], [`RunError::ChangedFile`], or [`RunError::Resume`] of a state
    /// without these entries.
    pub(crate) fn check(&self, state: &SavedState, path: &Path) -> Result<(), RunError> {
        let source = |name: &str| state.get(name);
        let saved = |name: &str| {
            let halves = RestartError::take(&source, name, 2).map_err(coupling::CheckpointError::from)?;
            Ok(((halves[0] as u64) << 32) | halves[1] as u64)
        };
        if saved("scene").map_err(RunError::Resume)? != self.fingerprint {
            return Err(RunError::OtherScene(path.into()));
        }
        for file in &self.files {
            let saved = saved(&file.array()).map_err(RunError::Resume)?;
            if saved != file.hash {
                return Err(RunError::ChangedFile {
                    file: file.path.clone(),
                    key: file.key.clone(),
                    state: path.into(),
                    saved,
                    found: file.hash,
                });
            }
        }
        Ok(())
    }
}

/// Hash of the contents of a file.
fn hash_of(path: &Path) -> io::Result<u64> {
    let mut file = File::open(path)?;
    let (mut hash, mut block) = (Fnv::default(), vec![0; 1 << 16]);
    loop {
        match file.read(&mut block)? {
            0 => return Ok(hash.value()),
            n => hash = hash.with(&block[..n]),
        }
    }
}
