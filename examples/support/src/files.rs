//! Folders of results.
use crate::Outcome;
use std::path::Path;

/// Makes a folder for what is written, if it is not there.
///
/// # Errors
/// What the file system answers, and of which folder.
pub fn make_folder(path: &Path) -> Outcome<()> {
    std::fs::create_dir_all(path).map_err(|e| format!("making the folder {}: {e}", path.display()).into())
}
