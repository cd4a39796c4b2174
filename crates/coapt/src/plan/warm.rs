//! Alternatives that begin at each other's closed shapes: quick, where many differ in little.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use rayon::prelude::*;

use super::{Alternative, Outcome, Progress, Refusal, Row, Settings, Watch, apply_all, attempted, closed};
use crate::model::Model;
use crate::state::State;

/// A closed valve at which others may begin.
struct Begun {
    faces: Vec<[u32; 3]>,
    state: State,
}

/// Closes the alternatives: first those that no earlier one leads, then the others from where their leaders ended. A valve of other
/// triangles than its leader, or led by one that is not certified, begins open, and so does once more what came to no certificate.
pub(super) fn rows(
    model: &Model,
    alternatives: &[Alternative],
    settings: &Settings,
    watch: Watch,
) -> Vec<Row> {
    let leaders = leaders(alternatives);
    let kept = Settings {
        keep_positions: true,
        ..settings.clone()
    };
    let lead = |number: usize| {
        let result = attempted(model, &alternatives[number], &kept, watch);
        let begun = result
            .as_ref()
            .ok()
            .and_then(|outcome| begun(model, &alternatives[number], outcome));
        (result, begun)
    };
    let leading: Vec<usize> = (0..alternatives.len()).filter(|&at| leaders[at] == at).collect();
    let led = leading.par_iter().with_max_len(1).map(|&number| lead(number));
    let mut led: BTreeMap<usize, _> = leading.iter().copied().zip(led.collect::<Vec<_>>()).collect();
    let follow = |number: usize| {
        let start = led.get(&leaders[number]).and_then(|(_, begun)| begun.as_ref());
        from_leader(
            model,
            &alternatives[number],
            start.map(|start| (leaders[number], start)),
            settings,
            watch,
        )
    };
    let followers = (0..alternatives.len()).into_par_iter().with_max_len(1);
    let followed: Vec<Option<_>> = followers
        .map(|number| (leaders[number] != number).then(|| follow(number)))
        .collect();
    let mut result_of = |number: usize, followed: Option<Result<Outcome, Refusal>>| {
        followed.or_else(|| {
            let (mut result, _) = led.remove(&number)?;
            if let (Ok(outcome), false) = (&mut result, settings.keep_positions) {
                outcome.positions_mm = Vec::new();
            }
            Some(result)
        })
    };
    let numbered = followed.into_iter().enumerate();
    numbered
        .filter_map(|(number, followed)| {
            Some(Row {
                alternative: number,
                rank: None,
                result: result_of(number, followed)?,
            })
        })
        .collect()
}

/// For each alternative the first whose repairs are the same but for the last, which is of the same kind; itself where it is the
/// first.
fn leaders(alternatives: &[Alternative]) -> Vec<usize> {
    let mut first = BTreeMap::new();
    let numbered = alternatives.iter().enumerate();
    numbered
        .map(|(number, alternative)| {
            let Some((last, before)) = alternative.repairs.split_last() else {
                return number;
            };
            match first.entry(format!("{before:?} {:?}", std::mem::discriminant(last))) {
                Entry::Vacant(entry) => *entry.insert(number),
                Entry::Occupied(entry) => *entry.get(),
            }
        })
        .collect()
}

fn begun(model: &Model, alternative: &Alternative, outcome: &Outcome) -> Option<Begun> {
    if !outcome.is_certified() {
        return None;
    }
    let applied = apply_all(model, &alternative.repairs).ok()?;
    Some(Begun {
        faces: applied.model.faces,
        state: State {
            positions_mm: outcome.positions_mm.clone(),
        },
    })
}

fn from_leader(
    model: &Model,
    alternative: &Alternative,
    leader: Option<(usize, &Begun)>,
    settings: &Settings,
    watch: Watch,
) -> Result<Outcome, Refusal> {
    let Some((number, begun)) = leader else {
        return attempted(model, alternative, settings, watch);
    };
    // What is told of a closure that is not used would be counted twice.
    let quietly = |progress: &Progress| match progress {
        Progress::Iterated(_) => watch(progress),
        Progress::Closed | Progress::Refused => std::ops::ControlFlow::Continue(()),
    };
    if let Ok(applied) = apply_all(model, &alternative.repairs)
        && applied.model.faces == begun.faces
    {
        let outcome = closed(applied, Some(&begun.state), settings, &quietly);
        if outcome.is_certified() {
            let _ = watch(&Progress::Closed);
            return Ok(Outcome {
                begun_at: Some(number),
                ..outcome
            });
        }
    }
    attempted(model, alternative, settings, watch)
}
