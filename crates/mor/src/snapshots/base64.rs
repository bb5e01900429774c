//! Bytes as text (RFC 4648).

/// The bytes of a text; blanks do not count. None if another character is in it. Several texts may follow one another, each with its own padding.
pub(super) fn decode(text: &[u8]) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    let (mut word, mut count) = (0_u32, 0);
    for &c in text.iter().filter(|c| !c.is_ascii_whitespace()) {
        let value = match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            b'=' => {
                if count >= 2 {
                    bytes.push((word >> (6 * count - 8)) as u8);
                }
                if count == 3 {
                    bytes.push((word >> 2) as u8);
                }
                (word, count) = (0, 0);
                continue;
            }
            _ => return None,
        };
        word = word << 6 | u32::from(value);
        count += 1;
        if count == 4 {
            bytes.extend_from_slice(&word.to_be_bytes()[1..]);
            (word, count) = (0, 0);
        }
    }
    if count == 0 { Some(bytes) } else { None }
}
