//! Where regions are.
use super::around::Oriented;
use super::convex::{Convex, Plane};
use super::deepest::Search;
use super::grow::Tree;
use super::lens::Lens;
use super::rays::Bundle;
use crate::Overlap;
use interfaces::{Point, Vector};
use nalgebra::Matrix3;

/// A box that one or more regions are in.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Root {
    pub(crate) bounds: Oriented,
    /// A place in a region.
    at: Vector,
    /// What is in it, if no boxes are needed to tell.
    pub(crate) region: Option<Region>,
    /// Is it measured?
    pub(crate) done: bool,
}

/// A region that is known as a whole.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Region {
    Lens(Lens),
    Convex(Convex),
    Bundle(Bundle),
}

impl Region {
    fn turn(&mut self, axes: &Matrix3<f64>) {
        match self {
            Self::Lens(lens) => lens.turn(axes),
            Self::Convex(convex) => convex.turn(axes),
            Self::Bundle(bundle) => bundle.turn(axes),
        }
    }
    pub(crate) fn overlap(&self, origin: Point, between: Vector) -> Overlap {
        match self {
            Self::Lens(lens) => lens.overlap(origin, between),
            Self::Convex(convex) => convex.overlap(origin, between),
            Self::Bundle(bundle) => bundle.overlap(origin, between),
        }
    }
    /// How far a place is from it, about; negative within.
    fn outside(&self, x: Vector, planes: &[Plane]) -> f64 {
        match self {
            Self::Lens(lens) => lens.outside(x),
            Self::Convex(convex) => convex.outside(x, planes),
            Self::Bundle(bundle) => bundle.outside(x),
        }
    }
}

impl Root {
    pub(crate) fn boxed(bounds: Oriented, at: Vector) -> Self {
        Self { bounds, at, region: None, done: false }
    }
    pub(crate) fn of(region: Region) -> Self {
        let (bounds, at) = match &region {
            Region::Lens(lens) => (lens.root, lens.centre),
            Region::Convex(convex) => (convex.root, convex.centre),
            Region::Bundle(bundle) => (bundle.root, bundle.centre),
        };
        Self { bounds, at, region: Some(region), done: true }
    }
    /// As a frame sees it in which this one's axes are the columns of `axes`.
    pub(crate) fn turn(&mut self, axes: &Matrix3<f64>) {
        self.bounds.turn(axes);
        if let Some(region) = &mut self.region {
            region.turn(axes);
        }
    }
    /// Is `x` in a region that is measured here?
    pub(crate) fn holds(&self, x: Vector, planes: &[Plane]) -> bool {
        match &self.region {
            Some(region) => region.outside(x, planes) <= 0.0,
            None => self.bounds.holds(x),
        }
    }
    /// Is all that is within `reach` of `x`? Or, with the `last` boxes that are looked at, at least what hangs together with it.
    pub(crate) fn knows(&self, x: Vector, reach: f64, last: bool, planes: &[Plane]) -> bool {
        match &self.region {
            Some(region) => region.outside(x, planes) <= if last { reach } else { -reach },
            None => self.bounds.holds_ball(x, reach),
        }
    }
    /// Is its region in the box of a bundle, or a part of it?
    pub(crate) fn is_in(&self, bundle: &Bundle) -> bool {
        match &self.region {
            Some(Region::Lens(lens)) => lens.places().any(|x| bundle.outside(x) < 0.0),
            Some(Region::Bundle(other)) => {
                bundle.outside(self.at) < 0.0 || other.outside(bundle.centre) < 0.0
            }
            Some(Region::Convex(_)) => bundle.outside(self.at) < 0.0,
            None => self.bounds.may_meet(&bundle.root),
        }
    }
    /// May what is said of both count something twice? What is convex holds nothing else, and lenses end at their rims.
    fn must_be_one_with(&self, o: &Self) -> bool {
        let apart = match (&self.region, &o.region) {
            (Some(Region::Lens(a)), Some(Region::Lens(b))) => a.is_apart_from(b),
            (Some(Region::Bundle(bundle)), _) => !o.is_in(bundle),
            (_, Some(Region::Bundle(bundle))) => !self.is_in(bundle),
            (Some(_), Some(_)) => true,
            _ => false,
        };
        !apart && self.bounds.may_meet(&o.bounds)
    }
    /// Is the straight way to `x` within both bodies? Steps as long as the distances prove it, but for a 32nd of the way.
    pub(crate) fn sees(&self, search: &Search<'_>, x: Vector) -> bool {
        let way = (x - self.at).norm();
        let mut gone = 0.0;
        while gone < way {
            let [a, b] = search.distances(x.lerp(&self.at, gone / way));
            let level = a.max(b);
            if level >= 0.0 {
                return false;
            }
            gone += (-level).max(way / 32.0);
        }
        true
    }
}

/// Makes one of roots that may meet; their trees change places with them.
pub(crate) fn merge(roots: &mut Vec<Root>, trees: &mut [Tree]) {
    'again: loop {
        for j in 1..roots.len() {
            for i in 0..j {
                if roots[i].must_be_one_with(&roots[j]) {
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
