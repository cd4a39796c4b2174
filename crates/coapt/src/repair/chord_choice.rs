//! Which chordae are meant: those of a group, or nearest to a place.

use std::collections::BTreeMap;

use super::rods::node_of;
use crate::Vec3;
use crate::mesh::topology::DisjointSets;
use crate::model::{ChordKind, Model};
use crate::scene::Fault;

/// No insertion so far from a place is meant by it [mm]; our choice, half a leaflet.
const REACH_MM: f64 = 10.0;

/// A chord: segments that hang together at branchings, a trunk with its branches.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct WholeChord {
    /// Its segments, ascending.
    pub(super) segments: Vec<usize>,
    /// Those that insert into a leaflet, each with the end that does, 0 or 1.
    pub(super) insertions: Vec<(usize, usize)>,
}

/// All chordae in the order of their first segments, without sutures.
pub(super) fn whole_chords(model: &Model) -> Vec<WholeChord> {
    let chords = &model.chords;
    let mut sets = DisjointSets::new(chords.ends.len());
    let mut first_at: BTreeMap<u32, u32> = BTreeMap::new();
    for (segment, ends) in (0..).zip(&chords.ends) {
        for node in ends.iter().filter_map(|&point| node_of(model, point)) {
            sets.join(*first_at.entry(node).or_insert(segment), segment);
        }
    }
    let (chord_of, count) = sets.numbered();
    let empty = WholeChord {
        segments: Vec::new(),
        insertions: Vec::new(),
    };
    let mut found = vec![empty; count];
    for (segment, &chord) in chord_of.iter().enumerate() {
        let chord = &mut found[chord as usize];
        chord.segments.push(segment);
        let on_leaflet = |&end: &usize| {
            let place = &chords.points[chords.ends[segment][end] as usize];
            place
                .iter()
                .all(|&(vertex, _)| (vertex as usize) < model.leaflet_vertex_count)
        };
        chord
            .insertions
            .extend([0, 1].into_iter().filter(on_leaflet).map(|end| (segment, end)));
    }
    found.retain(|chord| kind_of(model, chord.segments[0]) != ChordKind::Suture);
    found
}

fn kind_of(model: &Model, segment: usize) -> ChordKind {
    model.chord_groups[model.chords.group[segment] as usize].kind
}

/// Where a segment inserts [mm], in the open valve.
pub(super) fn insertion_mm(model: &Model, (segment, end): (usize, usize)) -> Vec3 {
    model
        .chords
        .point_mm(model.chords.ends[segment][end], &model.rest_mm)
}

/// The number of the chord group of that name, which is no suture's.
///
/// # Errors
/// There is none, with `place`.
pub(super) fn group_named(model: &Model, name: &str, place: &str) -> Result<u32, Fault> {
    let chordae = || {
        model
            .chord_groups
            .iter()
            .enumerate()
            .filter(|(_, group)| group.kind != ChordKind::Suture)
    };
    let found = chordae().find(|(_, group)| group.name == name);
    found.map(|(number, _)| number as u32).ok_or_else(|| {
        let names: Vec<String> = chordae().map(|(_, group)| format!("`{}`", group.name)).collect();
        Fault::error(
            place,
            format!(
                "is `{name}`, expected one of the chord groups {}",
                names.join(", ")
            ),
        )
    })
}

/// Those of `chords` that have a segment in the group.
///
/// # Errors
/// No such group, with `place`.
pub(super) fn in_group(
    model: &Model,
    chords: Vec<WholeChord>,
    group: Option<&str>,
    place: &str,
) -> Result<Vec<WholeChord>, Fault> {
    let Some(name) = group else { return Ok(chords) };
    let group = group_named(model, name, place)?;
    let is_of = |chord: &WholeChord| {
        chord
            .segments
            .iter()
            .any(|&segment| model.chords.group[segment] == group)
    };
    Ok(chords.into_iter().filter(is_of).collect())
}

/// The number of a chord, and a segment of it that inserts with the end that does.
pub(super) type Inserted = (usize, (usize, usize));

/// Insertions of these chordae, those nearest to a place first; of equals, the first.
///
/// # Errors
/// A place that is not finite, or that has no insertion near, with `place`.
pub(super) fn nearest_insertions(
    model: &Model,
    chords: &[WholeChord],
    near_mm: [f64; 3],
    place: &str,
) -> Result<Vec<Inserted>, Fault> {
    let near = Vec3::from(near_mm);
    let [x, y, z] = near_mm;
    if !near.iter().all(|coordinate| coordinate.is_finite()) {
        return Err(Fault::error(
            place,
            format!("is ({x}, {y}, {z}) mm, expected finite numbers"),
        ));
    }
    let away = |insertion: (usize, usize)| (insertion_mm(model, insertion) - near).norm();
    let numbered = chords.iter().enumerate();
    let mut found: Vec<Inserted> = numbered
        .flat_map(|(chord, whole)| whole.insertions.iter().map(move |&insertion| (chord, insertion)))
        .collect();
    found.sort_by(|a, b| away(a.1).total_cmp(&away(b.1)));
    match found.first() {
        Some(&(_, first)) if away(first) <= REACH_MM => Ok(found),
        Some(&(_, first)) => {
            let message = format!(
                "is ({x}, {y}, {z}) mm, {:.1} mm from the nearest insertion; expected a place within {REACH_MM} mm of one",
                away(first)
            );
            Err(Fault::of_shape(place, message))
        }
        None => Err(Fault::of_shape(
            place,
            "there is no chord that inserts in a leaflet",
        )),
    }
}
