//! Bodies with flat faces and inward edges, of which only the distances are used, against sums over the boxes that they are made of.
use super::*;
use crate::Cuboid;
use crate::draw::Draw;

/// A slab with two to three towers on it, all as wide as it along y.
struct Comb {
    /// Lower and upper corners; towers begin at the slab's bottom, so that distances within are below zero.
    boxes: Vec<[Vector; 2]>,
}

impl Comb {
    fn new(draw: &mut Draw) -> Self {
        let (wide, deep, low) = (draw.between(0.2, 0.5), 1.0, draw.between(0.1, 0.4));
        let mut boxes = vec![[Vector::new(-deep, -wide, -low), Vector::new(deep, wide, 0.0)]];
        let n = if draw.next() < 0.5 { 2 } else { 3 };
        // A tower, a gap, and so on.
        let widths: Vec<f64> = (1..2 * n).map(|_| draw.between(0.3, 1.0)).collect();
        let scale = 2.0 * deep / widths.iter().sum::<f64>();
        let mut x = -deep;
        for (i, width) in widths.into_iter().enumerate() {
            let end = x + scale * width;
            if i % 2 == 0 {
                let high = draw.between(0.2, 0.8);
                boxes.push([Vector::new(x, -wide, -low), Vector::new(end, wide, high)]);
            }
            x = end;
        }
        Self { boxes }
    }
    /// Boxes that share no more than faces.
    fn parts(&self, at: &Pose) -> Vec<(Cuboid, Pose)> {
        let part = |(i, [low, high]): (usize, &[Vector; 2])| {
            let low = if i > 0 { Vector::new(low.x, low.y, 0.0) } else { *low };
            let place = Pose::at((0.5 * (low + high)).into());
            (Cuboid::new((high - low).into()).unwrap(), at.of(&place))
        };
        self.boxes.iter().enumerate().map(part).collect()
    }
}

impl Solid for Comb {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        let to = |[low, high]: &[Vector; 2]| {
            let q = (low - x.coords).sup(&(x.coords - high));
            q.map(|q| q.max(0.0)).norm() + q.max().min(0.0)
        };
        self.boxes.iter().map(to).fold(f64::INFINITY, f64::min)
    }
    fn aabb(&self) -> Aabb {
        let (low, high) = (self.boxes[0][0], self.boxes.iter().fold(Vector::zeros(), |h, b| h.sup(&b[1])));
        Aabb { min: low.into(), max: high.into() }
    }
}
impl Shape for Comb {
    fn name(&self) -> &'static str {
        "comb"
    }
    fn inertia(&self, _: f64) -> Inertia {
        unreachable!("overlaps do not ask for it")
    }
    fn bounding_radius(&self) -> f64 {
        let Aabb { min, max } = self.aabb();
        (-min.coords).sup(&max.coords).norm()
    }
}

/// Volume, first moment, gradient and moment about the origin.
#[derive(Default)]
struct Sum {
    volume: f64,
    first: Vector,
    gradient: Vector,
    moment: Vector,
}

impl Sum {
    fn add(&mut self, patches: &[Overlap]) {
        for o in patches {
            self.volume += o.volume;
            self.first += o.volume * o.centroid.coords;
            self.gradient += o.gradient;
            self.moment += o.moment + o.centroid.coords.cross(&o.gradient);
        }
    }
}

fn exact(a: &Comb, at_a: &Pose, b: &Comb, at_b: &Pose) -> Sum {
    let (mut sum, mut clip) = (Sum::default(), OverlapSolver::new());
    for (p, at_p) in a.parts(at_a) {
        for (q, at_q) in b.parts(at_b) {
            sum.add(clip.solve(&p, &at_p, &q, &at_q).unwrap());
        }
    }
    sum
}

/// Regions of combs are parted along their faces: most come out exactly, few need boxes. What is off hangs together by less than
/// what is looked at (notches as narrow as a twentieth of a side), by no more than the tolerance.
#[test]
fn combs_are_parted_into_convex_pieces() {
    let mut draw = Draw(11);
    let mut tree = tolerance(1e-3);
    let (mut met, mut exact_ones, mut beyond, mut boxes) = (0, 0, 0, 0);
    for case in 0..300 {
        let [a, b] = [Comb::new(&mut draw), Comb::new(&mut draw)];
        let at_a = Pose { position: Point::new(0.3, -0.2, 0.7), orientation: draw.turn() };
        let (way, orientation) = (draw.direction(), draw.turn());
        let away = |distance: f64| Pose { position: at_a.position + way * distance, orientation };
        let mut at_b = away(draw.between(0.1, 1.6));
        if case % 2 == 1 {
            // From a graze on.
            let [mut near, mut far] = [0.1, 3.0];
            for _ in 0..30 {
                let middle = 0.5 * (near + far);
                let meets = exact(&a, &at_a, &b, &away(middle)).volume > 0.0;
                *(if meets { &mut near } else { &mut far }) = middle;
            }
            at_b = away(near - 10_f64.powf(draw.between(-4.0, -0.5)));
        }
        let known = exact(&a, &at_a, &b, &at_b);
        let mut found = Sum::default();
        found.add(tree.solve(&a, &at_a, &b, &at_b).unwrap());
        // Regions of less than a hundredth of a side may be missed.
        if known.volume < 1e-7 {
            assert!(found.volume <= 1.01 * known.volume, "{case}");
            continue;
        }
        met += 1;
        boxes += usize::from(tree.boxes().next().is_some());
        let error = (found.volume / known.volume - 1.0).abs();
        assert!(error < 1.5e-3, "{case} {error} {}", known.volume);
        beyond += usize::from(error > 1e-3);
        if error < 1e-9 {
            exact_ones += 1;
            let size = known.volume.cbrt();
            let off = [
                (found.first - known.first).norm() / (known.volume * size),
                (found.gradient - known.gradient).norm() / size.powi(2),
                (found.moment - known.moment).norm() / size.powi(2),
            ];
            assert!(off.iter().all(|off| *off < 1e-5), "{case} {off:?}");
        }
    }
    assert!(met > 220 && beyond <= 1 && boxes <= 2, "{met} {beyond} {boxes}");
    assert!(exact_ones > 3 * met / 4, "{exact_ones} of {met}");
}
