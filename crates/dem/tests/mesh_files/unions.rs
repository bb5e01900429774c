//! Unions of parts that cross, against the exact volumes of their overlaps.
use crate::solids::*;
use crate::writers::stl;
use dem::{Shape, TriangleMesh, TriangleSoup, overlap};
use interfaces::Pose;

/// Numbers from 0 to 1 in a fixed order.
struct Draw(u64);

impl Draw {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
    /// Turned about z and x, and moved by up to `by` along each axis.
    fn placed(&mut self, facets: Vec<Facet>, by: f64) -> Vec<Facet> {
        let [a, b] = [0, 1].map(|_| 6.0 * self.next());
        let shift = [0; 3].map(|_| by * (2.0 * self.next() - 1.0));
        moved(facets, |[x, y, z]| {
            let (x, y) = (a.cos() * x - a.sin() * y, a.sin() * x + a.cos() * y);
            let (y, z) = (b.cos() * y - b.sin() * z, b.sin() * y + b.cos() * z);
            [x + shift[0], y + shift[1], z + shift[2]]
        })
    }
}

fn soup(facets: &[Facet]) -> TriangleSoup {
    TriangleSoup::from_stl_bytes(&stl(facets), 1.0).unwrap()
}

/// Boxes, tetrahedra, cans and stars at random places: the volume of what repair makes of two that
/// cross is V₁ + V₂ − V₁₂, and it is a body.
#[test]
fn unions_have_the_volume_of_both_without_their_overlap() {
    let mut draw = Draw(5);
    let star = || {
        let ends: Vec<[usize; 3]> = (1..10).step_by(2).map(|i| [i, (i + 1) % 10, (i + 2) % 10]).collect();
        let inner = [[1, 3, 5], [1, 5, 7], [1, 7, 9]];
        prism(&ring(10, 0.35), &[ends, inner.to_vec()].concat())
    };
    let kinds: [&dyn Fn() -> Vec<Facet>; 4] = [&|| cube([-0.5; 3], 1.0), &tetrahedron, &|| can(12), &star];
    let mut crossing = 0;
    for i in 0..96 {
        let [a, b] = [kinds[i % 4](), kinds[i / 4 % 4]()].map(|facets| draw.placed(facets, 0.4));
        let [first, second] = [&a, &b].map(|facets| TriangleMesh::try_from(soup(facets)).unwrap());
        let [at, there] = [&first, &second].map(|mesh| Pose::at(mesh.origin().into()));
        let common: f64 = overlap(&first, &at, &second, &there).unwrap().iter().map(|o| o.volume).sum();
        if common == 0.0 || common > 0.999 * first.volume().min(second.volume()) {
            continue;
        }
        crossing += 1;
        let (united, report) = soup(&joined([a, b])).repaired(None).unwrap();
        assert!(report.united.count > 0 && report.welded.count == 0);
        let mesh = TriangleMesh::try_from(united).unwrap();
        let expected = first.volume() + second.volume() - common;
        assert!((mesh.volume() / expected - 1.0).abs() < 1e-12, "{i}: {} {expected}", mesh.volume());
        assert!(mesh.inertia(1.0).tensor.symmetric_eigenvalues().min() > 0.0);
    }
    assert!(crossing >= 80, "{crossing}");
}
