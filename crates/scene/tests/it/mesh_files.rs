//! Mesh files of scenes that have to be welded or repaired.
use crate::{folder, quiet};
use scene::Scene;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// A tetrahedron with edges of 1 mm along the axes; corners are written `apart` units of 1 mm from one
/// another, and the faces in `twice` are there twice.
fn write(folder: &Path, apart: f64, twice: usize) -> PathBuf {
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let mut text = String::from("solid rock\n");
    for (i, face) in faces.iter().chain(&faces[..twice]).enumerate() {
        text += "facet normal 0 0 0\nouter loop\n";
        for corner in face.map(|v| corners[v]) {
            let [x, y, z] = corner.map(|x: f64| x + apart * (i % 4) as f64);
            text += &format!("vertex {x} {y} {z}\n");
        }
        text += "endloop\nendfacet\n";
    }
    std::fs::create_dir_all(folder).unwrap();
    let path = folder.join("rock.stl");
    std::fs::write(&path, text + "endsolid rock\n").unwrap();
    path
}

/// A rock that falls in a vacuum, its shape with these keys.
fn scene(path: &Path, keys: &str) -> String {
    format!(
        r#"
gravity = [0.0, 0.0, -9.81]
grid = {{ cells = [8, 8, 8], size = [1e-2, 1e-2, 1e-2] }}
sides = {{ x = "wall", y = "wall", z = "wall" }}
time = {{ end = 1e-3 }}
output = {{ snapshots = 1, images = false, fields = false }}
[[bodies]]
name = "rock"
shape = {{ type = "mesh", file = {path:?}, unit = 1e-3{keys} }}
position = [5e-3, 5e-3, 5e-3]
"#
    )
}

fn warnings(text: &str) -> Result<Vec<String>, String> {
    let scene = Scene::parse("scene.toml", text, &[]).map_err(|e| e.to_string())?;
    Ok(scene.plan().map_err(|e| e.to_string())?.warnings)
}

#[test]
fn mesh_files_are_repaired_on_request_and_a_warning_tells_it() {
    let out = folder("mesh-files");
    let path = write(&out, 0.0, 1);
    let error = warnings(&scene(&path, "")).unwrap_err();
    assert!(error.contains("rock.stl") && error.contains("repair = true"), "{error}");
    let told = warnings(&scene(&path, ", repair = true")).unwrap();
    let repaired: Vec<&String> = told.iter().filter(|w| w.contains("rock.stl")).collect();
    assert!(repaired.len() == 1 && repaired[0].contains("repaired: 1 copies of faces left out"), "{told:?}");
    // The run tells it, too.
    let text = scene(&path, ", repair = true");
    let options = quiet(&out.join("run"));
    Scene::parse("scene.toml", &text, &[]).unwrap().run(&options, &AtomicBool::new(false)).unwrap();
    let log = std::fs::read_to_string(out.join("run/run.log")).unwrap();
    assert!(log.contains("rock.stl: repaired: 1 copies of faces left out"), "{log}");
    std::fs::remove_dir_all(&out).unwrap();
}

#[test]
fn mesh_files_are_welded_on_request() {
    let out = folder("welded-files");
    let path = write(&out, 1e-4, 0);
    for keys in ["", ", weld = 1e-9", ", repair = true"] {
        let error = warnings(&scene(&path, keys)).unwrap_err();
        assert!(error.contains("not closed"), "{keys}: {error}");
    }
    let told = warnings(&scene(&path, ", weld = 1e-6")).unwrap();
    assert!(
        told.iter().any(|w| w.contains("8 vertices up to 1.000e-6 m from others were joined")),
        "{told:?}"
    );
    // A file without faults needs no warning.
    let path = write(&out, 0.0, 0);
    for keys in ["", ", weld = 1e-6", ", repair = true"] {
        assert!(!warnings(&scene(&path, keys)).unwrap().iter().any(|w| w.contains("rock.stl")), "{keys}");
    }
    std::fs::remove_dir_all(&out).unwrap();
}
