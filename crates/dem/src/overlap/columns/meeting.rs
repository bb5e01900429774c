//! A point inside both of two convex bodies, or the proof that there is none.
use super::pair::Pair;
use interfaces::Vector;

/// Whether two bodies share a point.
pub(super) enum Meeting {
    /// They do not, or touch only.
    Apart,
    /// They share `point`; `direction` leads out of the first into the second, about normal to the surfaces where the
    /// overlap is shallow.
    At { point: Vector, direction: Vector },
}

/// A point of the Minkowski difference and the points of both bodies that it comes from.
#[derive(Clone, Copy)]
struct Vertex {
    difference: Vector,
    on_a: Vector,
}

/// Portals at most: each halves the angle of the portal, so that this is never reached.
const PORTALS: usize = 200;
/// Progress, as a share of the bodies' size, below which the bodies only touch.
const TOUCH: f64 = 1e-15;

/// Minkowski portal refinement (Snethen, XenoCollide: Complex Collision Made Simple, Game Programming Gems 7, 2008): the
/// origin is sought in the difference A − B of the bodies with a triangle of support points through which the ray from
/// the difference's inside to the origin passes. When origin, inside and triangle make up a tetrahedron with the origin
/// in it, its barycentric coordinates give a point of both.
pub(super) fn meet(pair: &Pair) -> Meeting {
    let support = |n: Vector| {
        let on_a = pair.a.support(n);
        Vertex { difference: on_a - pair.b.support(-n), on_a }
    };
    let inside = Vertex { difference: pair.a.centre - pair.b.centre, on_a: pair.a.centre };
    let out = -inside.difference;
    let at = |vertices: &[Vertex], weights: &[f64], direction: Vector| {
        let whole: f64 = weights.iter().sum();
        let sum: Vector = vertices.iter().zip(weights).map(|(v, w)| v.on_a * *w).sum();
        Meeting::At { point: sum / whole, direction }
    };
    if out == Vector::zeros() {
        return at(&[inside], &[1.0], Vector::z());
    }
    let mut one = support(out);
    let reach = one.difference.dot(&out);
    if reach <= 0.0 {
        return Meeting::Apart;
    }
    let side = one.difference.cross(&inside.difference);
    let size = one.difference.norm() + out.norm();
    if side.norm() <= 1e-14 * size * out.norm() {
        // All on one line.
        return at(&[inside, one], &[reach, out.norm_squared()], out);
    }
    let mut two = support(side);
    if two.difference.dot(&side) <= 0.0 {
        return Meeting::Apart;
    }
    let mut normal = (one.difference - inside.difference).cross(&(two.difference - inside.difference));
    if normal.dot(&inside.difference) > 0.0 {
        (one, two, normal) = (two, one, -normal);
    }
    let mut portals = 0..PORTALS;
    let mut three = loop {
        let three = support(normal);
        if three.difference.dot(&normal) <= 0.0 || portals.next().is_none() {
            return Meeting::Apart;
        }
        let (v0, v1, v2, v3) = (inside.difference, one.difference, two.difference, three.difference);
        if v1.cross(&v3).dot(&v0) < 0.0 {
            two = three;
            normal = (v1 - v0).cross(&(v3 - v0));
        } else if v3.cross(&v2).dot(&v0) < 0.0 {
            one = three;
            normal = (v3 - v0).cross(&(v2 - v0));
        } else {
            break three;
        }
    };
    for _ in portals {
        let (v0, v1, v2, v3) = (inside.difference, one.difference, two.difference, three.difference);
        let normal = (v2 - v1).cross(&(v3 - v1));
        if normal.dot(&v1) >= 0.0 {
            let weights = [
                v1.cross(&v2).dot(&v3),
                v3.cross(&v2).dot(&v0),
                v0.cross(&v1).dot(&v3),
                v2.cross(&v1).dot(&v0),
            ];
            if weights.iter().sum::<f64>() > 0.0 {
                return at(&[inside, one, two, three], &weights, normal);
            }
            return at(&[one, two, three], &[1.0; 3], normal);
        }
        let next = support(normal);
        let v4 = next.difference;
        let progress = (v4 - v3).dot(&normal).min((v4 - v1).dot(&normal)).min((v4 - v2).dot(&normal));
        if v4.dot(&normal) <= 0.0 || progress <= TOUCH * size * normal.norm() {
            return Meeting::Apart;
        }
        let cross = v4.cross(&v0);
        if v1.dot(&cross) > 0.0 {
            if v2.dot(&cross) > 0.0 { one = next } else { three = next }
        } else if v3.dot(&cross) > 0.0 {
            two = next;
        } else {
            one = next;
        }
    }
    Meeting::Apart
}
