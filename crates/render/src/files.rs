//! Files that are written again and again.
use std::fs::{File, OpenOptions};
use std::io::{self, BufWriter, Seek, Write};
use std::path::Path;

/// Writes a file: over the one that is there, if any, which costs less than to empty it first (ext4 then waits for the disk) or to make another one.
///
/// # Errors
/// What the file system or `write` answers.
pub fn write_over<T>(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<T>,
) -> io::Result<T> {
    let mut out = BufWriter::new(OpenOptions::new().write(true).create(true).truncate(false).open(path)?);
    let told = write(&mut out)?;
    out.flush()?;
    let end = out.stream_position()?;
    let file = out.get_ref();
    if file.metadata()?.len() > end {
        file.set_len(end)?;
    }
    Ok(told)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_there_is_gone() {
        let path = std::env::temp_dir().join(format!("siltflow-over-{}", std::process::id()));
        for text in ["long enough", "short", "longer than before"] {
            write_over(&path, |out| out.write_all(text.as_bytes())).unwrap();
            assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
        }
        std::fs::remove_file(&path).unwrap();
    }
}
