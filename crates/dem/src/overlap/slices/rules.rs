//! Quadrature rules that share their places.

/// Rules of 3, 7 and 15 points on \[−1, 1\] (Patterson 1968, Math. Comput. 22, 847), exact for degrees 5, 11 and 23: places
/// and the weights in these rules. The places of the rule of 7 points come first.
pub(super) const RULES: [[f64; 4]; 15] = [
    [-0.9604912687080203, 0.0, 0.10465622602646726, 0.05160328299707974],
    [-0.7745966692414834, 0.5555555555555556, 0.2684880898683334, 0.13441525524378423],
    [-0.43424374934680254, 0.0, 0.4013974147759622, 0.20062852937698902],
    [0.0, 0.888888888888889, 0.45091653865847414, 0.2255104997982067],
    [0.43424374934680254, 0.0, 0.4013974147759622, 0.20062852937698902],
    [0.7745966692414834, 0.5555555555555556, 0.2684880898683334, 0.13441525524378423],
    [0.9604912687080203, 0.0, 0.10465622602646726, 0.05160328299707974],
    [-0.993831963212755, 0.0, 0.0, 0.01700171962994026],
    [-0.888459232872257, 0.0, 0.0, 0.09292719531512454],
    [-0.6211029467372264, 0.0, 0.0, 0.1715119091363914],
    [-0.2233866864289669, 0.0, 0.0, 0.2191568584015875],
    [0.2233866864289669, 0.0, 0.0, 0.2191568584015875],
    [0.6211029467372264, 0.0, 0.0, 0.1715119091363914],
    [0.888459232872257, 0.0, 0.0, 0.09292719531512454],
    [0.993831963212755, 0.0, 0.0, 0.01700171962994026],
];

/// A column of seven or eight rows from one on; zeros fill it up.
pub(super) const fn column(from: usize, which: usize) -> [f64; 8] {
    let (mut column, mut i) = ([0.0; 8], 0);
    while i < 8 && (from > 0 || i < 7) {
        column[i] = RULES[from + i][which];
        i += 1;
    }
    column
}

/// What the rule of 7 points is guessed to miss of an integrand with these values at its places: with the sizes of the Legendre
/// coefficients of low and of higher degree, geometric decay leads to the first one that it cannot see.
pub(super) fn missed(values: &[f64]) -> f64 {
    let (mut low, mut high) = ([0.0; 2], [0.0; 2]);
    for (f, [x, _, w, _]) in values.iter().zip(&RULES[..7]) {
        let (f, x2) = (f * w, x * x);
        low[0] += f * x;
        low[1] += f * (1.5 * x2 - 0.5);
        high[0] += f * ((4.375 * x2 - 3.75) * x2 + 0.375);
        high[1] += f * ((7.875 * x2 - 8.75) * x2 + 1.875) * x;
    }
    let size = |[p, q]: [f64; 2], degree: f64| degree * p.abs().max(q.abs());
    let (low, high) = (size(low, 2.0), size(high, 5.0));
    if high == 0.0 {
        return 0.0;
    }
    high * (high / low).min(1.0).powi(2)
}
