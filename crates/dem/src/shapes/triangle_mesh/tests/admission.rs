//! Reports: every fault, shells, thickness, and how they read.
use super::*;

fn report((vertices, faces): &Faces) -> AdmissionReport {
    AdmissionReport::of(vertices, faces, Some(0.1))
}

#[test]
fn bodies_are_admitted() {
    let far =
        |(vertices, faces): Faces| (vertices.iter().map(|v| [v[0] + 1e3, v[1], v[2] - 1e3]).collect(), faces);
    for (faces, volume) in [
        (brick([0.0; 3], [1.0, 2.0, 3.0]), 6.0),
        (inverted(brick([0.0; 3], [1.0, 2.0, 3.0])), -6.0),
        (far(brick([0.0; 3], [1.0, 2.0, 3.0])), 6.0),
        (star(), 5.0 * 0.35 * (PI / 5.0).sin()),
    ] {
        let report = report(&faces);
        assert!(report.is_admissible(), "{report}");
        assert!((report.volume / volume - 1.0).abs() < 1e-12);
        assert_eq!((report.shells.len(), report.slivers), (1, 0));
        assert_eq!(report.shells[0].volume, report.volume);
        assert!(TriangleMesh::new(&faces.0, &faces.1).is_ok());
    }
    let report = report(&brick([0.5; 3], [1.0, 2.0, 3.0]));
    assert_eq!((report.bounds.min, report.bounds.max), ([0.5; 3].into(), [1.0, 2.0, 3.0].into()));
    assert_eq!((report.vertices, report.faces), (8, 12));
}

/// Shells in shells, each turned the other way; the wrong ones are named, whichever way the whole is turned.
#[test]
fn shells_are_counted_and_their_signs_checked() {
    let shell = |h: f64| brick([-h; 3], [h; 3]);
    let aside = || brick([2.0; 3], [3.0; 3]);
    let good = joined(joined(joined(shell(1.0), inverted(shell(0.5))), shell(0.25)), aside());
    for (faces, sign) in [(good.clone(), 1.0), (inverted(good), -1.0)] {
        let report = report(&faces);
        assert!(report.is_admissible(), "{report}");
        let depths: Vec<usize> = report.shells.iter().map(|s| s.depth).collect();
        let volumes: Vec<f64> =
            report.shells.iter().map(|s| (1e12 * sign * s.volume).round() / 1e12).collect();
        assert_eq!((depths, volumes), (vec![0, 1, 2, 0], vec![8.0, -1.0, 0.125, 1.0]));
        assert_eq!(
            report.shells.iter().map(|s| (s.faces, s.first)).collect::<Vec<_>>(),
            [(12, 0), (12, 12), (12, 24), (12, 36)]
        );
        assert!(report.to_string().contains("closed parts: 4, of which 1 cavities"), "{report}");
    }
    let bad = joined(joined(shell(1.0), shell(0.5)), inverted(aside()));
    for faces in [bad.clone(), inverted(bad)] {
        assert_eq!(report(&faces).faults, [MeshError::InsideOut { count: 2, faces: vec![12, 24] }]);
        assert!(matches!(TriangleMesh::new(&faces.0, &faces.1), Err(MeshError::InsideOut { count: 2, .. })));
    }
}

/// None hides another.
#[test]
fn all_faults_are_told_at_once() {
    let (mut vertices, mut faces) = joined(icosphere(1.0, 1), brick([5.0; 3], [6.0; 3]));
    faces[5].swap(0, 1); // Turned.
    faces.remove(17); // A hole.
    faces.push(faces[40]); // Twice, which makes edges of three.
    faces.push([4, 5, 4]); // No triangle.
    faces.push([7, 8, 999]);
    vertices.push([f64::NAN; 3]);
    vertices.push(vertices[49]);
    let copy = vertices.len() as u32 - 1;
    // A corner of the brick is two vertices at one place: open edges.
    let with_corner = faces.iter().position(|f| f.contains(&49)).unwrap();
    faces[with_corner].iter_mut().for_each(|v| *v = if *v == 49 { copy } else { *v });
    let report = report(&(vertices, faces));
    let has = |wanted: fn(&MeshError) -> bool| assert!(report.faults.iter().any(wanted), "{report}");
    has(|f| matches!(f, MeshError::NoVertex { face: 93, vertex: 999, .. }));
    has(|f| matches!(f, MeshError::NotFinite { vertex: 50, .. }));
    has(|f| matches!(f, MeshError::Degenerate { count: 1, .. }));
    has(|f| matches!(f, MeshError::NotManifold { count: 3, .. }));
    has(|f| matches!(f, MeshError::NotClosed { .. }));
    has(|f| matches!(f, MeshError::Inconsistent { count: 3, .. }));
    has(|f| matches!(f, MeshError::Duplicate { count: 1, faces } if faces == &[[40, 91]]));
    has(|f| matches!(f, MeshError::Coincident { count: 1, vertices } if vertices == &[[49, 51]]));
    assert_eq!(report.faults.len(), 8, "{report}");
    let text = report.to_string();
    for words in
        ["not admitted", "fault: the surface is not closed", "fault: face 93 has vertex 999", "[40, 91]"]
    {
        assert!(text.contains(words), "{text}");
    }
    // The same text as the error alone.
    assert!(report.faults.iter().all(|f| text.contains(&f.to_string())));
}

#[test]
fn no_more_than_eight_are_named() {
    let (vertices, faces) = icosphere(1.0, 2);
    let holes: Vec<[u32; 3]> = faces.iter().copied().step_by(2).collect();
    let report = report(&(vertices, holes));
    for fault in &report.faults {
        if let MeshError::NotClosed { count, faces } = fault {
            assert!(*count > 100 && faces.len() == 8);
            return;
        }
    }
    panic!("{report}");
}

/// Two tents that share the tip only.
#[test]
fn pinched_vertices_are_found() {
    let (mut vertices, mut faces) = (vec![[0.0; 3]], Vec::new());
    for side in [1.0, -1.0] {
        let n = vertices.len() as u32;
        vertices.extend([[1.0, 0.0, side], [0.0, 1.0, side], [-1.0, -1.0, side]]);
        let tent = [[0, n + 1, n], [0, n + 2, n + 1], [0, n, n + 2], [n, n + 1, n + 2]];
        faces.extend(tent.map(|f: [u32; 3]| if side > 0.0 { f } else { [f[0], f[2], f[1]] }));
    }
    let report = report(&(vertices.clone(), faces.clone()));
    assert_eq!(report.faults, [MeshError::Pinched { count: 1, vertices: vec![0] }]);
    assert!(matches!(TriangleMesh::new(&vertices, &faces), Err(MeshError::Pinched { .. })));
}

#[test]
fn thickness_is_that_of_plates_gaps_and_walls() {
    let wall = |faces: &Faces| report(faces).thinnest_wall.unwrap().thickness;
    let gap = |faces: &Faces| report(faces).thinnest_gap.map(|g| g.thickness);
    let plate = brick([0.0; 3], [3.0, 2.0, 0.01]);
    assert!((wall(&plate) - 0.01).abs() < 1e-15 && gap(&plate).is_none());
    assert!((wall(&inverted(plate)) - 0.01).abs() < 1e-15);
    // Two plates: the gap between them.
    let pair = joined(brick([0.0; 3], [3.0, 2.0, 0.5]), brick([0.0, 0.0, 0.52], [3.0, 2.0, 1.0]));
    assert!((wall(&pair) - 0.48).abs() < 1e-14 && (gap(&pair).unwrap() - 0.02).abs() < 1e-14);
    // Walls around a cavity of 1.1 to 1.3.
    let hollow = joined(brick([-1.0; 3], [1.0; 3]), inverted(brick([-0.6, -0.7, -0.5], [0.5, 0.6, 0.7])));
    assert!((wall(&hollow) - 0.3).abs() < 1e-14 && (gap(&hollow).unwrap() - 1.1).abs() < 1e-14);
    // A ball is as thick as it is, if no thinner than its facets leave it.
    let ball = icosphere(0.5, 3);
    assert!((0.98..=1.0).contains(&wall(&ball)) && gap(&ball).is_none());
    // A spike's tip over a plate: seen from the tip.
    let (mut vertices, mut faces) = brick([-1.0, -1.0, -1.0], [1.0, 1.0, 0.0]);
    let n = vertices.len() as u32;
    vertices.extend([[0.1, 0.2, 0.03], [0.0, 0.3, 2.0], [0.3, 0.3, 2.0], [0.1, 0.0, 2.0]]);
    faces.extend([[n, n + 1, n + 2], [n, n + 2, n + 3], [n, n + 3, n + 1], [n + 1, n + 3, n + 2]]);
    let spike = report(&(vertices, faces));
    assert!(spike.is_admissible(), "{spike}");
    assert!((spike.thinnest_gap.unwrap().thickness - 0.03).abs() < 2e-3, "{spike}");
    // Against the resolution, 0.1.
    let unresolved: Vec<f64> = report(&pair).unresolved().map(|t| t.thickness).collect();
    assert!(unresolved.len() == 1 && (unresolved[0] - 0.02).abs() < 1e-14);
    let text = report(&pair).to_string();
    assert!(
        text.contains("4.8 times the resolution") && text.contains("thinner than the resolution"),
        "{text}"
    );
}

#[test]
fn slivers_are_told_but_admitted() {
    // A vertex on the plane of a brick's side, very near an edge.
    let (mut vertices, mut faces) = brick([0.0; 3], [1.0; 3]);
    let at = faces.iter().position(|f| f.contains(&0) && f.contains(&1) && f.contains(&5)).unwrap();
    let [a, b, c] = faces.remove(at);
    let n = vertices.len() as u32;
    vertices.push([0.5, 0.0, 1e-4]);
    faces.extend([[a, b, n], [b, c, n], [c, a, n]]);
    let report = report(&(vertices, faces));
    assert!(report.is_admissible(), "{report}");
    assert_eq!((report.slivers, report.sliver_faces.clone()), (1, vec![11]), "{report}");
    assert!(report.to_string().contains("slivers: 1 faces, among them [11]"));
}

/// Vertices that no face has do not count.
#[test]
fn unused_vertices_do_not_matter() {
    let (mut vertices, faces) = brick([0.0; 3], [1.0; 3]);
    vertices.push([50.0; 3]);
    let mesh = TriangleMesh::new(&vertices, &faces).unwrap();
    assert!((mesh.bounding_radius() - 0.75_f64.sqrt()).abs() < 1e-15);
    assert!((mesh.aabb().max - Point::from([0.5; 3])).norm() < 1e-15);
    assert_eq!(report(&(vertices, faces)).bounds.max, [1.0; 3].into());
}

/// A heap of triangles through one point: the search ends.
#[test]
fn heaps_end() {
    let n = 800;
    let vertices: Vec<[f64; 3]> = (0..3 * n)
        .map(|i| {
            let (s, c) = (2.1 * f64::from(i) + 0.01 * f64::from(i / 3)).sin_cos();
            [c, s, 0.3 * (0.7 * f64::from(i)).sin()]
        })
        .collect();
    let faces: Vec<[u32; 3]> = (0..n as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
    let report = report(&(vertices, faces));
    let crossing = report.faults.iter().find(|f| matches!(f, MeshError::SelfIntersecting { .. })).unwrap();
    assert!(
        matches!(crossing, MeshError::SelfIntersecting { count: 100_000.., all: false, .. }),
        "{crossing}"
    );
    assert!(crossing.to_string().starts_with("at least 100"), "{crossing}");
}
