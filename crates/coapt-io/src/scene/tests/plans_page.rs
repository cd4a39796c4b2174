//! `docs/plans.md` says what plans are: its plans can be read, and its figures are those of the program.

use std::path::Path;

use coapt::measure::flow::{Filling, HARDLY_OPENS_MM2, mean_diastolic_gradient_mmhg};
use coapt::model::size::grouped;
use coapt::plan::ensemble::SEALED_BELOW_MM2;
use coapt::plan::{COAPTATION_TARGET_MM, Criterion, DIASTOLIC_TARGET_MM2, Sampling};

use super::super::{ALTERNATIVE_LIMIT, Alternatives, Bound, alternatives_from_text};

#[test]
fn the_page_of_plans_holds() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/plans.md");
    let page = std::fs::read_to_string(path).unwrap();
    let flat = page.split_whitespace().collect::<Vec<_>>().join(" ");
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
    let default = made[1].criteria.as_deref().unwrap();
    assert_eq!(default, Criterion::DEFAULT, "the default that the page tells");
    let listed: Vec<String> = default.iter().map(|it| format!("`{}`", it.name())).collect();
    assert!(flat.contains(&format!("in this order: {}", listed.join(", "))));
    assert!(made[1].alternatives.iter().any(|it| it.name == "ring saddle 28"));
    assert!(flat.contains(&format!("from {SEALED_BELOW_MM2} mm² on, the table tells it")));
    asked_for(&flat, [&made[2], &made[3], &made[4], &made[5]]);
    let limit = grouped(ALTERNATIVE_LIMIT as usize);
    assert!(page.contains(&format!("more than {limit} refused")));
    assert!(page.contains(&format!("lacks less of {COAPTATION_TARGET_MM} mm")));
    assert!(page.contains(&format!("halved from {DIASTOLIC_TARGET_MM2} mm²")));
    assert!(flat.contains(&format!(
        "meshes differ by {} mm²",
        Criterion::DiastolicOrifice.noise()
    )));
    for criterion in Criterion::ALL {
        let step = match criterion {
            Criterion::Strain => format!("{} %", 100.0 * criterion.noise()),
            Criterion::DiastolicOrifice => criterion.bin_width().1.to_owned(),
            _ => format!("{} {}", criterion.noise(), criterion.unit()),
        };
        let start = format!("| `{}` |", criterion.name());
        let row = page.lines().find(|line| line.starts_with(&start)).unwrap();
        assert!(row.ends_with(&format!("| {step} |")), "{row}: {step}");
    }
}

/// What the other plans of the page ask for is what their sections say.
fn asked_for(page: &str, [open, unknown, goal, rates]: [&Alternatives; 4]) {
    let Filling {
        stroke_volume_ml,
        filling_time_s,
        ..
    } = Filling::default();
    assert!(page.contains(&format!("{stroke_volume_ml} mL in {filling_time_s} s")));
    let most = mean_diastolic_gradient_mmhg(HARDLY_OPENS_MM2, &Filling::default()).unwrap();
    assert!(page.contains(&format!("Below {HARDLY_OPENS_MM2} mm² no gradient is told")));
    assert!(page.contains(&format!("that flow would need {most:.0} mmHg")));
    assert!(open.asked.diastole && rates.asked.sensitivities && !unknown.asked.diastole);
    assert_eq!(open.ranked_by()[1], Criterion::DiastolicOrifice);
    assert_eq!(unknown.asked.sampling, Some(Sampling::default()));
    let deviations = serde_json::to_value(Sampling::default().uncertainty).unwrap();
    for (key, value) in deviations.as_object().unwrap() {
        let start = format!("| `{key}` |");
        let row = &page[page.find(&start).unwrap_or_else(|| panic!("{key}"))..];
        assert_eq!(
            row.split(" | ").nth(2).and_then(|cell| cell.split(" |").next()),
            Some(&*value.to_string())
        );
    }
    let search = goal.asked.search.as_ref().unwrap();
    assert_eq!(
        (search.bound, search.place.as_str()),
        (Bound::AtLeast(8.0), "repair[0]")
    );
}
