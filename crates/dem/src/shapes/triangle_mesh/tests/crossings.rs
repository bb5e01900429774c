//! Which triangles meet, against separating planes in integers; meshes that cross or touch themselves.
use super::super::meeting::meet;
use super::*;

type Whole = [i64; 3];

fn minus(a: Whole, b: Whole) -> Whole {
    [0, 1, 2].map(|i| a[i] - b[i])
}
fn cross(a: Whole, b: Whole) -> Whole {
    [0, 1, 2].map(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
}
fn dot(a: Whole, b: Whole) -> i64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}
fn sides(polygon: &[Whole]) -> Vec<Whole> {
    (0..polygon.len()).map(|i| minus(polygon[(i + 1) % polygon.len()], polygon[i])).collect()
}

/// Have a triangle and a triangle or segment no point in common? Exact: some facet of their difference, or the plane that it
/// is on, keeps the origin off.
fn apart(triangle: &[Whole; 3], other: &[Whole]) -> bool {
    let (e, f) = (sides(triangle), sides(other));
    let normal = cross(e[0], e[1]);
    let mut axes = vec![normal, cross(f[0], f[f.len() - 1])];
    for p in &e {
        axes.push(cross(normal, *p));
        axes.extend(f.iter().map(|q| cross(*p, *q)));
    }
    axes.extend(f.iter().map(|q| cross(normal, *q)));
    axes.into_iter().any(|axis| {
        let span = |points: &[Whole]| {
            let along: Vec<i64> = points.iter().map(|p| dot(axis, *p)).collect();
            (*along.iter().min().unwrap(), *along.iter().max().unwrap())
        };
        let (one, two) = (span(triangle), span(other));
        one.1 < two.0 || two.1 < one.0
    })
}

/// What [`meet`] is to say of two faces.
fn meet_in_integers(f: [u32; 3], g: [u32; 3], at: impl Fn(u32) -> Whole) -> bool {
    let others = |f: [u32; 3], g: [u32; 3]| -> Vec<Whole> {
        f.into_iter().filter(|v| !g.contains(v)).map(&at).collect()
    };
    let (at_f, at_g) = (f.map(&at), g.map(&at));
    let (of_f, of_g) = (others(f, g), others(g, f));
    match of_f.len() {
        3 => !apart(&at_f, &at_g),
        2 => !apart(&at_g, &of_f) || !apart(&at_f, &of_g),
        1 => {
            // Folded onto one another: on one plane, on the same side of the edge.
            let edge: Vec<Whole> = f.into_iter().filter(|v| g.contains(v)).map(&at).collect();
            let along = minus(edge[1], edge[0]);
            let (p, q) = (cross(along, minus(of_f[0], edge[0])), cross(along, minus(of_g[0], edge[0])));
            cross(p, q) == [0; 3] && dot(p, q) > 0
        }
        _ => false,
    }
}

fn is_flat([a, b, c]: [Whole; 3]) -> bool {
    cross(minus(b, a), minus(c, a)) == [0; 3]
}

/// Six points of a small grid, in space or on a plane.
fn points() -> impl Strategy<Value = Vec<Whole>> {
    let plane = (0..9_i64, 0..9_i64).prop_map(|(x, y)| [x, y, x - y]);
    let space = prop::array::uniform3(0..4_i64);
    prop_oneof![prop::collection::vec(space, 6), prop::collection::vec(plane, 6)]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20_000, max_global_rejects: 20_000, failure_persistence: None, ..ProptestConfig::default() })]
    /// Small integers: most pairs are degenerate in some way.
    #[test]
    fn pairs_are_told_exactly(points in points(), shared in 0..3_u32) {
        let at = |v: u32| points[v as usize];
        // None, one or two of the first face's corners are the second's.
        let (f, g) = ([0, 1, 2], [0, 1, 2].map(|i: u32| if i < shared { i } else { i + 3 }));
        prop_assume!(!is_flat(f.map(at)) && !is_flat(g.map(at)));
        let expected = meet_in_integers(f, g, at);
        let place = |v: u32| at(v).map(|x| x as f64);
        for turn in 0..3 {
            let turned = |f: [u32; 3]| [0, 1, 2].map(|i| f[(i + turn) % 3]);
            prop_assert_eq!(meet(f, turned(g), place), expected);
            prop_assert_eq!(meet(turned(g), [f[2], f[1], f[0]], place), expected);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]
    /// A ball of triangles, a vertex or two of which were moved: the pairs are those found by asking all.
    #[test]
    fn all_crossings_are_found(moved in prop::collection::vec((0..42_u32, prop::array::uniform3(-24..24_i64)), 1..3)) {
        let (vertices, faces) = icosphere(20.0, 1);
        let mut whole: Vec<Whole> = vertices.iter().map(|v| v.map(|x| x.round() as i64)).collect();
        moved.iter().for_each(|(v, to)| whole[*v as usize] = *to);
        let at = |v: u32| whole[v as usize];
        // Vertices at one place are one.
        let first = |v: u32| whole.iter().position(|w| *w == at(v)).unwrap() as u32;
        let faces: Vec<[u32; 3]> = faces.iter().map(|f| f.map(first)).collect();
        prop_assume!(!faces.iter().any(|f| is_flat(f.map(at))));
        let mut pairs = Vec::new();
        for (i, f) in faces.iter().enumerate() {
            for (j, g) in faces.iter().enumerate().skip(i + 1) {
                if meet_in_integers(*f, *g, at) {
                    pairs.push([i, j]);
                }
            }
        }
        // Any unit of length; a power of two commits no rounding.
        let vertices: Vec<[f64; 3]> = whole.iter().map(|v| v.map(|x| x as f64 * 2.0_f64.powi(-23))).collect();
        let report = AdmissionReport::of(&vertices, &faces, None);
        let found = report.faults.iter().find_map(|f| match f {
            MeshError::SelfIntersecting { count, all: true, faces } => Some((*count, faces.clone())),
            _ => None,
        });
        let expected = (!pairs.is_empty()).then(|| (pairs.len(), pairs[..pairs.len().min(8)].to_vec()));
        prop_assert_eq!(found, expected);
    }
}

/// Bricks that touch one another in a face, an edge, a corner, or cross.
#[test]
fn touching_is_told_from_being_apart() {
    let unit = || brick([0.0; 3], [1.0; 3]);
    let with = |low: [f64; 3], high: [f64; 3]| {
        AdmissionReport::of(&joined(unit(), brick(low, high)).0, &joined(unit(), brick(low, high)).1, None)
    };
    let crossing = |report: &AdmissionReport| {
        report.faults.iter().any(|f| matches!(f, MeshError::SelfIntersecting { .. }))
    };
    let next = 1.0 + f64::EPSILON;
    assert!(with([next, 0.0, 0.0], [2.0, 1.0, 1.0]).is_admissible());
    for (low, high) in [
        ([1.0, 0.25, 0.25], [2.0, 0.75, 0.75]),
        ([1.0, 0.0, 0.0], [2.0, 1.0, 1.0]),
        ([1.0, 1.0, 0.25], [2.0, 2.0, 0.75]),
        ([1.0, 1.0, 1.0], [2.0, 2.0, 2.0]),
        ([0.5, 0.5, 0.5], [2.0, 2.0, 2.0]),
        ([0.25, 0.25, 0.25], [0.5, 0.5, 1.0]),
    ] {
        let report = with(low, high);
        let joined = report.faults.iter().any(|f| matches!(f, MeshError::Coincident { .. }));
        assert!((crossing(&report) || joined) && !report.is_admissible(), "{low:?}: {report}");
    }
    // Within, not touching: not crossing, but inside out.
    let inner = with([0.25; 3], [0.75; 3]);
    assert!(!crossing(&inner));
    assert_eq!(inner.faults, [MeshError::InsideOut { count: 1, faces: vec![12] }]);
    // Only crossing faces keep this from being a body.
    let (vertices, faces) = joined(unit(), brick([0.5; 3], [1.5; 3]));
    assert!(matches!(
        TriangleMesh::new(&vertices, &faces),
        Err(MeshError::SelfIntersecting { all: true, .. })
    ));
}
