//! Formulas of place and time.
//!
//! ```text
//! sum     = product {("+" | "-") product}
//! product = sign {("*" | "/") sign}
//! sign    = ["+" | "-"] sign | power
//! power   = atom ["^" sign]                  so that −x^2 is −(x²) and 2^3^2 is 2⁹
//! atom    = number | constant | variable | function "(" sum {"," sum} ")" | "(" sum ")"
//! ```
//!
//! (No kept library does this: one reads −x^2 as (−x)² and no 1e-3, one is left alone since 2018, one is under a licence that binds its users.)
use crate::time_table::TimeTable;
use std::f64::consts::{E, PI};
use std::sync::{Arc, OnceLock};

/// A formula of some variables, ready to be evaluated.
#[derive(Clone, Debug)]
pub(crate) struct Expression {
    /// What to do, one after the other, on a stack.
    steps: Arc<[Step]>,
    /// Columns for [`Step::Column`].
    table: Option<Arc<TimeTable>>,
    /// The variables that had no finite value, and what it was, if there were any.
    fault: Arc<OnceLock<([f64; 4], f64)>>,
}

#[derive(Clone, Copy, Debug)]
enum Step {
    Number(f64),
    Variable(usize),
    Negate,
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    One(One),
    Two(Two),
    /// Value of a column of the table at the time on the stack.
    Column(usize),
}

/// Functions of one and of two numbers.
type One = fn(f64) -> f64;
type Two = fn(f64, f64) -> f64;

/// Functions of one number.
const ONE: [(&str, One); 21] = [
    ("sin", f64::sin),
    ("cos", f64::cos),
    ("tan", f64::tan),
    ("asin", f64::asin),
    ("acos", f64::acos),
    ("atan", f64::atan),
    ("sinh", f64::sinh),
    ("cosh", f64::cosh),
    ("tanh", f64::tanh),
    ("exp", f64::exp),
    ("log", f64::ln),
    ("ln", f64::ln),
    ("log10", f64::log10),
    ("sqrt", f64::sqrt),
    ("cbrt", f64::cbrt),
    ("abs", f64::abs),
    ("sign", |x| if x == 0.0 { 0.0 } else { x.signum() }),
    ("floor", f64::floor),
    ("ceil", f64::ceil),
    ("round", f64::round),
    // 0 before, 1 from 0 on.
    ("step", |x| f64::from(u8::from(x >= 0.0))),
];
/// Functions of two.
const TWO: [(&str, Two); 4] =
    [("min", f64::min), ("max", f64::max), ("atan2", f64::atan2), ("mod", f64::rem_euclid)];
const CONSTANTS: [(&str, f64); 4] = [("PI", PI), ("pi", PI), ("E", E), ("e", E)];

/// No formula is longer, none goes deeper.
const MOST: usize = 2000;
const DEEPEST: usize = 60;

impl Expression {
    pub(crate) fn constant(value: f64) -> Self {
        Self { steps: Arc::new([Step::Number(value)]), table: None, fault: Arc::default() }
    }

    /// Value of a column of `table` at the time that the variable with this number is.
    pub(crate) fn column(table: &Arc<TimeTable>, column: usize, variable: usize) -> Self {
        let steps = Arc::new([Step::Variable(variable), Step::Column(column)]);
        Self { steps, table: Some(table.clone()), fault: Arc::default() }
    }

    /// Understands `text` as a formula of `variables`; the error is the rest of a sentence that begins "the formula …".
    pub(crate) fn new(text: &str, variables: &[&str]) -> Result<Self, String> {
        if text.chars().count() > MOST {
            return Err(format!("is longer than {MOST} characters"));
        }
        let mut parser = Parser { rest: text, variables, steps: Vec::new(), depth: 0 };
        parser.sum()?;
        parser.blanks();
        if let Some(c) = parser.rest.chars().next() {
            return Err(format!(
                "cannot be understood from \"{c}\" on, {} characters before its end",
                parser.rest.chars().count()
            ));
        }
        let formula = Self { steps: parser.steps.into(), table: None, fault: Arc::default() };
        if formula.fixed().is_some() {
            let value = formula.at(&[]);
            if !value.is_finite() {
                return Err(format!("is {value}; give one with a finite value"));
            }
            return Ok(Self::constant(value));
        }
        Ok(formula)
    }

    /// Its value; not a number if it has none there.
    pub(crate) fn at(&self, variables: &[f64]) -> f64 {
        // Every level of brackets and of precedence holds one number at most.
        let mut stack = [0.0; 4 * (DEEPEST + 1)];
        let mut top = 0;
        for step in &*self.steps {
            match *step {
                Step::Number(x) => {
                    stack[top] = x;
                    top += 1;
                }
                Step::Variable(v) => {
                    stack[top] = variables.get(v).copied().unwrap_or(f64::NAN);
                    top += 1;
                }
                Step::Negate => stack[top - 1] = -stack[top - 1],
                Step::One(f) => stack[top - 1] = f(stack[top - 1]),
                Step::Column(c) => {
                    stack[top - 1] =
                        self.table.as_ref().map_or(f64::NAN, |table| table.at(c, stack[top - 1]));
                }
                two => {
                    top -= 1;
                    let (a, b) = (stack[top - 1], stack[top]);
                    stack[top - 1] = match two {
                        Step::Add => a + b,
                        Step::Subtract => a - b,
                        Step::Multiply => a * b,
                        Step::Divide => a / b,
                        // Squares by products, to the bit.
                        Step::Power if b == 2.0 => a * a,
                        Step::Power => a.powf(b),
                        Step::Two(f) => f(a, b),
                        _ => f64::NAN,
                    };
                }
            }
        }
        stack[0]
    }

    /// Its value as a run needs it: whether it is finite is remembered.
    pub(crate) fn needed(&self, variables: &[f64]) -> f64 {
        let value = self.at(variables);
        if !value.is_finite() {
            let given = std::array::from_fn(|i| variables.get(i).copied().unwrap_or(0.0));
            let _ = self.fault.set((given, value));
        }
        value
    }

    /// The first variables and value of [`needed`](Self::needed) that were not finite.
    pub(crate) fn fault(&self) -> Option<([f64; 4], f64)> {
        self.fault.get().copied()
    }

    /// Whether it depends on the variable with this number.
    pub(crate) fn uses(&self, variable: usize) -> bool {
        self.steps.iter().any(|step| matches!(step, Step::Variable(v) if *v == variable))
    }

    /// Its value if it is the same everywhere.
    pub(crate) fn fixed(&self) -> Option<f64> {
        let varies = self.steps.iter().any(|step| matches!(step, Step::Variable(_)));
        (!varies).then(|| self.at(&[]))
    }
}

struct Parser<'a> {
    rest: &'a str,
    variables: &'a [&'a str],
    steps: Vec<Step>,
    depth: usize,
}

impl<'a> Parser<'a> {
    fn blanks(&mut self) {
        self.rest = self.rest.trim_start();
    }
    /// Takes `c` if it is next.
    fn takes(&mut self, c: char) -> bool {
        self.blanks();
        let rest = self.rest.strip_prefix(c);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    fn sum(&mut self) -> Result<(), String> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(format!("goes deeper than {DEEPEST} brackets or signs within one another"));
        }
        self.product()?;
        loop {
            let step = if self.takes('+') {
                Step::Add
            } else if self.takes('-') {
                Step::Subtract
            } else {
                self.depth -= 1;
                return Ok(());
            };
            self.product()?;
            self.steps.push(step);
        }
    }

    fn product(&mut self) -> Result<(), String> {
        self.sign()?;
        loop {
            let step = if self.takes('*') {
                Step::Multiply
            } else if self.takes('/') {
                Step::Divide
            } else {
                return Ok(());
            };
            self.sign()?;
            self.steps.push(step);
        }
    }

    fn sign(&mut self) -> Result<(), String> {
        let mut negative = false;
        loop {
            if self.takes('-') {
                negative = !negative;
            } else if !self.takes('+') {
                break;
            }
        }
        self.power()?;
        if negative {
            self.steps.push(Step::Negate);
        }
        Ok(())
    }

    fn power(&mut self) -> Result<(), String> {
        self.atom()?;
        if self.takes('^') {
            // Powers of powers go deeper.
            self.depth += 1;
            if self.depth > DEEPEST {
                return Err(format!("goes deeper than {DEEPEST} powers of powers"));
            }
            self.sign()?;
            self.depth -= 1;
            self.steps.push(Step::Power);
        }
        Ok(())
    }

    fn atom(&mut self) -> Result<(), String> {
        if self.takes('(') {
            self.sum()?;
            return if self.takes(')') { Ok(()) } else { Err("lacks a closing bracket".into()) };
        }
        let first =
            self.rest.chars().next().ok_or("ends where a number, a variable or a bracket is needed")?;
        if first.is_ascii_digit() || first == '.' {
            return self.number();
        }
        let name: &'a str = {
            let end =
                self.rest.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).unwrap_or(self.rest.len());
            &self.rest[..end]
        };
        if name.is_empty() {
            return Err(format!("has \"{first}\" where a number, a variable or a bracket is needed"));
        }
        self.rest = &self.rest[name.len()..];
        if let Some(v) = self.variables.iter().position(|variable| *variable == name) {
            self.steps.push(Step::Variable(v));
        } else if let Some((_, value)) = CONSTANTS.iter().find(|(constant, _)| *constant == name) {
            self.steps.push(Step::Number(*value));
        } else if let Some((_, f)) = ONE.iter().find(|(function, _)| *function == name) {
            self.arguments(name, 1)?;
            self.steps.push(Step::One(*f));
        } else if let Some((_, f)) = TWO.iter().find(|(function, _)| *function == name) {
            self.arguments(name, 2)?;
            self.steps.push(Step::Two(*f));
        } else {
            let functions: Vec<_> = ONE.iter().map(|(n, _)| *n).chain(TWO.iter().map(|(n, _)| *n)).collect();
            let variables = match self.variables {
                [] => String::new(),
                variables => format!("a variable ({}), nor ", variables.join(", ")),
            };
            return Err(format!(
                "asks for \"{name}\", which is neither {variables}PI or E, nor a function ({})",
                functions.join(", ")
            ));
        }
        Ok(())
    }

    fn arguments(&mut self, name: &str, number: usize) -> Result<(), String> {
        let wants = || {
            format!(
                "has \"{name}\" without its {number} argument{} in brackets",
                if number > 1 { "s" } else { "" }
            )
        };
        if !self.takes('(') {
            return Err(wants());
        }
        for i in 0..number {
            if i > 0 && !self.takes(',') {
                return Err(wants());
            }
            self.sum()?;
        }
        if self.takes(')') { Ok(()) } else { Err(wants()) }
    }

    fn number(&mut self) -> Result<(), String> {
        let bytes = self.rest.as_bytes();
        let digits = |mut i: usize| {
            while bytes.get(i).is_some_and(u8::is_ascii_digit) {
                i += 1;
            }
            i
        };
        let mut end = digits(0);
        if bytes.get(end) == Some(&b'.') {
            end = digits(end + 1);
        }
        if matches!(bytes.get(end), Some(b'e' | b'E')) {
            let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
            let exponent = digits(end + 1 + sign);
            if exponent > end + 1 + sign {
                end = exponent;
            }
        }
        let (text, rest) = self.rest.split_at(end);
        let value: f64 = text.parse().map_err(|_| format!("has {text:?}, which is no number"))?;
        self.steps.push(Step::Number(value));
        self.rest = rest;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn f(text: &str) -> Expression {
        Expression::new(text, &["x", "y", "z", "t"]).unwrap_or_else(|e| panic!("{text} {e}"))
    }

    #[test]
    fn formulas_are_evaluated() {
        let at = |text: &str| f(text).at(&[3.0, 0.205, 0.0, 0.5]);
        assert!((at("1.5*4*y*(0.41-y)/0.41^2") - 1.5).abs() < 1e-15);
        for (text, value) in [
            ("x - 2*t", 2.0),
            ("-x^2", -9.0),
            ("2*(-x^2) + 3 - -x^2", -6.0),
            ("2 * -x^2", -18.0),
            ("1e-3*2^-x", 1.25e-4),
            ("2-3-4", -5.0),
            ("12/3/2", 2.0),
            ("2^3^2", 512.0),
            ("min(t, 1) + max(-x, -1)", -0.5),
            (" ( +x ) ", 3.0),
            ("atan2(0, -1) - PI", 0.0),
            ("mod(-1, x)", 2.0),
            (".5e1 - 2.E-0", 3.0),
            ("step(t - 0.5)*sign(z)", 0.0),
            ("--x", 3.0),
        ] {
            assert_eq!(at(text), value, "{text}");
        }
        assert_eq!(f("2*PI").fixed(), Some(std::f64::consts::TAU));
        assert_eq!(f("2*t").fixed(), None);
        assert!(f("log(x)").at(&[-1.0]).is_nan());
    }

    #[test]
    fn what_is_no_formula_is_told() {
        let told = |text: &str| Expression::new(text, &["t"]).err().unwrap_or_else(|| panic!("{text}"));
        for (text, part) in [
            ("2*x", "\"x\""),
            ("2*(t", "closing bracket"),
            ("", "ends where"),
            ("t +", "ends where"),
            ("2t", "from \"t\" on"),
            ("sin t", "1 argument "),
            ("min(t)", "2 arguments"),
            ("1/0", "finite"),
            ("t # 2", "from \"#\" on"),
            ("..5", "no number"),
        ] {
            assert!(told(text).contains(part), "{text}: {}", told(text));
        }
        let deep = |n: usize, open: &str, close: &str| format!("{}t{}", open.repeat(n), close.repeat(n));
        assert!(told(&deep(500, "(", ")")).contains("deeper"));
        assert!(told(&deep(300, "2^", "")).contains("deeper"));
        assert!(told(&deep(3000, "-", "")).contains("longer"));
        let nested = Expression::new(&deep(50, "1+2*(3^(", "))"), &["t"]);
        assert!(nested.is_err() || nested.is_ok_and(|f| !f.at(&[1.0]).is_nan()));
    }

    proptest! {
        /// Whatever is written, there is an answer, and formulas that are understood have a value.
        #[test]
        fn nothing_panics(text in "[-+*/^(), .0-9xytePIsinmaxogr]{0,60}") {
            if let Ok(formula) = Expression::new(&text, &["x", "y", "z", "t"]) {
                let _ = formula.at(&[0.1, 0.2, 0.3, 0.4]);
            }
        }
    }
}
