//! Flat-faced bodies in poses full of coincidences: both routes against counted cells, one another and themselves.
use super::clip::Clipper;
use super::facets::FacetOverlap;
use super::{Overlap, OverlapSolver};
use crate::shapes::Facets;
use crate::{ConvexPolyhedron, Cuboid};
use approx::assert_relative_eq;
use interfaces::{Point, Pose, Rotation, Solid, Vector};
use proptest::prelude::*;
use std::collections::{BTreeSet, HashMap};

type Cell = [i32; 3];

/// The surface of cells of edge 1 on the integer grid, and their middle; `None` where four faces meet in an edge.
fn surface(cells: &BTreeSet<Cell>, middle: Vector) -> Option<Facets> {
    let (mut vertices, mut numbers, mut faces) = (Vec::new(), HashMap::new(), Vec::new());
    for cell in cells {
        for axis in 0..3 {
            for up in [false, true] {
                let mut other = *cell;
                other[axis] += if up { 1 } else { -1 };
                if cells.contains(&other) {
                    continue;
                }
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                let mut corner = |i: i32, j: i32| {
                    let mut at = *cell;
                    at[axis] += i32::from(up);
                    at[u] += i;
                    at[v] += j;
                    *numbers.entry(at).or_insert_with(|| {
                        vertices.push(Vector::from(at.map(f64::from)) - middle);
                        vertices.len() as u32 - 1
                    })
                };
                let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                faces.extend(if up { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] });
            }
        }
    }
    Facets::new(vertices, faces).ok()
}

/// Cells that hang together by faces.
fn cells(steps: &[(usize, usize, bool)]) -> BTreeSet<Cell> {
    let mut all = vec![[0; 3]];
    for &(from, axis, up) in steps {
        let mut next = all[from % all.len()];
        next[axis % 3] += if up { 1 } else { -1 };
        all.push(next);
    }
    all.into_iter().collect()
}

fn steps() -> impl Strategy<Value = Vec<(usize, usize, bool)>> {
    prop::collection::vec((0..100_usize, 0..3_usize, any::<bool>()), 0..9)
}

/// The 24 turns that map the grid onto itself.
fn grid_turn(number: usize) -> (Rotation, impl Fn(Vector) -> Vector) {
    let quarter = |axis: Vector, times: usize| {
        Rotation::from_scaled_axis(axis * (std::f64::consts::FRAC_PI_2 * times as f64))
    };
    let turn = match number / 4 {
        0..4 => quarter(Vector::y(), number / 4),
        4 => quarter(Vector::x(), 1),
        _ => quarter(Vector::x(), 3),
    } * quarter(Vector::z(), number % 4);
    let exact = turn.to_rotation_matrix().matrix().map(f64::round);
    (turn, move |x| exact * x)
}

/// Connected parts of a set of cells.
fn parts(cells: &BTreeSet<Cell>) -> usize {
    let mut left = cells.clone();
    let mut parts = 0;
    while let Some(start) = left.pop_first() {
        parts += 1;
        let mut todo = vec![start];
        while let Some(cell) = todo.pop() {
            for axis in 0..3 {
                for step in [-1, 1] {
                    let mut next = cell;
                    next[axis] += step;
                    if left.remove(&next) {
                        todo.push(next);
                    }
                }
            }
        }
    }
    parts
}

fn solve(solver: &mut FacetOverlap, a: &Facets, at_a: &Pose, b: &Facets, at_b: &Pose) -> Vec<Overlap> {
    let mut out = Vec::new();
    solver.overlap(a, at_a, b, at_b, &mut out).unwrap();
    out
}

/// A convex body from the hull of whole-numbered points: a box, a wedge, a tetrahedron or an octahedron.
fn convex(kind: usize, size: [i32; 3]) -> ConvexPolyhedron {
    let [x, y, z] = size.map(f64::from);
    let (vertices, faces): (Vec<[f64; 3]>, Vec<Vec<u32>>) = match kind % 4 {
        0 => {
            let corner = |i: u32| [0, 1, 2].map(|a| if i >> a & 1 == 1 { [x, y, z][a] } else { 0.0 });
            let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
            ((0..8).map(corner).collect(), faces.map(Vec::from).to_vec())
        }
        1 => (
            vec![[0.0; 3], [x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z], [x, 0.0, z], [0.0, y, z]],
            vec![vec![0, 2, 1], vec![3, 4, 5], vec![0, 1, 4, 3], vec![1, 2, 5, 4], vec![2, 0, 3, 5]],
        ),
        2 => (
            vec![[0.0; 3], [x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]],
            vec![vec![0, 2, 1], vec![0, 1, 3], vec![0, 3, 2], vec![1, 2, 3]],
        ),
        _ => (
            vec![[x, 0.0, 0.0], [-x, 0.0, 0.0], [0.0, y, 0.0], [0.0, -y, 0.0], [0.0, 0.0, z], [0.0, 0.0, -z]],
            (0..8)
                .map(|i: u32| {
                    let face = [i & 1, 2 + (i >> 1 & 1), 4 + (i >> 2 & 1)];
                    if i.count_ones().is_multiple_of(2) {
                        face.to_vec()
                    } else {
                        vec![face[1], face[0], face[2]]
                    }
                })
                .collect(),
        ),
    };
    ConvexPolyhedron::new(&vertices, &faces).unwrap()
}

fn turn(t: [f64; 3]) -> Rotation {
    Rotation::from_scaled_axis(t.into())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60_000, failure_persistence: None, ..ProptestConfig::default() })]

    /// Blocks of cells, turned and shifted onto the grid: shared planes, edges and corners everywhere, and by the rounded turn also
    /// all but shared. The volume is the number of cells in common.
    #[test]
    fn as_many_cells_as_are_common(a in steps(), b in steps(), shift in prop::array::uniform3(-3..=3i32), number in 0..24_usize) {
        let (a, b) = (cells(&a), cells(&b));
        let Some(first) = surface(&a, Vector::zeros()) else { return Ok(()) };
        let Some(second) = surface(&b, Vector::zeros()) else { return Ok(()) };
        let (orientation, exact) = grid_turn(number);
        let shift = Vector::from(shift.map(f64::from));
        let turned: BTreeSet<Cell> = b.iter().map(|c| {
            let middle = exact(Vector::from(c.map(f64::from)) + Vector::repeat(0.5)) + shift;
            <[f64; 3]>::from(middle).map(|x| x.floor() as i32)
        }).collect();
        let common: BTreeSet<Cell> = a.intersection(&turned).copied().collect();
        let (origin, at) = (Pose::at([0.0; 3]), Pose { position: shift.into(), orientation });
        let mut solver = FacetOverlap::default();
        let one = solve(&mut solver, &first, &origin, &second, &at);
        let two = solve(&mut solver, &second, &at, &first, &origin);
        for patches in [one, two] {
            let volume: f64 = patches.iter().map(|o| o.volume).sum();
            prop_assert!((volume - common.len() as f64).abs() < 1e-12, "{} instead of {}", volume, common.len());
            let large = patches.iter().filter(|o| o.volume > 1e-9).count();
            // Parts that share no more than an edge or a corner count as one or two.
            prop_assert!(large <= parts(&common));
            prop_assert!(patches.iter().all(|o| o.volume >= 0.0 && o.gradient.iter().all(|x| x.is_finite())));
        }
    }

    /// Clipping and crossings agree on convex bodies from small whole numbers, shifted by small whole numbers: coincidences
    /// abound. Turned a little, they nearly do.
    #[test]
    fn routes_agree(
        kinds in prop::array::uniform2(0..4_usize), sizes in prop::array::uniform2(prop::array::uniform3(1..4i32)),
        shift in prop::array::uniform3(-4..=4i32), t in prop::array::uniform3(-1.0..1.0f64), how in 0..4_usize,
    ) {
        let (a, b) = (convex(kinds[0], sizes[0]), convex(kinds[1], sizes[1]));
        // The corner that was the origin on whole numbers again.
        let start = Point::from(shift.map(f64::from)) + b.origin().coords;
        let turned = turn(t.map(|x| x * [0.0, 1e-6, 1e-14, 1.0][how]));
        let (at_a, at_b) = (Pose::at(a.origin().into()), Pose { position: start, orientation: turned });
        let mut clipped = Vec::new();
        Clipper::default().overlap(&a, &at_a, &b, &at_b, &mut clipped);
        let mut crossed = solve(&mut FacetOverlap::default(), a.facets(), &at_a, b.facets(), &at_b);
        crossed.retain(|o| o.volume > 1e-12);
        clipped.retain(|o| o.volume > 1e-12);
        prop_assert!(crossed.len() <= 1, "convex bodies share one region: {:?}", crossed);
        let volume = |all: &[Overlap]| all.first().map_or(0.0, |o| o.volume);
        let least = a.volume().min(b.volume());
        prop_assert!((volume(&clipped) - volume(&crossed)).abs() < 1e-12 * least, "{:?} {:?}", clipped, crossed);
        prop_assert!(volume(&clipped) <= least * (1.0 + 1e-12));
        if let (Some(p), Some(q)) = (clipped.first(), crossed.first()) {
            // Sums over whole bodies carry their round-off, however thin what is shared.
            assert_relative_eq!(p.centroid, q.centroid, epsilon = 1e-10 + 1e-14 * least / volume(&clipped));
            // Where faces coincide the gradient has a jump; elsewhere both find the same.
            if how == 3 {
                assert_relative_eq!(p.gradient, q.gradient, epsilon = 1e-11);
                assert_relative_eq!(p.moment, q.moment, epsilon = 1e-9);
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, failure_persistence: None, ..ProptestConfig::default() })]

    /// Gradient and moment are the derivatives of the volume along a shift and about an axis, both routes; the pair may be swapped,
    /// moved, turned and scaled.
    #[test]
    fn derivatives_and_symmetries(
        kinds in prop::array::uniform2(0..4_usize), place in prop::array::uniform3(-1.5..1.5f64),
        t in prop::array::uniform3(-3.0..3.0f64), far in prop::array::uniform3(-50.0..50.0f64), s in -30..20i32,
    ) {
        let (a, b) = (convex(kinds[0], [2, 3, 2]), convex(kinds[1], [3, 2, 2]));
        let mut clipper = Clipper::default();
        let mut solver = FacetOverlap::default();
        let at_b = Pose { position: place.into(), orientation: turn(t) };
        let origin = Pose::at([0.0; 3]);
        for route in 0..2 {
            let mut solve = |a: &ConvexPolyhedron, at_a: &Pose, b: &ConvexPolyhedron, at_b: &Pose| {
                let mut out = Vec::new();
                match route {
                    0 => clipper.overlap(a, at_a, b, at_b, &mut out),
                    _ => solver.overlap(a.facets(), at_a, b.facets(), at_b, &mut out).unwrap(),
                }
                out.first().copied()
            };
            let Some(o) = solve(&a, &origin, &b, &at_b) else { return Ok(()) };
            prop_assume!(o.volume > 1e-3);
            let swapped = solve(&b, &at_b, &a, &origin).unwrap();
            assert_relative_eq!(swapped.volume, o.volume, max_relative = 1e-12);
            assert_relative_eq!(swapped.gradient, -o.gradient, epsilon = 1e-11);
            assert_relative_eq!(swapped.moment, -o.moment, epsilon = 1e-10);
            // Differences; kinks of the slope are rare and excused by the bound on them.
            let h = 1e-5;
            for axis in 0..3 {
                let mut step = Vector::zeros();
                step[axis] = h;
                let shifted = |sign: f64| Pose { position: Point::from(sign * step), orientation: Rotation::identity() };
                let volume = |at: Pose| solve(&a, &at, &b, &at_b).map_or(0.0, |o| o.volume);
                let mut volume = volume;
                let slope = (volume(shifted(1.0)) - volume(shifted(-1.0))) / (2.0 * h);
                assert_relative_eq!(slope, o.gradient[axis], epsilon = 2e-4);
                let about = |sign: f64| {
                    let orientation = Rotation::from_scaled_axis(sign * step);
                    let arm = Point::origin() - o.centroid;
                    Pose { position: o.centroid + orientation * arm, orientation }
                };
                let slope = (volume(about(1.0)) - volume(about(-1.0))) / (2.0 * h);
                assert_relative_eq!(slope, o.moment[axis], epsilon = 5e-4);
            }
            // Elsewhere and turned.
            let move_ = Pose { position: far.into(), orientation: turn([t[1], t[2], t[0]]) };
            let moved = |p: &Pose| Pose {
                position: move_.to_world(p.position), orientation: move_.orientation * p.orientation,
            };
            let m = solve(&a, &moved(&origin), &b, &moved(&at_b)).unwrap();
            assert_relative_eq!(m.volume, o.volume, max_relative = 1e-9, epsilon = 1e-12);
            assert_relative_eq!(m.centroid, move_.to_world(o.centroid), epsilon = 1e-10);
            assert_relative_eq!(m.gradient, move_.orientation * o.gradient, epsilon = 1e-10);
            assert_relative_eq!(m.moment, move_.orientation * o.moment, epsilon = 1e-10);
            // By a power of two, every digit is the same.
            let s = 2f64.powi(s);
            let big = |p: &ConvexPolyhedron| {
                let vertices: Vec<[f64; 3]> = p.vertices().iter().map(|v| (v.coords * s).into()).collect();
                let triangles = p.polyhedron().unwrap().faces.iter().map(|f| f.to_vec()).collect::<Vec<_>>();
                ConvexPolyhedron::new(&vertices, &triangles).unwrap()
            };
            let at_big = Pose { position: Point::from(at_b.position.coords * s), ..at_b };
            let large = solve(&big(&a), &origin, &big(&b), &at_big).unwrap();
            assert_relative_eq!(large.volume, o.volume * s.powi(3), max_relative = 1e-12);
            assert_relative_eq!(large.gradient, o.gradient * s * s, epsilon = 1e-11 * s * s);
        }
    }

    /// V^⅓ is concave along any shift of a convex pair (Brunn–Minkowski).
    #[test]
    fn brunn_minkowski(
        kinds in prop::array::uniform2(0..4_usize), place in prop::array::uniform3(-1.0..1.0f64),
        t in prop::array::uniform3(-3.0..3.0f64), along in prop::array::uniform3(-1.0..1.0f64),
    ) {
        let (a, b) = (convex(kinds[0], [2, 3, 2]), convex(kinds[1], [3, 2, 2]));
        let mut solver = OverlapSolver::new();
        let mut root = |s: f64| {
            let position = Point::from(place) + s * Vector::from(along);
            let at = Pose { position, orientation: turn(t) };
            let patches = solver.solve(&a, &Pose::at([0.0; 3]), &b, &at).unwrap();
            patches.first().map_or(0.0, |o| o.volume).cbrt()
        };
        let [left, middle, right] = [root(-1.0), root(0.0), root(1.0)];
        if left > 0.0 && right > 0.0 {
            prop_assert!(middle >= 0.5 * (left + right) - 1e-12);
        }
    }

    /// A box cut in two by a plane of its own shares what its parts share together.
    #[test]
    fn additive(kind in 0..4_usize, share in 0.1..0.9f64, place in prop::array::uniform3(-1.5..1.5f64), t in prop::array::uniform3(-3.0..3.0f64)) {
        let whole = Cuboid::new([2.0, 1.5, 1.0]).unwrap();
        let parts = [share, 1.0 - share].map(|s| Cuboid::new([2.0 * s, 1.5, 1.0]).unwrap());
        let other = convex(kind, [2, 2, 3]);
        let at = Pose { position: place.into(), orientation: turn(t) };
        let mut solver = OverlapSolver::new();
        let mut shared = |cuboid: &Cuboid, x: f64| {
            let patches = solver.solve(cuboid, &Pose::at([x, 0.0, 0.0]), &other, &at).unwrap();
            patches.first().map_or((0.0, Vector::zeros()), |o| (o.volume, o.volume * o.centroid.coords))
        };
        let (v, m) = shared(&whole, 0.0);
        let (v1, m1) = shared(&parts[0], share - 1.0);
        let (v2, m2) = shared(&parts[1], share);
        assert_relative_eq!(v, v1 + v2, epsilon = 1e-13);
        assert_relative_eq!(m, m1 + m2, epsilon = 1e-12);
    }
}

/// A tetrahedron with its tip in one arm of a U and its base in the other: every edge at the tip leaves the U and enters it again.
#[test]
fn across_a_gap() {
    let u = BTreeSet::from([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [2, 1, 0]]);
    let u = surface(&u, Vector::zeros()).unwrap();
    let corners = [[0.5, 1.5, 0.5], [2.5, 1.2, 0.2], [2.5, 1.8, 0.5], [2.5, 1.5, 0.8]].map(Vector::from);
    let whole =
        (corners[1] - corners[0]).cross(&(corners[2] - corners[0])).dot(&(corners[3] - corners[0])) / 6.0;
    for first in 0..4 {
        // The search starts from another corner.
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| (i + first) % 4);
        let turn = if (whole > 0.0) == (first % 2 == 0) { [b, c, d] } else { [c, b, d] };
        let [b, c, d] = turn;
        let faces = [[a, c, b], [a, b, d], [b, c, d], [a, d, c]].map(|f| f.map(|i| i as u32));
        let tip = Facets::new(corners.to_vec(), faces.to_vec()).unwrap();
        let mut shares: Vec<f64> =
            solve(&mut FacetOverlap::default(), &tip, &Pose::at([0.0; 3]), &u, &Pose::at([0.0; 3]))
                .iter()
                .map(|o| o.volume / whole.abs())
                .collect();
        shares.sort_by(f64::total_cmp);
        // Sections grow with the square of the distance from the tip.
        assert_eq!(shares.len(), 2, "{shares:?}");
        assert_relative_eq!(shares[0], 0.25_f64.powi(3), max_relative = 1e-12);
        assert_relative_eq!(shares[1], 1.0 - 0.75_f64.powi(3), max_relative = 1e-12);
    }
}
