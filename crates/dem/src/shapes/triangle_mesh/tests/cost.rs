//! Cost of admission: in proportion to n log n, however many faces a vertex has and however narrow
//! they are.
use super::super::crossings::FaceTree;
use super::large::kinds;
use super::*;
use cpu_time::ProcessTime;

/// Pairs of faces that reach the exact predicates, per face, do not grow with the number
/// of faces.
#[test]
fn candidates_are_neighbours() {
    for n in [1000, 8000] {
        for (kind, (vertices, faces)) in kinds(n) {
            let mut pairs = 0;
            FaceTree::new(&faces, &vertices).visit_candidates(|_, _| {
                pairs += 1;
                true
            });
            let per_face = f64::from(pairs) / faces.len() as f64;
            assert!(per_face < 15.0, "{kind} of {n} faces: {per_face} pairs per face");
        }
    }
}

/// Eight times the faces take less than 25 times as long: 11 times is n log n, 64 times n².
#[test]
fn admission_is_linear_but_for_a_logarithm() {
    for ((kind, few), (_, many)) in kinds(800).into_iter().zip(kinds(6400)) {
        let cost = |(vertices, faces): &Faces, times: u32| {
            let start = ProcessTime::now();
            for _ in 0..times {
                assert!(TriangleMesh::new(vertices, faces).is_ok(), "{kind}");
                assert!(AdmissionReport::of(vertices, faces, None).is_admissible(), "{kind}");
            }
            start.elapsed().as_secs_f64() / f64::from(times)
        };
        let (small, large) = (cost(&few, 3), cost(&many, 1));
        assert!(large < 25.0 * small, "{kind}: {small:.4} s, then {large:.4} s");
    }
}
