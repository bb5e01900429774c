//! Text that need not be text.
use super::MeshError;
use std::borrow::Cow;

/// The words of a file, one by one, with the numbers of their lines.
pub(crate) struct Words<'a> {
    format: &'static str,
    lines: std::slice::Split<'a, u8, fn(&u8) -> bool>,
    /// What is left of the line.
    rest: &'a [u8],
    line: usize,
}

fn is_end(byte: &u8) -> bool {
    *byte == b'\n'
}

impl<'a> Words<'a> {
    /// Of these bytes.
    pub(crate) fn new(format: &'static str, bytes: &'a [u8]) -> Self {
        Self { format, lines: bytes.split(is_end as fn(&u8) -> bool), rest: &[], line: 0 }
    }
    /// The next one, on this line or one of those that follow.
    pub(crate) fn next(&mut self) -> Option<Cow<'a, str>> {
        loop {
            if let Some(word) = self.next_on_line() {
                return Some(word);
            }
            if !self.next_line() {
                return None;
            }
        }
    }
    /// The next one on this line.
    pub(crate) fn next_on_line(&mut self) -> Option<Cow<'a, str>> {
        let rest = self.rest.trim_ascii_start();
        let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        let (word, rest) = rest.split_at(end);
        self.rest = rest;
        // Short enough to be named in a message.
        (!word.is_empty()).then(|| String::from_utf8_lossy(&word[..word.len().min(100)]))
    }
    /// Goes to the next line, if there is one.
    pub(crate) fn next_line(&mut self) -> bool {
        let next = self.lines.next();
        self.rest = next.unwrap_or_default();
        self.line += usize::from(next.is_some());
        next.is_some()
    }
    /// Leaves out the rest of this line.
    pub(crate) fn skip_line(&mut self) {
        self.rest = &[];
    }
    /// Does the last word of this line say that it goes on in the next? (Then it is taken off.)
    pub(crate) fn goes_on(&mut self) -> bool {
        let rest = self.rest.trim_ascii_end();
        let goes_on = rest.last() == Some(&b'\\');
        if goes_on {
            self.rest = &rest[..rest.len() - 1];
        }
        goes_on
    }
    /// Something is wrong on this line.
    pub(crate) fn error(&self, what: String) -> MeshError {
        MeshError::Text { format: self.format, line: self.line, what }
    }
}

/// The number that a word says.
pub(crate) fn number(word: Option<Cow<'_, str>>) -> Result<f64, String> {
    let word = word.ok_or("a number is missing")?;
    word.parse().map_err(|_| format!("{word:?} is no number"))
}
