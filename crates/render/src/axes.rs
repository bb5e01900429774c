//! Axes with ticks, and colour bars.

use crate::canvas::{Canvas, Pixel, Rect};
use crate::colour::{GRID, INK, Map};
use crate::text::Type;

/// Sizes of what surrounds a plot, in pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Look {
    /// Font size.
    pub(crate) font: f64,
    /// Width of the frame and of the ticks, whole pixels.
    pub(crate) line: f64,
}

impl Look {
    /// Ticks over so many pixels, with air between their numbers.
    fn ticks(self, range: (f64, f64), pixels: f64) -> Ticks {
        Ticks::new(range, (pixels / (4.6 * self.font)).round() as usize)
    }
}

/// A plot's rectangle and the range of either axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Axes {
    pub(crate) rect: Rect,
    pub(crate) x: (f64, f64),
    pub(crate) y: (f64, f64),
}

impl Axes {
    /// Where a point of the plot lies on the canvas.
    pub(crate) fn at(&self, x: f64, y: f64) -> Pixel {
        let across = (x - self.x.0) / (self.x.1 - self.x.0);
        let up = (y - self.y.0) / (self.y.1 - self.y.0);
        (self.rect.left + across * self.rect.width, self.rect.bottom() - up * self.rect.height)
    }

    /// Light lines at the ticks.
    pub(crate) fn grid(&self, canvas: &mut Canvas, look: Look) {
        let ticks = [look.ticks(self.x, self.rect.width), look.ticks(self.y, self.rect.height)];
        self.grid_at(canvas, look, &ticks);
    }

    /// The same at given ticks along x and y.
    pub(crate) fn grid_at(&self, canvas: &mut Canvas, look: Look, [along_x, along_y]: &[Ticks; 2]) {
        for &tick in &along_x.places {
            let (x, _) = self.at(tick, self.y.0);
            canvas.fill(Rect::new(x, self.rect.top, look.line, self.rect.height), GRID, 1.0);
        }
        for &tick in &along_y.places {
            let (_, y) = self.at(self.x.0, tick);
            canvas.fill(Rect::new(self.rect.left, y, self.rect.width, look.line), GRID, 1.0);
        }
    }

    /// The box around the plot.
    pub(crate) fn frame(&self, canvas: &mut Canvas, look: Look) {
        outline(canvas, self.rect, look.line);
    }

    /// Ticks and numbers below the plot, with the label under them.
    pub(crate) fn bottom(&self, canvas: &mut Canvas, look: Look, label: &str) {
        self.bottom_at(canvas, look, &look.ticks(self.x, self.rect.width), label);
    }

    /// The same with given ticks.
    pub(crate) fn bottom_at(&self, canvas: &mut Canvas, look: Look, ticks: &Ticks, label: &str) {
        let (foot, length) = (self.rect.bottom() + look.line, 0.4 * look.font);
        let style = Type::new(look.font, (0.5, 1.0));
        for &tick in &ticks.places {
            let (x, _) = self.at(tick, self.y.0);
            canvas.fill(Rect::new((x - 0.5 * look.line).round(), foot, look.line, length), INK, 1.0);
            canvas.text((x, foot + length + 0.4 * look.font), style, &ticks.label(tick));
        }
        let middle = self.rect.left + 0.5 * self.rect.width;
        canvas.text((middle, foot + length + 1.75 * look.font), style, label);
    }

    /// Ticks and numbers left of the plot, with the label beside them, reading upwards.
    pub(crate) fn left(&self, canvas: &mut Canvas, look: Look, label: &str) {
        self.left_at(canvas, look, &look.ticks(self.y, self.rect.height), label);
    }

    /// The same with given ticks.
    pub(crate) fn left_at(&self, canvas: &mut Canvas, look: Look, ticks: &Ticks, label: &str) {
        let (foot, length) = (self.rect.left - look.line, 0.4 * look.font);
        let mut reach = 0.0f64;
        for &tick in &ticks.places {
            let (_, y) = self.at(self.x.0, tick);
            let mark = Rect::new(foot - length, (y - 0.5 * look.line).round(), length, look.line);
            canvas.fill(mark, INK, 1.0);
            let text = ticks.label(tick);
            canvas.text((foot - length - 0.4 * look.font, y), Type::new(look.font, (1.0, 0.5)), &text);
            reach = reach.max(crate::text::width(look.font, &text));
        }
        let x = foot - length - 1.1 * look.font - reach;
        let middle = self.rect.top + 0.5 * self.rect.height;
        canvas.text((x, middle), Type::new(look.font, (0.5, 0.0)).turned(), label);
    }
}

fn outline(canvas: &mut Canvas, rect: Rect, line: f64) {
    let Rect { left, top, width, height } = rect;
    for side in [
        Rect::new(left - line, top - line, width + 2.0 * line, line),
        Rect::new(left - line, top + height, width + 2.0 * line, line),
        Rect::new(left - line, top, line, height),
        Rect::new(left + width, top, line, height),
    ] {
        canvas.fill(side, INK, 1.0);
    }
}

/// A colour bar with numbers to its right and the label beyond them, reading upwards.
pub(crate) fn colour_bar(
    canvas: &mut Canvas,
    rect: Rect,
    map: &Map,
    range: (f64, f64),
    label: &str,
    look: Look,
) {
    for y in 0..rect.height as usize {
        let colour = map.at(1.0 - (y as f64 + 0.5) / rect.height);
        canvas.fill(Rect::new(rect.left, rect.top + y as f64, rect.width, 1.0), colour, 1.0);
    }
    outline(canvas, rect, look.line);
    let axes = Axes { rect, x: (0.0, 1.0), y: range };
    let ticks = look.ticks(range, rect.height);
    let (foot, length) = (rect.right() + look.line, 0.3 * look.font);
    let mut reach = 0.0f64;
    for &tick in &ticks.places {
        let (_, y) = axes.at(0.0, tick);
        canvas.fill(Rect::new(foot, (y - 0.5 * look.line).round(), length, look.line), INK, 1.0);
        let text = ticks.label(tick);
        canvas.text((foot + length + 0.35 * look.font, y), Type::new(look.font, (0.0, 0.5)), &text);
        reach = reach.max(crate::text::width(look.font, &text));
    }
    let x = foot + length + 1.0 * look.font + reach;
    canvas.text((x, rect.top + 0.5 * rect.height), Type::new(look.font, (0.5, 1.0)).turned(), label);
}

const SUPERSCRIPTS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];

/// Round numbers within a range.
pub(crate) struct Ticks {
    pub(crate) places: Vec<f64>,
    decimals: usize,
    /// Places are powers of ten.
    powers: bool,
}

impl Ticks {
    /// About `wanted` ticks at 1, 2 or 5 times a power of ten.
    pub(crate) fn new((low, high): (f64, f64), wanted: usize) -> Self {
        let span = high - low;
        if !(span.is_finite() && span > 0.0) {
            return Self { places: vec![low], decimals: 3, powers: false };
        }
        let rough = span / wanted.max(1) as f64;
        let power = 10f64.powf(rough.log10().floor());
        // The nearest of the round steps, by ratio.
        let step = match rough / power {
            ..1.414 => power,
            ..3.162 => 2.0 * power,
            ..7.071 => 5.0 * power,
            _ => 10.0 * power,
        };
        let (first, last) = ((low / step - 1e-6).ceil() as i64, (high / step + 1e-6).floor() as i64);
        let decimals = (-(step * 1.001).log10().floor()).max(0.0) as usize;
        Self { places: (first..=last).map(|k| k as f64 * step).collect(), decimals, powers: false }
    }

    /// The powers of ten whose exponents lie within a range.
    pub(crate) fn decades((low, high): (f64, f64)) -> Self {
        let places = (low.ceil() as i64..=high.floor() as i64).map(|k| k as f64).collect();
        Self { places, decimals: 0, powers: true }
    }

    /// The number at a tick, with a true minus sign.
    pub(crate) fn label(&self, tick: f64) -> String {
        let text = format!("{:.*}", self.decimals, tick + 0.0);
        if !self.powers {
            return text.replace('-', "−");
        }
        let raised = |c: char| match c {
            '-' => '⁻',
            digit => digit.to_digit(10).map_or(digit, |d| SUPERSCRIPTS[d as usize]),
        };
        "10".chars().chain(text.chars().map(raised)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let labels = |low, high, wanted| {
            let ticks = Ticks::new((low, high), wanted);
            ticks.places.iter().map(|&t| ticks.label(t)).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(labels(0.0, 20.0, 5), "0 5 10 15 20");
        assert_eq!(labels(-0.03, 0.6, 6), "0.0 0.1 0.2 0.3 0.4 0.5 0.6");
        assert_eq!(labels(-2.0, 2.0, 4), "−2 −1 0 1 2");
        assert_eq!(labels(0.0, 0.03, 3), "0.00 0.01 0.02 0.03");
        assert_eq!(labels(1.0, 1.0, 3), "1.000");
        let decades = Ticks::decades((-2.5, 1.0));
        assert_eq!(decades.places.iter().map(|&t| decades.label(t)).collect::<String>(), "10⁻²10⁻¹10⁰10¹");
    }
}
