//! Alternatives that begin at each other's shapes, closed and open: quick, where many differ in little.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::ops::ControlFlow;

use rayon::prelude::*;

use super::{
    Alternative, Diastole, Outcome, Progress, Refusal, Row, Settings, Start, Watch, apply_all, attempted,
    closed, joins_edges,
};
use crate::Vec3;
use crate::model::Model;
use crate::state::State;

/// A valve at whose shapes others may begin.
struct Begun {
    faces: Vec<[u32; 3]>,
    closed: State,
    opened: Option<State>,
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
        let alternative = &alternatives[number];
        let mut result = attempted(model, alternative, &kept, watch);
        let begun = result
            .as_ref()
            .ok()
            .and_then(|outcome| begun(model, alternative, outcome));
        if let (Ok(outcome), false) = (&mut result, settings.keep_positions) {
            outcome.forget_positions();
        }
        (number, (result, begun))
    };
    let leading: Vec<usize> = (0..alternatives.len())
        .filter(|&number| leaders[number] == number)
        .collect();
    let led = leading.into_par_iter().with_max_len(1).map(lead);
    let led: BTreeMap<usize, (Result<Outcome, Refusal>, Option<Begun>)> = led.collect();
    let close = |number: usize| {
        let leader = leaders[number];
        let (result, begun) = &led[&leader];
        match begun {
            _ if leader == number => result.clone(),
            Some(begun) => from_leader(model, &alternatives[number], (leader, begun), settings, watch),
            None => attempted(model, &alternatives[number], settings, watch),
        }
    };
    let all = (0..alternatives.len()).into_par_iter().with_max_len(1);
    let row = |number: usize| Row {
        alternative: number,
        rank: None,
        only_takes_chordae: alternatives[number].only_takes_chordae(),
        result: close(number),
    };
    all.map(row).collect()
}

/// For each alternative the first whose repairs are the same but for the last, which is of the same kind; itself where it is the
/// first, or the last joins the leaflets edge to edge. Where a clip sits decides how leaflets fold beside it: of clips in the dilated
/// valve, begun where one at another place had ended, two orifices came out 6.6 and 6.8 mm² smaller than from the open valve.
fn leaders(alternatives: &[Alternative]) -> Vec<usize> {
    let mut first = BTreeMap::new();
    let numbered = alternatives.iter().enumerate();
    numbered
        .map(|(number, alternative)| {
            let Some((last, before)) = alternative.repairs.split_last() else {
                return number;
            };
            if joins_edges(last) {
                return number;
            }
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
    let at = |positions_mm: &[Vec3]| State {
        positions_mm: positions_mm.to_vec(),
    };
    let opened = outcome
        .diastole
        .as_ref()
        .filter(|diastole| diastole.is_certified());
    Some(Begun {
        faces: applied.model.faces,
        closed: at(&outcome.positions_mm),
        opened: opened.map(|diastole| at(&diastole.positions_mm)),
    })
}

fn from_leader(
    model: &Model,
    alternative: &Alternative,
    (leader, begun): (usize, &Begun),
    settings: &Settings,
    watch: Watch,
) -> Result<Outcome, Refusal> {
    // Told once it is known that it is used: else a closure made again would count twice.
    let quietly = |progress: &Progress| match progress {
        Progress::Iterated(_) => watch(progress),
        Progress::Closed | Progress::Refused => ControlFlow::Continue(()),
    };
    if let Ok(applied) = apply_all(model, &alternative.repairs)
        && applied.model.faces == begun.faces
    {
        let start = Start {
            closed: Some(&begun.closed),
            opened: begun.opened.as_ref(),
        };
        let outcome = closed(applied, start, settings, &quietly);
        if outcome.is_certified() && outcome.diastole.as_ref().is_none_or(Diastole::is_certified) {
            let _ = watch(&Progress::Closed);
            return Ok(Outcome {
                begun_at: Some(leader),
                ..outcome
            });
        }
    }
    attempted(model, alternative, settings, watch)
}
