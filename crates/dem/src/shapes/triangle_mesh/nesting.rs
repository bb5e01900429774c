//! Closed parts of a surface in one another.
use super::crossings::FaceTree;
use super::meeting::{Place, side};
use interfaces::Vector;
use robust::{Coord, orient2d};
use std::cmp::Ordering;
use std::collections::HashMap;

/// Number of other shells around each of the `shells`, which are positions in the list of faces:
/// those that a ray upwards from a vertex, one that no other shell has, leaves more or less often
/// than it enters them. Exact for shells that are closed and apart.
pub(crate) fn depths(shells: &[Vec<u32>], tree: &FaceTree, vertices: &[[f64; 3]]) -> Vec<usize> {
    let mut shell_of = vec![0; tree.faces.len()];
    let (mut owner, mut is_shared) = (vec![usize::MAX; vertices.len()], vec![false; vertices.len()]);
    let corners = |f: u32| tree.faces[f as usize].map(|v| v as usize);
    for (number, shell) in shells.iter().enumerate() {
        for f in shell {
            shell_of[*f as usize] = number;
            for v in corners(*f) {
                is_shared[v] |= owner[v] != usize::MAX && owner[v] != number;
                owner[v] = number;
            }
        }
    }
    let mut net: HashMap<usize, i32> = HashMap::new();
    let depth = |(own, shell): (usize, &Vec<u32>)| {
        let alone = shell.iter().flat_map(|f| corners(*f)).find(|v| !is_shared[*v]);
        let start = alone.unwrap_or(corners(shell[0])[0]);
        net.clear();
        tree.tree.visit_ahead(Vector::from(vertices[start]), Vector::z(), |f| {
            if shell_of[f as usize] != own {
                let places = corners(f).map(|v| tree.places[v]);
                *net.entry(shell_of[f as usize]).or_default() += leaves(places, tree.places[start]);
            }
        });
        net.values().filter(|n| **n != 0).count()
    };
    shells.iter().enumerate().map(depth).collect()
}

/// Whether the ray upwards from `p` leaves through a triangle (1), enters (−1) or misses it (0),
/// decided for a point next to `p`, at (ε, ε²) from it, whose ray meets no edge (Edelsbrunner &
/// Mücke 1990, ACM Trans. Graph. 9, 66).
fn leaves([a, b, c]: [Place; 3], p: Place) -> i32 {
    let turn = |a: Place, b: Place| {
        let [q, r, s] = [a, b, p].map(|[x, y, _]| Coord { x, y });
        let order = |x: f64| x.partial_cmp(&0.0).unwrap_or(Ordering::Equal);
        order(orient2d(q, r, s)).then(a[1].total_cmp(&b[1])).then(b[0].total_cmp(&a[0]))
    };
    let turns = [turn(a, b), turn(b, c), turn(c, a)];
    // Seen from above the corners go round counter-clockwise, and `p` is below their plane.
    let over = |order| turns == [order; 3] && side(a, b, c, p) == order;
    i32::from(over(Ordering::Greater)) - i32::from(over(Ordering::Less))
}
