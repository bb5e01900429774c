//! What a run asks of a scene.
use super::law::Granulate;
use crate::Outcome;
use dem::Shape;
use interfaces::{Aabb, BodyId, Pose};
use render::solids::View;
use std::sync::Arc;

/// A scene: its grains are the bodies from [`first_grain`](Self::first_grain) on, what comes before are walls.
pub trait Scene {
    /// Number of the first body that is a grain.
    fn first_grain(&self) -> usize {
        0
    }
    /// Where grains should be.
    fn domain(&self) -> Aabb;
    /// Do grains touch at the start, as those of a heap at rest?
    fn may_touch(&self) -> bool {
        false
    }
    /// Bodies that come in at `time`, asked at the beginning of every row of the table of motion.
    ///
    /// # Errors
    /// Those of the bodies.
    fn feed(&mut self, bodies: &mut Granulate, time: f64) -> Outcome<()> {
        let _ = (bodies, time);
        Ok(())
    }
    /// Adds, anywhere, what had come in until a run was saved that is to go on, so that there are `number` bodies; the last ones came in at
    /// `time`.
    ///
    /// # Errors
    /// Those of the bodies.
    fn refill(&mut self, bodies: &mut Granulate, number: usize, time: f64) -> Outcome<()> {
        let _ = number;
        self.feed(bodies, time)
    }
    /// Moves walls as they should move from `time` on; asked before every short advance.
    fn steer(&mut self, bodies: &mut Granulate, time: f64) {
        let _ = (bodies, time);
    }
    /// Columns of its own in the table of motion.
    fn columns(&self) -> Vec<&'static str> {
        Vec::new()
    }
    /// Their values.
    fn measure(&mut self, bodies: &Granulate, time: f64) -> Vec<f64> {
        let _ = (bodies, time);
        Vec::new()
    }
    /// Where pictures are taken from.
    fn view(&self) -> View;
    /// What is drawn besides bodies.
    fn furniture(&self) -> Vec<(Arc<dyn Shape>, Pose)> {
        Vec::new()
    }
    /// Is it left out of pictures?
    fn hidden(&self, bodies: &Granulate, b: BodyId) -> bool {
        let _ = (bodies, b);
        false
    }
    /// The number that colours a grain.
    fn value(&self, bodies: &Granulate, b: BodyId) -> f64;
    /// What the colour bar says, and the numbers at its ends.
    fn scale(&self) -> (&'static str, (f64, f64));
    /// What a table of the grains says about this one: size and kind.
    fn tells(&self, b: BodyId) -> (Option<f64>, &'static str);
}
