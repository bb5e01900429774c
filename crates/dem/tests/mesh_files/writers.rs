//! Bytes of files, as programs write them.
use crate::solids::Facet;

/// STL as text with this normal on each facet.
pub(crate) fn text(facets: &[Facet], normal: &str) -> String {
    let corner = |[x, y, z]: [f64; 3]| format!("      vertex {x:e} {y:e} {z:e}\n");
    let facet = |f: &Facet| {
        format!("  facet{normal}\n    outer loop\n{}    endloop\n  endfacet\n", f.map(corner).concat())
    };
    format!("solid part\n{}endsolid part\n", facets.iter().map(facet).collect::<String>())
}

/// STL as text.
pub(crate) fn stl(facets: &[Facet]) -> Vec<u8> {
    text(facets, " normal 0 0 1").into_bytes()
}

/// STL as bytes, single precision, with this header.
pub(crate) fn binary(facets: &[Facet], header: &str) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes[..header.len()].copy_from_slice(header.as_bytes());
    bytes.extend((facets.len() as u32).to_le_bytes());
    for facet in facets {
        bytes.extend([0; 12]);
        bytes.extend(facet.as_flattened().iter().flat_map(|x| (*x as f32).to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

/// UTF-16 with its byte-order mark.
pub(crate) fn utf16(text: &str, bytes: fn(u16) -> [u8; 2]) -> Vec<u8> {
    std::iter::once(0xfeff).chain(text.encode_utf16()).flat_map(bytes).collect()
}

/// OBJ of polygons given by their corners, in words for each vertex and each face: `v` and `f` with
/// vertices counted from 1.
pub(crate) fn obj(polygons: &[Vec<[f64; 3]>]) -> Vec<u8> {
    let mut places: Vec<[f64; 3]> = Vec::new();
    let mut faces = String::new();
    for polygon in polygons {
        faces += "f";
        for corner in polygon {
            let known = places.iter().position(|p| p == corner);
            let number = known.unwrap_or_else(|| {
                places.push(*corner);
                places.len() - 1
            });
            faces += &format!(" {}", number + 1);
        }
        faces += "\n";
    }
    let vertices: String = places.iter().map(|[x, y, z]| format!("v {x:e} {y:e} {z:e}\n")).collect();
    (vertices + &faces).into_bytes()
}

/// Sides of a prism of height 1 over a polygon, its ends in one piece.
pub(crate) fn prism_sides(corners: &[[f64; 2]]) -> Vec<Vec<[f64; 3]>> {
    let n = corners.len();
    let at = |i: usize, z: f64| [corners[i % n][0], corners[i % n][1], z];
    let mut polygons: Vec<Vec<[f64; 3]>> =
        (0..n).map(|i| vec![at(i, 0.0), at(i + 1, 0.0), at(i + 1, 1.0), at(i, 1.0)]).collect();
    polygons.push((0..n).map(|i| at(i, 1.0)).collect());
    polygons.push((0..n).rev().map(|i| at(i, 0.0)).collect());
    polygons
}
