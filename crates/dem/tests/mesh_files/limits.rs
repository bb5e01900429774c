//! Paths that lead to no file, or to one without end.
use dem::{MeshError, TriangleSoup};
use std::fs::{self, File};
use std::path::{Path, PathBuf};

/// A folder that is removed in the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("mesh-{name}-{}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        _ = fs::remove_dir_all(&self.0);
    }
}

fn errors(path: &Path) -> [MeshError; 2] {
    [TriangleSoup::from_stl(path, 1.0).unwrap_err(), TriangleSoup::from_obj(path, 1.0).unwrap_err()]
}

#[test]
fn files_beyond_the_limit_are_refused() {
    let folder = Folder::new("large");
    let path = folder.0.join("large.stl");
    // Without contents: it takes no room.
    File::create(&path).unwrap().set_len(TriangleSoup::LARGEST_FILE + 1).unwrap();
    for error in errors(&path) {
        assert!(
            matches!(&error, MeshError::TooLarge { bytes: 1_073_741_825, limit: 1_073_741_824, path: named } if *named == path)
        );
        assert!(
            error.to_string().contains("1073741825 bytes are more than the limit of 1073741824 bytes"),
            "{error}"
        );
    }
}

#[test]
fn folders_are_no_files() {
    let folder = Folder::new("folder");
    for error in errors(&folder.0) {
        assert!(matches!(&error, MeshError::NoFile { kind: "a directory", .. }), "{error}");
    }
    for error in errors(&folder.0.join("none.stl")) {
        assert!(matches!(&error, MeshError::File { .. }), "{error}");
    }
}

/// Devices that give bytes without end, and pipes into which nothing is written.
#[cfg(unix)]
#[test]
fn devices_and_pipes_are_no_files() {
    let folder = Folder::new("pipe");
    let (link, pipe) = (folder.0.join("zero.stl"), folder.0.join("pipe.stl"));
    std::os::unix::fs::symlink("/dev/zero", &link).unwrap();
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    for path in [link, pipe] {
        for error in errors(&path) {
            assert!(matches!(&error, MeshError::NoFile { kind: "a device, pipe or socket", .. }), "{error}");
        }
    }
}
