//! Chordae cut, or torn.

use std::collections::BTreeSet;

use super::chord_choice::{WholeChord, in_group, nearest_insertions, whole_chords};
use super::rods::without;
use crate::model::Model;
use crate::repair::{Repaired, Report};
use crate::scene::{ChordPart, CutChord, Fault};

/// What was cut.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct CutReport {
    /// Chordae, or branches, that were cut.
    pub count: usize,
    /// How many chords of one kind were there to choose from.
    pub of: usize,
    /// Segments that the valve has lost, with those left hanging.
    pub segments: usize,
}

/// Cuts chordae.
///
/// # Errors
/// No such group; a place far from all chordae; more than there are; neither group nor place.
pub fn cut(model: &Model, cut: &CutChord) -> Result<Repaired, Vec<Fault>> {
    chosen(model, cut)
        .map_err(|fault| vec![fault])
        .map(|(segments, count, of)| {
            let after = without(model, &segments);
            Repaired {
                report: Report::CutChord(report(model, &after, count, of)),
                model: after,
                warnings: Vec::new(),
            }
        })
}

pub(super) fn report(before: &Model, after: &Model, count: usize, of: usize) -> CutReport {
    CutReport {
        count,
        of,
        segments: before.chords.ends.len() - after.chords.ends.len(),
    }
}

/// The segments to cut, of how many chordae or branches, and of how many that there are.
fn chosen(model: &Model, cut: &CutChord) -> Result<(BTreeSet<usize>, usize, usize), Fault> {
    if cut.group.is_none() && cut.near_mm.is_none() {
        return Err(Fault::error(
            "cut-chord.group",
            "is missing; expected the name of a chord group, or `near_mm`",
        ));
    }
    let chords = in_group(
        model,
        whole_chords(model),
        cut.group.as_deref(),
        "cut-chord.group",
    )?;
    let units = units(&chords, cut.part);
    if units.is_empty() {
        let group = cut.group.as_deref().unwrap_or_default();
        let message = format!("is `{group}`, which has no chordae any more; expected a group that has");
        return Err(Fault::of_shape("cut-chord.group", message));
    }
    let Some(near_mm) = cut.near_mm else {
        if cut.count.is_some() {
            let message = "is given without `near_mm`, which says which ones; expected both, or neither";
            return Err(Fault::error("cut-chord.count", message));
        }
        return Ok((
            units.iter().flatten().copied().collect(),
            units.len(),
            units.len(),
        ));
    };
    let nearest = nearest_insertions(model, &chords, near_mm, "cut-chord.near_mm")?;
    let wanted = cut.count.unwrap_or(1) as usize;
    if wanted == 0 || wanted > units.len() {
        let message = format!("is {wanted}, expected 1 to {}", units.len());
        return Err(Fault {
            of_shape: wanted > 0,
            ..Fault::error("cut-chord.count", message)
        });
    }
    let mut picked: Vec<usize> = Vec::new();
    for (_, (segment, _)) in nearest {
        let unit = units.iter().position(|unit| unit.contains(&segment));
        picked.extend(unit.filter(|unit| !picked.contains(unit) && picked.len() < wanted));
    }
    Ok((
        picked.iter().flat_map(|&unit| &units[unit]).copied().collect(),
        wanted,
        units.len(),
    ))
}

/// What can be cut, as segments: chordae with all that belongs to them, or each branch.
fn units(chords: &[WholeChord], part: ChordPart) -> Vec<Vec<usize>> {
    match part {
        ChordPart::Chord => chords.iter().map(|chord| chord.segments.clone()).collect(),
        ChordPart::Branch => {
            let branches = chords.iter().flat_map(|chord| &chord.insertions);
            branches.map(|&(segment, _)| vec![segment]).collect()
        }
    }
}
