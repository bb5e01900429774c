//! Adaptive quadrature by the rules of Gauss (7 points) and Kronrod (15 points).

const NODES: [f64; 8] = [
    0.991_455_371_120_812_6,
    0.949_107_912_342_758_5,
    0.864_864_423_359_769_1,
    0.741_531_185_599_394_4,
    0.586_087_235_467_691_1,
    0.405_845_151_377_397_2,
    0.207_784_955_007_898_47,
    0.0,
];
const KRONROD: [f64; 8] = [
    0.022_935_322_010_529_224,
    0.063_092_092_629_978_55,
    0.104_790_010_322_250_18,
    0.140_653_259_715_525_92,
    0.169_004_726_639_267_9,
    0.190_350_578_064_785_4,
    0.204_432_940_075_298_9,
    0.209_482_141_084_727_82,
];
const GAUSS: [f64; 4] =
    [0.129_484_966_168_869_7, 0.279_705_391_489_276_64, 0.381_830_050_505_118_9, 0.417_959_183_673_469_4];

/// Pieces at the start, so that narrow peaks are sampled.
const PIECES: usize = 8;

/// ∫ f over a range to an absolute error.
pub(crate) fn integrate([low, high]: [f64; 2], error: f64, f: &impl Fn(f64) -> f64) -> f64 {
    let place = |i: usize| low + (high - low) * i as f64 / PIECES as f64;
    (0..PIECES).map(|i| halves([place(i), place(i + 1)], error / PIECES as f64, 40, f)).sum()
}

/// ∫ f to an absolute error between breaks, beside which f may be a function of the square root of the distance.
pub(crate) fn integrate_between(breaks: &[f64], error: f64, f: &impl Fn(f64) -> f64) -> f64 {
    let piece = |ends: &[f64]| {
        let (middle, half) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
        let smooth = |u: f64| 1.5 * half * (1.0 - u * u) * f(middle + 0.5 * half * u * (3.0 - u * u));
        if half > 0.0 { halves([-1.0, 1.0], error, 40, &smooth) } else { 0.0 }
    };
    breaks.windows(2).map(piece).sum()
}

fn halves([low, high]: [f64; 2], error: f64, depth: u32, f: &impl Fn(f64) -> f64) -> f64 {
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let (mut gauss, mut kronrod) = (0.0, 0.0);
    for i in 0..8 {
        let x = half * NODES[i];
        let value = if i == 7 { f(middle) } else { f(middle - x) + f(middle + x) };
        kronrod += KRONROD[i] * value;
        if i % 2 == 1 {
            gauss += GAUSS[i / 2] * value;
        }
    }
    let (gauss, kronrod) = (gauss * half, kronrod * half);
    let rounding = 1e-15 * kronrod.abs();
    if depth == 0 || (gauss - kronrod).abs() <= error.max(rounding) {
        return kronrod;
    }
    halves([low, middle], 0.6 * error, depth - 1, f) + halves([middle, high], 0.6 * error, depth - 1, f)
}
