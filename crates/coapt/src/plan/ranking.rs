//! The order of alternatives: certified repairs by the criteria, then the others.

use std::cmp::Ordering;

use super::{Criterion, Outcome, Row};

/// Sorts rows and gives certified repairs their places.
///
/// Places are those of the bins of each criterion in turn. Rows that no bin tells apart share a place and stand in the order
/// of the values themselves, then of their numbers: a total order, whatever the rows come in.
pub(super) fn rank(rows: &mut [Row], criteria: &[Criterion]) {
    rows.sort_by(|a, b| {
        let by_criteria = match (certified(a), certified(b)) {
            (Some(one), Some(other)) => {
                by_bins(one, other, criteria).then_with(|| by_costs(one, other, criteria))
            }
            _ => Ordering::Equal,
        };
        group(a)
            .cmp(&group(b))
            .then(by_criteria)
            .then(a.alternative.cmp(&b.alternative))
    });
    let mut rank = 0;
    for index in 0..rows.len() {
        let Some(outcome) = certified(&rows[index]).filter(|_| group(&rows[index]) == 0) else {
            break;
        };
        let is_tie = index > 0
            && certified(&rows[index - 1])
                .is_some_and(|better| by_bins(better, outcome, criteria) == Ordering::Equal);
        if !is_tie {
            rank = index + 1;
        }
        rows[index].rank = Some(rank);
    }
}

fn certified(row: &Row) -> Option<&Outcome> {
    row.result.as_ref().ok().filter(|outcome| outcome.is_certified())
}

/// Certified repairs, what is certified and none, what is not certified, what was not carried out.
fn group(row: &Row) -> u8 {
    match &row.result {
        Ok(outcome) if outcome.is_certified() && !row.only_takes_chordae => 0,
        Ok(outcome) if outcome.is_certified() => 1,
        Ok(_) => 2,
        Err(_) => 3,
    }
}

fn by_bins(a: &Outcome, b: &Outcome, criteria: &[Criterion]) -> Ordering {
    let bins = |outcome: &Outcome| -> Vec<u64> {
        let bin = |criterion: &Criterion| criterion.bin(&outcome.measures, outcome.diastole.as_ref());
        criteria.iter().map(bin).collect()
    };
    bins(a).cmp(&bins(b))
}

fn by_costs(a: &Outcome, b: &Outcome, criteria: &[Criterion]) -> Ordering {
    let compared = criteria.iter().map(|criterion| {
        let [one, other] = [a, b].map(|outcome| criterion.cost(&outcome.measures, outcome.diastole.as_ref()));
        one.total_cmp(&other)
    });
    compared.fold(Ordering::Equal, Ordering::then)
}
