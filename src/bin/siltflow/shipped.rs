//! Scenes that come with the command.
use crate::outcome::Failure;
use serde_json::{Value, json};
use std::cell::OnceCell;
use std::path::PathBuf;
use tempfile::TempDir;

macro_rules! shipped {
    ($($name:literal)*) => {
        &[$(($name, include_str!(concat!("../../../scenes/", $name)))),*]
    };
}

/// File names and texts.
const SCENES: &[(&str, &str)] = shipped!(
    "backward_step.toml"
    "bent_channel.toml"
    "bouncing_sphere.toml"
    "cavity.toml"
    "cylinder.toml"
    "dense_suspension.toml"
    "drafting_kissing_tumbling.toml"
    "drum.toml"
    "fluidised_bed.toml"
    "heap.toml"
    "hopper.toml"
    "naca_0012.toml"
    "oscillating_cylinder.toml"
    "packed_bed.toml"
    "raining_discs.toml"
    "reduced_discs.toml"
    "rock_in_channel.toml"
    "sedimenting_polyhedra.toml"
    "sinking_shapes.toml"
    "sliding_block.toml"
    "sphere_les.toml"
    "taylor_green.toml"
    "ten_cate.toml"
    "turbulent_cylinder.toml"
    "two_discs.toml"
    "vortex_street.toml"
    "warm_cavity.toml"
);
/// Files that these scenes name.
const FILES: &[(&str, &[u8])] = &[("rock.stl", include_bytes!("../../../scenes/rock.stl"))];

/// Folder into which the scenes are written when one is asked for, until the command ends.
#[derive(Default)]
pub(crate) struct Shipped {
    folder: OnceCell<TempDir>,
}

impl Shipped {
    /// Path of the scene in the file `scene`, or of that name.
    ///
    /// # Errors
    /// [`Failure`] if there is neither.
    pub(crate) fn path(&self, scene: &str) -> Result<PathBuf, Failure> {
        let path = PathBuf::from(scene);
        let file = format!("{scene}.toml");
        if path.exists() {
            return Ok(path);
        }
        if SCENES.iter().all(|(name, _)| *name != file) {
            let message = format!(
                "there is no file {scene}, and no scene of that name comes with the command; `siltflow list` tells the names"
            );
            return Err(Failure::of_input(message));
        }
        let folder = match self.folder.get() {
            Some(folder) => folder,
            None => {
                let failed = |error| {
                    let place = std::env::temp_dir();
                    Failure::of_output(format!(
                        "{file} could not be written to the temporary folder {} (TMPDIR): {error}",
                        place.display()
                    ))
                };
                let folder = write().map_err(failed)?;
                self.folder.get_or_init(|| folder)
            }
        };
        Ok(folder.path().join(file))
    }
}

fn write() -> std::io::Result<TempDir> {
    let folder = tempfile::Builder::new().prefix("siltflow-").tempdir()?;
    for (name, text) in SCENES {
        std::fs::write(folder.path().join(name), text)?;
    }
    for (name, bytes) in FILES {
        std::fs::write(folder.path().join(name), bytes)?;
    }
    Ok(folder)
}

/// Names of the scenes.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    SCENES.iter().map(|(file, _)| file.trim_end_matches(".toml"))
}

/// Names and titles, line by line or as JSON.
pub(crate) fn list(as_json: bool) -> String {
    let scenes = names().zip(SCENES.iter().map(|(_, text)| title(text)));
    if as_json {
        let all: Vec<Value> = scenes.map(|(name, title)| json!({ "name": name, "title": title })).collect();
        return format!("{:#}\n", Value::from(all));
    }
    let width = SCENES.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    scenes.map(|(name, title)| format!("{name:width$}{title}\n")).collect()
}

fn title(text: &str) -> &str {
    let line = text.lines().find_map(|line| line.strip_prefix("title = \""));
    line.and_then(|rest| rest.split('"').next()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use std::path::Path;

    #[test]
    fn every_file_in_the_folder_of_scenes_is_shipped() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
        let kept = |name: &String| name.ends_with(".toml") || name.ends_with(".stl");
        let there: BTreeSet<String> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .filter(kept)
            .collect();
        let names = SCENES.iter().map(|(name, _)| *name).chain(FILES.iter().map(|(name, _)| *name));
        assert_eq!(there, names.map(String::from).collect());
    }

    #[test]
    fn every_scene_has_a_title() {
        for (name, text) in SCENES {
            assert!(!title(text).is_empty(), "{name}");
        }
    }
}
