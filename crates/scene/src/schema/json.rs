//! The schema as JSON Schema (draft 2020-12), for editors.
use super::{Key, Kind, Need, Range, SCENE, Table};
use serde_json::{Map, Value, json};

/// The schema of scene files as JSON Schema, pretty-printed: what editors complete keys from.
pub fn json_schema() -> String {
    let mut definitions = Map::new();
    let mut root = table(&SCENE, &mut definitions);
    root["$schema"] = json!("https://json-schema.org/draft/2020-12/schema");
    root["title"] = json!("Scene");
    root["$defs"] = Value::Object(definitions);
    let mut text = format!("{root:#}");
    text.push('\n');
    text
}

fn table(table: &Table, definitions: &mut Map<String, Value>) -> Value {
    let properties: Map<_, _> =
        table.keys.iter().map(|key| (key.name.into(), property(key, definitions))).collect();
    let required: Vec<_> =
        table.keys.iter().filter(|key| key.need == Need::Required).map(|key| key.name).collect();
    let mut out = json!({
        "type": "object",
        "description": table.about,
        "properties": properties,
        "additionalProperties": false,
    });
    if !required.is_empty() {
        out["required"] = json!(required);
    }
    out
}

fn property(key: &Key, definitions: &mut Map<String, Value>) -> Value {
    let mut out = kind(&key.kind, definitions);
    let text = match key.need {
        Need::Required => format!("{} Required.", key.about),
        Need::Default(default) => format!("{} Default: {default}.", key.about),
    };
    out["description"] = json!(text);
    out
}

fn kind(kind_: &Kind, definitions: &mut Map<String, Value>) -> Value {
    match kind_ {
        Kind::Flag => json!({ "type": "boolean" }),
        Kind::Number(range, unit) => {
            let mut out = json!({ "type": ["number", "string"] });
            match range {
                Range::Any => {}
                Range::Positive => out["exclusiveMinimum"] = json!(0),
                Range::NotNegative => out["minimum"] = json!(0),
                Range::Within(a, b) => (out["minimum"], out["maximum"]) = (json!(a), json!(b)),
                Range::Above(a, b) => (out["exclusiveMinimum"], out["maximum"]) = (json!(a), json!(b)),
            }
            out["$comment"] = json!(unit);
            out
        }
        Kind::Whole(least, most) => {
            json!({ "type": ["integer", "string"], "minimum": least, "maximum": most })
        }
        Kind::Text | Kind::File => json!({ "type": "string" }),
        Kind::Formula(..) => json!({ "type": ["number", "string"] }),
        Kind::Word(words) => {
            let words: Vec<_> = words.iter().map(|(word, _)| *word).collect();
            json!({ "enum": words })
        }
        Kind::List(of, least, most) => {
            json!({ "type": "array", "items": kind(of, definitions), "minItems": least, "maxItems": most })
        }
        Kind::Table(inner) => table(inner, definitions),
        Kind::Named(inner) => json!({ "type": "object", "additionalProperties": table(inner, definitions) }),
        Kind::Choice(tag, tables) => {
            // Shapes hold shapes: choices are defined once, under the name of their first word.
            let name = format!("{tag}-{}", tables.first().map_or("", |(name, _)| name));
            if !definitions.contains_key(&name) {
                definitions.insert(name.clone(), Value::Null);
                let choice = choice(tag, tables, definitions);
                definitions.insert(name.clone(), choice);
            }
            json!({ "$ref": format!("#/$defs/{name}") })
        }
        Kind::Either(kinds) => {
            let kinds: Vec<_> = kinds.iter().map(|k| kind(k, definitions)).collect();
            json!({ "anyOf": kinds })
        }
    }
}

fn choice(tag: &str, tables: &[(&str, &Table)], definitions: &mut Map<String, Value>) -> Value {
    let mut forms = Vec::new();
    let alone = |table: &Table| table.keys.iter().all(|key| key.need != Need::Required);
    let words: Vec<_> = tables.iter().filter(|(_, t)| alone(t)).map(|(name, _)| *name).collect();
    if !words.is_empty() {
        forms.push(json!({ "enum": words }));
    }
    for (name, inner) in tables {
        let mut form = table(inner, definitions);
        form["properties"][tag] = json!({ "const": name });
        let mut required = vec![json!(tag)];
        required.extend(form["required"].as_array().cloned().unwrap_or_default());
        form["required"] = Value::Array(required);
        forms.push(form);
    }
    json!({ "oneOf": forms })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn references_are_defined() {
        let schema: Value = serde_json::from_str(&json_schema()).unwrap();
        let text = schema.to_string();
        for part in text.split("\"#/$defs/").skip(1) {
            let name = part.split('"').next().unwrap();
            assert!(schema["$defs"][name].is_object(), "{name}");
        }
        assert!(schema["properties"]["fluid"]["properties"]["density"]["exclusiveMinimum"] == json!(0));
    }
}
