//! `docs/plans.md` says what plans are: its plans can be read, and its figures are those of the program.

use std::path::Path;

use coapt::model::size::grouped;
use coapt::plan::{COAPTATION_TARGET_MM, Criterion};

use super::super::{ALTERNATIVE_LIMIT, alternatives_from_text};

#[test]
fn the_page_of_plans_holds() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/plans.md");
    let page = std::fs::read_to_string(path).unwrap();
    let plans = page
        .split("```toml\n")
        .skip(1)
        .map(|rest| rest.split("```").next().unwrap());
    let made: Vec<_> = plans
        .map(|text| {
            alternatives_from_text(Path::new("page.toml"), text, ALTERNATIVE_LIMIT)
                .unwrap()
                .0
        })
        .collect();
    assert_eq!(made[0].alternatives.len(), 1);
    assert!(page.contains(&format!("These are {} alternatives", made[1].alternatives.len())));
    assert_eq!(
        made[1].criteria,
        Criterion::ALL,
        "the default that the page tells"
    );
    assert!(made[1].alternatives.iter().any(|it| it.name == "ring saddle 28"));
    let limit = grouped(ALTERNATIVE_LIMIT as usize);
    assert!(page.contains(&format!("more than {limit} refused")));
    assert!(page.contains(&format!("lacks less of {COAPTATION_TARGET_MM} mm")));
    for criterion in Criterion::ALL {
        let step = match criterion {
            Criterion::Strain => format!("{} %", 100.0 * criterion.noise()),
            _ => format!("{} {}", criterion.noise(), criterion.unit()),
        };
        let start = format!("| `{}` |", criterion.name());
        let row = page.lines().find(|line| line.starts_with(&start)).unwrap();
        assert!(row.ends_with(&format!("| {step} |")), "{row}: {step}");
    }
}
