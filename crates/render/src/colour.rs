//! Colours: two maps of equal perceptual steps and a set of line colours that survives colour blindness.

/// Red, green and blue.
pub(crate) type Colour = [u8; 3];

pub(crate) const BLACK: Colour = [0, 0, 0];
pub(crate) const INK: Colour = [38, 38, 38];
pub(crate) const WHITE: Colour = [255, 255, 255];
pub(crate) const GRID: Colour = [229, 229, 229];

/// Lines of the bodies (Okabe and Ito's set), taken in turn.
const LINES: [Colour; 6] =
    [[0, 114, 178], [213, 94, 0], [0, 158, 115], [204, 121, 167], [86, 180, 233], [230, 159, 0]];

/// The line colour of body `index`.
pub(crate) fn line(index: usize) -> Colour {
    LINES[index % LINES.len()]
}

/// Viridis (by N. Smith and S. van der Walt, CC0) at 33 equal steps.
#[rustfmt::skip]
const VIRIDIS: [Colour; 33] = [
    [68, 1, 84], [71, 13, 96], [72, 24, 106], [72, 35, 116], [71, 45, 123], [69, 55, 129],
    [66, 64, 134], [62, 73, 137], [59, 82, 139], [55, 91, 141], [51, 99, 141], [47, 107, 142],
    [44, 114, 142], [41, 122, 142], [38, 130, 142], [35, 137, 142], [33, 145, 140], [31, 152, 139],
    [31, 160, 136], [34, 167, 133], [40, 174, 128], [50, 182, 122], [63, 188, 115], [78, 195, 107],
    [94, 201, 98], [112, 207, 87], [132, 212, 75], [152, 216, 62], [173, 220, 48], [194, 223, 35],
    [216, 226, 25], [236, 229, 27], [253, 231, 37],
];

/// From white to a deep blue-grey, at equal steps of lightness.
const SLATE: [Colour; 5] = [[255, 255, 255], [199, 205, 214], [145, 156, 173], [92, 107, 131], [39, 60, 91]];

/// From a deep blue over white to a deep red, at equal steps of lightness to both sides.
const SEISMIC: [Colour; 7] = [
    [5, 48, 97],
    [67, 133, 187],
    [171, 208, 230],
    [255, 255, 255],
    [246, 178, 147],
    [208, 88, 76],
    [103, 0, 31],
];

/// A colour map as 256 entries.
#[derive(Clone)]
pub(crate) struct Map([Colour; 256]);

impl Map {
    /// For magnitudes: dark violet over green to yellow.
    pub(crate) fn viridis() -> Self {
        Self::through(&VIRIDIS)
    }

    /// For fractions: white to slate.
    pub(crate) fn slate() -> Self {
        Self::through(&SLATE)
    }

    /// For what has a sign: blue over white to red.
    pub(crate) fn signed() -> Self {
        Self::through(&SEISMIC)
    }

    fn through(knots: &[Colour]) -> Self {
        Self(std::array::from_fn(|entry| {
            let place = entry as f64 / 255.0 * (knots.len() - 1) as f64;
            let knot = (place as usize).min(knots.len() - 2);
            mix(knots[knot], knots[knot + 1], place - knot as f64)
        }))
    }

    /// The colour at `fraction` of the range; what lies outside takes the colour of the end, NaN of the start.
    #[inline]
    pub(crate) fn at(&self, fraction: f64) -> Colour {
        self.0[usize::from((fraction * 255.0 + 0.5) as u8)]
    }

    /// The same for a row of pixels, in single precision.
    pub(crate) fn row(&self, fractions: &[f32], pixels: &mut [Colour]) {
        for (fractions, pixels) in fractions.chunks(64).zip(pixels.chunks_mut(64)) {
            let mut entries = [0; 64];
            entries.iter_mut().zip(fractions).for_each(|(entry, f)| *entry = (f * 255.0 + 0.5) as u8);
            pixels.iter_mut().zip(entries).for_each(|(pixel, entry)| *pixel = self.0[usize::from(entry)]);
        }
    }
}

/// `a` with a share of `b` in it, 0 to 1.
#[inline]
pub(crate) fn mix(a: Colour, b: Colour, share: f64) -> Colour {
    std::array::from_fn(|k| (f64::from(a[k]) + (f64::from(b[k]) - f64::from(a[k])) * share + 0.5) as u8)
}
