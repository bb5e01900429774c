//! Vertices that are near one another.
use std::collections::HashMap;

/// Vertices of which none is near one before it, and the number among them for each of the others.
pub(crate) struct Welded {
    pub(crate) kept: Vec<[f64; 3]>,
    pub(crate) number: Vec<u32>,
}

impl Welded {
    /// Replaces each vertex by the first one kept that is no farther than `tolerance` \[m\].
    pub(crate) fn new(vertices: &[[f64; 3]], tolerance: f64) -> Self {
        // Boxes wider than the tolerance, and wide enough that they can be numbered: a vertex near
        // another is in its box or in one next to it.
        let largest = largest(vertices);
        let width = (1.001 * tolerance).max(largest * 1e-15).max(f64::MIN_POSITIVE);
        let mut boxes: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
        let mut kept: Vec<[f64; 3]> = Vec::new();
        let mut number = Vec::with_capacity(vertices.len());
        for v in vertices {
            let home = v.map(|x| (x / width).floor() as i64);
            let near = |w: &u32| {
                let w = kept[*w as usize];
                (0..3).map(|a| (w[a] - v[a]).powi(2)).sum::<f64>() <= tolerance * tolerance
            };
            let around = (0..27).map(|i| [i % 3, i / 3 % 3, i / 9]);
            let around = around.map(|i| [0, 1, 2].map(|a| home[a].saturating_add(i[a] - 1)));
            let like = around.filter_map(|b| boxes.get(&b)).flatten().copied().filter(near).min();
            number.push(like.unwrap_or_else(|| {
                kept.push(*v);
                boxes.entry(home).or_default().push(kept.len() as u32 - 1);
                kept.len() as u32 - 1
            }));
        }
        Self { kept, number }
    }

    /// Faces of the vertices kept. Vertices that do not exist stay so, to be named later.
    pub(crate) fn faces<'a>(&'a self, faces: &'a [[u32; 3]]) -> impl Iterator<Item = [u32; 3]> + 'a {
        let last = self.number.len() as u32;
        let number = move |v: u32| self.number.get(v as usize).copied().unwrap_or(v.max(last));
        faces.iter().map(move |f| f.map(number))
    }
}

/// Largest coordinate, not counting those that are not finite \[m\].
pub(crate) fn largest(vertices: &[[f64; 3]]) -> f64 {
    vertices.as_flattened().iter().filter(|x| x.is_finite()).fold(0.0, |m: f64, x| m.max(x.abs()))
}

/// Whether a face has one vertex twice.
pub(crate) fn is_collapsed([a, b, c]: [u32; 3]) -> bool {
    a == b || b == c || c == a
}
