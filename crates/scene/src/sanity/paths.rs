//! Paths of bodies that move by formulas.
use crate::build_error::{BuildError, PathProblem};
use crate::setup::{Algorithm, BodySetup, ForcingChoice, Setup, is_open};
use interfaces::Pose;

/// Nodes of equal distance that the markers of the smooth forcing need beyond a body, in cells.
const REACH: f64 = 2.5;
/// Relative difference of cells that counts as none.
const EQUAL: f64 = 1e-6;

impl Setup {
    /// Requires that formulas keep bodies within walls and, with the smooth forcing, where cells are
    /// equal, at instants over the whole run.
    pub(crate) fn check_paths(&self) -> Result<(), BuildError> {
        for body in &self.bodies.list {
            let Some(motion) = body.motion.prescribed(body.pose.position) else { continue };
            let mut last = 0.0;
            let mut pose = body.pose;
            for time in self.instants() {
                if time > last {
                    let twist = motion.mean(last, time - last);
                    pose.position += twist.linear * (time - last);
                    last = time;
                }
                self.check_place(body, time, &pose)?;
            }
        }
        Ok(())
    }

    fn check_place(&self, body: &BodySetup, time: f64, pose: &Pose) -> Result<(), BuildError> {
        let smooth = self.is_forced()
            && self.flow.algorithm == Algorithm::Projection
            && self.bodies.forcing() == ForcingChoice::Smooth;
        let lattice = smooth.then(|| self.lattice());
        let half = 0.5 * body.shape.aabb().extent();
        for axis in 0..self.dim() {
            let at = pose.position[axis];
            let fail = |place_of| {
                let (body, key) = (body.name.clone(), body.origin.clone());
                Err(BuildError::Path { body, key, time, axis, at, place_of })
            };
            let ends = [self.axes[axis].lower(), self.axes[axis].upper()];
            let side = &self.sides[axis][usize::from(at > ends[1])];
            if !self.periodic(axis) && !(ends[0]..=ends[1]).contains(&at) && !is_open(side) {
                return fail(PathProblem::Outside(ends));
            }
            if let Some(lattice) = &lattice {
                let nodes = &lattice.axes[axis];
                let [_, here] = nodes.spacings(at - half[axis], at + half[axis]);
                let reach = half[axis] + REACH * here;
                let [least, most] = nodes.spacings(at - reach, at + reach);
                if most - least > EQUAL * most {
                    return fail(PathProblem::Stretched([least, most]));
                }
            }
        }
        Ok(())
    }
}
