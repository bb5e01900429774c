//! How sizes are distributed.
use super::MOST;
use super::error::{PlacingError, finite, positive};
use super::source::Source;

/// What fractions of a distribution count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Basis {
    /// Bodies.
    #[default]
    Number,
    /// Mass of bodies of one shape and density, which grows with the third power of the size.
    Mass,
    /// Mass in a plane scene, which grows with the second power of the size.
    PlaneMass,
}

impl Basis {
    /// The power of the size that divides a fraction of mass to make one of number of it.
    fn power(self) -> f64 {
        match self {
            Self::Number => 0.0,
            Self::Mass => 3.0,
            Self::PlaneMass => 2.0,
        }
    }
}

/// A distribution of sizes (diameters, say) \[m\]. What is drawn from it depends on the seed only, bit for bit on any machine.
///
/// ```
/// use dem::placing::{Basis, SizeDistribution};
///
/// // Half of the mass is in grains of 1 mm, half in grains of 2 mm: eight times as many small ones.
/// let sieve = [(1e-3, 0.0), (1e-3, 0.5), (2e-3, 0.5), (2e-3, 1.0)];
/// let sizes = SizeDistribution::table(&sieve, Basis::Mass)?.sample(9000, 1);
/// let small = sizes.iter().filter(|d| **d < 1.5e-3).count();
/// assert!((small as f64 / 9000.0 - 8.0 / 9.0).abs() < 0.01);
/// # Ok::<(), dem::placing::PlacingError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SizeDistribution {
    law: Law,
    /// Nothing is drawn outside.
    bounds: [f64; 2],
}

#[derive(Clone, Debug, PartialEq)]
enum Law {
    Constant,
    /// Density ∝ size^(p−1) between the bounds.
    Power {
        p: f64,
    },
    Normal {
        mean: f64,
        deviation: f64,
    },
    /// Deviation is that of the logarithm.
    LogNormal {
        median: f64,
        deviation: f64,
    },
    /// 1 − exp(−(size/scale)^shape); (low/scale)^shape, and what of the rest is below the upper bound.
    Weibull {
        scale: f64,
        shape: f64,
        start: f64,
        share: f64,
    },
    /// Bins one after the other.
    Bins {
        bins: Vec<Bin>,
        p: f64,
    },
}

/// Sizes between two bounds, with the fraction of all numbers up to its end.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Bin {
    bounds: [f64; 2],
    until: f64,
}

/// Bounds must hold at least this share of a distribution that is drawn again outside of them.
const SHARE: f64 = 1e-3;
/// After so many sizes it is known whether there would be more, if they would be so many times too many.
const SAMPLE: usize = 10_000;
const CERTAIN: f64 = 100.0;
/// Bins that a Weibull distribution of mass is divided into.
const BINS: usize = 2000;

impl SizeDistribution {
    /// All of one `size`.
    ///
    /// # Errors
    /// [`PlacingError::Parameter`] unless it is positive and finite.
    pub fn constant(size: f64) -> Result<Self, PlacingError> {
        let size = positive("size", size)?;
        Ok(Self { law: Law::Constant, bounds: [size, size] })
    }
    /// The same number in every interval of the same length.
    ///
    /// # Errors
    /// [`PlacingError::Sizes`] unless 0 < low < high < ∞.
    pub fn uniform(low: f64, high: f64) -> Result<Self, PlacingError> {
        Self::power_law(0.0, [low, high])
    }
    /// Number density ∝ size^`exponent`; −1 has the same number in every octave, −3.5 is that of ground rock.
    ///
    /// # Errors
    /// [`PlacingError::Sizes`] unless 0 < low < high < ∞, [`PlacingError::Parameter`] unless the exponent is finite.
    pub fn power_law(exponent: f64, bounds: [f64; 2]) -> Result<Self, PlacingError> {
        let p = finite("exponent of the power law", exponent)? + 1.0;
        Ok(Self { law: Law::Power { p }, bounds: finite_bounds(bounds)? })
    }
    /// Normal with this `mean` and standard `deviation`; what falls outside the bounds is drawn again, which moves the mean unless
    /// they are symmetric about it.
    ///
    /// # Errors
    /// [`PlacingError::Parameter`] unless the deviation is positive and both are finite, [`PlacingError::Sizes`] unless
    /// 0 < low < high, [`PlacingError::Tail`] if the bounds hold less than 1e-3 of the distribution.
    pub fn normal(mean: f64, deviation: f64, bounds: [f64; 2]) -> Result<Self, PlacingError> {
        let mean = finite("mean of the sizes", mean)?;
        let deviation = positive("standard deviation of the sizes", deviation)?;
        check_bounds(bounds)?;
        held(bounds, |size| (size - mean) / deviation)?;
        Ok(Self { law: Law::Normal { mean, deviation }, bounds })
    }
    /// Log-normal by number with this `median` and geometric standard deviation (the ratio of the size below which 84.1 % are to the
    /// median); what falls outside the bounds is drawn again. `[0.0, f64::INFINITY]` cuts off nothing.
    ///
    /// A median by mass is exp(3 ln² σ) times the one by number, and exp(2 ln² σ) times in plane scenes (Hatch & Choate 1929).
    ///
    /// # Errors
    /// [`PlacingError::Parameter`] unless the median is positive and the deviation above 1, [`PlacingError::Sizes`] unless
    /// 0 ≤ low < high, [`PlacingError::Tail`] if the bounds hold less than 1e-3 of the distribution.
    pub fn log_normal(median: f64, geometric_deviation: f64, bounds: [f64; 2]) -> Result<Self, PlacingError> {
        let median = positive("median of the sizes", median)?;
        if !(geometric_deviation.is_finite() && geometric_deviation > 1.0) {
            return Err(PlacingError::Parameter {
                what: "geometric standard deviation of the sizes",
                value: geometric_deviation,
                remedy: "give a finite ratio above 1 (1.5, say)",
            });
        }
        let deviation = libm::log(geometric_deviation);
        open_bounds(bounds)?;
        held(bounds, |size| (libm::log(size) - libm::log(median)) / deviation)?;
        Ok(Self { law: Law::LogNormal { median, deviation }, bounds })
    }
    /// Weibull, as a distribution of mass also called that of Rosin and Rammler: the fraction of larger ones is
    /// exp(−(size/`scale`)^`shape`). What is outside of the bounds is left out. As a distribution of mass it needs a lower bound
    /// above zero, since the number below any size is infinite else (shapes up to 3); it is then made of 2000 bins.
    ///
    /// # Errors
    /// [`PlacingError::Parameter`] unless scale and shape are positive and finite, [`PlacingError::Sizes`] for bounds that hold
    /// nothing or do not fit the basis.
    pub fn weibull(scale: f64, shape: f64, bounds: [f64; 2], basis: Basis) -> Result<Self, PlacingError> {
        let scale = positive("scale of the Weibull distribution", scale)?;
        let shape = positive("shape of the Weibull distribution", shape)?;
        let [low, high] = open_bounds(bounds)?;
        let power = |size: f64| libm::pow(size / scale, shape);
        let start = power(low);
        // 1 − exp(−(t_high − t_low)): of what is above the lower bound, the share below the upper one.
        let share = -libm::expm1(start - power(high));
        let held = libm::exp(-start) * share;
        let some = held > 1e-100;
        if !some {
            let remedy = "the distribution has nothing there; move the bounds towards its scale";
            return Err(PlacingError::Sizes { low, high, remedy });
        }
        let whole = Self { law: Law::Weibull { scale, shape, start, share }, bounds };
        if basis == Basis::Number {
            return Ok(whole);
        }
        if low == 0.0 {
            let remedy = "give a lower bound above zero for a distribution of mass";
            return Err(PlacingError::Sizes { low, high, remedy });
        }
        // Equal ratios of sizes; beyond the upper end is less than 1e-16 of the mass.
        let high = high.min(whole.quantile(1.0 - f64::EPSILON));
        let ratio = libm::log(high / low) / BINS as f64;
        let rows: Vec<_> = (0..=BINS)
            .map(|i| match i {
                0 => (low, 0.0),
                BINS => (high, 1.0),
                _ => {
                    let size = low * libm::exp(ratio * i as f64);
                    (size, libm::expm1(start - power(size)) / -share)
                }
            })
            .collect();
        Self::table(&rows, basis)
    }
    /// From rows of sizes and the cumulative fraction up to them, as a sieve gives them; the first fraction is 0, the last one 1.
    /// Between two rows the fraction grows evenly with the size; where a size stands twice, that fraction has just this size.
    ///
    /// A fraction of mass m between sizes a and b holds a number ∝ m ∫ s⁻³ ds/(b − a) = m (a + b)/(2a²b²), and m/(ab) in a plane
    /// scene, where s⁻² takes the place of s⁻³.
    ///
    /// # Errors
    /// [`PlacingError::Table`] unless sizes are positive and finite, and both columns go up from row to row.
    pub fn table(rows: &[(f64, f64)], basis: Basis) -> Result<Self, PlacingError> {
        check_table(rows)?;
        let mut bins = Vec::with_capacity(rows.len());
        // Sizes relative to the smallest one that there is any of, so that no power of them is beyond what numbers hold.
        let first = rows.windows(2).position(|pair| pair[1].1 > 0.0).unwrap_or(0);
        let (unit, mut sum) = (rows[first].0, 0.0);
        for pair in rows.windows(2) {
            let (a, b, m) = (pair[0].0 / unit, pair[1].0 / unit, pair[1].1 - pair[0].1);
            if m > 0.0 {
                let number = match basis {
                    Basis::Number => m,
                    Basis::Mass => 0.5 * m * (1.0 / a + 1.0 / b) / a / b,
                    Basis::PlaneMass => m / a / b,
                };
                sum += number.max(f64::MIN_POSITIVE);
            }
            bins.push(Bin { bounds: [pair[0].0, pair[1].0], until: sum });
        }
        for bin in &mut bins {
            bin.until /= sum;
        }
        let bounds = [rows[0].0, rows[rows.len() - 1].0];
        Ok(Self { law: Law::Bins { bins, p: 1.0 - basis.power() }, bounds })
    }

    /// An endless row of sizes, drawn with `seed`.
    pub fn sizes(&self, seed: u64) -> impl Iterator<Item = f64> + '_ {
        let mut source = Source::new(seed);
        std::iter::repeat_with(move || self.draw(&mut source))
    }
    /// As many sizes, drawn with `seed`.
    pub fn sample(&self, number: usize, seed: u64) -> Vec<f64> {
        self.sizes(seed).take(number).collect()
    }
    /// Sizes, drawn with `seed`, as long as the sum of their `measure`s, volumes for instance, stays within `total`.
    ///
    /// # Errors
    /// [`PlacingError::Parameter`] for a total or a measure that is not positive and finite, [`PlacingError::TooMany`] from 10⁷ sizes on.
    pub fn until(
        &self,
        total: f64,
        measure: impl Fn(f64) -> f64,
        seed: u64,
    ) -> Result<Vec<f64>, PlacingError> {
        positive("total to be filled with bodies", total)?;
        let (mut sum, mut out) = (0.0, Vec::new());
        for size in self.sizes(seed) {
            sum += positive("measure of a body", measure(size))?;
            if sum > total {
                break;
            }
            let number = total / sum * out.len() as f64;
            if out.len() >= MOST || out.len() == SAMPLE && number > CERTAIN * MOST as f64 {
                return Err(PlacingError::TooMany { what: "bodies", number, most: MOST as f64 });
            }
            out.push(size);
        }
        Ok(out)
    }

    fn draw(&self, source: &mut Source) -> f64 {
        let [low, high] = self.bounds;
        let mut within = |size: &mut dyn FnMut(f64) -> f64| loop {
            let x = size(source.normal());
            if x >= low && x <= high && x > 0.0 {
                return x;
            }
        };
        match self.law {
            Law::Constant => low,
            Law::Normal { mean, deviation } => within(&mut |z| mean + deviation * z),
            Law::LogNormal { median, deviation } => within(&mut |z| median * libm::exp(deviation * z)),
            _ => self.quantile(source.unit()),
        }
    }
    /// The size below which the fraction `u` of all is, of laws that are drawn so.
    fn quantile(&self, u: f64) -> f64 {
        let [low, high] = self.bounds;
        let size = match &self.law {
            Law::Power { p } => power_quantile(self.bounds, *p, u),
            Law::Weibull { scale, shape, start, share } => {
                let t = start - libm::log1p(-u * share);
                scale * libm::pow(t, 1.0 / shape)
            }
            Law::Bins { bins, p } => {
                let i = bins.partition_point(|bin| bin.until <= u).min(bins.len() - 1);
                let from = if i == 0 { 0.0 } else { bins[i - 1].until };
                let v = (u - from) / (bins[i].until - from);
                power_quantile(bins[i].bounds, *p, v.clamp(0.0, 1.0))
            }
            Law::Constant | Law::Normal { .. } | Law::LogNormal { .. } => low,
        };
        size.clamp(low.max(f64::MIN_POSITIVE), high)
    }
}

/// The size below which the fraction `u` is where the density is ∝ size^(p−1): from the end where most are, so that no power is
/// beyond what numbers hold.
fn power_quantile([low, high]: [f64; 2], p: f64, u: f64) -> f64 {
    let span = libm::log(high / low);
    let size = if (p * span).abs() < 1e-12 {
        low * libm::exp(u * span)
    } else if p > 0.0 {
        high * libm::exp(libm::log1p((1.0 - u) * libm::expm1(-p * span)) / p)
    } else {
        low * libm::exp(libm::log1p(u * libm::expm1(p * span)) / p)
    };
    size.clamp(low, high)
}

fn check_bounds([low, high]: [f64; 2]) -> Result<[f64; 2], PlacingError> {
    if low > 0.0 && low < high {
        Ok([low, high])
    } else {
        Err(PlacingError::Sizes {
            low,
            high,
            remedy: "give a lower bound above zero and an upper one above it",
        })
    }
}
fn finite_bounds([low, high]: [f64; 2]) -> Result<[f64; 2], PlacingError> {
    if high == f64::INFINITY {
        return Err(PlacingError::Sizes { low, high, remedy: "give a finite upper bound" });
    }
    check_bounds([low, high])
}
/// Bounds of laws that have no size of zero.
fn open_bounds([low, high]: [f64; 2]) -> Result<[f64; 2], PlacingError> {
    if low == 0.0 && high > 0.0 { Ok([0.0, high]) } else { check_bounds([low, high]) }
}

/// Whether bounds hold enough of a normal distribution, given what makes it the standard one.
fn held([low, high]: [f64; 2], standard: impl Fn(f64) -> f64) -> Result<(), PlacingError> {
    let above = |z: f64| 0.5 * libm::erfc(z * std::f64::consts::FRAC_1_SQRT_2);
    let (a, b) = (standard(low), standard(high));
    // From the side where both are small, so that they do not cancel.
    let share = if a > 0.0 { above(a) - above(b) } else { above(-b) - above(-a) };
    if share >= SHARE { Ok(()) } else { Err(PlacingError::Tail { low, high, share: share.max(0.0) }) }
}

fn check_table(rows: &[(f64, f64)]) -> Result<(), PlacingError> {
    let fail = |row: usize, problem| {
        let (size, fraction) = rows.get(row).copied().unwrap_or((f64::NAN, f64::NAN));
        Err(PlacingError::Table { row, size, fraction, problem })
    };
    if rows.len() < 2 {
        return fail(rows.len(), "is missing; give two rows or more");
    }
    for (i, &(size, fraction)) in rows.iter().enumerate() {
        if !(size.is_finite() && size > 0.0) {
            return fail(i, "has no positive, finite size");
        }
        if !(0.0..=1.0).contains(&fraction) {
            return fail(i, "has no fraction from 0 to 1");
        }
        if i > 0 && (size < rows[i - 1].0 || fraction < rows[i - 1].1) {
            return fail(i, "goes below the row before; sort the rows and give cumulative fractions");
        }
    }
    if rows[0].1 != 0.0 {
        return fail(0, "is the first one; its fraction must be 0, at the size below which there is nothing");
    }
    if rows[rows.len() - 1].1 != 1.0 {
        return fail(rows.len() - 1, "is the last one; its fraction must be 1");
    }
    Ok(())
}
