//! Polynomials beside the radial functions.

/// All monomials in d variables of degree up to a given one.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tail {
    /// Of every monomial, one exponent for each variable.
    exponents: Vec<Vec<u8>>,
}

impl Tail {
    /// None of them for the degree None.
    pub(super) fn new(variables: usize, degree: Option<usize>) -> Self {
        let Some(degree) = degree else { return Self { exponents: vec![] } };
        let mut exponents = vec![vec![]];
        for _ in 0..variables {
            exponents = exponents
                .into_iter()
                .flat_map(|done: Vec<u8>| {
                    let used: usize = done.iter().map(|&e| usize::from(e)).sum();
                    (0..=degree - used).map(move |e| [done.as_slice(), &[e as u8]].concat())
                })
                .collect();
        }
        exponents.sort_by_key(|e| e.iter().map(|&e| u32::from(e)).sum::<u32>());
        Self { exponents }
    }
    pub(super) fn len(&self) -> usize {
        self.exponents.len()
    }
    /// Monomial `i` at z.
    pub(super) fn value(&self, i: usize, z: &[f64]) -> f64 {
        self.exponents[i].iter().zip(z).map(|(&e, z)| z.powi(e.into())).product()
    }
    /// Its derivative along variable `along`.
    pub(super) fn slope(&self, i: usize, along: usize, z: &[f64]) -> f64 {
        let factor = |(j, (&e, z)): (usize, (&u8, &f64))| match (j == along, e) {
            (false, _) => z.powi(e.into()),
            (true, 0) => 0.0,
            (true, _) => f64::from(e) * z.powi(i32::from(e) - 1),
        };
        self.exponents[i].iter().zip(z).enumerate().map(factor).product()
    }
}
