//! Is a file what the schema says?
use super::{Key, Kind, Need, Table};
use crate::document::{Document, Item, Place, Section, Value};
use crate::expression::Expression;
use crate::problem::{Problem, Problems, clipped, shown};

/// Results of checking a document.
#[derive(Debug, Default)]
pub(crate) struct Findings {
    pub(crate) problems: Vec<Problem>,
    pub(crate) files: Vec<FileKey>,
}

/// A key whose value is the path of a file.
#[derive(Clone, Debug)]
pub(crate) struct FileKey {
    /// The key, from the top: `bodies.2.shape.file`.
    pub(crate) key: String,
    pub(crate) place: Place,
    /// The path, as written in the scene.
    pub(crate) path: String,
}

/// Checks every key of `document`: unknown ones, missing ones, kinds, ranges, formulas. Returns its
/// paths of files.
///
/// # Errors
/// All problems at once.
pub(crate) fn check(document: &Document) -> Result<Vec<FileKey>, Problems> {
    let mut found = Findings::default();
    check_section(&document.root, &super::SCENE, None, "", &Place::File(0..0), &mut found);
    if found.problems.is_empty() { Ok(found.files) } else { Err(document.problems(found.problems)) }
}

fn join(path: &str, key: &str) -> String {
    if path.is_empty() { key.into() } else { format!("{path}.{key}") }
}

fn check_section(
    section: &Section,
    table: &Table,
    tag: Option<&str>,
    path: &str,
    place: &Place,
    found: &mut Findings,
) {
    for (name, key_place, item) in &section.0 {
        if tag == Some(name) {
            continue;
        }
        match table.keys.iter().find(|key| key.name == name) {
            Some(key) => check_item(item, &key.kind, &join(path, name), found),
            None => {
                let known: Vec<_> = tag.into_iter().chain(table.keys.iter().map(|key| key.name)).collect();
                let message = format!("there is no key \"{name}\" here; {}", instead(name, &known));
                found.problems.push(Problem::new(path.into(), key_place.clone(), message));
            }
        }
    }
    for Key { name, need, about, example, .. } in table.keys {
        if *need == Need::Required && section.get(name).is_none() {
            let message =
                format!("the key \"{name}\" is missing. {about} Write, for example, {name} = {example}");
            found.problems.push(Problem::new(path.into(), place.clone(), message));
        }
    }
}

/// Which word may have been meant, and all there are.
fn instead(word: &str, known: &[&str]) -> String {
    if known.is_empty() {
        return "no key is known here".into();
    }
    let near = |k: &&&str| strsim::damerau_levenshtein(word, k);
    let nearest = known.iter().min_by_key(near).filter(|k| {
        strsim::damerau_levenshtein(word, k) <= 1 + word.chars().count() / 3
            || k.contains(word)
            || word.contains(**k)
    });
    let all = known.join(", ");
    match nearest {
        Some(nearest) => format!("did you mean \"{nearest}\"? Known are: {all}"),
        None => format!("known are: {all}"),
    }
}

/// Checks what stands at `path`.
pub(crate) fn check_item(item: &Item, kind: &Kind, path: &str, found: &mut Findings) {
    let mut problem =
        |message: String| found.problems.push(Problem::new(path.into(), item.place.clone(), message));
    let wanted = |what: &str| format!("{} stands here; give {what}", clipped(&item.value.to_string()));
    match (kind, &item.value) {
        (Kind::Flag, Value::Flag(_)) | (Kind::Text, Value::Text(_)) => {}
        (Kind::Flag, _) => problem(wanted("true or false")),
        (Kind::Text, _) => problem(wanted("a text in quotes")),
        (Kind::File, Value::Text(text)) if !text.is_empty() => {
            found.files.push(FileKey { key: path.into(), place: item.place.clone(), path: text.clone() });
        }
        (Kind::File, _) => problem(wanted("the path of a file in quotes")),
        (Kind::Number(range, unit), value) => match number(value) {
            Some(x) if range.holds(x) => {}
            _ => problem(wanted(&with_unit(&range.phrase(), unit)) + &evaluated(value)),
        },
        (Kind::Whole(least, most), value) => match whole(value) {
            Some(n) if (*least..=*most).contains(&n) => {}
            _ if *most == i64::MAX => {
                problem(wanted(&format!("a whole number from {least} on")) + &evaluated(value))
            }
            _ => problem(wanted(&format!("a whole number from {least} to {most}")) + &evaluated(value)),
        },
        (Kind::Formula(variables, unit), value) => match value {
            Value::Text(text) => {
                if let Err(error) = Expression::new(text, variables) {
                    problem(format!("the formula {} {error}", shown(text)));
                }
            }
            value if number(value).is_some_and(f64::is_finite) => {}
            _ => {
                let text = format!("a number or a formula of {} in quotes", variables.join(", "));
                problem(wanted(&with_unit(&text, unit)));
            }
        },
        (Kind::Word(words), Value::Text(text)) => {
            if !words.iter().any(|(word, _)| word == text) {
                let known: Vec<_> = words.iter().map(|(word, _)| *word).collect();
                problem(format!("\"{text}\" is not known here; {}", instead(text, &known)));
            }
        }
        (Kind::Word(words), _) => {
            let known: Vec<_> = words.iter().map(|(word, _)| format!("\"{word}\"")).collect();
            problem(wanted(&format!("one of {}", known.join(", "))));
        }
        (Kind::List(of, least, most), Value::List(items)) => {
            if !(*least..=*most).contains(&items.len()) {
                let how_many = if least == most { format!("{least}") } else { format!("{least} to {most}") };
                problem(format!("the list has {} entries; give {how_many}", items.len()));
            }
            for (i, item) in items.iter().enumerate() {
                check_item(item, of, &join(path, &i.to_string()), found);
            }
        }
        (Kind::List(..), _) => problem(wanted("a list in square brackets")),
        (Kind::Table(table), Value::Table(section)) => {
            check_section(section, table, None, path, &item.place, found);
        }
        (Kind::Named(table), Value::Table(section)) => {
            for (name, _, item) in &section.0 {
                check_item(item, &Kind::Table(table), &join(path, name), found);
            }
        }
        (Kind::Table(_) | Kind::Named(_), _) => {
            problem(wanted("a table in braces, or under a heading of its own"))
        }
        (Kind::Choice(tag, tables), value) => check_choice(item, value, (tag, tables), path, found),
        (Kind::Either(kinds), value) => {
            // The kind that fits the value's form tells what is wrong with it.
            match kinds.iter().find(|kind| fits(kind, value)) {
                Some(kind) => check_item(item, kind, path, found),
                None => {
                    let forms: Vec<_> = kinds.iter().map(form).collect();
                    problem(wanted(&forms.join(" or ")));
                }
            }
        }
    }
}

fn check_choice(
    item: &Item,
    value: &Value,
    (tag, tables): (&str, &[(&str, &'static Table)]),
    path: &str,
    found: &mut Findings,
) {
    let known: Vec<_> = tables.iter().map(|(name, _)| *name).collect();
    let mut problem = |place: &Place, message: String| {
        found.problems.push(Problem::new(path.into(), place.clone(), message))
    };
    let unknown = |word: &str| format!("\"{word}\" is not known here; {}", instead(word, &known));
    let empty = Section::default();
    let (word, place, section) = match value {
        Value::Text(word) => (word, &item.place, &empty),
        Value::Table(section) => match section.get(tag) {
            Some(Item { value: Value::Text(word), place }) => (word, place, section),
            Some(other) => {
                return problem(
                    &other.place,
                    format!("{tag} is {}; give one of {}", other.value, known.join(", ")),
                );
            }
            None => {
                let message = format!("the key \"{tag}\" is missing; it is one of {}", known.join(", "));
                return problem(&item.place, message);
            }
        },
        other => {
            let message = format!(
                "{} stands here; give a table with the key \"{tag}\", one of {}",
                clipped(&other.to_string()),
                known.join(", ")
            );
            return problem(&item.place, message);
        }
    };
    match tables.iter().find(|(name, _)| name == word) {
        Some((_, table)) => check_section(section, table, Some(tag), path, &item.place, found),
        None => problem(place, unknown(word)),
    }
}

fn fits(kind: &Kind, value: &Value) -> bool {
    match kind {
        Kind::Number(..) | Kind::Formula(..) => number(value).is_some() || matches!(value, Value::Text(_)),
        Kind::Flag => matches!(value, Value::Flag(_)),
        Kind::List(..) => matches!(value, Value::List(_)),
        Kind::Table(_) => matches!(value, Value::Table(_)),
        _ => false,
    }
}

fn form(kind: &Kind) -> String {
    match kind {
        Kind::Number(range, unit) => with_unit(&range.phrase(), unit),
        Kind::Flag => "true or false".into(),
        Kind::List(_, least, most) if least == most => format!("a list of {least}"),
        Kind::List(..) => "a list".into(),
        Kind::Formula(variables, unit) => {
            with_unit(&format!("a number or a formula of {}", variables.join(", ")), unit)
        }
        _ => "a table".into(),
    }
}

fn with_unit(text: &str, unit: &str) -> String {
    if unit.is_empty() || unit == "1" { text.into() } else { format!("{text} [{unit}]") }
}

/// The number that a value is; a text is a formula without variables.
pub(crate) fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Whole(n) => Some(*n as f64),
        Value::Number(x) => Some(*x),
        Value::Text(text) => Expression::new(text, &[]).ok()?.fixed(),
        _ => None,
    }
}

/// Largest whole number up to which doubles hold all of them.
const LARGEST_WHOLE: f64 = 9_007_199_254_740_992.0;

/// The whole number that a value is; a text is a formula without variables.
pub(crate) fn whole(value: &Value) -> Option<i64> {
    match value {
        Value::Whole(n) => Some(*n),
        Value::Text(_) => {
            number(value).filter(|x| x.fract() == 0.0 && x.abs() <= LARGEST_WHOLE).map(|x| x as i64)
        }
        _ => None,
    }
}

/// Value or fault of a text as a formula, as the end of a message; empty for other values.
fn evaluated(value: &Value) -> String {
    let Value::Text(text) = value else { return String::new() };
    match Expression::new(text, &[]) {
        Ok(formula) => format!("; the formula is {}", formula.at(&[])),
        Err(error) => format!(", or a formula without variables: this one {error}"),
    }
}
