//! Which bodies are near others.
use interfaces::{Aabb, BodyId, Vector};

/// Finds boxes that meet and those that meet no other; holds the memory that this takes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Crowd {
    /// To be filled in.
    pub(crate) boxes: Vec<Aabb>,
    /// Whether each box meets no other.
    pub(crate) alone: Vec<bool>,
    /// Boxes that meet, both ways round, sorted.
    pairs: Vec<[usize; 2]>,
    /// Those that met when this was last found.
    met: Vec<[usize; 2]>,
    /// Lower and upper end of each box along one axis, sorted.
    spans: Vec<(f64, f64, usize)>,
}

impl Crowd {
    /// Finds which boxes meet in a space with these periods (zero where it does not repeat), and those that are `alone`: none, if one is longer than half a period.
    pub(crate) fn find(&mut self, periods: Vector) {
        std::mem::swap(&mut self.pairs, &mut self.met);
        let Self { boxes, alone, pairs, spans, .. } = self;
        let long = |b: &Aabb| (0..3).any(|a| periods[a] > 0.0 && b.extent()[a] > 0.5 * periods[a]);
        alone.clear();
        alone.resize(boxes.len(), boxes.len() < 2 || !boxes.iter().any(long));
        pairs.clear();
        // Sweeps along the axis on which they spread farthest.
        let middle = |b: &Aabb, a: usize| 0.5 * (b.min[a] + b.max[a]);
        let spread = |a: usize| {
            let [low, high] = boxes.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], b| {
                [low.min(middle(b, a)), high.max(middle(b, a))]
            });
            high - low
        };
        let axis = (0..3).max_by(|&a, &b| spread(a).total_cmp(&spread(b))).unwrap_or(0);
        let period = periods[axis];
        spans.clear();
        for (k, b) in boxes.iter().enumerate() {
            let turn = if period > 0.0 { -period * (middle(b, axis) / period).floor() } else { 0.0 };
            let (low, high) = (b.min[axis] + turn, b.max[axis] + turn);
            spans.push((low, high, k));
            // As it repeats beyond either end.
            if period > 0.0 && low < 0.0 {
                spans.push((low + period, high + period, k));
            }
            if period > 0.0 && high >= period {
                spans.push((low - period, high - period, k));
            }
        }
        spans.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let apart = |a: &Aabb, b: &Aabb, axis: usize| {
            let mut apart = middle(a, axis) - middle(b, axis);
            if periods[axis] > 0.0 {
                apart -= periods[axis] * (apart / periods[axis]).round();
            }
            apart.abs() > 0.5 * (a.extent() + b.extent())[axis]
        };
        for (at, &(_, high, k)) in spans.iter().enumerate() {
            for &(_, _, other) in spans[at + 1..].iter().take_while(|span| span.0 <= high) {
                if other != k && !(0..3).any(|a| apart(&boxes[k], &boxes[other], a)) {
                    (alone[k], alone[other]) = (false, false);
                    pairs.extend([[k, other], [other, k]]);
                }
            }
        }
        pairs.sort_unstable();
        pairs.dedup();
    }

    /// The boxes that box `k` meets.
    pub(crate) fn others(&self, k: usize) -> impl Iterator<Item = BodyId> {
        of(&self.pairs, k)
    }

    /// Is there one that `moves` among those that box `k` meets, or met before?
    pub(crate) fn stirs(&self, k: usize, moves: &[bool]) -> bool {
        of(&self.pairs, k).chain(of(&self.met, k)).any(|b| moves[b.0])
    }

    /// The boxes go by other numbers from now on.
    pub(crate) fn renumber(&mut self) {
        self.pairs.clear();
        self.met.clear();
    }
}

/// Those that `k` meets.
fn of(pairs: &[[usize; 2]], k: usize) -> impl Iterator<Item = BodyId> {
    let first = pairs.partition_point(|pair| pair[0] < k);
    pairs[first..].iter().take_while(move |pair| pair[0] == k).map(|pair| BodyId(pair[1]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::Point;
    use proptest::prelude::*;

    proptest! {
        /// As each pair tells, over its nearest images.
        #[test]
        fn those_alone_meet_no_other(
            places in proptest::collection::vec((-3.0..6.0_f64, -3.0..6.0_f64, 0.1..2.8_f64), 1..12), flat: bool,
        ) {
            let periods = Vector::new(3.0, if flat { 0.0 } else { 4.0 }, 0.0);
            let half = |size: f64| Vector::new(0.5 * size, 0.3 * size, 0.0);
            let boxes: Vec<_> = places.iter().map(|&(x, y, size)| Aabb::around(Point::new(x, y, 0.0), half(size))).collect();
            let mut crowd = Crowd { boxes, ..Crowd::default() };
            crowd.find(periods);
            let Crowd { boxes, alone, .. } = &crowd;
            for (k, a) in boxes.iter().enumerate() {
                let meets = |b: &Aabb| (0..2).all(|axis| {
                    let mut apart = 0.5 * (a.min + a.max.coords - b.min.coords - b.max.coords)[axis];
                    if periods[axis] > 0.0 {
                        apart -= periods[axis] * (apart / periods[axis]).round();
                    }
                    apart.abs() <= 0.5 * (a.extent() + b.extent())[axis]
                });
                let met = |&other: &usize| other != k && meets(&boxes[other]);
                let met: Vec<_> = (0..boxes.len()).filter(met).map(BodyId).collect();
                let long = boxes.iter().any(|b| b.extent().x > 1.5);
                prop_assert_eq!(alone[k], met.is_empty() && (!long || boxes.len() == 1), "{}", k);
                prop_assert_eq!(crowd.others(k).collect::<Vec<_>>(), met, "{}", k);
            }
        }
    }

    /// Those that meet one that moves, or met it before it did.
    #[test]
    fn what_moves_stirs_those_around() {
        let at = |x: f64| Aabb::around(Point::new(x, 0.0, 0.0), Vector::repeat(0.5));
        let mut crowd = Crowd { boxes: [0.0, 0.9, 5.0, 9.0].map(at).into(), ..Crowd::default() };
        crowd.find(Vector::zeros());
        crowd.boxes[1] = at(8.2);
        crowd.find(Vector::zeros());
        let stirred = |crowd: &Crowd| [0, 2, 3].map(|k| crowd.stirs(k, &[false, true, false, false]));
        assert_eq!(stirred(&crowd), [true, false, true]);
        crowd.find(Vector::zeros());
        assert_eq!(stirred(&crowd), [false, false, true]);
        assert!([0, 2, 3].iter().all(|&k| !crowd.stirs(k, &[false; 4])));
        crowd.renumber();
        assert_eq!(stirred(&crowd), [false; 3]);
    }

    #[test]
    fn a_box_as_long_as_the_period_is_not_alone() {
        let boxes =
            [0.2, 5.0].map(|half| Aabb::around(Point::new(1.0, 20.0 * half, 0.0), Vector::repeat(half)));
        let mut crowd = Crowd { boxes: boxes.into(), ..Crowd::default() };
        crowd.find(Vector::new(10.5, 0.0, 0.0));
        assert_eq!(crowd.alone, [false, false]);
        crowd.find(Vector::zeros());
        assert_eq!(crowd.alone, [true, true]);
    }
}
