//! Surfaces damaged at random, and faces without area.
use crate::solids::*;
use crate::writers::stl;
use dem::{Shape, TriangleMesh, TriangleSoup, overlap};
use interfaces::{Point, Pose, Solid};
use proptest::prelude::*;

fn soup(facets: &[Facet]) -> TriangleSoup {
    TriangleSoup::from_stl_bytes(&stl(facets), 1.0).unwrap()
}

/// A box with facets left out, there twice, turned or with a corner moved to another place of a small
/// lattice, where much is on a line, in a plane or at one place.
fn damaged() -> impl Strategy<Value = Vec<Facet>> {
    let change = (any::<prop::sample::Index>(), 0..6_u8, prop::array::uniform3(0..4_u8));
    let start = prop::sample::select(vec![0, 1, 2]);
    (start, prop::collection::vec(change, 0..5)).prop_map(|(start, changes)| {
        let parts = [
            vec![cube([0.0; 3], 3.0)],
            vec![cube([0.0; 3], 2.0), cube([1.0; 3], 2.0)],
            vec![cube([0.0; 3], 1.0), cube([1.0, 0.0, 0.0], 1.0)],
        ];
        let mut facets = joined(parts[start].clone());
        for (at, how, place) in changes {
            let n = facets.len();
            let (at, place) = (at.index(n), place.map(f64::from));
            match how {
                0 => _ = facets.remove(at),
                1 => facets.push(facets[at]),
                2 => facets[at].swap(0, 1),
                // The corner of all facets there, of one, or a facet that comes in addition.
                3 => {
                    let old = facets[at][0];
                    facets = moved(facets, |p| if p == old { place } else { p });
                }
                4 => facets[at][1] = place,
                _ => facets.push([facets[at][0], place, facets[at][2]]),
            }
        }
        facets
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    /// No panic, and whatever repair returns is a body; a body is repaired without any change of its volume.
    #[test]
    fn repaired_is_a_body_or_an_error(facets in damaged()) {
        let given = TriangleMesh::try_from(soup(&facets));
        let repaired = soup(&facets).repaired(None);
        if let Ok(mesh) = &given {
            prop_assert!((TriangleMesh::try_from(repaired.as_ref().unwrap().0.clone()).unwrap().volume() - mesh.volume()).abs() < 1e-12);
        }
        if let Ok((soup, _)) = repaired {
            prop_assert!(TriangleMesh::try_from(soup.clone()).is_ok());
            // There is nothing left to do.
            let (again, report) = soup.clone().repaired(None).unwrap();
            prop_assert!(report.is_empty(), "{}", report);
            prop_assert_eq!(again.faces.len(), soup.faces.len());
        }
    }
}

/// A body with faces without area on its edges is the same as without, to distances, contacts and
/// mass.
#[test]
fn faces_without_area_do_nothing() {
    let [o, a, b, c] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let on = |x: f64| [x, 0.0, 0.0];
    let mut facets = vec![[o, b, a], [o, c, b], [a, b, c]];
    let ends = [0.0, 0.125, 0.3, 0.7, 1.0].map(on);
    facets.extend(ends.windows(2).map(|pair| [pair[0], pair[1], c]));
    facets.extend(ends[1..].windows(2).map(|pair| [o, pair[1], pair[0]]));
    let report = soup(&facets).admission(None);
    assert!(report.is_admissible() && report.flat == 3, "{report}");
    let [flat, plain] = [facets, tetrahedron()].map(|f| TriangleMesh::try_from(soup(&f)).unwrap());
    assert_eq!(flat.n_faces(), 10);
    assert!((flat.inertia(2.0).tensor - plain.inertia(2.0).tensor).norm() < 1e-16);
    for i in 0..2000 {
        let turned = |k: f64| 0.7 * (k * f64::from(i)).sin();
        let x = Point::new(turned(12.9898), turned(78.233), turned(37.719));
        let [p, q] = [&flat, &plain].map(|mesh| mesh.signed_distance(x, f64::INFINITY));
        assert!((p - q).abs() < 1e-15, "{x}: {p} {q}");
    }
    let there = Pose::at([0.2, -0.1, 0.15]);
    let common = |mesh: &TriangleMesh| overlap(mesh, &Pose::at([0.0; 3]), &plain, &there).unwrap()[0].volume;
    assert!((common(&flat) / common(&plain) - 1.0).abs() < 1e-13);
}
