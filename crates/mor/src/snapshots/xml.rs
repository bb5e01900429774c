//! As much of XML as VTK's files need.
use std::borrow::Cow;

/// `<name key="value" …>` and the text up to the next tag.
pub(super) struct Tag<'a> {
    /// With a slash before it at the end of an element.
    pub(super) name: &'a str,
    attributes: &'a str,
    pub(super) text: &'a str,
}

/// All tags of a text, in their order; declarations and comments are left out.
pub(super) fn tags(text: &str) -> impl Iterator<Item = Tag<'_>> {
    let parts = text.split('<').skip(1).filter(|part| !part.starts_with(['?', '!']));
    parts.filter_map(|part| {
        let (tag, text) = part.split_once('>')?;
        let tag = tag.strip_suffix('/').unwrap_or(tag);
        let (name, attributes) = tag.split_once(char::is_whitespace).unwrap_or((tag, ""));
        Some(Tag { name, attributes, text })
    })
}

impl<'a> Tag<'a> {
    /// The value of this attribute.
    pub(super) fn get(&self, key: &str) -> Option<Cow<'a, str>> {
        let mut rest = self.attributes;
        loop {
            let (name, after) = rest.split_once('=')?;
            let after = after.trim_start();
            let quote = after.chars().next().filter(|c| ['"', '\''].contains(c))?;
            let (value, others) = after[1..].split_once(quote)?;
            if name.trim() == key {
                return Some(plain(value));
            }
            rest = others;
        }
    }

    /// All numbers of an attribute.
    pub(super) fn numbers<T: std::str::FromStr>(&self, key: &str) -> Option<Vec<T>> {
        self.get(key)?.split_whitespace().map(|n| n.parse().ok()).collect()
    }
}

/// Without entities.
fn plain(value: &str) -> Cow<'_, str> {
    if !value.contains('&') {
        return value.into();
    }
    value.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"").replace("&amp;", "&").into()
}
