//! A TOML file whose every value knows where it stands.
use crate::problem::{Problem, Problems};
use std::fmt;
use std::ops::Range;
use toml::de::{DeTable, DeValue};

/// Where a value was given.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// Bytes of the file.
    File(Range<usize>),
    /// The override with this number.
    Override(usize),
}

/// A value and where it was given.
#[derive(Clone, Debug)]
pub(crate) struct Item {
    pub(crate) value: Value,
    pub(crate) place: Place,
}

/// What TOML knows. Dates are kept as text, which no key takes.
#[derive(Clone, Debug)]
pub(crate) enum Value {
    Flag(bool),
    Whole(i64),
    Number(f64),
    Text(String),
    Date(String),
    List(Vec<Item>),
    Table(Section),
}

/// A table: its keys in the order of the file, each with the place of its name.
#[derive(Clone, Debug, Default)]
pub(crate) struct Section(pub(crate) Vec<(String, Place, Item)>);

impl Section {
    pub(crate) fn get(&self, key: &str) -> Option<&Item> {
        self.0.iter().find(|(name, ..)| name == key).map(|(.., item)| item)
    }
}

impl Value {
    /// What it is called in messages.
    pub(crate) fn kind(&self) -> &'static str {
        match self {
            Self::Flag(_) => "true or false",
            Self::Whole(_) => "a whole number",
            Self::Number(_) => "a number",
            Self::Text(_) => "a text",
            Self::Date(_) => "a date",
            Self::List(_) => "a list",
            Self::Table(_) => "a table",
        }
    }
}

impl Value {
    fn lines(&self, path: &str, out: &mut Vec<String>) {
        match self {
            Self::Table(section) => section.lines(path, out),
            Self::List(items) => {
                items.iter().enumerate().for_each(|(i, item)| item.value.lines(&format!("{path}.{i}"), out));
            }
            // 1 is 1.0.
            Self::Whole(n) => out.push(format!("{path}={:?}", *n as f64)),
            other => out.push(format!("{path}={other}")),
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flag(flag) => write!(f, "{flag}"),
            Self::Whole(n) => write!(f, "{n}"),
            Self::Number(x) => write!(f, "{x:?}"),
            Self::Text(text) => write!(f, "{text:?}"),
            Self::Date(date) => write!(f, "the date {date}"),
            Self::List(items) => {
                f.write_str("[")?;
                for (i, item) in items.iter().enumerate() {
                    write!(f, "{}{}", if i > 0 { ", " } else { "" }, item.value)?;
                }
                f.write_str("]")
            }
            Self::Table(_) => f.write_str("a table"),
        }
    }
}

/// Whether `path` is one of `keys` or below one.
pub(crate) fn is_under(path: &str, keys: &[&str]) -> bool {
    let below =
        |key: &&str| path.strip_prefix(*key).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
    keys.iter().any(below)
}

/// 64-bit FNV-1a hash.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fnv(u64);

impl Default for Fnv {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fnv {
    /// Hash of what was hashed so far, followed by `bytes`.
    pub(crate) fn with(self, bytes: &[u8]) -> Self {
        let next = |h: u64, b: &u8| (h ^ u64::from(*b)).wrapping_mul(0x0100_0000_01b3);
        Self(bytes.iter().fold(self.0, next))
    }
    pub(crate) fn value(self) -> u64 {
        self.0
    }
}

/// A scene file with the overrides of the command line.
#[derive(Clone, Debug)]
pub(crate) struct Document {
    /// The file's name, for messages.
    pub(crate) name: String,
    source: String,
    overrides: Vec<String>,
    pub(crate) root: Section,
}

impl Document {
    /// Reads `source`, then sets what `overrides` say (`fluid.nu=2e-6`, `bodies.0.density = 1100`).
    pub(crate) fn parse(name: &str, source: &str, overrides: &[String]) -> Result<Self, Problems> {
        let document =
            |root| Self { name: name.into(), source: source.into(), overrides: overrides.to_vec(), root };
        let table = DeTable::parse(source).map_err(|error| {
            let place = Place::File(error.span().unwrap_or(0..0));
            let message = format!("this is not TOML: {}", error.message().trim_end());
            document(Section::default()).problems(vec![Problem::new(String::new(), place, message)])
        })?;
        let mut this = document(section(table.get_ref(), &Place::File));
        let mut problems = Vec::new();
        for (number, text) in overrides.iter().enumerate() {
            if let Err(message) = this.set(number, text) {
                let (path, _) = text.split_once('=').unwrap_or((text, ""));
                problems.push(Problem::new(path.trim().into(), Place::Override(number), message));
            }
        }
        if problems.is_empty() { Ok(this) } else { Err(this.problems(problems)) }
    }

    /// What is wrong with the value under a key from the top (`bodies.2`), or with the nearest that is there.
    pub(crate) fn problem(&self, key: &str, message: String) -> Problems {
        let mut steps = key.split('.');
        let mut item = steps.next().and_then(|step| self.root.get(step));
        for step in steps {
            let inner = item.and_then(|item| match &item.value {
                Value::Table(table) => table.get(step),
                Value::List(list) => list.get(step.parse::<usize>().ok()?),
                _ => None,
            });
            item = inner.or(item);
        }
        let place = item.map_or(Place::File(0..0), |item| item.place.clone());
        self.problems(vec![Problem::new(key.into(), place, message)])
    }

    /// These problems, with what is needed to show where they are.
    pub(crate) fn problems(&self, list: Vec<Problem>) -> Problems {
        Problems {
            name: self.name.clone(),
            text: self.source.clone(),
            overrides: self.overrides.clone(),
            list,
        }
    }

    /// Text of the file.
    pub(crate) fn source(&self) -> &str {
        &self.source
    }

    /// Overrides of the command line.
    pub(crate) fn overrides(&self) -> &[String] {
        &self.overrides
    }

    /// A number that changes with every value but those under the keys `loose`, and not with their order or with comments.
    pub(crate) fn fingerprint(&self, loose: &[&str]) -> u64 {
        let mut lines = Vec::new();
        self.root.lines("", &mut lines);
        lines.retain(|line| !is_under(line.split('=').next().unwrap_or_default(), loose));
        lines.sort_unstable();
        lines.iter().fold(Fnv::default(), |hash, line| hash.with(line.as_bytes()).with(b"\n")).value()
    }

    fn set(&mut self, number: usize, text: &str) -> Result<(), String> {
        let (path, value) = text.split_once('=').ok_or("an override is written key.key=value")?;
        let (path, value) = (path.trim(), value.trim());
        let value = match DeTable::parse(&format!("value = {value}")) {
            Ok(table) => match table.get_ref().iter().next() {
                Some((_, item)) if table.get_ref().len() == 1 => {
                    convert(item.get_ref(), &|_| Place::Override(number))
                }
                _ => return Err("a single value is needed behind the =".into()),
            },
            // A bare word is a text: shells take quotes away.
            Err(_) if !value.is_empty() && !value.contains(['"', '\n', '[', '{']) => {
                Value::Text(value.trim_matches('\'').into())
            }
            Err(error) => {
                return Err(format!("the value {value} is not TOML: {}", error.message().trim_end()));
            }
        };
        let keys: Vec<&str> = path.split('.').collect();
        if keys.iter().any(|key| key.is_empty()) {
            return Err(format!("{path:?} is no key; write key.key=value"));
        }
        self.root.put(&keys, Item { value, place: Place::Override(number) })
    }
}

impl Section {
    /// A line for every value.
    fn lines(&self, path: &str, out: &mut Vec<String>) {
        for (name, _, item) in &self.0 {
            let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
            item.value.lines(&path, out);
        }
    }

    /// Puts `new` where `keys` say; tables that are not there are made.
    fn put(&mut self, keys: &[&str], new: Item) -> Result<(), String> {
        let [key, rest @ ..] = keys else { return Ok(()) };
        if let Some((.., item)) = self.0.iter_mut().find(|(name, ..)| name == key) {
            return item.put(key, rest, new);
        }
        let mut item = Item { value: Value::Table(Self::default()), place: new.place.clone() };
        let place = new.place.clone();
        item.put(key, rest, new)?;
        self.0.push(((*key).into(), place, item));
        Ok(())
    }
}

impl Item {
    fn put(&mut self, name: &str, keys: &[&str], new: Self) -> Result<(), String> {
        let [key, rest @ ..] = keys else {
            *self = new;
            return Ok(());
        };
        match &mut self.value {
            Value::Table(section) => section.put(keys, new),
            Value::List(items) => {
                let n = items.len();
                let item = key.parse::<usize>().ok().and_then(|i| items.get_mut(i));
                let item = item.ok_or(format!("there is no entry {key}; {name} has {n}, numbered from 0"))?;
                item.put(key, rest, new)
            }
            other => Err(format!("{name} is {}, which has no keys of its own", other.kind())),
        }
    }
}

/// A table, whose spans are `at` these places.
fn section(table: &DeTable<'_>, at: &dyn Fn(Range<usize>) -> Place) -> Section {
    let mut entries: Vec<_> = table.iter().collect();
    entries.sort_by_key(|(key, _)| key.span().start);
    let entry = |(key, item): (&toml::Spanned<std::borrow::Cow<'_, str>>, &toml::Spanned<DeValue<'_>>)| {
        let value = Item { value: convert(item.get_ref(), at), place: at(item.span()) };
        (key.get_ref().to_string(), at(key.span()), value)
    };
    Section(entries.into_iter().map(entry).collect())
}

fn convert(value: &DeValue<'_>, at: &dyn Fn(Range<usize>) -> Place) -> Value {
    match value {
        DeValue::String(text) => Value::Text(text.to_string()),
        DeValue::Boolean(flag) => Value::Flag(*flag),
        DeValue::Datetime(date) => Value::Date(date.to_string()),
        DeValue::Float(number) => Value::Number(number.as_str().parse().unwrap_or(f64::NAN)),
        // Beyond 64 bits it is a number all the same.
        DeValue::Integer(n) => match i64::from_str_radix(n.as_str(), n.radix()) {
            Ok(n) => Value::Whole(n),
            Err(_) => Value::Number(n.as_str().parse().unwrap_or(f64::INFINITY)),
        },
        DeValue::Array(items) => Value::List(
            items
                .iter()
                .map(|item| Item { value: convert(item.get_ref(), at), place: at(item.span()) })
                .collect(),
        ),
        DeValue::Table(table) => Value::Table(section(table, at)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn find<'a>(document: &'a Document, keys: &[&str]) -> &'a Value {
        let mut section = &document.root;
        for (i, key) in keys.iter().enumerate() {
            let item = section.get(key).unwrap();
            match &item.value {
                Value::Table(next) if i + 1 < keys.len() => section = next,
                value => return value,
            }
        }
        panic!("no such key")
    }

    #[test]
    fn overrides_reach_tables_lists_and_new_keys() {
        let source = "[fluid]\nnu = 1e-6\n[[bodies]]\ndensity = 1\n[[bodies]]\ndensity = 2\n";
        let set =
            ["fluid.nu=2e-6", "bodies.1.density = 7", "flow.scheme=quick", "fluid.names=[\"a\", \"b\"]"];
        let document = Document::parse("a", source, &set.map(String::from)).unwrap();
        assert!(matches!(find(&document, &["fluid", "nu"]), Value::Number(x) if *x == 2e-6));
        assert!(matches!(find(&document, &["flow", "scheme"]), Value::Text(t) if t == "quick"));
        assert!(matches!(find(&document, &["fluid", "names"]), Value::List(l) if l.len() == 2));
        let Value::List(bodies) = find(&document, &["bodies"]) else { panic!() };
        let Value::Table(second) = &bodies[1].value else { panic!() };
        assert!(matches!(second.get("density").unwrap().value, Value::Whole(7)));
    }

    #[test]
    fn overrides_that_make_no_sense_are_told() {
        let told = |set: &str| Document::parse("a", "[[b]]\nx = 1\n", &[set.into()]).unwrap_err().to_string();
        assert!(told("fluid.nu").contains("key.key=value"));
        assert!(told("b.3.x=1").contains("no entry 3"));
        assert!(told("b.0.x.y=1").contains("no keys of its own"));
        assert!(told("x=[1").contains("not TOML"));
    }

    #[test]
    fn what_is_not_toml_is_told_with_its_line() {
        let told = Document::parse("scene.toml", "a = 1\nb = = 2\n", &[]).unwrap_err().to_string();
        assert!(told.contains("scene.toml:2:"), "{told}");
    }
}
