//! What fuzzing found, and what was found by reading for the same reasons. `fuzz/README.md` says how it is run.

use super::*;
use coapt::scene::Fault;

#[test]
fn a_fault_quotes_a_long_word_in_part() {
    let word = "a".repeat(5000);
    for text in [
        format!("schema_version = 1\n{word} = 1\n"),
        format!("{{\"schema_version\": 1, \"{word}\": 1}}"),
    ] {
        let faults: Vec<Fault> = plan_from_text(Path::new("plan.toml"), &text).unwrap_err();
        assert!(
            faults.iter().all(|fault| fault.message.chars().count() < 1100),
            "{faults:?}"
        );
    }
}
