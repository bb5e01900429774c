//! The manual of scene files.
use super::{Kind, Need, SCENE, Table};
use std::fmt::Write;

/// The manual of all keys, of what a run leaves, and of limits, as Markdown: docs/scene.md is this text.
pub fn manual() -> String {
    let mut out = String::from(
        "# Scene files\n\n<!-- Made of crates/scene/src/schema by `cargo run --release -- manual`; do not edit. -->\n\n\
         `siltflow run scenes/NAME.toml` runs a scene (`cargo run --release -- run scenes/NAME.toml` from a checkout); `siltflow check` tells what would be run, `--set key.key=value` changes a value, \
         `--help` tells the rest. `scenes/schema.json` is this page for editors.\n\n",
    );
    let mut queue: Vec<(String, &'static Table, Option<&'static str>)> = vec![("".into(), &SCENE, None)];
    let mut done: Vec<*const Table> = Vec::new();
    while let Some((path, table, tag)) = queue.pop() {
        if done.contains(&std::ptr::from_ref(table)) {
            continue;
        }
        done.push(table);
        let heading = if path.is_empty() { "The file".into() } else { format!("`{path}`") };
        let _ = writeln!(out, "## {heading}\n\n{}\n", table.about);
        let mut below = Vec::new();
        if table.keys.is_empty() {
            let _ = writeln!(
                out,
                "It has no keys{}.\n",
                tag.map_or(String::new(), |tag| format!(" but `{tag}`"))
            );
        } else {
            out.push_str("| key | what | takes | without it | example |\n|---|---|---|---|---|\n");
        }
        for key in table.keys {
            let default = match key.need {
                Need::Required => "**required**",
                Need::Default(default) => default,
            };
            let about = cell(key.about);
            let _ = writeln!(
                out,
                "| `{}` | {about} | {} | {} | `{}` |",
                key.name,
                cell(&takes(&key.kind)),
                cell(default),
                cell(key.example)
            );
            let inner = if path.is_empty() { key.name.into() } else { format!("{path}.{}", key.name) };
            tables(&key.kind, &inner, &mut below);
        }
        out.push('\n');
        queue.extend(below.into_iter().rev());
    }
    out.truncate(out.trim_end().len());
    out.push('\n');
    out + include_str!("results.md") + include_str!("limits.md")
}

fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

fn takes(kind: &Kind) -> String {
    let unit = |unit: &str| if unit.is_empty() || unit == "1" { String::new() } else { format!(" [{unit}]") };
    match kind {
        Kind::Flag => "`true` or `false`".into(),
        Kind::Number(range, u) => format!("{}{}", range.phrase(), unit(u)),
        Kind::Whole(least, i64::MAX) => format!("a whole number from {least} on"),
        Kind::Whole(least, most) => format!("a whole number, {least} to {most}"),
        Kind::Text => "a text".into(),
        Kind::File => "a path".into(),
        Kind::Formula(variables, u) => {
            format!("a number, or a formula of {}{}", variables.join(", "), unit(u))
        }
        Kind::Word(words) => {
            let words: Vec<_> = words
                .iter()
                .map(
                    |(word, about)| {
                        if word == about { format!("`{word}`") } else { format!("`{word}`: {about}") }
                    },
                )
                .collect();
            words.join("; ")
        }
        Kind::List(of, least, most) if least == most => format!("a list of {least}: {}", takes(of)),
        Kind::List(of, least, most @ 0..=3) => format!("a list of {least} to {most}: {}", takes(of)),
        Kind::List(of, ..) => format!("a list: {}", takes(of)),
        Kind::Table(_) => "a table, see below".into(),
        Kind::Named(_) => "tables under names of your own, see below".into(),
        Kind::Choice(tag, tables) => {
            let words: Vec<_> = tables.iter().map(|(name, _)| format!("`{name}`")).collect();
            format!("a table whose `{tag}` is one of {}, or that word alone", words.join(", "))
        }
        Kind::Either(kinds) => kinds.iter().map(takes).collect::<Vec<_>>().join("; or "),
    }
}

fn tables(kind: &'static Kind, path: &str, out: &mut Vec<(String, &'static Table, Option<&'static str>)>) {
    match kind {
        Kind::Table(table) => out.push((path.into(), table, None)),
        Kind::Named(table) => out.push((format!("{path}.NAME"), table, None)),
        Kind::List(of, ..) => tables(of, path, out),
        Kind::Either(kinds) => kinds.iter().for_each(|kind| tables(kind, path, out)),
        Kind::Choice(tag, of) => {
            out.extend(
                of.iter()
                    .map(|&(name, table)| (format!("{path} = {{ {tag} = \"{name}\" }}"), table, Some(*tag))),
            );
        }
        _ => {}
    }
}
