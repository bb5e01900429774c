//! Formulas of place and time.
use exmex::{Express, FlatEx};
use std::sync::Arc;

/// A formula of some variables, ready to be evaluated.
#[derive(Clone, Debug)]
pub(crate) struct Expression {
    kind: Kind,
}

#[derive(Clone, Debug)]
enum Kind {
    Constant(f64),
    /// The formula, and which of the variables it asks for.
    Formula(Arc<FlatEx<f64>>, Vec<usize>),
}

/// No formula needs more.
const MOST: usize = 2000;
/// Nor goes deeper into brackets.
const DEEPEST: usize = 100;

impl Expression {
    pub(crate) fn constant(value: f64) -> Self {
        Self { kind: Kind::Constant(value) }
    }

    /// Understands `text` as a formula of `variables`; the error is the rest of a sentence that begins "the formula …".
    pub(crate) fn new(text: &str, variables: &[&str]) -> Result<Self, String> {
        if text.chars().count() > MOST {
            return Err(format!("is longer than {MOST} characters"));
        }
        let deepest = text.chars().scan(0i32, |depth, c| {
            *depth += i32::from(c == '(') - i32::from(c == ')');
            Some(*depth)
        });
        if deepest.max().unwrap_or(0) > DEEPEST as i32 {
            return Err(format!("has more than {DEEPEST} brackets within one another"));
        }
        let formula = FlatEx::<f64>::parse(text).map_err(|e| format!("cannot be understood: {}", e.msg()))?;
        let mut asked = Vec::new();
        for name in formula.var_names() {
            match variables.iter().position(|v| v == name) {
                Some(v) => asked.push(v),
                None => {
                    let known = variables.join(", ");
                    return Err(format!("asks for \"{name}\", which is neither a function nor one of {known}"));
                }
            }
        }
        if asked.is_empty() {
            let value = formula.eval(&[]).map_err(|e| format!("has no value: {}", e.msg()))?;
            if !value.is_finite() {
                return Err(format!("is {value}; give one with a finite value"));
            }
            return Ok(Self::constant(value));
        }
        Ok(Self { kind: Kind::Formula(Arc::new(formula), asked) })
    }

    /// Its value; not a number if it has none there.
    pub(crate) fn at(&self, variables: &[f64]) -> f64 {
        match &self.kind {
            Kind::Constant(value) => *value,
            Kind::Formula(formula, asked) => {
                let mut values = [0.0; 4];
                for (value, &v) in values.iter_mut().zip(asked) {
                    *value = variables.get(v).copied().unwrap_or(f64::NAN);
                }
                formula.eval(&values[..asked.len()]).unwrap_or(f64::NAN)
            }
        }
    }

    /// Its value if it is the same everywhere.
    pub(crate) fn fixed(&self) -> Option<f64> {
        match &self.kind {
            Kind::Constant(value) => Some(*value),
            Kind::Formula(..) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_are_evaluated() {
        let f = |text: &str| Expression::new(text, &["x", "y", "z", "t"]).unwrap();
        assert!((f("1.5*4*y*(0.41-y)/0.41^2").at(&[9.0, 0.205, 0.0, 0.0]) - 1.5).abs() < 1e-15);
        assert_eq!(f("x - 2*t").at(&[1.0, 0.0, 0.0, 3.0]), -5.0);
        assert_eq!(f("-x^2").at(&[3.0, 0.0, 0.0, 0.0]), -9.0);
        assert_eq!(f("min(t, 1)").at(&[0.0, 0.0, 0.0, 0.5]), 0.5);
        assert_eq!(f("2*PI").fixed(), Some(std::f64::consts::TAU));
        assert!(f("log(x)").at(&[-1.0, 0.0, 0.0, 0.0]).is_nan());
    }

    #[test]
    fn what_is_no_formula_is_told() {
        let told = |text: &str| Expression::new(text, &["t"]).unwrap_err();
        assert!(told("2*x").contains("\"x\""));
        assert!(told("2*(t").contains("cannot be understood"));
        assert!(told("").contains("understood"));
        assert!(told("1/0").contains("finite"));
        assert!(told(&format!("{}t{}", "(".repeat(500), ")".repeat(500))).contains("brackets"));
    }
}
