//! What fuzzing found, and what was found by reading for the same reasons. `fuzz/README.md` says how it is run.

use super::*;
use coapt::scene::Fault;

/// To find the line of each fault is to read the text once more: thousands of faults would take the square of its length.
#[test]
fn faults_are_told_up_to_twenty() {
    let muscle = "[[papillary]]\nname = \"a\"\ntips_file = \"nowhere\"\n";
    let text = format!("{}{}", two_leaflets(""), muscle.repeat(3000));
    let folder = Folder::new(
        "many-faults",
        &[("a.obj", SQUARE), ("b.obj", SQUARE), ("scene.toml", &text)],
    );
    let told = messages(&folder.read().unwrap_err(), Severity::Error);
    assert_eq!(told.len(), 21, "{told:#?}");
    assert!(
        told[19].contains("papillary[19].tips_file is `nowhere`"),
        "{told:#?}"
    );
    assert!(told[20].ends_with("and 2980 more like these"), "{told:#?}");
}

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
