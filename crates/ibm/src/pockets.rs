//! Fluid that bodies have closed in.
use crate::SolidFraction;
use interfaces::{BodyId, Lattice};

/// A connected region of fluid that solid cells, closed faces and bounded sides cut off from the rest.
/// Its pressure is known up to a constant of its own only.
#[derive(Clone, Debug, PartialEq)]
pub struct Pocket {
    /// Storage indices of its cells, ascending.
    pub cells: Vec<usize>,
    /// Volume of the fluid in it, Σ (1 − λ) V \[m³\]; area in the plane.
    pub volume: f64,
}

/// Finds pockets of fluid among bodies in contact, when bodies have moved.
///
/// Cells that the bodies together fill (Σλ ≥ 0.999) are solid; others are connected through
/// their common faces, over periodic sides too. Of all regions so connected, those that reach a side through
/// which fluid comes and goes are no pockets; if there are no such sides, the largest is none.
#[derive(Clone, Debug, Default)]
pub struct Pockets {
    open: [[bool; 2]; 3],
    seen: Option<(Lattice, u64, usize)>,
    pockets: Vec<Pocket>,
    /// Σλ of every cell, x fastest.
    solid: Vec<f64>,
    /// Of every cell another one of the same region, down to the region's first.
    region: Vec<u32>,
}

/// A region's cell for cells that are solid.
const SOLID: u32 = u32::MAX;
/// Cells are solid from here on: λ of cells that several bodies fill together is no more accurate.
const FULL: f64 = 0.999;

impl Pockets {
    /// In a box without inlets and outlets.
    pub fn new() -> Self {
        Self::default()
    }
    /// With inlets or outlets: `open[a]` says whether fluid comes and goes through the lower and the
    /// upper side of axis a.
    #[must_use]
    pub fn with_open_sides(mut self, open: [[bool; 2]; 3]) -> Self {
        self.open = open;
        self.seen = None;
        self
    }

    /// The pockets among the bodies of `fraction` on the lattice of cell centres that it was last
    /// updated on. Nothing is done unless a body has moved since.
    pub fn find(&mut self, lattice: &Lattice, fraction: &SolidFraction) -> &[Pocket] {
        self.find_behind(lattice, fraction, |_, _| true)
    }

    /// The same for a flow that does not pass everywhere: `open(cell, a)` says whether fluid passes
    /// between the cell with this storage index and the next one along axis a (its aperture is not zero).
    pub fn find_behind(
        &mut self,
        lattice: &Lattice,
        fraction: &SolidFraction,
        open: impl Fn(usize, usize) -> bool,
    ) -> &[Pocket] {
        let (updates, n) = (fraction.updates(), fraction.n_bodies());
        let known = self.seen.as_ref().is_some_and(|(l, u, m)| (*u, *m) == (updates, n) && l == lattice);
        if !known {
            self.fill(lattice, fraction);
            self.connect(lattice, open);
            self.gather(lattice);
            self.seen = Some((lattice.clone(), updates, n));
        }
        &self.pockets
    }

    /// Lays out Σλ.
    fn fill(&mut self, lattice: &Lattice, fraction: &SolidFraction) {
        let [nx, ny, nz] = lattice.shape();
        self.solid.clear();
        self.solid.resize(nx * ny * nz, 0.0);
        for node in (0..fraction.n_bodies()).flat_map(|b| fraction.nodes(BodyId(b))) {
            let [i, j, k] = lattice.node(node.index).map(|i| i as usize);
            self.solid[i + nx * (j + ny * k)] += node.fraction;
        }
    }

    /// Joins every fluid cell with those before it that it is connected to.
    fn connect(&mut self, lattice: &Lattice, open: impl Fn(usize, usize) -> bool) {
        let shape = lattice.shape();
        let step = [1, shape[0], shape[0] * shape[1]];
        self.region.clear();
        self.region.extend((0_u32..).zip(&self.solid).map(|(n, s)| if *s >= FULL { SOLID } else { n }));
        let mut n = 0;
        for k in 0..shape[2] {
            for j in 0..shape[1] {
                for i in 0..shape[0] {
                    if self.region[n] != SOLID {
                        let cell = [i, j, k];
                        let index = lattice.base + (0..3).map(|a| cell[a] * lattice.stride[a]).sum::<usize>();
                        for a in 0..lattice.dim {
                            if cell[a] > 0 && open(index - lattice.stride[a], a) {
                                join(&mut self.region, n, n - step[a]);
                            }
                            // Round a periodic axis: from its last cell to its first.
                            if cell[a] + 1 == shape[a] && lattice.axes[a].is_periodic() && open(index, a) {
                                join(&mut self.region, n, n - cell[a] * step[a]);
                            }
                        }
                    }
                    n += 1;
                }
            }
        }
    }

    /// Lists the cells of the regions that are pockets.
    fn gather(&mut self, lattice: &Lattice) {
        let shape = lattice.shape();
        let mut regions: Vec<(Pocket, bool)> = Vec::new();
        // A region's first cell comes before all its others.
        let mut number = std::collections::HashMap::new();
        for n in 0..self.region.len() {
            if self.region[n] == SOLID {
                continue;
            }
            let first = root(&mut self.region, n);
            let r = *number.entry(first).or_insert(regions.len());
            if r == regions.len() {
                regions.push((Pocket { cells: Vec::new(), volume: 0.0 }, false));
            }
            let cell = [n % shape[0], n / shape[0] % shape[1], n / (shape[0] * shape[1])];
            let (pocket, escapes) = &mut regions[r];
            pocket.cells.push(lattice.base + (0..3).map(|a| cell[a] * lattice.stride[a]).sum::<usize>());
            pocket.volume += (1.0 - self.solid[n]) * lattice.volume(cell.map(|i| i as isize));
            for a in 0..lattice.dim {
                *escapes |= self.open[a][0] && cell[a] == 0 || self.open[a][1] && cell[a] + 1 == shape[a];
            }
        }
        if !self.open.as_flattened().contains(&true) {
            let largest =
                |a: &&mut (Pocket, bool), b: &&mut (Pocket, bool)| a.0.volume.total_cmp(&b.0.volume);
            if let Some((_, escapes)) = regions.iter_mut().max_by(largest) {
                *escapes = true;
            }
        }
        self.pockets = regions.into_iter().filter(|(_, escapes)| !escapes).map(|(p, _)| p).collect();
    }
}

/// The first cell of the region of cell `n`, to which the way is shortened.
fn root(region: &mut [u32], mut n: usize) -> usize {
    while region[n] as usize != n {
        let up = region[n] as usize;
        region[n] = region[up];
        n = up;
    }
    n
}

/// Makes the regions of two cells one, unless one of them is solid.
fn join(region: &mut [u32], a: usize, b: usize) {
    if region[b] == SOLID {
        return;
    }
    let (a, b) = (root(region, a), root(region, b));
    let (low, high) = (a.min(b), a.max(b));
    region[high] = low as u32;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Balls, Brick, lattice};
    use interfaces::{Aabb, Nodes, Point, Pose, Solid, Vector};
    use std::f64::consts::PI;

    fn placed(lattice: &Lattice, bodies: &Balls) -> SolidFraction {
        let mut fraction = SolidFraction::new();
        fraction.update(lattice, bodies).unwrap();
        fraction
    }

    /// Eight discs of radius `r` on a circle of radius 1 around `centre`.
    fn ring(r: f64, centre: [f64; 2]) -> Balls {
        let at = |i: i32| {
            let angle = PI / 4.0 * f64::from(i);
            [centre[0] + angle.cos(), centre[1] + angle.sin(), 0.0]
        };
        Balls::new(2, r, (0..8).map(at).collect())
    }

    /// The octagon between the centres less the discs in it, whose overlaps count once.
    fn area_inside(r: f64) -> f64 {
        let c = 2.0 * (PI / 8.0).sin();
        let lens = 2.0 * r * r * (0.5 * c / r).acos() - 0.5 * c * (4.0 * r * r - c * c).sqrt();
        4.0 * (PI / 4.0).sin() - 8.0 * 0.5 * r * r * 0.75 * PI + 8.0 * 0.5 * lens
    }

    #[test]
    fn a_ring_of_discs_closes_a_pocket() {
        let lattice = lattice(2, [0.02; 3], 3.0);
        // In the middle, and over periodic sides and corner.
        for centre in [[1.5, 1.5], [0.1, 2.95]] {
            let mut bodies = ring(0.4, centre);
            let mut fraction = placed(&lattice, &bodies);
            let mut finder = Pockets::new();
            let pockets = finder.find(&lattice, &fraction);
            assert_eq!(pockets.len(), 1);
            let exact = area_inside(0.4);
            assert!((pockets[0].volume / exact - 1.0).abs() < 0.01, "{} {exact}", pockets[0].volume);
            let middle = lattice.axes[0].range(centre[0], 9.0).start;
            let beside = lattice.axes[1].range(centre[1], 9.0).start;
            let index = lattice.index([middle, beside, 0]).unwrap();
            assert!(pockets[0].cells.binary_search(&index).is_ok());
            // One disc steps aside: the pocket opens.
            bodies.shift(3, Vector::new(-0.2, 0.2, 0.0));
            fraction.update(&lattice, &bodies).unwrap();
            assert!(finder.find(&lattice, &fraction).is_empty());
        }
    }

    /// Discs that do not touch close nothing, however near: the flow passes between them.
    #[test]
    fn a_ring_with_gaps_closes_nothing() {
        let lattice = lattice(2, [0.02; 3], 3.0);
        let bodies = ring(0.37, [1.5, 1.5]);
        let fraction = placed(&lattice, &bodies);
        let mut finder = Pockets::new();
        assert!(finder.find(&lattice, &fraction).is_empty());
        // Unless the faces in the gaps are closed to it: at a distance of 0.9 from the centre.
        let inside = |cell: usize| {
            let x = lattice.position(lattice.node(cell));
            (x[0] - 1.5).hypot(x[1] - 1.5) < 0.9
        };
        let open = |cell: usize, a: usize| inside(cell) == inside(cell + lattice.stride[a]);
        let mut finder = Pockets::new();
        let pockets = finder.find_behind(&lattice, &fraction, open);
        assert_eq!(pockets.len(), 1);
        assert!(pockets[0].cells.iter().all(|c| inside(*c)));
    }

    /// A spherical shell of radius ½ and thickness 0.2.
    struct Shell;

    impl Solid for Shell {
        fn signed_distance(&self, x: Point, _: f64) -> f64 {
            (x.coords.norm() - 0.5).abs() - 0.1
        }
        fn aabb(&self) -> Aabb {
            Aabb::around(Point::origin(), Vector::repeat(0.6))
        }
    }

    #[test]
    fn a_hollow_shell_holds_a_pocket() {
        let axis = |periodic| Nodes::uniform(0.025, 0.05, 40, periodic);
        let round = Lattice::new([axis(true), axis(true), axis(true)], 7, [1, 40, 1600]);
        let exact = 4.0 / 3.0 * PI * 0.4_f64.powi(3);
        for at in [[1.01, 0.97, 1.02], [0.01, 1.98, 0.03]] {
            let fraction = placed(&round, &Balls::of(Shell, 1.0, vec![Pose::at(at)]));
            let mut finder = Pockets::new();
            let pockets = finder.find(&round, &fraction);
            assert_eq!(pockets.len(), 1);
            assert!((pockets[0].volume / exact - 1.0).abs() < 2e-3, "{} {exact}", pockets[0].volume);
        }
        // Cut by a wall it holds half of it; by an outlet, nothing.
        let walled = Lattice::new([axis(false), axis(true), axis(true)], 7, [1, 40, 1600]);
        let fraction = placed(&walled, &Balls::of(Shell, 1.0, vec![Pose::at([0.0, 1.0, 1.0])]));
        let mut finder = Pockets::new();
        let pockets = finder.find(&walled, &fraction);
        assert!(pockets.len() == 1 && (pockets[0].volume / exact - 0.5).abs() < 1e-3);
        let mut finder = Pockets::new().with_open_sides([[true, false], [false; 2], [false; 2]]);
        assert!(finder.find(&walled, &fraction).is_empty());
        let mut finder = Pockets::new().with_open_sides([[false, true], [false; 2], [false; 2]]);
        assert_eq!(finder.find(&walled, &fraction).len(), 1);
    }

    /// Bars that share cells fill them together; two pockets are told apart.
    #[test]
    fn bars_across_the_box_make_two_pockets() {
        let axis = || Nodes::uniform(0.05, 0.1, 30, false);
        let lattice = Lattice::new([axis(), axis()], 0, [1, 30]);
        // Each pair of bars meets within the cells at y = 1.05 and 2.05.
        let poses = [0.95, 1.15, 1.95, 2.15].map(|y| Pose::at([1.5, y, 0.0]));
        let bodies = Balls::of(Brick([2.0, 0.1, 0.0]), 0.8, poses.to_vec());
        let fraction = placed(&lattice, &bodies);
        let mut finder = Pockets::new();
        let volumes: Vec<f64> = finder.find(&lattice, &fraction).iter().map(|p| p.volume).collect();
        // 0 … 0.85 is the largest; 1.25 … 1.85 and 2.25 … 3 are shut.
        assert_eq!(volumes.len(), 2);
        assert!((volumes[0] - 1.8).abs() < 1e-9 && (volumes[1] - 2.25).abs() < 1e-9, "{volumes:?}");
    }

    #[test]
    fn bodies_at_rest_are_not_searched_again() {
        let lattice = lattice(2, [0.02; 3], 3.0);
        let fraction = placed(&lattice, &ring(0.4, [1.5, 1.5]));
        let mut finder = Pockets::new();
        let cells = finder.find(&lattice, &fraction)[0].cells.as_ptr();
        assert_eq!(finder.find(&lattice, &fraction)[0].cells.as_ptr(), cells);
    }
}
