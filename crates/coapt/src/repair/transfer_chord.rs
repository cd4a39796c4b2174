//! A chord set elsewhere: to another place of a leaflet, or to another papillary tip.

use std::collections::BTreeSet;

use super::chord_choice::{in_group, insertion_mm, nearest_insertions, whole_chords};
use super::chord_ends::{LeafletPlace, insertions, tip};
use super::rods::without;
use crate::Vec3;
use crate::model::Model;
use crate::repair::{Repaired, Report};
use crate::scene::{Fault, TransferChord};

/// What was moved.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct TransferReport {
    /// Name of the chord's group.
    pub group: String,
    /// Where it inserted [mm], in the open valve.
    pub from_mm: [f64; 3],
    /// Where it inserts now [mm].
    pub to_mm: [f64; 3],
    /// Name of the papillary muscle that it was set to; absent where it stayed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub muscle: Option<String>,
    /// Unloaded length of the segment that inserts [mm].
    pub length_mm: f64,
    /// Distance that it spans in the open valve now [mm].
    pub open_mm: f64,
}

/// Moves the chord whose insertion is nearest to a place.
///
/// # Errors
/// No chord there; no such leaflet, place, muscle or tip; nothing to move it to.
pub fn transfer(model: &Model, transfer: &TransferChord) -> Result<Repaired, Vec<Fault>> {
    transferred(model, transfer).map_err(|fault| vec![fault])
}

fn transferred(model: &Model, transfer: &TransferChord) -> Result<Repaired, Fault> {
    if transfer.leaflet.is_none() && transfer.muscle.is_none() {
        let message = "is missing; expected the leaflet or the papillary `muscle` that the chord is moved to";
        return Err(Fault::error("transfer-chord.leaflet", message));
    }
    let chords = in_group(
        model,
        whole_chords(model),
        transfer.group.as_deref(),
        "transfer-chord.group",
    )?;
    let nearest = nearest_insertions(model, &chords, transfer.near_mm, "transfer-chord.near_mm")?;
    let Some(&(chord, (segment, end))) = nearest.first() else {
        return Err(Fault::of_shape(
            "transfer-chord.near_mm",
            "there is no chord that inserts in a leaflet",
        ));
    };
    let from_mm = insertion_mm(model, (segment, end)).into();
    let mut moved = model.clone();
    if let Some(leaflet) = &transfer.leaflet {
        let place = LeafletPlace {
            leaflet,
            site: transfer.site,
            position: transfer.position,
            inset_mm: transfer.inset_mm,
            point_mm: transfer.point_mm,
        };
        for (insertion, _) in insertions(model, place, (1, 0.0), "transfer-chord")? {
            moved.chords.ends[segment][end] = moved.chords.points.len() as u32;
            moved.chords.points.push(insertion.vertices);
        }
    }
    let mut muscle = None;
    if let Some(name) = &transfer.muscle {
        let near = insertion_mm(&moved, (segment, end));
        let tip = tip(model, Some(name), transfer.tip, near, "transfer-chord")?;
        muscle = Some(model.papillary[tip.muscle].name.clone());
        set_tip(&mut moved, &chords[chord].segments, tip.vertex);
    }
    // The point that it left belongs to nothing any more.
    let moved = without(&moved, &BTreeSet::new());
    let ends: [Vec3; 2] =
        moved.chords.ends[segment].map(|point| moved.chords.point_mm(point, &moved.rest_mm));
    let report = TransferReport {
        group: model.chord_groups[model.chords.group[segment] as usize]
            .name
            .clone(),
        from_mm,
        to_mm: ends[end].into(),
        muscle,
        length_mm: moved.chords.rest_length_mm[segment],
        open_mm: (ends[1] - ends[0]).norm(),
    };
    Ok(Repaired {
        model: moved,
        report: Report::TransferChord(report),
        warnings: Vec::new(),
    })
}

/// Lets what came from any tip come from this one.
fn set_tip(model: &mut Model, segments: &[usize], tip: u32) {
    let tips: BTreeSet<u32> = model
        .papillary
        .iter()
        .flat_map(|muscle| &muscle.tips)
        .copied()
        .collect();
    for &segment in segments {
        for end in 0..2 {
            let place = &model.chords.points[model.chords.ends[segment][end] as usize];
            if matches!(place[..], [(vertex, _)] if tips.contains(&vertex)) {
                model.chords.ends[segment][end] = model.chords.points.len() as u32;
                model.chords.points.push(vec![(tip, 1.0)]);
            }
        }
    }
}
