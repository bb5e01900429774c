//! What is wrong with a scene, and where.
use crate::document::Place;
use std::fmt;

/// Words of a scene for those of the libraries.
const IN_KEYS: [(&str, &str); 6] = [
    ("or use `Hfdib`", "or take coupling.forcing = \"hfdib\""),
    ("upwind convection", "flow.convection = \"upwind\""),
    ("axis 0", "axis x"),
    ("axis 1", "axis y"),
    ("axis 2", "axis z"),
    ("`exits` of a scene, `dem::Population::with_exit`", "`exits`"),
];

/// A message of the libraries in words of a scene.
fn in_keys(message: String) -> String {
    IN_KEYS.iter().fold(message, |text, (library, key)| text.replace(library, key))
}

/// One thing that is wrong.
#[derive(Clone, Debug)]
pub(crate) struct Problem {
    /// The key, from the top: `bodies.2.shape.radius`.
    pub(crate) path: String,
    pub(crate) place: Place,
    /// What is wrong and what to do.
    pub(crate) message: String,
}

impl Problem {
    pub(crate) fn new(path: String, place: Place, message: impl Into<String>) -> Self {
        Self { path, place, message: in_keys(message.into()) }
    }
}

/// All that is wrong with a scene: shown as the file's name, line and column, the line itself with the place marked, the key and what to do.
#[derive(Clone, Debug, thiserror::Error)]
pub struct Problems {
    pub(crate) name: String,
    pub(crate) text: String,
    pub(crate) overrides: Vec<String>,
    pub(crate) list: Vec<Problem>,
}

impl Problems {
    /// How many there are.
    pub fn count(&self) -> usize {
        self.list.len()
    }
    /// Of each, in the order of the file: line (from 1; 0 for an override of the command line), key and message.
    pub fn iter(&self) -> impl Iterator<Item = (usize, &str, &str)> {
        let starts = self.line_starts();
        self.list.iter().map(move |p| {
            let line = match &p.place {
                Place::File(range) => self.line(&starts, range.start).0,
                Place::Override(_) => 0,
            };
            (line, p.path.as_str(), p.message.as_str())
        })
    }

    /// Bytes at which lines begin.
    fn line_starts(&self) -> Vec<usize> {
        std::iter::once(0).chain(self.text.match_indices('\n').map(|(i, _)| i + 1)).collect()
    }

    /// Line and column, from 1, of byte `at`, and the line's text.
    fn line(&self, starts: &[usize], at: usize) -> (usize, usize, &str) {
        let mut at = at.min(self.text.len());
        // Errors at the end of the file are behind its last line's end.
        while !self.text.is_char_boundary(at) {
            at -= 1;
        }
        let line = starts.partition_point(|start| *start <= at);
        let start = starts[line - 1];
        let end = starts.get(line).map_or(self.text.len(), |next| next - 1);
        (line, self.text[start..at].chars().count() + 1, &self.text[start..end])
    }
}

/// So many characters of a line are shown.
const SHOWN: usize = 120;
/// Number of problems that are shown; all are counted.
const MOST: usize = 50;

impl fmt::Display for Problems {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let starts = self.line_starts();
        for (i, problem) in self.list.iter().take(MOST).enumerate() {
            if i > 0 {
                writeln!(f)?;
            }
            match &problem.place {
                // What is not there has no line.
                Place::File(range) if range.is_empty() && range.start == 0 && !problem.path.is_empty() => {
                    write!(f, "{}: ", self.name)?;
                    write_message(f, problem)?;
                }
                Place::File(range) => {
                    let (line, column, text) = self.line(&starts, range.start);
                    write!(f, "{}:{line}:{column}: ", self.name)?;
                    write_message(f, problem)?;
                    // Long lines are shown around the place.
                    let skip = column.saturating_sub(SHOWN / 2);
                    let shown: String = text.chars().skip(skip).take(SHOWN).collect();
                    let length = self
                        .text
                        .get(range.clone())
                        .map_or(1, |s| s.lines().next().map_or(1, |first| first.chars().count()));
                    let room = shown.chars().count().saturating_sub(column - 1 - skip).max(1);
                    let marks = "^".repeat(length.clamp(1, room));
                    let gutter = line.to_string();
                    let blank = " ".repeat(gutter.len());
                    write!(f, "\n {gutter} | {shown}\n {blank} | {}{marks}", " ".repeat(column - 1 - skip))?;
                }
                Place::Override(number) => {
                    let text = self.overrides.get(*number).map_or("", String::as_str);
                    write!(f, "--set {text}: ")?;
                    write_message(f, problem)?;
                }
            }
        }
        match self.list.len().saturating_sub(MOST) {
            0 => Ok(()),
            more => write!(f, "\n{more} more problems are not shown; correct these and check the file again"),
        }
    }
}

/// The beginning of a text in quotes: formulas may be long.
pub(crate) fn shown(text: &str) -> String {
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{:?} …", &text[..end]),
        None => format!("{text:?}"),
    }
}

/// The beginning of a text without quotes.
pub(crate) fn clipped(text: &str) -> String {
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{} …", &text[..end]),
        None => text.into(),
    }
}

fn write_message(f: &mut fmt::Formatter<'_>, problem: &Problem) -> fmt::Result {
    if !problem.path.is_empty() {
        write!(f, "{}: ", problem.path)?;
    }
    f.write_str(&problem.message)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_shown() {
        let source = "[fluid]\nnü = 1e-6 # here\n";
        let at = source.find("1e-6").unwrap();
        let list = vec![Problem::new("fluid.nü".into(), Place::File(at..at + 4), "give more")];
        let problems = Problems { name: "s.toml".into(), text: source.into(), overrides: vec![], list };
        assert_eq!(
            problems.to_string(),
            "s.toml:2:6: fluid.nü: give more\n 2 | nü = 1e-6 # here\n   |      ^^^^"
        );
        assert_eq!(problems.iter().next(), Some((2, "fluid.nü", "give more")));
    }
}
