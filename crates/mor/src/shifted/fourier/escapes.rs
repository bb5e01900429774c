//! Other ways to a fit that is stuck.
use super::als::{Als, LONG};
use super::newton::Newton;
use super::spectrum::Spectrum;
use crate::shifted::{Decomposition, Progress, ShiftedError, StopReason};

/// A fit that is as good as this need not be another one.
const GOOD: f64 = 1e-6;
/// Two fits that end so near to one another, as a part of the error, have found the same.
const ALIKE: f64 = 1e-3;
/// While not all frames have their modes.
const SHORT: (usize, f64) = (10, 1e-2);
/// Newton's steps may take so many times the steps of the first fit.
const PRODUCTS: usize = 10;
const DAMPING: f64 = 1e-3;

/// What is tried one after the other.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Way {
    /// Down from the best so far.
    Newton,
    /// From nothing, the modes of the first frame first, or those of the last one.
    Filled { backwards: bool },
}

impl Als {
    /// From nothing; if that ends above the tolerance also in other ways, of which the best is told. [`Als::fit`] adds modes of all frames at a time,
    /// and ends in the minimum to which that leads, or creeps if frames hardly move against one another. One that is found twice is taken for the least.
    /// A further fit from nothing takes no more steps than all before together and those that tell that nothing gets better.
    pub(in crate::shifted) fn least(
        &self,
        spectrum: &Spectrum,
        progress: &mut dyn FnMut(&Progress) -> bool,
    ) -> Result<Decomposition, ShiftedError> {
        let error = |d: &Decomposition| d.history.last().map_or(0.0, |p| p.error);
        let mut best = self.fit(spectrum, None, LONG, progress)?;
        if best.frames.iter().filter(|f| f.rank() > 0).count() < 2 {
            return Ok(best);
        }
        let mut products = PRODUCTS * best.history.len();
        let mut history = best.history.clone();
        let (mut attempts, mut refined) = (0, false);
        let filled = [false, true].map(|backwards| Way::Filled { backwards });
        for way in [Way::Newton, filled[0], filled[1], Way::Newton] {
            let newton = way == Way::Newton;
            if best.stopped == StopReason::Asked || error(&best) <= GOOD.max(self.tolerance) {
                break;
            }
            let flat = best.stopped == StopReason::Stagnation;
            if newton && (refined || products == 0 || attempts == 0 && flat) {
                continue;
            }
            let d = match way {
                Way::Newton => {
                    let mut newton = Newton { damping: DAMPING, products };
                    let d = self.refine(spectrum, &best, &mut newton, progress)?;
                    products = newton.products;
                    d
                }
                Way::Filled { backwards } => {
                    let least = SHORT.0 * (self.ranks.len() - 1) + LONG.0;
                    let most = (history.len() + least).min(self.max_steps);
                    Self { max_steps: most, ..self.clone() }.filled(spectrum, backwards, progress)?
                }
            };
            attempts += 1;
            history.extend(&d.history);
            let flat = flat && d.stopped == StopReason::Stagnation;
            let same = flat && !newton && (error(&d) / error(&best) - 1.0).abs() <= ALIKE;
            let asked = d.stopped == StopReason::Asked;
            // An attempt that ends before all frames have their modes is none.
            let full = d.ranks().iter().zip(best.ranks()).all(|(&r, s)| r >= s);
            if full && error(&d) < error(&best) {
                (best, refined) = (d, newton);
            }
            if asked {
                best.stopped = StopReason::Asked;
            }
            if same {
                break;
            }
        }
        // The last step tells the error of what is returned.
        if let Some(last) = best.history.last().filter(|_| attempts > 0 && best.stopped != StopReason::Asked)
        {
            progress(last);
            history.push(*last);
        }
        history.iter_mut().enumerate().for_each(|(step, p)| p.step = step);
        Ok(Decomposition { history, attempts, ..best })
    }

    /// All modes of one frame before those of the next one.
    fn filled(
        &self,
        spectrum: &Spectrum,
        backwards: bool,
        progress: &mut dyn FnMut(&Progress) -> bool,
    ) -> Result<Decomposition, ShiftedError> {
        let n = self.ranks.len();
        let mut part = Self { ranks: vec![0; n], ..self.clone() };
        let mut d: Option<Decomposition> = None;
        for k in 0..n - 1 {
            let k = if backwards { n - 1 - k } else { k };
            part.ranks[k] = self.ranks[k];
            let next = part.fit(spectrum, d.as_ref(), SHORT, progress)?;
            if next.stopped == StopReason::Asked || next.stopped == StopReason::Steps {
                return Ok(next);
            }
            part.max_steps = part.max_steps.saturating_sub(next.history.len()).max(1);
            d = Some(next);
        }
        part.ranks = self.ranks.clone();
        part.fit(spectrum, d.as_ref(), LONG, progress)
    }
}
