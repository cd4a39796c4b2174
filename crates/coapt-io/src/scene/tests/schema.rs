//! The published JSON Schemas are those of the types.

use std::path::Path;

use coapt::scene::{Plan, Scene};
use schemars::{Schema, schema_for};

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
    check("plan.schema.json", &schema_for!(Plan));
}
