//! Facets of bodies, as files have them: three corners each.
use std::f64::consts::TAU;

pub(crate) type Facet = [[f64; 3]; 3];

/// A polygon as a fan around its first corner.
fn fan(corners: &[[f64; 3]]) -> Vec<Facet> {
    corners.windows(2).skip(1).map(|pair| [corners[0], pair[0], pair[1]]).collect()
}

/// Corners of a box, and its six sides counter-clockwise from outside.
pub(crate) fn sides(low: [f64; 3], high: [f64; 3]) -> Vec<Vec<[f64; 3]>> {
    let at = |i: usize| [0, 1, 2].map(|a| if i >> a & 1 == 1 { high[a] } else { low[a] });
    let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    sides.map(|side| side.map(at).to_vec()).to_vec()
}

pub(crate) fn block(low: [f64; 3], high: [f64; 3]) -> Vec<Facet> {
    sides(low, high).iter().flat_map(|side| fan(side)).collect()
}

/// A cube of this edge with its lower corner at `at`.
pub(crate) fn cube(at: [f64; 3], edge: f64) -> Vec<Facet> {
    block(at, at.map(|x| x + edge))
}

/// A box whose sides are divided along their other diagonals.
pub(crate) fn other_diagonals(low: [f64; 3], high: [f64; 3]) -> Vec<Facet> {
    let turned = |side: &Vec<[f64; 3]>| fan(&[side[1], side[2], side[3], side[0]]);
    sides(low, high).iter().flat_map(turned).collect()
}

pub(crate) fn tetrahedron() -> Vec<Facet> {
    let [o, a, b, c] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    vec![[o, b, a], [o, a, c], [o, c, b], [a, b, c]]
}

/// A prism over a polygon in the plane of x and y, of height 1, the polygons at its ends divided as
/// given by triples of corners.
pub(crate) fn prism(corners: &[[f64; 2]], ends: &[[usize; 3]]) -> Vec<Facet> {
    let at = |i: usize, z: f64| [corners[i % corners.len()][0], corners[i % corners.len()][1], z];
    let mut all = Vec::new();
    for &[a, b, c] in ends {
        all.push([at(a, 1.0), at(b, 1.0), at(c, 1.0)]);
        all.push([at(c, 0.0), at(b, 0.0), at(a, 0.0)]);
    }
    for i in 0..corners.len() {
        all.extend(fan(&[at(i, 0.0), at(i + 1, 0.0), at(i + 1, 1.0), at(i, 1.0)]));
    }
    all
}

/// Corners of a regular polygon, or of a star whose every other corner is at `inner`.
pub(crate) fn ring(n: usize, inner: f64) -> Vec<[f64; 2]> {
    let corner = |i: usize| {
        let (r, angle) = (if i % 2 == 1 { inner } else { 1.0 }, TAU * i as f64 / n as f64);
        [r * angle.cos(), r * angle.sin()]
    };
    (0..n).map(corner).collect()
}

/// A can with n sides, whose ends are fans around hubs in their middles.
pub(crate) fn can(n: usize) -> Vec<Facet> {
    let mut corners = ring(n, 1.0);
    corners.push([0.0, 0.0]);
    let ends: Vec<[usize; 3]> = (0..n).map(|i| [n, i, (i + 1) % n]).collect();
    let mut all = prism(&corners, &ends);
    // The sides of the polygon alone, not those to its hub.
    all.truncate(2 * n + 2 * (n - 1));
    let at = |i: usize, z: f64| [corners[i][0], corners[i][1], z];
    all.extend(fan(&[at(n - 1, 0.0), at(0, 0.0), at(0, 1.0), at(n - 1, 1.0)]));
    all
}

/// Area of a polygon in the plane.
pub(crate) fn area(corners: &[[f64; 2]]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    0.5 * corners.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>()
}

/// A band around the z axis, n long, that turns over `half_turns` times by half.
pub(crate) fn band(n: usize, half_turns: usize) -> Vec<Facet> {
    let at = |i: usize, side: f64| {
        let angle = TAU * i as f64 / n as f64;
        let tilt = 0.5 * half_turns as f64 * angle;
        let r = 1.0 + 0.25 * side * tilt.cos();
        [r * angle.cos(), r * angle.sin(), 0.25 * side * tilt.sin()]
    };
    let last = if half_turns % 2 == 1 { [at(0, 1.0), at(0, -1.0)] } else { [at(0, -1.0), at(0, 1.0)] };
    let edge = |i: usize| if i == n { last } else { [at(i, -1.0), at(i, 1.0)] };
    (0..n).flat_map(|i| fan(&[edge(i)[0], edge(i + 1)[0], edge(i + 1)[1], edge(i)[1]])).collect()
}

pub(crate) fn inverted(facets: Vec<Facet>) -> Vec<Facet> {
    facets.into_iter().map(|[a, b, c]| [a, c, b]).collect()
}

pub(crate) fn joined(parts: impl IntoIterator<Item = Vec<Facet>>) -> Vec<Facet> {
    parts.into_iter().flatten().collect()
}

pub(crate) fn moved(facets: Vec<Facet>, change: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<Facet> {
    facets.into_iter().map(|f| f.map(&change)).collect()
}
