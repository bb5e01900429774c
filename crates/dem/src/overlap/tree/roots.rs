//! Where regions are.
use super::around::Oriented;
use super::deepest::Search;
use super::grow::Tree;
use super::lens::Lens;
use interfaces::Vector;
use nalgebra::Matrix3;

/// A box that one or more regions are in.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Root {
    pub(crate) bounds: Oriented,
    /// A place in a region.
    at: Vector,
    /// What is in it, if it is a lens.
    pub(crate) lens: Option<Lens>,
    /// Is it measured?
    pub(crate) done: bool,
}

impl Root {
    pub(crate) fn boxed(bounds: Oriented, at: Vector) -> Self {
        Self { bounds, at, lens: None, done: false }
    }
    pub(crate) fn of(lens: Lens) -> Self {
        Self { bounds: lens.root, at: lens.centre, lens: Some(lens), done: true }
    }
    /// As a frame sees it in which this one's axes are the columns of `axes`.
    pub(crate) fn turn(&mut self, axes: &Matrix3<f64>) {
        self.bounds.centre = axes * self.bounds.centre;
        self.bounds.axes = axes * self.bounds.axes;
        if let Some(lens) = &mut self.lens {
            lens.turn(axes);
        }
    }
    /// Is `x` in a region that is measured here?
    pub(crate) fn holds(&self, x: Vector) -> bool {
        match &self.lens {
            Some(lens) => lens.outside(x) <= 0.0,
            None => self.bounds.holds(x),
        }
    }
    /// Is all that is within `reach` of `x`? Or, with the `last` boxes that are looked at, at least what hangs together with it.
    pub(crate) fn knows(&self, x: Vector, reach: f64, last: bool) -> bool {
        match &self.lens {
            Some(lens) => lens.outside(x) <= if last { reach } else { -reach },
            None => self.bounds.holds_ball(x, reach),
        }
    }
    /// Is the straight way to `x` within both bodies?
    pub(crate) fn sees(&self, search: &Search<'_>, x: Vector) -> bool {
        [0.0, 0.25, 0.5, 0.75].into_iter().all(|share| {
            let [a, b] = search.distances(x.lerp(&self.at, share));
            a.max(b) < 0.0
        })
    }
}

/// Makes one of roots that may meet; their trees change places with them.
pub(crate) fn merge(roots: &mut Vec<Root>, trees: &mut [Tree]) {
    'again: loop {
        for j in 1..roots.len() {
            for i in 0..j {
                if roots[i].bounds.may_meet(&roots[j].bounds) {
                    trees.swap(j, roots.len() - 1);
                    let other = roots.swap_remove(j).bounds;
                    let mut bounds = roots[i].bounds;
                    let [low, high] = bounds.reach(&other);
                    bounds.set(low.inf(&-bounds.half), high.sup(&bounds.half));
                    roots[i] = Root::boxed(bounds, roots[i].at);
                    continue 'again;
                }
            }
        }
        return;
    }
}
