//! Words of text files that need not be text.
use super::MeshError;
use std::borrow::Cow;

/// A format whose files are text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Format {
    Stl,
    Obj,
}

impl Format {
    fn name(self) -> &'static str {
        match self {
            Self::Stl => "STL",
            Self::Obj => "OBJ",
        }
    }
}

/// The bytes of a text without its byte-order mark; UTF-16 becomes UTF-8.
pub(crate) fn decoded(bytes: &[u8]) -> Cow<'_, [u8]> {
    let utf16 = |bytes: &[u8], unit: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = bytes.as_chunks::<2>().0.iter().map(|b| unit(*b)).collect();
        Cow::Owned(String::from_utf16_lossy(&units).into_bytes())
    };
    match bytes {
        [0xef, 0xbb, 0xbf, rest @ ..] => Cow::Borrowed(rest),
        [0xff, 0xfe, rest @ ..] => utf16(rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => utf16(rest, u16::from_be_bytes),
        _ => Cow::Borrowed(bytes),
    }
}

/// The words of a file, one by one, with the numbers of their lines. Lines end with LF, CR or both.
/// A comment runs from `#` to the end of the line; in STL files, whose names may contain that
/// character, only a whole line is one. In OBJ files a line that ends with a backslash continues.
pub(crate) struct Words<'a> {
    format: Format,
    /// Bytes after this line.
    after: Option<&'a [u8]>,
    /// Remainder of this line.
    rest: &'a [u8],
    /// The line continues on the next one.
    continues: bool,
    line: usize,
}

impl<'a> Words<'a> {
    pub(crate) fn new(format: Format, bytes: &'a [u8]) -> Self {
        Self { format, after: Some(bytes), rest: &[], continues: false, line: 0 }
    }
    /// The next word, on this line or one of those that follow.
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
    /// The next word on this line and its continuations.
    pub(crate) fn next_on_line(&mut self) -> Option<Cow<'a, str>> {
        loop {
            let rest = self.rest.trim_ascii_start();
            let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
            let (word, rest) = rest.split_at(end);
            self.rest = rest;
            if !word.is_empty() {
                // Short enough to be named in a message.
                return Some(String::from_utf8_lossy(&word[..word.len().min(100)]));
            }
            if !(self.continues && self.read_line()) {
                return None;
            }
        }
    }
    /// Goes to the next line that is no continuation of this one, if there is one.
    pub(crate) fn next_line(&mut self) -> bool {
        while self.continues && self.read_line() {}
        self.read_line()
    }
    fn read_line(&mut self) -> bool {
        self.continues = false;
        self.rest = &[];
        let Some(bytes) = self.after else { return false };
        self.line += 1;
        let end = bytes.iter().position(|b| matches!(b, b'\n' | b'\r'));
        let line = end.map_or(bytes, |end| &bytes[..end]);
        self.after = end.map(|end| bytes[end..].strip_prefix(b"\r\n").unwrap_or(&bytes[end + 1..]));
        self.rest = match self.format {
            Format::Stl if line.trim_ascii_start().starts_with(b"#") => &[],
            Format::Stl => line,
            Format::Obj => line.split(|b| *b == b'#').next().unwrap_or_default(),
        };
        if self.format == Format::Obj
            && let Some(rest) = self.rest.trim_ascii_end().strip_suffix(b"\\")
        {
            (self.rest, self.continues) = (rest, true);
        }
        true
    }
    /// Skips the rest of this line.
    pub(crate) fn skip_line(&mut self) {
        self.rest = &[];
    }
    /// An error on this line.
    pub(crate) fn error(&self, what: String) -> MeshError {
        MeshError::Text { format: self.format.name(), line: self.line, what }
    }
}

/// The number that a word says.
pub(crate) fn number(word: Option<Cow<'_, str>>) -> Result<f64, String> {
    let word = word.ok_or("a number is missing")?;
    word.parse().map_err(|_| format!("{word:?} is no number"))
}
