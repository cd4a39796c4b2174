//! The files of `assets/hard`, closed by the program.

use coapt_tests::hard::cases;
use rayon::prelude::*;

use crate::program::{coapt, stderr, stdout};

/// Every file ends as the table of hard cases says: certified, refused, or with the status that says it is neither.
#[test]
fn every_hard_file_ends_as_the_table_says() {
    let cases = cases();
    // 22 rows of scenes on five presets, seven on one, and eight rings.
    assert_eq!(cases.len(), 125);
    let complaint = |case: &coapt_tests::hard::Case| {
        let scene = case.scene.display().to_string();
        let plan = case.plan.as_ref().map(|path| path.display().to_string());
        let mut arguments = vec!["closure", &scene, "--threads", "1"];
        if let Some(plan) = &plan {
            arguments.extend(["--plan", plan]);
        }
        let output = coapt(&arguments);
        let said = stdout(&output) + &stderr(&output);
        let is_right = output.status.code() == Some(case.exit_status) && !said.contains("panicked");
        (!is_right).then(|| format!("{arguments:?}: {:?}\n{said}", output.status))
    };
    let complaints: Vec<String> = cases.par_iter().filter_map(complaint).collect();
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}
