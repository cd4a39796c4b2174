//! The published JSON Schemas are those of the types.

use std::path::Path;

use coapt::plan::ensemble::Uncertainty;
use coapt::plan::{Criterion, Sampling};
use coapt::scene::{Plan, Scene};
use schemars::{Schema, schema_for};
use serde_json::{Map, Value, json};

use super::super::SAMPLE_LIMIT;

/// Set this to write the schemas anew.
const REFRESH: &str = "COAPT_REFRESH_SCHEMAS";

fn check(file: &str, schema: &Schema) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../assets/schema")
        .join(file);
    let text = serde_json::to_string_pretty(schema).unwrap() + "\n";
    if std::env::var_os(REFRESH).is_some() {
        std::fs::write(&path, &text).unwrap();
    }
    let published = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        published == text,
        "assets/schema/{file} is out of date; refresh it with: {REFRESH}=1 cargo test -p coapt-io schema"
    );
}

#[test]
fn the_published_schemas_are_up_to_date() {
    check("scene.schema.json", &schema_for!(Scene));
    check("plan.schema.json", &with_alternatives(schema_for!(Plan)));
}

/// The schema of a plan with what its reader makes alternatives of: blocks, lists and ranges.
fn with_alternatives(plan: Schema) -> Schema {
    let mut plan = Value::from(plan);
    sweep_keys(&mut plan["$defs"]);
    plan["description"] =
        "Repairs that every alternative begins with, applied in order, and alternatives.".into();
    plan["$defs"]["Range"] = json!({
        "description": "The values from `from` to `to` in steps of `step`.",
        "type": "object",
        "properties": { "from": { "type": "number" }, "to": { "type": "number" }, "step": { "type": "number", "exclusiveMinimum": 0 } },
        "required": ["from", "to", "step"],
        "additionalProperties": false
    });
    plan["$defs"]["Alternative"] = json!({
        "description": "What is done after the repairs that every alternative begins with.",
        "type": "object",
        "properties": {
            "name": { "description": "What it is called in reports; made from its repairs if left out.", "type": "string" },
            "repair": { "description": "Its repairs.", "type": "array", "items": { "$ref": "#/$defs/Repair" } }
        },
        "additionalProperties": false
    });
    plan["$defs"]["Criterion"] = schema_for!(Criterion).into();
    if let Some(criterion) = plan["$defs"]["Criterion"].as_object_mut() {
        criterion.remove("$schema");
    }
    plan["properties"]["alternative"] = json!({
        "description": "Alternatives, each compared with the valve as it is.",
        "type": "array",
        "items": { "$ref": "#/$defs/Alternative" }
    });
    plan["properties"]["ranking"] = json!({
        "description": "How alternatives are ranked.",
        "type": "object",
        "properties": {
            "criteria": {
                "description": "The most important first.",
                "type": "array",
                "items": { "$ref": "#/$defs/Criterion" },
                "minItems": 1,
                "uniqueItems": true
            }
        },
        "required": ["criteria"],
        "additionalProperties": false
    });
    asked(&mut plan["properties"]);
    Schema::try_from(plan).unwrap()
}

/// What a plan asks for beside its alternatives.
fn asked(properties: &mut Value) {
    properties["diastole"] = json!({
        "description": "Whether each valve is also relaxed without pressure, for the orifice that it opens to; absent: where an alternative joins the leaflets edge to edge and the plan does not say what ranks.",
        "type": "boolean"
    });
    properties["warm"] = json!({
        "description": "Whether alternatives that differ from an earlier one in their last repair alone begin at its closed shape.",
        "type": "boolean",
        "default": false,
    });
    properties["sensitivities"] = json!({
        "description": "Whether to tell how fast the criteria change with the numbers in the repairs and the length of the chordae.",
        "type": "boolean",
        "default": false
    });
    let mut unknown = Value::from(schema_for!(Uncertainty));
    let Sampling {
        samples,
        seed,
        alternatives,
        ..
    } = Sampling::default();
    for (key, description, default, minimum) in [
        ("samples", "Valves of an ensemble.", u64::from(samples), 1),
        (
            "seed",
            "Which ensemble: the same seed gives the same valves.",
            seed,
            0,
        ),
        (
            "alternatives",
            "So many alternatives have one, the best.",
            alternatives as u64,
            0,
        ),
    ] {
        unknown["properties"][key] = json!({
            "description": description, "type": "integer", "minimum": minimum, "default": default
        });
    }
    unknown["properties"]["samples"]["maximum"] = SAMPLE_LIMIT.into();
    unknown["description"] = "Ensembles of valves that an image could not tell from the given one; what is not known of it, as \
                              standard deviations of normal distributions, beyond three of which nothing is drawn."
        .into();
    for key in ["$schema", "title"] {
        unknown.as_object_mut().unwrap().remove(key);
    }
    properties["uncertainty"] = unknown;
    let number = |description: &str| json!({ "description": description, "type": "number" });
    let count = |description: &str| json!({ "description": description, "type": "integer", "minimum": 0 });
    properties["search"] = json!({
        "description": "The gentlest value of a number in a repair that reaches a goal; either at_least or at_most.",
        "type": "object",
        "properties": {
            "alternative": count("Whose repair it is, from 0; none for those that every alternative begins with."),
            "repair": count("Which of its repairs, from 0."),
            "key": { "description": "The number's key.", "type": "string" },
            "from": number("The gentlest value."),
            "to": number("The most drastic value."),
            "tolerance": { "description": "How exactly the answer is wanted.", "type": "number", "exclusiveMinimum": 0 },
            "measure": { "description": "A criterion, or the path of a measure in plan.json, such as coaptation/length_a2p2_mm.", "type": "string" },
            "at_least": number("The least that it should be."),
            "at_most": number("The most that it should be.")
        },
        "required": ["key", "from", "to", "tolerance", "measure"],
        "additionalProperties": false
    });
}

/// Every key of a repair that takes one value takes a list of them too, and a range where they are numbers.
fn sweep_keys(definitions: &mut Value) {
    let known = definitions.clone();
    for kind in definitions["Repair"]["oneOf"].as_array_mut().unwrap() {
        let of_ref = |kind: &Value| {
            let name = kind["$ref"].as_str()?.strip_prefix("#/$defs/")?;
            Some(known[name].clone())
        };
        // A kind may stand elsewhere, with only its tag here.
        let elsewhere = of_ref(kind);
        let properties = elsewhere
            .as_ref()
            .and_then(|it| it["properties"].as_object())
            .cloned();
        let here = kind["properties"].as_object_mut().unwrap();
        for (key, value) in properties.unwrap_or_default() {
            here.entry(key).or_insert(value);
        }
        let keys = here.iter_mut().filter(|(key, _)| *key != "kind");
        keys.for_each(|(_, value)| *value = swept(value, &known));
    }
}

fn swept(value: &Value, known: &Value) -> Value {
    let is_value = |kind: &Value| {
        ["string", "number", "integer", "boolean"]
            .iter()
            .any(|name| kind == name)
    };
    let takes = |schema: &Value, which: &dyn Fn(&Value) -> bool| match &schema["type"] {
        Value::Array(types) => types.iter().any(which),
        one => which(one),
    };
    // Optional ones of a named type stand in a list with null.
    let alone = value["anyOf"]
        .as_array()
        .and_then(|all| all.iter().find(|it| !it["$ref"].is_null()));
    let name = alone.unwrap_or(value)["$ref"]
        .as_str()
        .and_then(|name| name.strip_prefix("#/$defs/"));
    let is_name = name.is_some_and(|name| known[name]["oneOf"].is_array() || known[name]["enum"].is_array());
    if !is_name && !takes(value, &is_value) {
        return value.clone();
    }
    let mut one = value.clone();
    let mut whole = Map::new();
    for key in ["description", "default"] {
        if let Some(moved) = one.as_object_mut().and_then(|one| one.remove(key)) {
            whole.insert(key.into(), moved);
        }
    }
    let mut choices = vec![
        one.clone(),
        json!({ "type": "array", "items": one, "minItems": 1 }),
    ];
    if takes(value, &|kind| kind == "number" || kind == "integer") {
        choices.push(json!({ "$ref": "#/$defs/Range" }));
    }
    whole.insert("anyOf".into(), choices.into());
    whole.into()
}

#[test]
fn lists_and_ranges_are_in_the_schema_where_one_value_is() {
    let plan = Value::from(with_alternatives(schema_for!(Plan)));
    let ring = &plan["$defs"]["Repair"]["oneOf"][0]["properties"];
    assert_eq!(ring["size_mm"]["anyOf"][2]["$ref"], "#/$defs/Range");
    for key in ["family", "attachment", "placed", "curve_file"] {
        assert_eq!(ring[key]["anyOf"][1]["type"], "array", "{key}");
        assert_eq!(ring[key]["anyOf"][2], Value::Null, "{key}");
    }
    assert!(ring["curve_mm"]["anyOf"].is_null(), "a list by nature");
    assert!(ring["kind"]["anyOf"].is_null());
}
