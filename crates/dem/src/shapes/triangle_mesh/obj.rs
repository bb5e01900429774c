//! The lines `v` and `f` of a Wavefront OBJ file.
use super::MeshError;
use super::polygon::Triangulation;
use super::text::{Format, Words, decoded, number};

type Mesh = (Vec<[f64; 3]>, Vec<[u32; 3]>);

/// Vertices, in the file's unit, and triangles. All other lines are skipped (texture, normals,
/// groups, materials), and so is whatever follows three coordinates (weights, colours).
pub(crate) fn read(bytes: &[u8]) -> Result<Mesh, MeshError> {
    let text = decoded(bytes);
    let mut words = Words::new(Format::Obj, &text);
    let mut vertices = Vec::new();
    // Corners of all polygons, and where each of them ends.
    let (mut corners, mut ends): (Vec<u32>, Vec<usize>) = (Vec::new(), Vec::new());
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
                let first = corners.len();
                while let Some(word) = words.next_on_line() {
                    corners.push(vertex(&word, vertices.len()).map_err(|what| words.error(what))?);
                }
                if corners.len() < first + 3 {
                    return Err(words.error(format!("a face of {} vertices", corners.len() - first)));
                }
                ends.push(corners.len());
            }
            _ => {}
        }
    }
    MeshError::check_count("vertices", vertices.len())?;
    MeshError::check_count("corners", corners.len())?;
    // Faces may come before their vertices.
    let (mut faces, mut triangulation, mut first) = (Vec::new(), Triangulation::default(), 0);
    for end in ends {
        triangulation.append(&corners[first..end], &vertices, &mut faces);
        first = end;
    }
    Ok((vertices, faces))
}

/// The vertex in `5`, `5/1`, `5//2` or `5/1/2`, counted from 1, or from the last one backward: −1.
fn vertex(word: &str, vertices: usize) -> Result<u32, String> {
    let first = word.split('/').next().unwrap_or_default();
    let said: i64 = first.parse().map_err(|_| format!("{word:?} is no vertex"))?;
    let number = if said < 0 { said.saturating_add_unsigned(vertices as u64) } else { said - 1 };
    let number = u32::try_from(number).ok().filter(|n| said != 0 && (said > 0 || (*n as usize) < vertices));
    number.ok_or_else(|| format!("there is no vertex {said}; {vertices} were given before"))
}
