//! A ball's surface, from its signed distance alone.
use interfaces::{Aabb, Point, Solid, Vector};

struct Ball(f64);

impl Solid for Ball {
    fn signed_distance(&self, x: Point, _band: f64) -> f64 {
        x.coords.norm() - self.0
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), Vector::repeat(self.0))
    }
}

fn main() {
    let (ball, x) = (Ball(2.0), Point::new(2.0, 0.0, 0.0));
    assert!((ball.normal(x, 0.1) - Vector::x()).norm() < 1e-6);
    assert!((ball.curvature(x, 0.1) - 1.0).abs() < 1e-2);
    println!("interfaces: normal {:?}", ball.normal(x, 0.1).as_slice());
}
