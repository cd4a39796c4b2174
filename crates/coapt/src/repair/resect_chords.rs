//! Which chordae a resection cuts.

use std::collections::BTreeSet;

use super::incision::Fields;
use crate::model::{ChordKind, Model};
use crate::scene::Fault;

/// So many chordae are named at most, for who is told of them.
const NAMED: usize = 3;

/// The segments that insert where all fields are negative.
///
/// # Errors
/// There are some, and `may_cut` is not set; an earlier repair's sutures are there.
pub(super) fn chords_in_piece(
    model: &Model,
    fields: &Fields,
    may_cut: bool,
) -> Result<BTreeSet<usize>, Fault> {
    let chords = &model.chords;
    let is_in_piece = |point: u32| {
        let place = &chords.points[point as usize];
        let on_leaflet = place
            .iter()
            .all(|&(v, _)| (v as usize) < model.leaflet_vertex_count);
        let value = |field: &Vec<f64>| {
            place
                .iter()
                .map(|&(v, weight)| weight * field[v as usize])
                .sum::<f64>()
        };
        on_leaflet && fields.iter().all(|field| value(field) < 0.0)
    };
    let inserts: Vec<(usize, u32)> = (0..chords.ends.len())
        .flat_map(|segment| chords.ends[segment].map(|point| (segment, point)))
        .filter(|&(_, point)| is_in_piece(point))
        .collect();
    let group = |segment: usize| &model.chord_groups[chords.group[segment] as usize];
    if let Some(&(suture, _)) = inserts
        .iter()
        .find(|(segment, _)| group(*segment).kind == ChordKind::Suture)
    {
        let message = format!(
            "holds sutures of `{}`; expected a piece that no earlier repair has sewn",
            group(suture).name
        );
        return Err(Fault::of_shape("resect", message));
    }
    if !may_cut && !inserts.is_empty() {
        let named = inserts.iter().take(NAMED).map(|&(segment, point)| {
            let at = chords.point_mm(point, &model.rest_mm);
            format!(
                "of `{}` at ({:.1}, {:.1}, {:.1}) mm",
                group(segment).name,
                at.x,
                at.y,
                at.z
            )
        });
        let named: Vec<String> = named.collect();
        let more = match inserts.len().saturating_sub(NAMED) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        let message = format!(
            "is not set, but chordae insert in the piece: {}{more}; expected a piece without, or `cut_chords = true`",
            named.join(", ")
        );
        return Err(Fault::of_shape("resect.cut_chords", message));
    }
    Ok(inserts.into_iter().map(|(segment, _)| segment).collect())
}
