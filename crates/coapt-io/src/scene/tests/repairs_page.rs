//! `docs/repairs.md` is written from the types of repairs: their keys, defaults and documentation stand in one place.

use std::fmt::Write;
use std::path::Path;

use coapt::scene::{ClipModel, ClipSize, Plan, ResectionShape};
use schemars::schema_for;
use serde_json::Value;

/// Set this to write the page anew.
const REFRESH: &str = "COAPT_REFRESH_SCHEMAS";

#[test]
fn the_page_of_repairs_is_up_to_date() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/repairs.md");
    let mended = std::fs::read_to_string(path.with_file_name("mended.md")).unwrap();
    let text = page(&Value::from(schema_for!(Plan)), &mended);
    // What sizes do is told where there are figures of it.
    for told in [
        "`flail`, triangular resection of 10 mm",
        "`restricted`, posterior patch of 10 by 30 mm",
    ] {
        assert!(text.contains(told), "{told}");
    }
    if std::env::var_os(REFRESH).is_some() {
        std::fs::write(&path, &text).unwrap();
    }
    let published = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        published == text,
        "docs/repairs.md is out of date; refresh it with: {REFRESH}=1 cargo test -p coapt-io repairs"
    );
    for [said, meant] in [
        [ClipSize::Short.grasp_mm(), 6.0],
        [ClipSize::Long.grasp_mm(), 9.0],
        [ClipModel::Springs.stiffness_n_per_mm(), 9.81],
        [ClipModel::Rigid.stiffness_n_per_mm(), 50.0],
        [ResectionShape::Triangular.width_mm(), 10.0],
        [ResectionShape::Quadrangular.width_mm(), 15.0],
    ] {
        assert_eq!(said, meant, "the page says {meant}");
    }
}

/// How `docs/mended.md` calls what is done by the repairs of a kind whose sizes it compares.
const COMPARED: [[&str; 2]; 2] = [
    ["resect", "triangular resection of "],
    ["augment", "posterior patch of "],
];

/// What sizes of a repair do to a valve, by the measurements of `docs/mended.md`; nothing where that does not compare them.
fn sizes(name: &str, mended: &str) -> String {
    let Some([_, start]) = COMPARED.into_iter().find(|[kind, _]| *kind == name) else {
        return String::new();
    };
    let rows = mended.lines().map(|line| line.split(" | ").collect::<Vec<_>>());
    let of = |row: &Vec<&str>| {
        let done = row.get(1).filter(|done| done.starts_with(start))?;
        let preset = row[0].trim_start_matches("| ");
        Some(format!("{preset}, {done}: orifice [mm²] {}", row.get(2)?))
    };
    let told: Vec<String> = rows.filter_map(|row| of(&row)).collect();
    format!(
        "\nSizes matter, as measured on presets of 650 triangles ([mended.md](mended.md)): {}.\n",
        told.join("; ")
    )
}

fn page(schema: &Value, mended: &str) -> String {
    let mut out = "# Repairs\n\nWritten by the test `the_page_of_repairs_is_up_to_date` with `COAPT_REFRESH_SCHEMAS=1`; not by hand. For \
                   research use; not a medical device.\n\nWhat `[[repair]]` and `[[alternative.repair]]` of a [plan](plans.md) may be, with \
                   their keys. Leaflets, papillary muscles and groups of chordae go by their names in the scene; of the presets: \
                   `anterior` and `posterior`, `anterolateral` and `posteromedial`, `marginal`, `intermediate`, `basal` and \
                   `strut`. Directions and points are in the scene's frame.\n"
        .to_owned();
    for kind in schema["$defs"]["Repair"]["oneOf"].as_array().unwrap() {
        let name = kind["properties"]["kind"]["const"].as_str().unwrap();
        let what = flat(&kind["description"]);
        let _ = writeln!(
            out,
            "\n## {name}\n\n{what}\n\n| key | takes | if absent | meaning |\n|---|---|---|---|"
        );
        let required = kind["required"].as_array().unwrap();
        let keys = kind["properties"].as_object().unwrap().iter();
        for (key, property) in keys.filter(|(key, _)| *key != "kind") {
            let absent = match &property["default"] {
                _ if required.iter().any(|it| it == key) => "must be there".to_owned(),
                Value::Null => String::new(),
                default => format!("`{default}`"),
            };
            let takes = takes(property, schema);
            let meaning = flat(&property["description"]);
            let _ = writeln!(out, "| `{key}` | {takes} | {absent} | {meaning} |");
        }
        out += &sizes(name, mended);
    }
    out
}

/// A description as one line of a table.
fn flat(description: &Value) -> String {
    description
        .as_str()
        .unwrap_or_default()
        .replace('\n', " ")
        .replace('|', "\\|")
}

/// What a key takes: the words of a choice, else a type in plain words.
fn takes(property: &Value, schema: &Value) -> String {
    if let Some(name) = property["$ref"]
        .as_str()
        .and_then(|path| path.strip_prefix("#/$defs/"))
    {
        let defined = &schema["$defs"][name];
        let choices = defined["oneOf"].as_array().into_iter().flatten();
        let words = choices
            .filter_map(|choice| choice["const"].as_str())
            .map(str::to_owned);
        let plain = defined["enum"].as_array().into_iter().flatten();
        let words = words.chain(plain.filter_map(|word| word.as_str().map(str::to_owned)));
        return words
            .map(|word| format!("`{word}`"))
            .collect::<Vec<_>>()
            .join(", ");
    }
    if let Some(any) = property["anyOf"].as_array() {
        return takes(&any[0], schema);
    }
    let of = |kind: &Value| match kind.as_str().unwrap_or_default() {
        "number" => "a number",
        "integer" => "a whole number",
        "boolean" => "`true` or `false`",
        "string" => "a text",
        "array" => "a list",
        _ => "",
    };
    match &property["type"] {
        Value::Array(kinds) => of(&kinds[0]).to_owned(),
        kind => of(kind).to_owned(),
    }
}
