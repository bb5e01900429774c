//! Pictures of a run, those that the page has room for.
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// Pictures of all runs together take at most so many bytes of the page \[bytes of base64\].
pub(crate) const MOST_BYTES: u64 = 8_000_000;
/// Pictures of a run.
const MOST_PICTURES: usize = 60;
/// First bytes of a PNG file.
const PNG: [u8; 8] = [0x89, b'P', b'N', b'G', 0x0d, 0x0a, 0x1a, 0x0a];

/// A picture on the page.
#[derive(Clone, Debug)]
pub(crate) struct Picture {
    /// Its label.
    pub(crate) label: String,
    path: PathBuf,
}

impl Picture {
    /// The picture as base64; empty if its file is gone since it was listed.
    fn encoded(&self) -> String {
        std::fs::read(&self.path).map(|png| STANDARD.encode(png)).unwrap_or_default()
    }

    /// The picture as a URL.
    pub(crate) fn url(&self) -> String {
        format!("data:image/png;base64,{}", self.encoded())
    }
}

/// The pictures of a run.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pictures {
    pub(crate) shown: Vec<Picture>,
    /// Notes on pictures that are left out.
    pub(crate) notes: Vec<String>,
}

/// A picture's file and its label.
#[derive(Clone, Debug)]
pub(crate) struct Listed {
    path: PathBuf,
    label: String,
    bytes: u64,
}

/// The pictures in `folder`: those of `index` (file name, time) if there is one, otherwise all.
/// Files that are not there are notes.
pub(crate) fn list(
    folder: &Path,
    index: Option<&[(String, f64)]>,
    steady: bool,
    notes: &mut Vec<String>,
) -> Vec<Listed> {
    let folder = folder.join("images");
    let mut there: BTreeMap<String, (PathBuf, u64)> = std::fs::read_dir(&folder)
        .into_iter()
        .flatten()
        .flatten()
        .filter(|entry| entry.path().extension().is_some_and(|e| e == "png"))
        .filter_map(|entry| {
            let size = entry.metadata().ok()?.len();
            Some((entry.file_name().to_string_lossy().into_owned(), (entry.path(), size)))
        })
        .collect();
    let Some(index) = index else {
        return there.into_iter().map(|(name, (path, bytes))| Listed { path, label: name, bytes }).collect();
    };
    let (mut listed, mut missing) = (Vec::new(), 0);
    for (name, time) in index {
        let label = if steady {
            format!("after {time} iterations")
        } else {
            format!("t = {} s", crate::text::number(*time))
        };
        match there.remove(name) {
            Some((path, bytes)) => listed.push(Listed { path, label, bytes }),
            None => missing += 1,
        }
    }
    if missing > 0 {
        notes.push(format!("{missing} pictures that images.csv lists are not in images/"));
    }
    if !there.is_empty() {
        notes.push(format!(
            "{} pictures in images/ are not of this run (images.csv) and left out",
            there.len()
        ));
    }
    listed
}

impl Pictures {
    /// Reads as many of the `listed` pictures as fit into `room` bytes of the page, at equal
    /// distances with the first and the last.
    pub(crate) fn read(listed: &[Listed], room: u64) -> Self {
        let mut out = Self::default();
        let largest = listed.iter().map(|one| one.bytes * 4 / 3 + 100).max().unwrap_or(1);
        let fits = usize::try_from(room / largest).unwrap_or(usize::MAX).min(MOST_PICTURES);
        let chosen: Vec<&Listed> = match (listed.len(), fits) {
            (n, fits) if n <= fits => listed.iter().collect(),
            (_, 0) => Vec::new(),
            (n, 1) => vec![&listed[n - 1]],
            (n, fits) => (0..fits).map(|i| &listed[i * (n - 1) / (fits - 1)]).collect(),
        };
        let left_out = listed.len() - chosen.len();
        if left_out > 0 {
            out.notes.push(format!(
                "{} of {} pictures are shown, so that the page stays small; all are in the folder images/",
                chosen.len(),
                listed.len()
            ));
        }
        for one in chosen {
            let mut head = [0; PNG.len()];
            match File::open(&one.path).and_then(|mut file| file.read_exact(&mut head)) {
                Ok(()) if head == PNG => {
                    out.shown.push(Picture { label: one.label.clone(), path: one.path.clone() });
                }
                Ok(_) => out.notes.push(format!("{} is no PNG file", one.path.display())),
                Err(error) => out.notes.push(format!("{} cannot be read: {error}", one.path.display())),
            }
        }
        out
    }

    /// Writes the element with labels and pictures (base64) that the slider reads, picture by
    /// picture: a run's memory is not exceeded by that of its page.
    pub(crate) fn write_data(&self, number: usize, page: &mut impl Write) -> io::Result<()> {
        write!(page, "<script type=\"application/json\" id=\"pictures-{number}\">[")?;
        for (i, picture) in self.shown.iter().enumerate() {
            // A label cannot end the element: `<` is written as an escape of JSON.
            let label = serde_json::Value::from(picture.label.as_str()).to_string().replace('<', "\\u003c");
            let comma = if i > 0 { "," } else { "" };
            write!(page, "{comma}[{label},\"{}\"]", picture.encoded())?;
        }
        write!(page, "]</script>")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(sizes: &[usize]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("images")).unwrap();
        for (i, size) in sizes.iter().enumerate() {
            let mut bytes = PNG.to_vec();
            bytes.resize(*size, 0);
            std::fs::write(folder.path().join(format!("images/{i:05}.png")), bytes).unwrap();
        }
        folder
    }

    #[test]
    fn pictures_are_thinned_to_the_room() {
        let folder = folder(&[300; 11]);
        let listed = list(folder.path(), None, false, &mut Vec::new());
        let all = Pictures::read(&listed, 1_000_000);
        assert!(all.shown.len() == 11 && all.notes.is_empty());
        let some = Pictures::read(&listed, 3 * 500);
        let labels: Vec<&str> = some.shown.iter().map(|p| p.label.as_str()).collect();
        assert_eq!(labels, ["00000.png", "00005.png", "00010.png"]);
        assert!(some.notes[0].starts_with("3 of 11 pictures"), "{:?}", some.notes);
        assert!(Pictures::read(&listed, 10).shown.is_empty());
    }

    #[test]
    fn pictures_of_an_earlier_run_and_missing_ones_are_noted() {
        let folder = folder(&[30; 3]);
        let mut notes = Vec::new();
        let index = [("00000.png".to_owned(), 0.0), ("00007.png".to_owned(), 0.5)];
        let listed = list(folder.path(), Some(&index), false, &mut notes);
        assert_eq!((listed.len(), notes.len()), (1, 2), "{notes:?}");
        assert_eq!(listed[0].label, "t = 0 s");
    }

    #[test]
    fn damaged_pictures_are_noted() {
        let folder = folder(&[30]);
        std::fs::write(folder.path().join("images/00000.png"), "no picture").unwrap();
        let listed = list(folder.path(), None, false, &mut Vec::new());
        let read = Pictures::read(&listed, 1_000_000);
        assert!(read.shown.is_empty() && read.notes[0].contains("is no PNG"), "{:?}", read.notes);
    }
}
