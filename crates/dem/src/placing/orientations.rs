//! How bodies are turned.
use super::source::Source;
use interfaces::Rotation;

/// How bodies are turned when they are placed.
///
/// ```
/// use dem::placing::Orientations;
///
/// let turns: Vec<_> = Orientations::Random.of(7).take(1000).collect();
/// // The mean of any body axis is nearly zero.
/// let mean: f64 = turns.iter().map(|r| (r * interfaces::Vector::z()).z).sum::<f64>() / 1000.0;
/// assert!(mean.abs() < 0.1);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Orientations {
    /// Any orientation is as likely as any other.
    #[default]
    Random,
    /// Any angle about z is as likely as any other; what plane scenes have.
    AboutZ,
    /// All alike.
    Fixed(Rotation),
}

impl Orientations {
    /// An endless row of them, drawn with `seed`.
    pub fn of(self, seed: u64) -> impl Iterator<Item = Rotation> {
        let mut source = Source::new(seed);
        std::iter::repeat_with(move || self.draw(&mut source))
    }
    pub(super) fn draw(&self, source: &mut Source) -> Rotation {
        match self {
            Self::Random => source.rotation(false),
            Self::AboutZ => source.rotation(true),
            Self::Fixed(rotation) => *rotation,
        }
    }
}
