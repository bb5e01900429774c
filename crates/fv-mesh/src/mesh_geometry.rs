//! The grid as any mesh.
use crate::{Axis, CartesianGrid};
use interfaces::{Aabb, Cell, MeshGeometry, Point, Vector};
use std::ops::Range;

impl<const D: usize> MeshGeometry for CartesianGrid<D> {
    fn for_cells_in(&self, b: &Aabb, mut see: impl FnMut(&Cell)) {
        let along = |a: usize| if a < D { reached(self.axis(a), b.min[a], b.max[a]) } else { 0..1 };
        for k in along(2) {
            for j in along(1) {
                for i in along(0) {
                    let number = [i, j, k];
                    let mut cell = Cell { centre: Point::origin(), edges: Vector::zeros(), volume: 1.0 };
                    for a in 0..D {
                        let (axis, n) = (self.axis(a), number[a]);
                        (cell.centre[a], cell.edges[a]) = (axis.centre(n), axis.width(n));
                        cell.volume *= axis.width(n);
                    }
                    see(&cell);
                }
            }
        }
    }
}

/// The cells of an axis that come into [low, high].
fn reached(axis: &Axis, low: f64, high: f64) -> Range<usize> {
    let faces = axis.faces();
    let first = faces[1..].partition_point(|upper| *upper < low);
    let end = faces[..faces.len() - 1].partition_point(|lower| *lower <= high);
    first..end.max(first)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen<const D: usize>(grid: &CartesianGrid<D>, b: Aabb) -> (usize, f64) {
        let (mut n, mut volume) = (0, 0.0);
        grid.for_cells_in(&b, |cell| {
            n += 1;
            volume += cell.volume;
            for a in 0..D {
                assert!(
                    (cell.centre[a] - 0.5 * (b.min[a] + b.max[a])).abs()
                        <= 0.5 * (cell.edges[a] + b.max[a] - b.min[a]) + 1e-12
                );
            }
        });
        (n, volume)
    }

    #[test]
    fn cells_that_a_box_meets() {
        let grid = CartesianGrid::new([8, 4, 2], [8.0, 4.0, 2.0]).unwrap();
        let b = |low: [f64; 3], high: [f64; 3]| Aabb { min: low.into(), max: high.into() };
        assert_eq!(seen(&grid, b([1.5, 0.5, 0.5], [3.5, 0.6, 0.6])), (3, 3.0));
        assert_eq!(seen(&grid, b([-9.0; 3], [9.0; 3])), (64, 64.0));
        assert_eq!(seen(&grid, b([9.0; 3], [10.0; 3])).0, 0);
        assert_eq!(seen(&grid, b([-2.0; 3], [-1.0; 3])).0, 0);
        let axes = [Axis::geometric(10, 0.0, 1.0, 1.3).unwrap(), Axis::uniform(2, 0.0, 1.0).unwrap()];
        let plane = CartesianGrid::from_axes(axes).unwrap();
        let (n, area) = seen(&plane, b([-1.0; 3], [2.0; 3]));
        assert!(n == 20 && (area - 1.0).abs() < 1e-12);
    }
}
