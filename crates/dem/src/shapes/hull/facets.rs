//! Plane facets of triangles.
use interfaces::Vector;
use std::collections::HashMap;

/// Joins the triangles of a convex hull to plane faces, each a loop of corners counter-clockwise seen from outside. A face has
/// all vertices within `flat` of the plane of its largest triangle; vertices as near to the straight edge between two faces
/// are left out. `None` if, by round-off, this would not make a closed surface.
pub(crate) fn merged(points: &[[f64; 3]], triangles: &[[u32; 3]], flat: f64) -> Option<Vec<Vec<u32>>> {
    let at = |v: u32| Vector::from(points[v as usize]);
    let face = plane_parts(triangles, at, flat)?;
    let mut loops = outlines(triangles, &face)?;
    while straighten(&mut loops, at, 4.0 * flat) {}
    is_closed(&loops).then_some(loops)
}

/// The triangle across each edge: by the edge's two corners, as the triangle itself has them.
fn sides(triangles: &[[u32; 3]]) -> HashMap<[u32; 2], usize> {
    let edges = |t: usize| [0, 1, 2].map(|i| ([triangles[t][i], triangles[t][(i + 1) % 3]], t));
    (0..triangles.len()).flat_map(edges).collect()
}

/// The number of the face that each triangle is part of.
fn plane_parts(triangles: &[[u32; 3]], at: impl Fn(u32) -> Vector, flat: f64) -> Option<Vec<usize>> {
    let sides = sides(triangles);
    let cross = |t: &[u32; 3]| (at(t[1]) - at(t[0])).cross(&(at(t[2]) - at(t[0])));
    let areas: Vec<f64> = triangles.iter().map(|t| cross(t).norm()).collect();
    let mut order: Vec<usize> = (0..triangles.len()).collect();
    order.sort_by(|s, t| areas[*t].total_cmp(&areas[*s]));
    let mut face = vec![usize::MAX; triangles.len()];
    for seed in order {
        if face[seed] != usize::MAX {
            continue;
        }
        let (normal, origin) = (cross(&triangles[seed]).try_normalize(0.0)?, at(triangles[seed][0]));
        let on_plane = |t: usize| triangles[t].iter().all(|v| normal.dot(&(at(*v) - origin)).abs() <= flat);
        face[seed] = seed;
        let mut rim = vec![seed];
        while let Some(t) = rim.pop() {
            for i in 0..3 {
                let across = *sides.get(&[triangles[t][(i + 1) % 3], triangles[t][i]])?;
                if face[across] == usize::MAX && on_plane(across) {
                    face[across] = seed;
                    rim.push(across);
                }
            }
        }
    }
    Some(face)
}

/// The loop of corners around each face; `None` if one has several.
fn outlines(triangles: &[[u32; 3]], face: &[usize]) -> Option<Vec<Vec<u32>>> {
    let sides = sides(triangles);
    let mut next: HashMap<(usize, u32), u32> = HashMap::new();
    for (t, corners) in triangles.iter().enumerate() {
        for i in 0..3 {
            let (from, to) = (corners[i], corners[(i + 1) % 3]);
            let outer = face[*sides.get(&[to, from])?] != face[t];
            if outer && next.insert((face[t], from), to).is_some() {
                return None;
            }
        }
    }
    let mut starts: Vec<(usize, u32)> = next.keys().copied().collect();
    starts.sort_unstable();
    let mut loops: Vec<Vec<u32>> = Vec::new();
    for (f, start) in starts {
        let mut outline = Vec::new();
        let mut v = start;
        while let Some(to) = next.remove(&(f, v)) {
            outline.push(v);
            v = to;
        }
        // Gone around already, with the first of this face's starts, or not to be closed.
        if !outline.is_empty() {
            if v != start {
                return None;
            }
            loops.push(outline);
        }
    }
    let faces = face.iter().enumerate().filter(|(t, f)| t == *f).count();
    (loops.len() == faces).then_some(loops)
}

/// Leaves out corners on straight edges, and faces that have only two corners then; `false` if there are none.
fn straighten(loops: &mut Vec<Vec<u32>>, at: impl Fn(u32) -> Vector, flat: f64) -> bool {
    let mut faces: HashMap<u32, usize> = HashMap::new();
    loops.iter().flatten().for_each(|v| *faces.entry(*v).or_default() += 1);
    let mut gone: HashMap<u32, bool> = HashMap::new();
    for outline in loops.iter() {
        let n = outline.len();
        for i in 0..n {
            let (v, before, after) = (outline[i], outline[(i + n - 1) % n], outline[(i + 1) % n]);
            // Neighbours one after the other, so that what is straight is judged by corners that stay.
            let stays = |w: &u32| !gone.get(w).copied().unwrap_or(false);
            if faces[&v] > 2 || gone.contains_key(&v) || !stays(&before) || !stays(&after) {
                continue;
            }
            let along = (at(after) - at(before)).try_normalize(0.0).unwrap_or_default();
            gone.insert(v, along.cross(&(at(v) - at(before))).norm() <= flat);
        }
    }
    let before: usize = loops.iter().map(Vec::len).sum();
    for outline in loops.iter_mut() {
        outline.retain(|v| !gone.get(v).copied().unwrap_or(false));
    }
    loops.retain(|outline| outline.len() > 2);
    loops.iter().map(Vec::len).sum::<usize>() < before
}

/// Is every edge that of two faces, once in each direction, and is it the surface of a ball (V − E + F = 2)?
fn is_closed(loops: &[Vec<u32>]) -> bool {
    let edges = |outline: &Vec<u32>| -> Vec<[u32; 2]> {
        let n = outline.len();
        (0..n).map(|i| [outline[i], outline[(i + 1) % n]]).collect()
    };
    let mut all: Vec<[u32; 2]> = loops.iter().flat_map(edges).collect();
    let n = all.len();
    all.sort_unstable();
    all.dedup();
    let paired = all.len() == n && all.iter().all(|[p, q]| all.binary_search(&[*q, *p]).is_ok());
    let mut corners: Vec<u32> = loops.iter().flatten().copied().collect();
    corners.sort_unstable();
    corners.dedup();
    paired && corners.len() + loops.len() == n / 2 + 2
}
