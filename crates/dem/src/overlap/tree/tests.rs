//! x
use crate::*;
use interfaces::*;
#[test]
fn debug() {
    let ball = Sphere::new(1.0).unwrap();
    for (k, dir) in [Vector::x(), Vector::new(0.3, 0.5, 0.7).normalize()].into_iter().enumerate() {
        for depth in [1e-6, 1e-2, 0.3] {
            for tol in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5] {
                let mut s = OverlapSolver::new().with_route(Some(Route::Tree)).with_refinement(Refinement::Tolerance(tol));
                let d = 2.0 - depth;
                let p = s.solve(&ball, &Pose::at([0.0; 3]), &ball, &Pose { position: Point::from(dir * d), orientation: Rotation::identity() }).unwrap();
                let depth = 2.0 - (dir * d).norm();
                let exact = std::f64::consts::PI * depth * depth * (6.0 - depth) / 12.0;
                let v: f64 = p.iter().map(|p| p.volume).sum();
                let n = p.len();
                let t = &s.tree.trees[0];
                println!("{k} {depth:.1e} {tol:.0e}: error {:9.2e} patches {n} boxes {} estimate {:.1e} {:.1e} ragged {} roots {} half {:?}", v / exact - 1.0, s.boxes().count(), t.sum[1] / t.sum[0], t.sum[2].sqrt() / t.sum[0],
                  t.nodes.iter().filter(|n| n.leaf != super::grow::NONE && t.leaves[n.leaf as usize].content.ragged).count(), s.tree.roots.len(), t.half);
            }
        }
    }
}
#[test]
fn debug_columns() {
    use super::columns::content;
    use super::quadric::*;
    // x = 0.53 (1 + ξ) etc.; z from 0 to 1.06: z < 1 - x² - y².
    let h = Vector::repeat(0.53);
    let f = |x: Vector| {
        let p = h + x.component_mul(&h);
        p.z - (1.0 - p.x * p.x - p.y * p.y)
    };
    let g = |x: Vector| {
        let p = h + x.component_mul(&h);
        -p.z - (1.0 - p.x * p.x - p.y * p.y)
    };
    let fit = |f: &dyn Fn(Vector) -> f64| Quadric::fit(f(Vector::zeros()), &stencil().map(|x| f(x))).0;
    let (q, r) = (fit(&f), fit(&g));
    let exact = std::f64::consts::PI / 8.0;
    for panels in [1, 2, 4] {
        for s in [[Some(&q), None], [Some(&q), Some(&r)]] {
            let c = content(s, h, h, panels, false);
            println!("{} {:e} first {:?} flux {:?}", panels, c.sums.volume / exact - 1.0, c.sums.first, c.sums.flux);
        }
    }
}
