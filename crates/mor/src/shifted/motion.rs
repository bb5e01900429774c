//! How frames of reference move.
use super::ShiftedError;
use interfaces::{Point, Pose, Rotation, Vector};

/// Where a frame of reference is: it takes x to M x = c + s + R (x − c).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// s, of the centre.
    pub displacement: Vector,
    /// R.
    pub rotation: Rotation,
    /// c, where the centre of rotation is in the frame itself.
    pub centre: Point,
}

impl Motion {
    /// M x = x + s.
    #[must_use]
    pub fn translation(displacement: Vector) -> Self {
        Self { displacement, rotation: Rotation::identity(), centre: Point::origin() }
    }

    /// Along with a body from one pose to another.
    #[must_use]
    pub fn between(start: &Pose, now: &Pose) -> Self {
        Self {
            displacement: now.position - start.position,
            rotation: now.orientation * start.orientation.inverse(),
            centre: start.position,
        }
    }

    /// M⁻¹, with c + s as the centre.
    #[must_use]
    pub fn inverse(&self) -> Self {
        Self {
            displacement: -self.displacement,
            rotation: self.rotation.inverse(),
            centre: self.centre + self.displacement,
        }
    }

    /// R x − x vanishes for all x.
    #[must_use]
    pub fn is_translation(&self) -> bool {
        self.rotation.imag() == Vector::zeros()
    }
}

/// The motions of frames of reference at the times of the snapshots. T^Δ q (x) = q(M⁻¹ x), which is q(x − s) if a frame does not turn.
pub trait Shifts: Sync {
    /// How many frames there are.
    fn n_frames(&self) -> usize;
    /// How many snapshots there are.
    fn n_snapshots(&self) -> usize;
    /// The motion of this frame at this snapshot.
    fn motion(&self, frame: usize, snapshot: usize) -> Motion;
}

/// Motions one by one.
#[derive(Clone, Debug, PartialEq)]
pub struct Motions {
    n_snapshots: usize,
    motions: Vec<Motion>,
}

impl Motions {
    /// Frame k at snapshot j by a formula.
    pub fn by(n_frames: usize, n_snapshots: usize, motion: impl Fn(usize, usize) -> Motion) -> Self {
        let motions = (0..n_frames).flat_map(|k| (0..n_snapshots).map(move |j| (k, j)));
        Self { n_snapshots, motions: motions.map(|(k, j)| motion(k, j)).collect() }
    }

    /// The same motions, each frame displaced by its offset.
    #[must_use]
    pub fn beside(shifts: &dyn Shifts, offsets: &[Vector]) -> Self {
        let offset = |k: usize| offsets.get(k).copied().unwrap_or_default();
        Self::by(shifts.n_frames(), shifts.n_snapshots(), |k, j| {
            let motion = shifts.motion(k, j);
            Motion { displacement: motion.displacement + offset(k), ..motion }
        })
    }

    /// Translations along x: for each frame one per snapshot.
    ///
    /// # Errors
    /// [`ShiftedError::Snapshots`] if the frames have not equally many.
    pub fn along_x(frames: &[Vec<f64>]) -> Result<Self, ShiftedError> {
        let shift = |&s: &f64| Motion::translation(Vector::new(s, 0.0, 0.0));
        Self::of_frames(frames.iter().map(|f| f.iter().map(shift).collect()).collect())
    }

    /// Translations: for each frame one per snapshot.
    ///
    /// # Errors
    /// [`ShiftedError::Snapshots`] if the frames have not equally many.
    pub fn translations(frames: &[Vec<Vector>]) -> Result<Self, ShiftedError> {
        Self::of_frames(frames.iter().map(|f| f.iter().map(|&s| Motion::translation(s)).collect()).collect())
    }

    /// Frames that move and turn along with bodies: for each body its pose at each snapshot. The frame is the body's at the first one.
    ///
    /// # Errors
    /// [`ShiftedError::Snapshots`] if the bodies have not equally many.
    pub fn along(paths: &[Vec<Pose>]) -> Result<Self, ShiftedError> {
        Self::of_frames(
            paths
                .iter()
                .map(|path| path.iter().map(|now| Motion::between(&path[0], now)).collect())
                .collect(),
        )
    }

    /// Frames that move along with bodies, but do not turn.
    ///
    /// # Errors
    /// [`ShiftedError::Snapshots`] if the bodies have not equally many.
    pub fn along_without_turning(paths: &[Vec<Pose>]) -> Result<Self, ShiftedError> {
        let shift = |path: &Vec<Pose>| path.iter().map(|now| now.position - path[0].position).collect();
        Self::translations(&paths.iter().map(shift).collect::<Vec<_>>())
    }

    fn of_frames(frames: Vec<Vec<Motion>>) -> Result<Self, ShiftedError> {
        let n_snapshots = frames.first().map_or(0, Vec::len);
        if let Some(other) = frames.iter().find(|f| f.len() != n_snapshots) {
            return Err(ShiftedError::Snapshots { snapshots: n_snapshots, shifts: other.len() });
        }
        Ok(Self { n_snapshots, motions: frames.concat() })
    }
}

impl Shifts for Motions {
    fn n_frames(&self) -> usize {
        self.motions.len().checked_div(self.n_snapshots).unwrap_or(0)
    }
    fn n_snapshots(&self) -> usize {
        self.n_snapshots
    }
    fn motion(&self, frame: usize, snapshot: usize) -> Motion {
        self.motions[frame * self.n_snapshots + snapshot]
    }
}
