//! Material files as a JSON Schema, for editors that complete and check while one types.

use serde_json::{Map, Value as Json, json};

use super::VERSION;
use super::colour::ColourSpace;
use super::read::{ROUGHNESS, ROUGHNESSES, spellings};
use crate::ior::{Class, provenances};
use crate::material::{Model, Parameter, ParameterKind, Profile};

/// The schema of a material file (JSON Schema, draft 2020-12), from the same tables that the reader follows.
///
/// What takes several parameters together, or the data sets, is beyond it: `gonio check` knows.
pub fn schema() -> Json {
    let models: Vec<Json> = Model::ALL.iter().map(|&model| of_model(model)).collect();
    let spaces = ColourSpace::ALL.map(ColourSpace::name);
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Materials of gonio",
        "type": "object",
        "additionalProperties": false,
        "required": ["gonio"],
        "properties": {
            "gonio": {
                "description": "conventions of the file",
                "type": "object",
                "additionalProperties": false,
                "required": ["version"],
                "properties": {
                    "version": { "const": VERSION as i64 },
                    "color": { "enum": spaces, "description": "how colours are written" },
                    "roughness": { "enum": ROUGHNESSES, "description": "what `roughness` means" },
                    "profile": {
                        "enum": Profile::ALL.map(Profile::name),
                        "default": Profile::default().name(),
                        "description": "whose ranges colours are held against",
                    },
                },
            },
            "material": {
                "type": "object",
                "propertyNames": { "pattern": "^[A-Za-z0-9_-][A-Za-z0-9_.-]*$" },
                "additionalProperties": { "oneOf": models },
            },
        },
    })
}

fn of_model(model: Model) -> Json {
    let mut properties = of_table(model.parameters());
    properties.insert("model".to_owned(), json!({ "const": model.name(), "description": model.summary() }));
    let reason = json!({ "type": "string", "minLength": 1 });
    properties.insert(
        "allow".to_owned(),
        json!({
            "description": "warnings that are meant, by code and parameter, each with a reason",
            "type": "object",
            "propertyNames": { "pattern": "^[Gg][0-9]{3}$" },
            "additionalProperties": {
                "type": "object",
                "additionalProperties": { "anyOf": [reason, { "type": "object", "additionalProperties": reason }] },
            },
        }),
    );
    json!({
        "title": model.name(),
        "type": "object",
        "required": ["model"],
        "additionalProperties": false,
        "properties": properties,
    })
}

fn of_table(parameters: &'static [Parameter]) -> Map<String, Json> {
    let mut properties = Map::new();
    for parameter in parameters {
        let mut schema = of_kind(parameter.kind);
        schema.insert("title".to_owned(), json!(parameter.label));
        let unit = if parameter.unit.is_empty() { String::new() } else { format!(" [{}]", parameter.unit) };
        schema.insert("description".to_owned(), json!(format!("{}{unit}", parameter.doc)));
        for (key, factor) in spellings(parameter) {
            let mut schema = schema.clone();
            // What α a roughness means is for the file to say.
            if factor == 1.0 && key != ROUGHNESS {
                schema
                    .extend(parameter.default.as_ref().map(|default| ("default".to_owned(), json!(default))));
            } else {
                // The same range in another unit.
                for bound in ["minimum", "maximum"] {
                    if let Some(value) = schema.get(bound).and_then(Json::as_f64) {
                        schema.insert(bound.to_owned(), json!(value / factor));
                    }
                }
            }
            properties.insert(key, Json::Object(schema));
        }
    }
    properties
}

fn of_kind(kind: ParameterKind) -> Map<String, Json> {
    let number = |[low, high]: [f64; 2]| json!({ "type": "number", "minimum": low, "maximum": high });
    let channels = |range: [f64; 2]| {
        let list = json!({ "type": "array", "items": number(range), "minItems": 3, "maxItems": 3 });
        json!({ "anyOf": [number(range), list] })
    };
    let schema = match kind {
        ParameterKind::Number { range } => number(range),
        ParameterKind::Channels { range } => channels(range),
        ParameterKind::Colour => {
            let share = channels([0.0, 1.0]);
            let spaces = ColourSpace::ALL.map(|space| (space.name().to_owned(), share.clone()));
            let own = json!({
                "type": "object",
                "properties": Map::from_iter(spaces),
                "additionalProperties": false,
                "minProperties": 1,
                "maxProperties": 1,
            });
            json!({ "anyOf": [share, own] })
        }
        ParameterKind::OneOf { numbers } => json!({ "enum": numbers }),
        ParameterKind::Choice { choices } => {
            json!({ "enum": choices.iter().map(|choice| choice.name).collect::<Vec<_>>() })
        }
        ParameterKind::DataSet => {
            let metals = provenances().unwrap_or_default().iter().filter(|table| table.class == Class::Metal);
            json!({ "type": "string", "examples": metals.map(|table| &table.table).collect::<Vec<_>>() })
        }
        ParameterKind::Group { parameters } => json!({
            "type": "object",
            "additionalProperties": false,
            "properties": of_table(parameters),
        }),
    };
    if let Json::Object(schema) = schema { schema } else { Map::new() }
}
