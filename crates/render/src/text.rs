//! Text on a canvas, set in an embedded subset of DejaVu Sans 2.37 (Latin-1, Greek, some signs; cut out with
//! fontTools' `pyftsubset`, licence in `DejaVuSans-LICENSE.txt`), so that a picture looks the same wherever it is made.

use std::sync::LazyLock;

use ab_glyph::{Font, FontRef, GlyphId, PxScale, ScaleFont, point};

use crate::canvas::{Canvas, Pixel};
use crate::colour::{Colour, INK};

static FONT: LazyLock<FontRef<'static>> = LazyLock::new(|| {
    FontRef::try_from_slice(include_bytes!("../DejaVuSans-subset.ttf")).expect("the embedded font is sound")
});

/// Height of a capital letter over the font size.
const CAPITAL: f64 = 0.729;

/// How a line of text is set. `align` is the share of the text's width and capital height that lies before
/// the anchor: (0, 0) anchors the left end of the baseline, (0.5, 0.5) the middle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Type {
    pub(crate) size: f64,
    pub(crate) colour: Colour,
    pub(crate) align: (f64, f64),
    /// Reads upwards.
    pub(crate) turned: bool,
}

impl Type {
    /// Dark, level text.
    pub(crate) fn new(size: f64, align: (f64, f64)) -> Self {
        Self { size, colour: INK, align, turned: false }
    }

    /// The same, reading upwards.
    pub(crate) fn turned(self) -> Self {
        Self { turned: true, ..self }
    }

    /// The same in another colour.
    pub(crate) fn coloured(self, colour: Colour) -> Self {
        Self { colour, ..self }
    }
}

impl Canvas {
    /// A line of text.
    pub(crate) fn text(&mut self, at: Pixel, style: Type, text: &str) {
        let width = width(style.size, text);
        let (back, drop) = (-style.align.0 * width, style.align.1 * CAPITAL * style.size);
        // Where the baseline starts; upwards text is laid out along x and turned pixel by pixel.
        let origin = if style.turned { (at.1 - back, at.0 + drop) } else { (at.0 + back, at.1 + drop) };
        let direction = if style.turned { -1.0 } else { 1.0 };
        let font = FONT.as_scaled(scale(style.size));
        // On whole pixels across the line, so that the strokes of all labels are equally sharp.
        let (start, base) = (direction * origin.0, origin.1.round() as i32);
        each_glyph(style.size, text, |id, x| {
            let pen = start + x;
            let glyph = id.with_scale_and_position(font.scale, point((pen - pen.floor()) as f32, 0.0));
            let Some(outline) = FONT.outline_glyph(glyph) else { return };
            let bounds = outline.px_bounds();
            let (left, top) = (pen.floor() as i32 + bounds.min.x as i32, bounds.min.y as i32);
            outline.draw(|i, j, cover| {
                let (along, down) = (left + i as i32, base + top + j as i32);
                let (px, py) = if style.turned { (down, -along - 1) } else { (along, down) };
                self.blend(px, py, style.colour, f64::from(cover));
            });
        });
    }
}

/// The scale at which the em of the font is `size` pixels.
fn scale(size: f64) -> PxScale {
    let em = FONT.units_per_em().unwrap_or(1.0);
    PxScale::from(size as f32 * FONT.height_unscaled() / em)
}

/// Visits the glyphs of `text` with their pen positions; returns the width of the whole.
fn each_glyph(size: f64, text: &str, mut visit: impl FnMut(GlyphId, f64)) -> f64 {
    let font = FONT.as_scaled(scale(size));
    let (mut pen, mut last) = (0.0, None);
    for letter in text.chars() {
        let id = font.glyph_id(letter);
        pen += last.map_or(0.0, |last| f64::from(font.kern(last, id)));
        visit(id, pen);
        pen += f64::from(font.h_advance(id));
        last = Some(id);
    }
    pen
}

/// The width of `text` in pixels.
pub(crate) fn width(size: f64, text: &str) -> f64 {
    each_glyph(size, text, |_, _| {})
}

/// `text` in lines of at most `room` pixels, broken between words; a longer word is broken
/// anywhere.
pub(crate) fn wrapped(size: f64, text: &str, room: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        if let Some(last) = lines.last_mut()
            && width(size, &format!("{last} {word}")) <= room
        {
            *last += &format!(" {word}");
            continue;
        }
        let mut line = String::new();
        for letter in word.chars() {
            if !line.is_empty() && width(size, &format!("{line}{letter}")) > room {
                lines.push(std::mem::take(&mut line));
            }
            line.push(letter);
        }
        lines.push(line);
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_broken_to_fit() {
        let room = width(16.0, "settling in");
        assert_eq!(wrapped(16.0, "settling in water", room), ["settling in", "water"]);
        assert_eq!(wrapped(16.0, "", room), [""; 0]);
        let broken = wrapped(16.0, "a rock_in_a_channel", room);
        assert!(broken.len() > 2 && broken.iter().all(|line| width(16.0, line) <= room), "{broken:?}");
        assert_eq!(broken.concat(), "arock_in_a_channel");
    }
}
