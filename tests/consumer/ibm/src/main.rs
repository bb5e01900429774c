//! The share of a cell that a sphere fills.
use ibm::{Vector, cell_fraction};

fn main() {
    let (radius, h) = (1.0, 0.1);
    let centre = Vector::new(0.58, 0.58, 0.57);
    let distance = centre.norm() - radius;
    let lambda = cell_fraction(distance, centre.normalize(), 2.0 / centre.norm(), Vector::repeat(h));
    assert!((0.0..=1.0).contains(&lambda));
    println!("ibm: lambda {lambda:.4}");
}
