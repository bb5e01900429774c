//! Cutting convex polygons at a height.
use interfaces::Vector;

/// Parts of a convex polygon below (z ≤ `height`) and above a plane, and the segment in which it
/// crosses the plane, with the inner side of the polygon's body on its left seen from above.
pub(super) fn cut(
    polygon: &[Vector],
    height: f64,
    below: &mut Vec<Vector>,
    above: &mut Vec<Vector>,
) -> Option<[Vector; 2]> {
    below.clear();
    above.clear();
    let (mut up, mut down) = (None, None);
    for (i, p) in polygon.iter().enumerate() {
        let q = &polygon[if i + 1 < polygon.len() { i + 1 } else { 0 }];
        let (low, high) = (p.z <= height, q.z <= height);
        if low {
            below.push(*p)
        } else {
            above.push(*p)
        }
        if low != high {
            // From the lower end, so that both faces of an edge find the same.
            let (from, to) = if low { (p, q) } else { (q, p) };
            let mut x = from + (to - from) * ((height - from.z) / (to.z - from.z));
            x.z = height;
            below.push(x);
            above.push(x);
            *(if low { &mut up } else { &mut down }) = Some(x);
        }
    }
    down.zip(up).map(|(down, up)| [down, up])
}
