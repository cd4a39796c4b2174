//! `docs/hard-cases.md`.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use super::{End, HardCase, JITTER, Outcome, STARTS};

/// Writes the table where the environment asks for it; otherwise holds what it says of each case against how that ended.
/// Figures may differ from machine to machine, names and ends may not.
pub(super) fn write_or_compare(cases: &[HardCase], outcomes: &[&[Outcome]]) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/hard-cases.md");
    if std::env::var_os("COAPT_WRITE_TABLES").is_some() {
        fs::write(&path, text(cases, outcomes)).expect("docs can be written to");
        return;
    }
    let found = fs::read_to_string(&path).expect("the table is there");
    let rows: Vec<&str> = found
        .lines()
        .filter(|line| line.starts_with("| "))
        .skip(1)
        .collect();
    let expected: Vec<String> = cases
        .iter()
        .map(|case| format!("| {} | {} | {} |", case.name, case.what, end(case)))
        .collect();
    assert_eq!(
        rows.len(),
        expected.len(),
        "write the table anew, with COAPT_WRITE_TABLES=1"
    );
    for (row, expected) in rows.iter().zip(&expected) {
        assert!(
            row.starts_with(expected.as_str()),
            "`{expected}` is not in {}",
            path.display()
        );
    }
}

fn end(case: &HardCase) -> &'static str {
    match case.end {
        End::Certified => "certified",
        End::Uncertified(..) => "not certified",
        End::Refused(_) => "refused",
    }
}

fn text(cases: &[HardCase], outcomes: &[&[Outcome]]) -> String {
    let mut text = format!(
        "# Hard cases\n\nWritten by the test `every_hard_case_ends_as_it_says` (`tests/it/hard`) with `COAPT_WRITE_TABLES=1`; not by \
         hand.\n\nEach case is closed from {STARTS} starts, all but the first with every point moved by up to {JITTER} of an edge in \
         each direction; one start that ends otherwise than the case says fails the suite. Residual, crossings, moved are the \
         worst of the {STARTS}, iterations (on all meshes, coarse ones too) the median and the most, time the median, on one core of a \
         machine with other work. *Moved* is how far \
         from a tangled start the solver began; open valves that overlap are drawn apart before, as their models are made. For \
         research use; not a medical device.\n\n\
         | case | what is hard | end | residual | crossings | moved [mm] | iterations | most | time [ms] |\n\
         |---|---|---|---:|---:|---:|---:|---:|---:|\n"
    );
    for (case, outcomes) in cases.iter().zip(outcomes) {
        let _ = write!(text, "| {} | {} | {} |", case.name, case.what, end(case));
        let ends: Vec<_> = outcomes
            .iter()
            .filter_map(|outcome| outcome.equilibrium.as_ref())
            .collect();
        let mut times: Vec<f64> = outcomes.iter().map(|outcome| outcome.wall_ms).collect();
        times.sort_unstable_by(f64::total_cmp);
        let mut iterations: Vec<usize> = ends.iter().map(|end| end.history.len()).collect();
        iterations.sort_unstable();
        let Some(most) = iterations.last() else {
            let _ = writeln!(text, " | | | | | {:.0} |", times[times.len() / 2]);
            continue;
        };
        let worst = |of: &dyn Fn(&coapt::relax::Equilibrium) -> f64| {
            ends.iter().map(|end| of(end)).fold(0.0, f64::max)
        };
        let moved = worst(&|end| end.untangled.map_or(0.0, |untangled| untangled.farthest_mm));
        let _ = writeln!(
            text,
            " {:.0e} | {} | {} | {} | {most} | {:.0} |",
            worst(&|end| end.certificate.residual),
            worst(&|end| end.certificate.crossings.len() as f64),
            if moved > 0.0 {
                format!("{moved:.1}")
            } else {
                String::new()
            },
            iterations[iterations.len() / 2],
            times[times.len() / 2],
        );
    }
    for case in cases {
        let _ = match case.end {
            End::Certified => Ok(()),
            End::Uncertified(statuses, why) => writeln!(text, "\n**{}**: {statuses:?}. {why}.", case.name),
            End::Refused(words) => writeln!(text, "\n**{}**: refused, since {words}.", case.name),
        };
    }
    text
}
