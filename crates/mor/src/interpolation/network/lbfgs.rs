//! Smallest values of smooth functions.
use super::Stop;
use super::wolfe::{self, Place};

/// A function to be made small.
pub(super) trait Objective {
    /// f(θ), and ∂f/∂θ into `gradient`.
    fn evaluate(&mut self, theta: &[f64], gradient: &mut [f64]) -> f64;
}

/// How long [`minimise`] goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Limits {
    pub(super) iterations: usize,
    /// Of the changes of θ and of the gradient that are remembered.
    pub(super) memory: usize,
    /// Stop once the largest entry of the gradient is this small.
    pub(super) gradient: f64,
    /// Stop once the value falls by less than this share in ten iterations.
    pub(super) decrease: f64,
}

/// One remembered pair: s = Δθ, y = Δg.
struct Pair {
    s: Vec<f64>,
    y: Vec<f64>,
    /// 1/sᵀy.
    rho: f64,
    alpha: f64,
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
/// a += factor b.
fn add(a: &mut [f64], factor: f64, b: &[f64]) {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += factor * b);
}

/// Makes f(θ) small by L-BFGS (Nocedal & Wright, Numerical Optimization, 2006, algorithm 7.5) with steps that obey the strong
/// conditions of Wolfe. `watch` sees the function at the start and after every iteration, and its value; it may end it.
pub(super) fn minimise<O: Objective>(
    objective: &mut O,
    theta: &mut [f64],
    limits: &Limits,
    watch: &mut dyn FnMut(&O, f64) -> Option<Stop>,
) -> Stop {
    let n = theta.len();
    let zeros = || vec![0.0; n];
    let mut pairs: Vec<Pair> =
        (0..limits.memory.max(1)).map(|_| Pair { s: zeros(), y: zeros(), rho: 0.0, alpha: 0.0 }).collect();
    // Pairs are a ring: the newest is at `next − 1`.
    let (mut known, mut next) = (0, 0);
    let (mut gradient, mut direction) = (zeros(), zeros());
    let mut place = Place { theta: zeros(), gradient: zeros(), value: 0.0, slope: 0.0, step: 0.0 };
    let mut value = objective.evaluate(theta, &mut gradient);
    if let Some(stop) = watch(objective, value) {
        return stop;
    }
    let mut before = [f64::INFINITY; 10];
    for iteration in 0..limits.iterations {
        let largest = gradient.iter().fold(0.0, |a: f64, g| a.max(g.abs()));
        if largest <= limits.gradient {
            return Stop::Gradient;
        }
        if before[iteration % 10] - value < limits.decrease * value {
            return Stop::Flat;
        }
        before[iteration % 10] = value;
        loop {
            let newest = |i: usize| (next + limits.memory - 1 - i) % limits.memory;
            direction.copy_from_slice(&gradient);
            for i in 0..known {
                let pair = &mut pairs[newest(i)];
                pair.alpha = pair.rho * dot(&pair.s, &direction);
                add(&mut direction, -pair.alpha, &pair.y);
            }
            if known > 0 {
                let pair = &pairs[newest(0)];
                let scale = 1.0 / (pair.rho * dot(&pair.y, &pair.y));
                direction.iter_mut().for_each(|d| *d *= scale);
            }
            for i in (0..known).rev() {
                let pair = &pairs[newest(i)];
                let beta = pair.rho * dot(&pair.y, &direction);
                add(&mut direction, pair.alpha - beta, &pair.s);
            }
            direction.iter_mut().for_each(|d| *d = -*d);
            let slope = dot(&direction, &gradient);
            let first = if known > 0 { 1.0 } else { (1.0 / dot(&gradient, &gradient).sqrt()).min(1.0) };
            let at = wolfe::Line { theta, direction: &direction, value, slope };
            if slope < 0.0 && wolfe::search(objective, &at, first, &mut place) {
                break;
            }
            if known == 0 {
                return Stop::LineSearch;
            }
            // Once more, straight down.
            known = 0;
        }
        let pair = &mut pairs[next];
        for i in 0..n {
            pair.s[i] = place.theta[i] - theta[i];
            pair.y[i] = place.gradient[i] - gradient[i];
        }
        let curvature = dot(&pair.s, &pair.y);
        if curvature > f64::EPSILON * dot(&pair.y, &pair.y).max(f64::MIN_POSITIVE) {
            pair.rho = 1.0 / curvature;
            known = (known + 1).min(limits.memory);
            next = (next + 1) % limits.memory;
        }
        theta.copy_from_slice(&place.theta);
        gradient.copy_from_slice(&place.gradient);
        value = place.value;
        if let Some(stop) = watch(objective, value) {
            return stop;
        }
    }
    Stop::Iterations
}
