//! The lines `v` and `f` of a Wavefront OBJ file.
use super::MeshError;
use super::text::{Words, number};

type Mesh = (Vec<[f64; 3]>, Vec<[u32; 3]>);

/// Vertices, in the file's unit, and triangles. All other lines are left out: texture, normals, groups, materials.
pub(crate) fn read(bytes: &[u8]) -> Result<Mesh, MeshError> {
    let mut words = Words::new("OBJ", bytes);
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    let mut corners: Vec<u32> = Vec::new();
    while words.next_line() {
        match words.next_on_line().as_deref() {
            Some("v") => {
                let mut vertex = [0.0; 3];
                for x in &mut vertex {
                    *x = number(words.next_on_line()).map_err(|what| words.error(what))?;
                }
                vertices.push(vertex);
            }
            Some("f") => {
                corners.clear();
                loop {
                    let goes_on = words.goes_on();
                    while let Some(word) = words.next_on_line() {
                        corners.push(vertex(&word, vertices.len()).map_err(|what| words.error(what))?);
                    }
                    if !(goes_on && words.next_line()) {
                        break;
                    }
                }
                if corners.len() < 3 {
                    return Err(words.error(format!("a face of {} vertices", corners.len())));
                }
                faces.extend(corners.windows(2).skip(1).map(|pair| [corners[0], pair[0], pair[1]]));
            }
            _ => {}
        }
    }
    Ok((vertices, faces))
}

/// The vertex that `5`, `5/1`, `5//2`, `5/1/2` say, counted from 1, or from the last one backward: −1.
fn vertex(word: &str, vertices: usize) -> Result<u32, String> {
    let first = word.split('/').next().unwrap_or_default();
    let said: i64 = first.parse().map_err(|_| format!("{word:?} is no vertex"))?;
    let number = if said < 0 { said.saturating_add_unsigned(vertices as u64) } else { said - 1 };
    let number = u32::try_from(number).ok().filter(|n| said != 0 && (said > 0 || (*n as usize) < vertices));
    number.ok_or_else(|| format!("there is no vertex {said}; {vertices} were given before"))
}
