//! The tessellated sphere.
use interfaces::Vector;
use std::collections::HashMap;

/// Vertices and faces of an icosahedron whose faces are quartered `times` times, the vertices at `radius`.
pub(crate) fn icosphere(radius: f64, times: u32) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut points: Vec<Vector> = Vec::new();
    for (a, b) in [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)] {
        points.push(Vector::new(a, b, 0.0).normalize());
    }
    for turn in 1..3 {
        for i in 0..4 {
            let p = points[i];
            points.push(if turn == 1 { Vector::new(p.z, p.x, p.y) } else { Vector::new(p.y, p.z, p.x) });
        }
    }
    // The faces are the triples of vertices that are neighbours of one another.
    let near = |i: usize, j: usize| points[i].dot(&points[j]) > 0.4;
    let mut faces: Vec<[u32; 3]> = Vec::new();
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                if near(i, j) && near(j, k) && near(k, i) {
                    let outward = points[i].dot(&points[j].cross(&points[k])) > 0.0;
                    let [j, k] = if outward { [j, k] } else { [k, j] };
                    faces.push([i as u32, j as u32, k as u32]);
                }
            }
        }
    }
    for _ in 0..times {
        let mut middles: HashMap<(u32, u32), u32> = HashMap::new();
        let mut finer = Vec::with_capacity(4 * faces.len());
        for [a, b, c] in faces {
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(p, q)| {
                *middles.entry((p.min(q), p.max(q))).or_insert_with(|| {
                    points.push((points[p as usize] + points[q as usize]).normalize());
                    points.len() as u32 - 1
                })
            });
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        faces = finer;
    }
    (points.into_iter().map(|p| (p * radius).into()).collect(), faces)
}
