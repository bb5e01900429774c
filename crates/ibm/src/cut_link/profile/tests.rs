use super::*;

/// Flux through an edge whose sides are `sides`, with the velocity `u` at distances from the node: 0 is the node, 1 to 4 are neighbours −1, 1, −2, 2.
fn flux(sides: [Side; 2], node_in_fluid: bool, u: &dyn Fn(f64) -> f64) -> f64 {
    let mut face = CutFace { index: 0, open: 0.0, constant: 0.0, terms: [(0, 0.0); 4] };
    if node_in_fluid {
        around_node(sides, &mut face);
    } else {
        from_walls(sides, &mut face);
    }
    let place = |index: usize| [0.0, -1.0, 1.0, -2.0, 2.0][index];
    face.terms.iter().map(|&(index, weight)| if weight == 0.0 { 0.0 } else { weight * u(place(index)) }).sum()
}

/// Wall below the edge that leaves `a` of it open.
fn one_wall(a: f64) -> ([Side; 2], bool) {
    let lower = Side {
        open: (a - 0.5).max(0.0),
        cut: true,
        next: Support::Wall((a - 0.5).max(0.0)),
        second: Support::Wall(2.0),
    };
    let upper = Side { open: a.min(0.5), cut: false, next: Support::Node(2), second: Support::Node(4) };
    ([lower, upper], a > 0.5)
}

/// Parabolas above one wall: exact for any open part.
#[test]
fn parabolas_are_exact() {
    for a in (1..100).map(|i| 0.01 * f64::from(i)) {
        for (alpha, beta) in [(1.0, 0.0), (0.0, 1.0), (0.7, -0.3)] {
            let u = |s: f64| {
                let t = s + a - 0.5;
                alpha * t + beta * t * t
            };
            let (sides, node) = one_wall(a);
            let exact = alpha * a * a / 2.0 + beta * (a.powi(3) / 3.0 - a / 12.0);
            let found = flux(sides, node, &u);
            assert!((found - exact).abs() < 1e-13, "{a} {alpha} {beta} {found} {exact}");
        }
    }
}

/// Profiles of any shape: no jump where the wall passes the ends of the edge and its node, whole edges carry the velocity of their node.
#[test]
fn fluxes_are_continuous() {
    let at = |a: f64| {
        let u = |s: f64| {
            let t = s + a - 0.5;
            (2.0 * t).sin() + t.powi(3)
        };
        let (sides, node) = one_wall(a);
        flux(sides, node, &u)
    };
    let small = 1e-7;
    assert!(at(small).abs() < small);
    assert!((at(0.5 + small) - at(0.5 - small)).abs() < 10.0 * small);
    let node = 1.0_f64.sin() + 0.125;
    assert!((at(1.0 - small) - node).abs() < 10.0 * small, "{} {node}", at(1.0 - small));
    // Channels with walls at −p and q around the node, up to a whole link on either side.
    let channel = |p: f64, q: f64| {
        let u = |s: f64| (s + p).sin() * (q - s);
        let side = |e: f64| Side {
            open: e.min(0.5),
            cut: e <= 0.5,
            next: Support::Wall(e),
            second: Support::Wall(2.0),
        };
        flux([side(p), side(q)], true, &u)
    };
    for p in [0.1, 0.3, 0.5 - small] {
        let [below, above] = [0.5 - small, 0.5 + small].map(|q| channel(p, q));
        assert!((below - above).abs() < 10.0 * small, "{p} {below} {above}");
        // The next node comes out of the wall.
        let lower = Side { open: p, cut: true, next: Support::Wall(p), second: Support::Wall(2.0) };
        let upper = Side { open: 0.5, cut: false, next: Support::Node(2), second: Support::Wall(2.0) };
        let found = flux([lower, upper], true, &|s| (s + p).sin() * (1.0 - s));
        let closed = channel(p, 1.0 - small);
        // But for the curvature of the wall and both neighbours, of which the node on the wall has none.
        assert!((found - closed).abs() < 10.0 * small, "{p} {found} {closed}");
    }
    // A wall that the edge touches at its node.
    let cap = |c: f64| {
        let side = |n: usize| Side {
            open: 0.5 - c,
            cut: false,
            next: Support::Node(n),
            second: Support::Node(n + 2),
        };
        flux([side(1), side(2)], false, &|s| s * s + s.powi(4))
    };
    assert!(cap(small).abs() < 10.0 * small, "{}", cap(small));
}
