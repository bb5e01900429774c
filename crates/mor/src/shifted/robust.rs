//! Some entries are wrong, of snapshots that any operators carry along.
use super::rank_search::deviation;
use super::residual::Problem;
use super::shifted_pod::{Ranks, Watch, only};
use super::{
    Decomposition, Frame, FrameOperators, JointDescent, Proximal, ShiftedError, ShiftedPod, StopReason,
};
use monomorphic::{Mat, MatRef};

impl ShiftedPod {
    /// Some entries are wrong.
    pub(super) fn robust(
        &self,
        operators: &dyn FrameOperators,
        snapshots: MatRef<'_, f64>,
        start: Option<Vec<Frame>>,
        watch: &mut Watch<'_>,
    ) -> Result<Decomposition, ShiftedError> {
        let mut proximal = Proximal::augmented_lagrangian().with_noise().tolerance(1e-3);
        proximal = proximal.max_steps(2 * self.max_steps);
        let convex = proximal.solve(operators, snapshots, start.as_deref(), &mut |p| watch.see(p))?;
        if convex.stopped == StopReason::Asked {
            return Ok(Decomposition { history: watch.take(), ..convex });
        }
        // Small singular values are noise or will be found again.
        let largest = convex.frames.iter().flat_map(|f| &f.singular_values).fold(0.0, |a: f64, &s| a.max(s));
        let leading = |(k, frame): (usize, &Frame)| match &self.ranks {
            Ranks::Given(ranks) => frame.cut(ranks.get(k).map_or(0, |&r| r.min(frame.rank()))),
            Ranks::Found => {
                frame.cut(frame.singular_values.iter().filter(|&&s| s > LEADING * largest).count())
            }
        };
        let mut frames: Vec<Frame> = convex.frames.iter().enumerate().map(leading).collect();
        let problem = Problem::new(operators, snapshots)?;
        for round in 1.. {
            let ranks: Vec<_> = frames.iter().map(Frame::rank).collect();
            frames = self.robust_fit(&problem, frames, watch)?;
            // Where nothing is explained nothing is wrong.
            let known = ranks.iter().any(|&rank| rank > 0);
            let wrong = match known {
                true => entries(&problem.residual(&frames), 6.0 * deviation_there(&problem, &frames)),
                false => vec![],
            };
            let stopped;
            (frames, stopped) = self.fit(operators, snapshots, &wrong, frames, watch)?;
            let same = frames.iter().map(Frame::rank).eq(ranks);
            if same || round == ROUNDS || stopped == StopReason::Asked {
                let noise = Some(only(&problem.residual(&frames), &wrong));
                return Ok(Decomposition { noise, ..Decomposition::of(frames, watch.take(), stopped) });
            }
        }
        unreachable!("the last round returns")
    }

    /// Modes fitted so that wrong entries do little harm, with Huber's level from the deviation of the others, until that is as small as it gets.
    fn robust_fit(
        &self,
        problem: &Problem<'_>,
        mut frames: Vec<Frame>,
        watch: &mut Watch<'_>,
    ) -> Result<Vec<Frame>, ShiftedError> {
        let mut level = deviation_there(problem, &frames);
        for _ in 0..self.max_steps {
            if level <= 0.0 {
                break;
            }
            let ranks: Vec<_> = frames.iter().map(Frame::rank).collect();
            let descent = JointDescent::new(ranks).huber(level).stagnation(0.05).max_steps(self.max_steps);
            let d =
                descent.solve(problem.operators, problem.snapshots, Some(&frames), &mut |p| watch.see(p))?;
            frames = d.frames;
            let before = level;
            level = deviation_there(problem, &frames);
            if d.stopped == StopReason::Asked || level > 0.9 * before {
                break;
            }
        }
        Ok(frames)
    }
}

/// Modes of the augmented Lagrangian below this part of the largest one are not started from.
const LEADING: f64 = 0.02;

/// How often ranks are looked for.
const ROUNDS: usize = 3;

/// The deviation of what is left, where there is something to carry along, from nothing; no less than round-off.
fn deviation_there(problem: &Problem<'_>, frames: &[Frame]) -> f64 {
    let residual = problem.residual(frames);
    let explained = problem.snapshots - &residual;
    let something = 0.02 * explained.norm_max();
    let there = explained.col_iter().zip(residual.col_iter()).flat_map(|(f, r)| {
        f.iter().zip(r.iter()).filter(|(f, _)| f.abs() > something).map(|(_, r)| r.abs()).collect::<Vec<_>>()
    });
    deviation(there.collect()).max(1e-10 * problem.snapshots.norm_max())
}

/// Row and column of entries larger than that.
fn entries(field: &Mat<f64>, size: f64) -> Vec<(usize, usize)> {
    let column =
        |j: usize| (0..field.nrows()).filter(move |&i| field[(i, j)].abs() > size).map(move |i| (i, j));
    (0..field.ncols()).flat_map(column).collect()
}
