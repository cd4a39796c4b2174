//! Chordae of one segment that tear.

use std::collections::BTreeSet;

use super::chord_choice::{group_named, insertion_mm, whole_chords};
use super::cut_chord;
use super::leaflet::{LeafletMargin, leaflet_named};
use super::rods::without;
use super::sutures::leaflet_of;
use crate::mesh::polyline;
use crate::model::Model;
use crate::repair::{Repaired, Report};
use crate::scene::{Fault, Rupture, Segment};

/// Tears chordae of a segment, from its middle outward.
///
/// # Errors
/// No such group or leaflet; no chordae there; numbers out of range.
pub fn rupture(model: &Model, rupture: &Rupture) -> Result<Repaired, Vec<Fault>> {
    torn(model, rupture)
        .map_err(|fault| vec![fault])
        .map(|(segments, count, of)| {
            let after = without(model, &segments);
            Repaired {
                report: Report::Rupture(cut_chord::report(model, &after, count, of)),
                model: after,
                warnings: Vec::new(),
            }
        })
}

/// Leaflet of a segment and which third of its margin it is.
fn third(region: Segment) -> (&'static str, f64) {
    match region {
        Segment::A1 => ("anterior", 0.0),
        Segment::A2 => ("anterior", 1.0),
        Segment::A3 => ("anterior", 2.0),
        Segment::P1 => ("posterior", 0.0),
        Segment::P2 => ("posterior", 1.0),
        Segment::P3 => ("posterior", 2.0),
    }
}

fn torn(model: &Model, rupture: &Rupture) -> Result<(BTreeSet<usize>, usize, usize), Fault> {
    let (name, number) = third(rupture.region);
    let leaflet = leaflet_named(model, name, "rupture.region")?;
    let margin = LeafletMargin::new(model, leaflet, "rupture.region")?;
    let groups = rupture.groups.iter().enumerate();
    let groups = groups.map(|(i, name)| group_named(model, name, &format!("rupture.groups[{i}]")));
    let groups: Vec<u32> = groups.collect::<Result<_, _>>()?;
    let share = |insertion| {
        let foot = polyline::nearest(&margin.points_mm, false, insertion_mm(model, insertion));
        foot.map_or(0.0, |foot| foot.arc_mm / margin.length_mm())
    };
    let mut found: Vec<(f64, Vec<usize>)> = Vec::new();
    for chord in whole_chords(model) {
        let here = |&&(segment, end): &&(usize, usize)| {
            let place = &model.chords.points[model.chords.ends[segment][end] as usize];
            leaflet_of(model, place) == leaflet
        };
        let shares: Vec<f64> = chord
            .insertions
            .iter()
            .filter(here)
            .map(|&insertion| share(insertion))
            .collect();
        let is_of = chord
            .segments
            .iter()
            .any(|&segment| groups.contains(&model.chords.group[segment]));
        let mean = shares.iter().sum::<f64>() / shares.len() as f64;
        // A chord that does not insert in this leaflet has no mean.
        if is_of && mean * 3.0 >= number && mean * 3.0 < number + 1.0 {
            found.push(((mean * 3.0 - number - 0.5).abs(), chord.segments));
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let count = count(rupture, found.len())?;
    let segments = found
        .iter()
        .take(count)
        .flat_map(|(_, segments)| segments)
        .copied();
    Ok((segments.collect(), count, found.len()))
}

fn count(rupture: &Rupture, of: usize) -> Result<usize, Fault> {
    if of == 0 {
        let message = format!("is {:?}, where no chord of these groups inserts", rupture.region);
        return Err(Fault::of_shape("rupture.region", message));
    }
    match (rupture.fraction, rupture.count) {
        (None, None) => Ok(of),
        (Some(_), Some(_)) => Err(Fault::error(
            "rupture.count",
            "is given beside `fraction`; expected one of the two",
        )),
        (Some(fraction), None) if fraction > 0.0 && fraction <= 1.0 => {
            Ok(((fraction * of as f64).round() as usize).max(1))
        }
        (Some(fraction), None) => Err(Fault::error(
            "rupture.fraction",
            format!("is {fraction}, expected above 0 and at most 1"),
        )),
        (None, Some(count)) if count >= 1 && count as usize <= of => Ok(count as usize),
        (None, Some(count)) => Err(Fault {
            of_shape: count > 0,
            ..Fault::error("rupture.count", format!("is {count}, expected 1 to {of}"))
        }),
    }
}
