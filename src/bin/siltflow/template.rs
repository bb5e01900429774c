//! `siltflow new`.
use crate::outcome::{Failure, print};
use std::fs::OpenOptions;
use std::io::Write;
use std::path::Path;

/// Scene with comments.
const TEMPLATE: &str = include_str!("template.toml");

/// Writes the template to `path`.
///
/// # Errors
/// [`Failure`] if there is such a file, or it cannot be written.
pub(crate) fn write(path: &Path) -> Result<(), Failure> {
    let failed = |error| Failure::of_output(format!("{}: {error}", path.display()));
    let mut file = OpenOptions::new().write(true).create_new(true).open(path).map_err(failed)?;
    file.write_all(TEMPLATE.as_bytes()).map_err(failed)?;
    let path = path.display();
    print(&format!(
        "{path} is written. `siltflow check {path}` tells what it means, `siltflow run {path}` runs it.\n"
    ))
}
