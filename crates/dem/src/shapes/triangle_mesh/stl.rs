//! The corners of triangles in an STL file.
use super::MeshError;
use super::text::{Format, Words, decoded, number};

/// Bytes before the first triangle of a binary file, and of each triangle.
const HEADER: usize = 84;
const TRIANGLE: usize = 50;

/// Words of a facet's normal: `normal` and three numbers.
const NORMAL: usize = 4;

/// Three corners per triangle, in the file's unit. A file is binary if it is as long as its number
/// of triangles says, or if it is no text: some programs begin binary files with `solid`, too, and
/// write bytes behind the last triangle.
pub(crate) fn read(bytes: &[u8]) -> Result<Vec<[f64; 3]>, MeshError> {
    let triangles = bytes.get(80..HEADER).and_then(|n| n.first_chunk()).map(|n| u32::from_le_bytes(*n));
    let exact = |n: u32| (bytes.len() - HEADER) as u64 == TRIANGLE as u64 * u64::from(n);
    if let Some(n) = triangles.filter(|n| exact(*n)) {
        return binary(bytes, n);
    }
    let text = decoded(bytes);
    match triangles {
        Some(n) if !is_text(&text) => binary(bytes, n),
        _ => Text { words: Words::new(Format::Stl, &text) }.solids(),
    }
}

/// Whether these bytes are an STL file as text, which has no zero byte where binary files have the
/// number of triangles and the first of them, nor unprintable ones unless in a name behind `solid`.
fn is_text(bytes: &[u8]) -> bool {
    let printable = |b: &u8| b.is_ascii_graphic() || b.is_ascii_whitespace();
    let solid = bytes.trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    let first = &bytes[..bytes.len().min(HEADER + TRIANGLE)];
    !first.contains(&0) && (solid || first.iter().take(HEADER).all(printable))
}

fn binary(bytes: &[u8], triangles: u32) -> Result<Vec<[f64; 3]>, MeshError> {
    // Bytes behind the last triangle are skipped. No memory is taken for triangles that are not there.
    let records = bytes[HEADER..].as_chunks::<TRIANGLE>().0;
    let Some(records) = records.get(..triangles as usize) else {
        return Err(MeshError::Truncated { triangles, bytes: bytes.len() });
    };
    let mut corners = Vec::with_capacity(3 * records.len());
    for record in records {
        // A normal, three corners, two bytes.
        for corner in record[12..48].as_chunks::<12>().0 {
            let x = |a: usize| f32::from_le_bytes([corner[a], corner[a + 1], corner[a + 2], corner[a + 3]]);
            corners.push([x(0), x(4), x(8)].map(f64::from));
        }
    }
    Ok(corners)
}

struct Text<'a> {
    words: Words<'a>,
}

impl Text<'_> {
    fn solids(mut self) -> Result<Vec<[f64; 3]>, MeshError> {
        let mut corners = Vec::new();
        while let Some(word) = self.words.next() {
            if !word.eq_ignore_ascii_case("solid") {
                return Err(self.words.error(format!("{word:?} instead of \"solid\"")));
            }
            // Its name.
            self.words.skip_line();
            loop {
                let Some(word) = self.words.next() else {
                    return Err(self.words.error("the file ends before \"endsolid\"".into()));
                };
                if word.eq_ignore_ascii_case("endsolid") {
                    self.words.skip_line();
                    break;
                }
                if !word.eq_ignore_ascii_case("facet") {
                    return Err(self.words.error(format!("{word:?} instead of \"facet\" or \"endsolid\"")));
                }
                self.facet(&mut corners)?;
            }
        }
        Ok(corners)
    }

    fn facet(&mut self, corners: &mut Vec<[f64; 3]>) -> Result<(), MeshError> {
        // The normal follows from the corners. Some files have "-nan(ind)" there, or less than three
        // numbers, or nothing.
        for _ in 0..=NORMAL {
            match self.words.next() {
                Some(word) if word.eq_ignore_ascii_case("outer") => return self.outer_loop(corners),
                Some(_) => {}
                None => return Err(self.words.error("the file ends before \"outer\"".into())),
            }
        }
        Err(self.words.error("no \"outer\" behind a facet's normal".into()))
    }

    fn outer_loop(&mut self, corners: &mut Vec<[f64; 3]>) -> Result<(), MeshError> {
        self.expect("loop")?;
        for _ in 0..3 {
            self.expect("vertex")?;
            corners.push(self.numbers()?);
        }
        self.expect("endloop")?;
        self.expect("endfacet")
    }

    fn expect(&mut self, expected: &str) -> Result<(), MeshError> {
        match self.words.next() {
            Some(word) if word.eq_ignore_ascii_case(expected) => Ok(()),
            Some(word) => Err(self.words.error(format!("{word:?} instead of {expected:?}"))),
            None => Err(self.words.error(format!("the file ends before {expected:?}"))),
        }
    }

    fn numbers(&mut self) -> Result<[f64; 3], MeshError> {
        let mut numbers = [0.0; 3];
        for x in &mut numbers {
            *x = number(self.words.next()).map_err(|what| self.words.error(what))?;
        }
        Ok(numbers)
    }
}
