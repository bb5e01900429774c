//! What every method owes, and every function made by one.
use super::{
    FitObserver, FitProgress, FitStage, Folds, Harmonics, InterpolationError, Network, Product, Rbf, Record,
    RecordError, Samples, Spline, Varying, unobserved,
};
use crate::{Mat, MatRef};

/// A way to make a function of samples, with all its parameters.
pub trait Method: Send + Sync {
    /// What tables call it.
    fn name(&self) -> String;
    /// The function through the samples, or near them.
    ///
    /// # Errors
    /// [`InterpolationError`] when the samples are too few, too many or not arranged as the method needs them.
    fn fit(&self, samples: &Samples) -> Result<Box<dyn Interpolator>, InterpolationError> {
        self.fit_observed(samples, &mut unobserved)
    }
    /// The same, with every step of an iteration or a search reported; a method in closed form
    /// reports none.
    ///
    /// # Errors
    /// As [`fit`](Self::fit); [`InterpolationError::Stopped`] by the observer.
    fn fit_observed(
        &self,
        samples: &Samples,
        observer: FitObserver<'_>,
    ) -> Result<Box<dyn Interpolator>, InterpolationError>;
    /// Errors ŷ − y (k × size of the set) at the samples of every set, of functions through all the
    /// others: one fit for each set ([`FitStage::Fold`]), where there is no closed form.
    ///
    /// # Errors
    /// As [`fit_observed`](Self::fit_observed), of a part of the samples;
    /// [`InterpolationError::Empty`] if a set has them all.
    fn left_out(
        &self,
        samples: &Samples,
        folds: &Folds,
        observer: FitObserver<'_>,
    ) -> Result<Vec<Mat<f64>>, InterpolationError> {
        let count = folds.sets().len();
        let one = |(k, set): (usize, &Vec<usize>)| {
            let fold = FitProgress::new(FitStage::Fold, k + 1, count);
            let others = samples.without(set)?;
            let function = fold.run(&mut *observer, |observer| self.fit_observed(&others, observer))?;
            let mut errors = function.predict_all(samples.pick(set)[0].as_ref())?;
            for (j, &sample) in set.iter().enumerate() {
                let pairs = errors.col_as_slice_mut(j).iter_mut().zip(samples.value(sample));
                pairs.for_each(|(error, value)| *error -= value);
            }
            Ok(errors)
        };
        folds.sets().iter().enumerate().map(one).collect()
    }
}

impl<M: Method + ?Sized> Method for &M {
    fn name(&self) -> String {
        (**self).name()
    }
    fn fit_observed(
        &self,
        samples: &Samples,
        observer: FitObserver<'_>,
    ) -> Result<Box<dyn Interpolator>, InterpolationError> {
        (**self).fit_observed(samples, observer)
    }
    fn left_out(
        &self,
        samples: &Samples,
        folds: &Folds,
        observer: FitObserver<'_>,
    ) -> Result<Vec<Mat<f64>>, InterpolationError> {
        (**self).left_out(samples, folds, observer)
    }
}

/// A function ℝᵈ → ℝᵏ made of samples.
pub trait Interpolator: Send + Sync {
    /// d.
    fn inputs(&self) -> usize;
    /// k.
    fn outputs(&self) -> usize;
    /// Smallest and largest value of every input among the samples: predictions outside are extrapolations.
    fn domain(&self) -> &[[f64; 2]];
    /// y(x) into `out`.
    ///
    /// # Errors
    /// [`InterpolationError::Shape`], [`InterpolationError::Point`].
    fn predict(&self, x: &[f64], out: &mut [f64]) -> Result<(), InterpolationError>;
    /// ∂y/∂x_j (x) for j = `input` into `out`.
    ///
    /// # Errors
    /// [`InterpolationError::Shape`] (also if there is no such input), [`InterpolationError::Point`].
    fn derivative(&self, x: &[f64], input: usize, out: &mut [f64]) -> Result<(), InterpolationError>;
    /// All of it, for a file: [`load`] gives it back bit for bit.
    fn record(&self) -> Record;

    /// Is x within the samples' [`domain`](Self::domain)?
    fn covers(&self, x: &[f64]) -> bool {
        x.len() == self.inputs()
            && x.iter().zip(self.domain()).all(|(x, [low, high])| (low..=high).contains(&x))
    }
    /// Predictions as columns (k × n) at points given as columns (d × n).
    ///
    /// # Errors
    /// As [`predict`](Self::predict).
    fn predict_all(&self, points: MatRef<'_, f64>) -> Result<Mat<f64>, InterpolationError> {
        let mut values = Mat::zeros(self.outputs(), points.ncols());
        let mut x = vec![0.0; points.nrows()];
        for j in 0..points.ncols() {
            x.iter_mut().enumerate().for_each(|(i, x)| *x = points[(i, j)]);
            self.predict(&x, values.col_as_slice_mut(j))?;
        }
        Ok(values)
    }
}

/// The interpolator that [`Interpolator::record`] recorded.
///
/// # Errors
/// [`RecordError`] if it is none of this module's, or not whole.
pub fn load(record: &Record) -> Result<Box<dyn Interpolator>, RecordError> {
    match record.kind() {
        Spline::KIND => Ok(Box::new(Spline::from_record(record)?)),
        Rbf::KIND => Ok(Box::new(Rbf::from_record(record)?)),
        Varying::KIND => Ok(Box::new(Varying::from_record(record)?)),
        Harmonics::KIND => Ok(Box::new(Harmonics::from_record(record)?)),
        Product::KIND => Ok(Box::new(Product::from_record(record)?)),
        Network::KIND => Ok(Box::new(Network::from_record(record)?)),
        kind => Err(RecordError::Kind { found: kind.into(), expected: "an interpolator".into() }),
    }
}

/// Checks that there is such an input.
pub(super) fn check_input(input: usize, inputs: usize) -> Result<(), InterpolationError> {
    if input < inputs {
        Ok(())
    } else {
        Err(InterpolationError::Shape {
            what: "inputs for this derivative",
            expected: input + 1,
            found: inputs,
        })
    }
}
