//! Line charts as SVG for web pages: ink takes the colour of the text, so that they are readable on
//! light and dark pages.
use crate::chart_scale::{Scale, tick_label};
use plotters::element::DashedPathElement;
use plotters::prelude::*;

/// Colours of lines: contrast above 3 on white and on near-black pages.
const COLOURS: [&str; 8] =
    ["#2f7ed8", "#d9641e", "#2b9a66", "#b8559f", "#8768d8", "#9c7b00", "#1f98a8", "#c14a4a"];
/// Width and height in units of the font's size being [`FONT`].
const SIZE: (u32, u32) = (560, 300);
/// Size of text.
const FONT: u32 = 14;
/// Units of the drawing per unit of [`SIZE`], as plotters rounds to whole ones.
const FINE: u32 = 8;
/// Stand-ins for ink and grid, which are replaced by the colour of the text.
const INK: RGBColor = RGBColor(1, 1, 1);
/// Opacity of the grid.
const GRID: f64 = 0.16;

/// Values along an axis.
#[derive(Clone, Debug)]
pub struct ChartAxis {
    /// Quantity.
    pub label: String,
    /// Unit, empty if there is none.
    pub unit: String,
    /// Whether the axis is logarithmic; values ≤ 0 are then left out.
    pub logarithmic: bool,
}

impl ChartAxis {
    /// A linear axis.
    pub fn linear(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { label: label.into(), unit: unit.into(), logarithmic: false }
    }
}

/// A line through points; values that are not finite interrupt it.
#[derive(Clone, Debug)]
pub struct ChartLine {
    /// Name in the legend.
    pub name: String,
    /// Points, x ascending.
    pub points: Vec<(f64, f64)>,
    /// Number of its colour, which lines of one run may share.
    pub colour: usize,
}

/// A value drawn across the chart, such as a reference.
#[derive(Clone, Debug)]
pub struct ChartLevel {
    /// Name in the legend.
    pub name: String,
    /// The value.
    pub value: f64,
    /// Number of its colour; none is that of the text.
    pub colour: Option<usize>,
}

/// A line chart.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Description for readers that do not see it.
    pub title: String,
    /// Across.
    pub x: ChartAxis,
    /// Upwards.
    pub y: ChartAxis,
    /// Lines.
    pub lines: Vec<ChartLine>,
    /// Levels.
    pub levels: Vec<ChartLevel>,
}

/// Entry of a legend.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LegendEntry {
    /// Its text.
    pub name: String,
    /// Colour as in CSS.
    pub colour: &'static str,
    /// Whether the line is dashed.
    pub dashed: bool,
}

/// A chart that is drawn.
#[derive(Clone, Debug)]
pub struct DrawnChart {
    /// The element `svg`, without sizes: it takes the width of what it is in.
    pub svg: String,
    /// Its legend.
    pub legend: Vec<LegendEntry>,
    /// Notes on values that are left out.
    pub notes: Vec<String>,
}

/// Why a chart cannot be drawn.
#[derive(Debug, thiserror::Error)]
pub enum ChartError {
    /// No point of any line has two finite values, positive on logarithmic axes.
    #[error("no value of {0} can be drawn: none is finite, or none is positive on a logarithmic axis")]
    Empty(String),
    /// The drawing library.
    #[error("drawing {title}: {cause}")]
    Drawing {
        /// The chart.
        title: String,
        /// Its cause.
        cause: String,
    },
}

/// Colour as in CSS of the line with this number.
pub fn colour(number: usize) -> &'static str {
    COLOURS[number % COLOURS.len()]
}

fn rgb(number: Option<usize>) -> RGBColor {
    let Some(number) = number else { return INK };
    let part = |i: usize| u8::from_str_radix(&colour(number)[i..i + 2], 16).unwrap_or(0);
    RGBColor(part(1), part(3), part(5))
}

impl Chart {
    /// Draws it.
    ///
    /// # Errors
    /// [`ChartError`].
    pub fn draw(&self) -> Result<DrawnChart, ChartError> {
        let (mut notes, all) = (Vec::new(), || self.lines.iter().flat_map(|line| &line.points));
        let levels = self.levels.iter().map(|level| level.value);
        let x = Scale::of(&self.x, all().map(|p| p.0), []);
        let y = Scale::of(&self.y, all().map(|p| p.1), levels);
        let (Some(x), Some(y)) = (x, y) else { return Err(ChartError::Empty(self.title.clone())) };
        if let Some([low, high]) = y.beyond {
            notes.push(format!(
                "the axis is cut: values go from {low:.3e} to {high:.3e}{}",
                if self.y.unit.is_empty() { String::new() } else { format!(" {}", self.y.unit) }
            ));
        }
        let left_out = all().filter(|p| !p.1.is_finite() || self.y.logarithmic && p.1 <= 0.0).count();
        if left_out > 0 {
            notes.push(format!(
                "{left_out} of {} values are not drawn, as they are {}",
                all().count(),
                if self.y.logarithmic { "not positive, or not finite" } else { "not finite" }
            ));
        }
        let mut svg = String::new();
        self.paint(&mut svg, &x, &y)
            .map_err(|error| ChartError::Drawing { title: self.title.clone(), cause: error.to_string() })?;
        let line = |line: &ChartLine| LegendEntry {
            name: line.name.clone(),
            colour: colour(line.colour),
            dashed: false,
        };
        let level = |level: &ChartLevel| LegendEntry {
            name: level.name.clone(),
            colour: level.colour.map_or("currentColor", colour),
            dashed: true,
        };
        let legend = self.lines.iter().map(line).chain(self.levels.iter().map(level)).collect();
        Ok(DrawnChart { svg: self.themed(&svg), legend, notes })
    }

    fn paint(
        &self,
        svg: &mut String,
        x: &Scale,
        y: &Scale,
    ) -> Result<(), DrawingAreaErrorKind<<SVGBackend<'static> as DrawingBackend>::ErrorType>> {
        let area = SVGBackend::with_string(svg, (SIZE.0 * FINE, SIZE.1 * FINE)).into_drawing_area();
        // plotters divides sizes by 1.24 for SVG.
        let text = ("sans-serif", 1.24 * f64::from(FONT * FINE)).into_font().color(&INK);
        let widest = y.longest_label();
        let mut chart = ChartBuilder::on(&area)
            .margin_top(FONT * FINE / 2)
            .margin_right(FONT * FINE * 3 / 2)
            .x_label_area_size(3 * FONT * FINE)
            .y_label_area_size((2 * FONT + widest as u32 * FONT * 5 / 8) * FINE)
            .build_cartesian_2d(x.range(), y.range())?;
        chart
            .configure_mesh()
            .x_labels(6)
            .y_labels(6)
            .max_light_lines(0)
            .bold_line_style(ShapeStyle { color: INK.mix(GRID), filled: false, stroke_width: FINE })
            .axis_style(ShapeStyle { color: INK.to_rgba(), filled: false, stroke_width: FINE })
            .set_all_tick_mark_size((FONT * FINE / 3) as i32)
            .label_style(text.clone())
            .axis_desc_style(text)
            .x_desc(x.description(&self.x))
            .y_desc(y.description(&self.y))
            .x_label_formatter(&|v| tick_label(*v, x))
            .y_label_formatter(&|v| tick_label(*v, y))
            .draw()?;
        let style = |colour, width: u32| ShapeStyle {
            color: rgb(colour).to_rgba(),
            filled: false,
            stroke_width: width * FINE / 4,
        };
        for level in &self.levels {
            let (Some(value), range) = (y.place(level.value), x.range()) else { continue };
            let ends = [(range.start, value), (range.end, value)];
            let dash = (6 * FINE, 4 * FINE);
            chart.draw_series(std::iter::once(DashedPathElement::new(
                ends,
                dash.0,
                dash.1,
                style(level.colour, 6),
            )))?;
        }
        for line in &self.lines {
            let style = style(Some(line.colour), 7);
            for piece in x.pieces(y, &line.points) {
                chart.draw_series(std::iter::once(match piece[..] {
                    [only] => Circle::new(only, 2 * FINE, style.filled()).into_dyn(),
                    _ => PathElement::new(piece, style).into_dyn(),
                }))?;
            }
        }
        area.present()
    }

    /// The drawing with the colour of the text for ink, and without sizes.
    fn themed(&self, svg: &str) -> String {
        let inked = svg.replace("\"#010101\"", "\"currentColor\"");
        let body = inked.split_once('>').map_or("", |(_, body)| body);
        let title: String = self
            .title
            .chars()
            .map(|c| match c {
                '<' => "&lt;".to_owned(),
                '>' => "&gt;".to_owned(),
                '&' => "&amp;".to_owned(),
                '"' => "&quot;".to_owned(),
                c => c.to_string(),
            })
            .collect();
        format!(
            "<svg role=\"img\" aria-label=\"{title}\" viewBox=\"0 0 {} {}\" stroke-linejoin=\"round\">{body}",
            SIZE.0 * FINE,
            SIZE.1 * FINE
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(points: Vec<(f64, f64)>, logarithmic: bool) -> Chart {
        Chart {
            title: "a <b> \"c\"".into(),
            x: ChartAxis::linear("time", "s"),
            y: ChartAxis { logarithmic, ..ChartAxis::linear("x", "m") },
            lines: vec![ChartLine { name: "<l>".into(), points, colour: 0 }],
            levels: vec![ChartLevel { name: "r".into(), value: 2.0, colour: None }],
        }
    }

    #[test]
    fn ink_takes_the_colour_of_the_page() {
        let drawn = chart(vec![(0.0, 1.0), (1.0, 3.0)], false).draw().unwrap();
        assert!(drawn.svg.starts_with("<svg role=\"img\" aria-label=\"a &lt;b&gt; &quot;c&quot;\""));
        assert!(drawn.svg.contains("currentColor") && !drawn.svg.contains("#010101"));
        assert!(drawn.svg.contains("#2F7ED8") && drawn.svg.contains("time in s"), "{}", drawn.svg);
        assert_eq!(drawn.legend.len(), 2);
        assert!(drawn.notes.is_empty());
    }

    #[test]
    fn what_is_not_drawn_is_noted() {
        let points = vec![(0.0, 1.0), (1.0, f64::NAN), (2.0, 0.0), (3.0, 1e-4), (4.0, 1e-5)];
        let drawn = chart(points, true).draw().unwrap();
        assert_eq!(drawn.notes.len(), 1, "{:?}", drawn.notes);
        assert!(drawn.notes[0].starts_with("2 of 5 values"), "{:?}", drawn.notes);
        assert!(drawn.svg.contains("10⁻⁴"), "{}", drawn.svg);
        let empty = chart(vec![(0.0, f64::NAN)], false);
        assert!(matches!(empty.draw(), Err(ChartError::Empty(_))));
    }
}
