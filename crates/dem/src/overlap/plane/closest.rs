//! Where two bodies of the plane are closest.
use crate::overlap::tree::Closest;
use crate::shapes::nearest_on_edge;
use crate::{Form, Part, Polygon};
use interfaces::{Point, Pose, Vector};
use nalgebra::{Matrix2, Vector2};

/// The closest places of two bodies of the plane that do not overlap, if they are no farther apart than `reach`: discs, polygons, unions of these, the second perhaps a wall.
pub(crate) fn closest(a: &Form<'_>, at_a: &Pose, b: &Form<'_>, at_b: &Pose, reach: f64) -> Option<Closest> {
    let [from, to] = match (a, b) {
        (Form::Union(parts), _) => {
            let each = |p: &Part| closest(&p.shape.form(), &at_a.of(&p.pose), b, at_b, reach);
            return parts.iter().filter_map(each).min_by(|v, w| v.gap.total_cmp(&w.gap));
        }
        (_, Form::Union(_)) => {
            let back = closest(b, at_b, a, at_a, reach)?;
            return Some(Closest { normal: -back.normal, ..back });
        }
        (Form::Disc(p), Form::Disc(q)) => {
            let way = (at_b.position - at_a.position).try_normalize(0.0)?;
            [at_a.position + way * p.radius(), at_b.position - way * q.radius()]
        }
        (Form::Disc(p), Form::HalfSpace(w)) => {
            let wall = w.posed(at_b);
            let foot = at_a.position - wall.normal() * wall.signed_distance(at_a.position);
            [at_a.position - wall.normal() * p.radius(), foot]
        }
        (Form::Polygon(p), Form::Polygon(q)) => {
            let back = ways(q, at_b, p, at_a).map(|[corner, foot]| [foot, corner]);
            least(ways(p, at_a, q, at_b).chain(back))?
        }
        (Form::Polygon(p), Form::Disc(disc)) => to_disc(p, at_a, disc.radius(), at_b.position)?,
        (Form::Disc(disc), Form::Polygon(q)) => {
            let [from, to] = to_disc(q, at_b, disc.radius(), at_a.position)?;
            [to, from]
        }
        (Form::Polygon(p), Form::HalfSpace(w)) => {
            let wall = w.posed(at_b);
            least(world(p, at_a).map(|x| [x, x - wall.normal() * wall.signed_distance(x)]))?
        }
        _ => return None,
    };
    let way = to - from;
    let gap = way.norm();
    (gap > 0.0 && gap <= reach).then(|| Closest {
        at: nalgebra::center(&from, &to),
        gap,
        normal: way / gap,
        curvatures: [Matrix2::zeros(); 2],
    })
}

fn least(ways: impl Iterator<Item = [Point; 2]>) -> Option<[Point; 2]> {
    let square = |way: &[Point; 2]| (way[1] - way[0]).norm_squared();
    ways.min_by(|v, w| square(v).total_cmp(&square(w)))
}

fn point(v: Vector2<f64>) -> Point {
    Point::new(v.x, v.y, 0.0)
}

/// The corners in the world.
fn world(p: &Polygon, at: &Pose) -> impl Iterator<Item = Point> {
    p.corners().iter().map(|c| at.to_world(point(*c)))
}

/// From each corner of `p` to the nearest place of each edge of `q`.
fn ways(p: &Polygon, at_p: &Pose, q: &Polygon, at_q: &Pose) -> impl Iterator<Item = [Point; 2]> {
    world(p, at_p).flat_map(move |corner| {
        let own = at_q.to_body(corner).coords.xy();
        q.edges().map(move |edge| [corner, at_q.to_world(point(nearest_on_edge(edge, own)))])
    })
}

/// From the nearest place of `p` to that of a disc.
fn to_disc(p: &Polygon, at: &Pose, r: f64, centre: Point) -> Option<[Point; 2]> {
    let own = at.to_body(centre).coords.xy();
    let [from, _] = least(p.edges().map(|edge| [at.to_world(point(nearest_on_edge(edge, own))), centre]))?;
    let way: Vector = centre - from;
    Some([from, centre - way.try_normalize(0.0)? * r])
}
