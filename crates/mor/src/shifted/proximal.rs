//! Proximal algorithms: ranks and noise by convex optimisation.
use super::dense::columns;
use super::residual::{Course, Limits, Observer, Problem};
use super::{Decomposition, Frame, FrameOperators, ShiftedError};
use monomorphic::{Mat, MatRef};

/// The proximal algorithms of Krah, Marmin, Zorawski, Reiss & Schneider (2024): the nuclear norms Σ_k ‖Q_k‖_* make ranks small that nobody
/// gave, and ‖E‖₁ makes a noise E sparse.
///
/// - [`augmented_lagrangian`](Self::augmented_lagrangian): min λ_s Σ ‖Q_k‖_* + λ_E ‖E‖₁ with Q = Σ T^k Q_k + E;
/// - [`joint`](Self::joint), [`block`](Self::block): min ½ ‖Q − Σ T^k Q_k − E‖² + λ_s Σ ‖Q_k‖_* + λ_E ‖E‖₁.
///
/// All of them go through Q_k ← D[Q_k + γ (T^k)ᵀ R], E ← S[E + γ R] with R what is left, D the soft threshold of singular values and
/// S that of entries. Singular values come out too small by the threshold, and there are too many: cut them and go on with
/// [`JointDescent`](super::JointDescent).
#[derive(Clone, Debug, PartialEq)]
pub struct Proximal {
    method: Method,
    noise: bool,
    /// λ_s and λ_E, if they are not the usual ones.
    low_rank: Option<f64>,
    sparse: Option<f64>,
    limits: Limits,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Method {
    /// With μ.
    AugmentedLagrangian(Option<f64>),
    /// With γ.
    Joint(Option<f64>),
    Block(f64),
}

impl Proximal {
    fn new(method: Method) -> Self {
        let limits =
            Limits { tolerance: 1e-6, stagnation: f64::NEG_INFINITY, max_steps: 500, settled: f64::INFINITY };
        Self { method, noise: false, low_rank: None, sparse: None, limits }
    }

    /// Multipliers and block by block; λ_s = 1, μ = M N / (4 ‖Q‖₁) fixed. To a relative error of 1e-6, when a step changes the
    /// functional by less than 1e-3 of it, or 500 steps.
    #[must_use]
    pub fn augmented_lagrangian() -> Self {
        let mut new = Self::new(Method::AugmentedLagrangian(None));
        new.limits.settled = 1e-3;
        new
    }

    /// All blocks forward with the same residual, γ = 1.98/(K + 1); γ < 2/(K + 1) converges with K frames and noise. Stops where the
    /// functional changes by less than 1e-6 of it, or after 500 steps; λ_s is 0.02 ‖Q‖.
    #[must_use]
    pub fn joint() -> Self {
        Self::new(Method::Joint(None)).stagnation(1e-6)
    }

    /// Block after block, the residual anew for each, γ = 1. Stops where the functional changes by less than 1e-6 of it, or
    /// after 500 steps; λ_s is 0.02 ‖Q‖.
    #[must_use]
    pub fn block() -> Self {
        Self::new(Method::Block(1.0)).stagnation(1e-6)
    }

    /// With a noise E besides the frames.
    #[must_use]
    pub fn with_noise(mut self) -> Self {
        self.noise = true;
        self
    }

    /// μ of the augmented Lagrangian.
    #[must_use]
    pub fn multiplier(mut self, mu: f64) -> Self {
        if let Method::AugmentedLagrangian(to) = &mut self.method {
            *to = Some(mu);
        }
        self
    }

    /// γ of the forward–backward methods.
    #[must_use]
    pub fn step(mut self, gamma: f64) -> Self {
        match &mut self.method {
            Method::Joint(to) => *to = Some(gamma),
            Method::Block(to) => *to = gamma,
            Method::AugmentedLagrangian(_) => {}
        }
        self
    }

    /// λ_s.
    #[must_use]
    pub fn low_rank(mut self, weight: f64) -> Self {
        self.low_rank = Some(weight);
        self
    }

    /// λ_E, if not λ_s/√max(M, N).
    #[must_use]
    pub fn sparse(mut self, weight: f64) -> Self {
        self.sparse = Some(weight);
        self
    }

    /// Stops at this relative error.
    #[must_use]
    pub fn tolerance(mut self, error: f64) -> Self {
        self.limits.tolerance = error;
        self
    }

    /// Stops when a step makes the functional smaller by less than this part of it.
    #[must_use]
    pub fn stagnation(mut self, part: f64) -> Self {
        self.limits.stagnation = part;
        self
    }

    /// Steps, at most.
    #[must_use]
    pub fn max_steps(mut self, steps: usize) -> Self {
        self.limits.max_steps = steps;
        self
    }

    /// Decomposes snapshots, from nothing or from frames that are known already.
    ///
    /// # Errors
    /// [`ShiftedError::Empty`], [`ShiftedError::Snapshots`], [`ShiftedError::Unknowns`], [`ShiftedError::Ranks`],
    /// [`ShiftedError::NotFinite`]; [`ShiftedError::Parameter`] of a step or weight with which the iteration does not converge.
    pub fn solve(
        &self,
        operators: &dyn FrameOperators,
        snapshots: MatRef<'_, f64>,
        start: Option<&[Frame]>,
        observer: Observer<'_>,
    ) -> Result<Decomposition, ShiftedError> {
        let problem = Problem::new(operators, snapshots)?;
        let scheme = self.scheme(&problem)?;
        let frames = problem.start(start)?;
        let residual = problem.residual(&frames);
        let (m, n) = snapshots.shape();
        let multipliers = matches!(self.method, Method::AugmentedLagrangian(_)).then(|| Mat::zeros(m, n));
        let noise = self.noise.then(|| Mat::zeros(m, n));
        let mut state = State { problem, frames, residual, multipliers, noise };
        let mut course = Course::new(self.limits, observer)?;
        let stopped = loop {
            state.advance(&scheme);
            let error = state.problem.relative(state.residual.norm_l2());
            let merit = state.objective(&scheme);
            if let Some(stopped) = course.note_merit(error, merit, &state.frames) {
                break stopped;
            }
        };
        Ok(Decomposition { noise: state.noise, ..Decomposition::of(state.frames, course.history, stopped) })
    }

    fn scheme(&self, problem: &Problem<'_>) -> Result<Scheme, ShiftedError> {
        let (m, n) = problem.snapshots.shape();
        let checked = |name, value: f64, limit: f64| {
            let good = value > 0.0 && value < limit;
            if good { Ok(value) } else { Err(ShiftedError::Parameter { name, value, limit }) }
        };
        let blocks = problem.operators.n_frames() + usize::from(self.noise);
        // The threshold of the augmented Lagrangian is λ/μ.
        let (step, unit, usual) = match self.method {
            Method::AugmentedLagrangian(mu) => {
                let sum = problem.snapshots.norm_l1();
                // Any μ is good for snapshots that are zero.
                let usual = if sum > 0.0 { (m * n) as f64 / (4.0 * sum) } else { 1.0 };
                (1.0, 1.0 / checked("the multiplier", mu.unwrap_or(usual), f64::INFINITY)?, 1.0)
            }
            Method::Joint(step) => {
                let limit = 2.0 / blocks as f64;
                (checked("the step", step.unwrap_or(0.99 * limit), limit)?, 1.0, 0.02 * problem.norm)
            }
            Method::Block(step) => (checked("the step", step, 2.0)?, 1.0, 0.02 * problem.norm),
        };
        let weight =
            |name, given: Option<f64>, usual| given.map_or(Ok(usual), |w| checked(name, w, f64::INFINITY));
        let low_rank = weight("the weight of the nuclear norm", self.low_rank, usual)?;
        let sparse = weight("the weight of the noise", self.sparse, low_rank / (m.max(n) as f64).sqrt())?;
        let joint = matches!(self.method, Method::Joint(_));
        Ok(Scheme { step, low_rank: unit * low_rank, sparse: unit * sparse, joint })
    }
}

/// How far to go.
struct Scheme {
    /// γ.
    step: f64,
    /// The thresholds of singular values and of entries are γ times these.
    low_rank: f64,
    sparse: f64,
    joint: bool,
}

struct State<'a> {
    problem: Problem<'a>,
    frames: Vec<Frame>,
    /// Q − Σ T^k Q_k − E.
    residual: Mat<f64>,
    /// Y/μ.
    multipliers: Option<Mat<f64>>,
    noise: Option<Mat<f64>>,
}

impl State<'_> {
    fn advance(&mut self, scheme: &Scheme) {
        let (m, n) = self.residual.shape();
        let operators = self.problem.operators;
        let mut later = scheme.joint.then(|| Mat::zeros(m, n));
        let mut change = Mat::zeros(m, n);
        for (k, frame) in self.frames.iter_mut().enumerate() {
            let mut field = self.residual.clone();
            if let Some(multipliers) = &self.multipliers {
                field += multipliers;
            }
            if scheme.step != 1.0 {
                columns(&mut field).into_iter().flatten().for_each(|x| *x *= scheme.step);
            }
            operators.to_lab_transposed(k, field.as_mut());
            frame.add_to(field.as_mut(), 1.0);
            let new = Frame::thresholded(field.as_ref(), scheme.step * scheme.low_rank);
            columns(&mut change).into_iter().for_each(|c| c.fill(0.0));
            frame.add_to(change.as_mut(), 1.0);
            new.add_to(change.as_mut(), -1.0);
            operators.to_lab(k, change.as_mut());
            *later.as_mut().unwrap_or(&mut self.residual) += &change;
            *frame = new;
        }
        self.sparsify(scheme);
        if let Some(later) = later {
            self.residual += later;
        }
        if let Some(multipliers) = &mut self.multipliers {
            *multipliers += &self.residual;
        }
    }

    /// ½ ‖R‖² + λ_s Σ ‖Q_k‖_* + λ_E ‖E‖₁.
    fn objective(&self, scheme: &Scheme) -> f64 {
        let nuclear: f64 = self.frames.iter().flat_map(|f| &f.singular_values).sum();
        let sparse = self.noise.as_ref().map_or(0.0, Mat::norm_l1);
        0.5 * self.residual.squared_norm_l2() + scheme.low_rank * nuclear + scheme.sparse * sparse
    }

    /// E ← S[E + γ (R + Y/μ)], and R along with it.
    fn sparsify(&mut self, scheme: &Scheme) {
        let Some(noise) = &mut self.noise else { return };
        let threshold = scheme.step * scheme.sparse;
        let mut multipliers = self.multipliers.as_mut().map(columns).map(Vec::into_iter);
        for (noise, residual) in columns(noise).into_iter().zip(columns(&mut self.residual)) {
            let column = multipliers.as_mut().and_then(Iterator::next);
            for (i, (e, r)) in noise.iter_mut().zip(residual).enumerate() {
                let push = *r + column.as_ref().map_or(0.0, |y| y[i]);
                let x = *e + scheme.step * push;
                let new = x.signum() * (x.abs() - threshold).max(0.0);
                *r += *e - new;
                *e = new;
            }
        }
    }
}
