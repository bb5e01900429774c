//! Places in order.
use super::MOST;
use super::error::{PlacingError, not_negative, positive};
use super::source::Source;
use interfaces::{Aabb, Point, Vector};

/// How points are arranged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LatticeKind {
    /// Corners of cubes; touching spheres fill π/6 = 0.5236.
    SimpleCubic,
    /// Corners and centres of cubes; √3π/8 = 0.6802.
    BodyCentredCubic,
    /// Corners and centres of the faces of cubes; √2π/6 = 0.7405.
    FaceCentredCubic,
    /// Triangular layers, the third one above the first; √2π/6 = 0.7405.
    HexagonalClosePacked,
    /// Corners of squares in the plane z = 0; touching discs fill π/4 = 0.7854.
    PlaneSquare,
    /// Triangles in the plane z = 0; π/√12 = 0.9069.
    PlaneHexagonal,
}

/// A lattice of points whose neighbours are all at the same distance.
///
/// ```
/// use dem::placing::{CrystalLattice, LatticeKind, Orientations};
/// use dem::{Aabb, Pose};
///
/// // Bodies of 8 mm, 10 mm apart, not quite in order but never nearer than 0.5 mm to one another.
/// let lattice = CrystalLattice::new(LatticeKind::HexagonalClosePacked, 0.01)?;
/// let amplitude = lattice.play(0.008, 5e-4)?;
/// let bounds = Aabb { min: [0.0; 3].into(), max: [0.1; 3].into() };
/// let mut points = lattice.in_box(&bounds, 0.004 + amplitude)?;
/// lattice.jitter(&mut points, amplitude, 7)?;
/// let turns = Orientations::Random.of(7);
/// let poses: Vec<_> = points.iter().zip(turns).map(|(p, r)| Pose { position: *p, orientation: r }).collect();
/// assert_eq!(poses.len(), points.len());
/// # Ok::<(), dem::placing::PlacingError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct CrystalLattice {
    distance: f64,
    plane: bool,
    cell: Vector,
    basis: Vec<Vector>,
}

impl CrystalLattice {
    /// One whose nearest neighbours are `distance` \[m\] apart.
    ///
    /// # Errors
    /// [`PlacingError::Parameter`] unless the distance is positive and finite.
    pub fn new(kind: LatticeKind, distance: f64) -> Result<Self, PlacingError> {
        let distance = positive("distance of neighbours in the lattice", distance)?;
        let (r2, r3) = (2_f64.sqrt(), 3_f64.sqrt());
        let (cell, basis): ([f64; 3], &[[f64; 3]]) = match kind {
            LatticeKind::SimpleCubic => ([1.0; 3], &[[0.0; 3]]),
            LatticeKind::BodyCentredCubic => ([2.0 / r3; 3], &[[0.0; 3], [0.5; 3]]),
            LatticeKind::FaceCentredCubic => {
                ([r2; 3], &[[0.0; 3], [0.5, 0.5, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5]])
            }
            LatticeKind::HexagonalClosePacked => {
                let basis = &[[0.0; 3], [0.5, 0.5, 0.0], [0.5, 1.0 / 6.0, 0.5], [0.0, 2.0 / 3.0, 0.5]];
                ([1.0, r3, 2.0 * r2 / r3], basis)
            }
            LatticeKind::PlaneSquare => ([1.0, 1.0, 0.0], &[[0.0; 3]]),
            LatticeKind::PlaneHexagonal => ([1.0, r3, 0.0], &[[0.0; 3], [0.5, 0.5, 0.0]]),
        };
        let cell = Vector::from(cell) * distance;
        let basis = basis.iter().map(|b| Vector::from(*b).component_mul(&cell)).collect();
        Ok(Self { distance, plane: cell.z == 0.0, cell, basis })
    }
    /// Edges of the smallest box that repeats \[m\]; a plane lattice has none along z. The points repeat in a periodic box if it is made of
    /// whole cells.
    pub fn cell(&self) -> Vector {
        self.cell
    }
    /// Points in one cell.
    pub fn points_per_cell(&self) -> usize {
        self.basis.len()
    }
    /// Distance of nearest neighbours \[m\].
    pub fn distance(&self) -> f64 {
        self.distance
    }

    /// All points of so many cells along each axis, the first point at the origin, layer by layer along z.
    ///
    /// # Errors
    /// [`PlacingError::TooMany`] from 10⁷ points on.
    pub fn cells(&self, counts: [usize; 3]) -> Result<Vec<Point>, PlacingError> {
        let counts = [counts[0], counts[1], if self.plane { 1 } else { counts[2] }];
        let number = counts.iter().map(|&n| n as f64).product::<f64>() * self.basis.len() as f64;
        check_number(number)?;
        let mut out = Vec::with_capacity(number as usize);
        for k in 0..counts[2] {
            for j in 0..counts[1] {
                for i in 0..counts[0] {
                    let corner = self.cell.component_mul(&Vector::new(i as f64, j as f64, k as f64));
                    out.extend(self.basis.iter().map(|b| Point::from(corner + b)));
                }
            }
        }
        Ok(out)
    }
    /// `number` points in a block of cells about as long as wide and high, filled layer by layer from the origin.
    ///
    /// # Errors
    /// [`PlacingError::TooMany`] from 10⁷ points on.
    pub fn number(&self, number: usize) -> Result<Vec<Point>, PlacingError> {
        check_number(number as f64)?;
        let axes = if self.plane { 2 } else { 3 };
        let mut counts = [1_usize; 3];
        // One cell more along the axis that is shortest, until there is room.
        while counts.iter().product::<usize>() * self.basis.len() < number {
            let length = |a: usize| counts[a] as f64 * self.cell[a];
            let shortest = (0..axes).reduce(|a, b| if length(b) < length(a) { b } else { a });
            counts[shortest.unwrap_or(0)] += 1;
        }
        let mut points = self.cells(counts)?;
        points.truncate(number);
        Ok(points)
    }
    /// All points that are at least `margin` \[m\] (the bodies' radius, say) from the faces of a box, the first one at that distance
    /// from its lower corner. Plane lattices stay at z = 0.
    ///
    /// # Errors
    /// [`PlacingError::Parameter`] for a negative margin, [`PlacingError::Region`] for a box that is not finite,
    /// [`PlacingError::TooMany`] from 10⁷ points on. A box without room for any point has none, which is no error.
    pub fn in_box(&self, bounds: &Aabb, margin: f64) -> Result<Vec<Point>, PlacingError> {
        let margin = not_negative("margin between lattice and box", margin)?;
        let (min, max) = (bounds.min, bounds.max);
        if !min.iter().chain(max.iter()).all(|c| c.is_finite()) {
            return Err(PlacingError::Region { min: min.into(), max: max.into() });
        }
        let axes = if self.plane { 2 } else { 3 };
        let mut room = bounds.extent().add_scalar(-2.0 * margin);
        let mut low = min + Vector::repeat(margin);
        if self.plane {
            (room.z, low.z) = (0.0, 0.0);
        }
        // A box of whole cells must not lose its last layer to rounding: of the box's own coordinates, or of the lattice's.
        let far = min.coords.amax().max(max.coords.amax());
        let slack = 1e-12 * self.distance + 4.0 * f64::EPSILON * far;
        let mut counts = [1; 3];
        for a in 0..axes {
            if room[a] < -slack {
                return Ok(Vec::new());
            }
            let n = ((room[a] + slack) / self.cell[a]).floor() + 1.0;
            check_number(n)?;
            counts[a] = n as usize;
        }
        let inside = |p: &Point| (0..3).all(|a| p[a] <= room[a] + slack);
        let points = self.cells(counts)?;
        // Rounding must not put a point nearer to the upper face than to the lower one.
        let high = low + room.sup(&Vector::zeros());
        Ok(points.into_iter().filter(inside).map(|p| (low + p.coords).inf(&high)).collect())
    }

    /// How far each point may be moved so that bodies of this `diameter` around them keep a `gap` \[m\]: half of what the distance leaves.
    ///
    /// # Errors
    /// [`PlacingError::Parameter`] for a diameter that is not positive, a negative gap, or both together beyond the distance of neighbours.
    pub fn play(&self, diameter: f64, gap: f64) -> Result<f64, PlacingError> {
        let room = self.distance - positive("diameter of a body", diameter)? - not_negative("gap", gap)?;
        if room < 0.0 {
            let remedy = "give less than the distance of neighbours, or a wider lattice";
            return Err(PlacingError::Parameter {
                what: "diameter with the gap",
                value: diameter + gap,
                remedy,
            });
        }
        Ok(0.5 * room)
    }
    /// Moves every point to a random place no farther than `amplitude` \[m\] from its own; in the plane for plane lattices.
    ///
    /// # Errors
    /// [`PlacingError::Parameter`] unless the amplitude is zero or positive, and finite.
    pub fn jitter(&self, points: &mut [Point], amplitude: f64, seed: u64) -> Result<(), PlacingError> {
        let amplitude = not_negative("amplitude of the jitter", amplitude)?;
        let mut source = Source::new(seed);
        for point in points {
            *point += source.in_ball(self.plane) * amplitude;
        }
        Ok(())
    }
}

fn check_number(number: f64) -> Result<(), PlacingError> {
    let most = MOST as f64;
    if number < most {
        Ok(())
    } else {
        Err(PlacingError::TooMany { what: "points of a lattice", number, most })
    }
}
