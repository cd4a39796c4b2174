//! Artificial chordae: threads from a papillary tip to a leaflet, which hold it back.

use super::chord_ends::{LeafletPlace, Tip, insertions, tip};
use super::closure_line::closing_place_mm;
use super::rods::{Rod, place_mm, string};
use crate::Vec3;
use crate::model::{ChordKind, Insertion, Model};
use crate::repair::{Repaired, Report};
use crate::scene::{Fault, Neochord};

/// How far below the annular plane the margin usually ends [mm].
const USUAL_DEPTHS_MM: [f64; 2] = [4.0, 6.0];
/// How far it is to end if nobody says [mm]: their middle, our choice.
const DEPTH_MM: f64 = 5.0;

/// Diameter of the thread [mm]: CV-4, as usually quoted. Only the product with its modulus matters.
const DIAMETER_MM: f64 = 0.31;

/// Neochordae are 14 to 24 mm long; outside twice that range lengths are doubted [mm].
const PLAUSIBLE_MM: std::ops::RangeInclusive<f64> = 7.0..=48.0;
/// Other lengths are refused, our choice: a length in centimetres or metres must not tie the margin to the muscle.
const LENGTH_MM: std::ops::RangeInclusive<f64> = 3.0..=200.0;

/// What was strung.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct NeochordReport {
    /// Name of the chord group.
    pub name: String,
    /// Name of the leaflet.
    pub leaflet: String,
    /// Name of the papillary muscle.
    pub muscle: String,
    /// Number of its tip, from 0.
    pub tip: usize,
    /// Unloaded length of each strand [mm], shape `[strand]`.
    pub length_mm: Vec<f64>,
    /// Distance that each spans in the open valve [mm], shape `[strand]`.
    pub open_mm: Vec<f64>,
    /// Depth below the annular plane that the lengths were chosen for [mm]; absent for given lengths.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub depth_mm: Option<f64>,
}

/// Strings artificial chordae.
///
/// # Errors
/// No such leaflet, place, muscle or tip; numbers out of range.
pub fn string_neochord(model: &Model, neochord: &Neochord) -> Result<Repaired, Vec<Fault>> {
    let faults = number_faults(neochord);
    if !faults.is_empty() {
        return Err(faults);
    }
    strung(model, neochord).map_err(|fault| vec![fault])
}

fn strung(model: &Model, neochord: &Neochord) -> Result<Repaired, Fault> {
    let place = LeafletPlace {
        leaflet: &neochord.leaflet,
        site: neochord.site,
        position: neochord.position,
        inset_mm: neochord.inset_mm,
        point_mm: neochord.point_mm,
    };
    let insertions = insertions(model, place, (neochord.strands, neochord.spread_mm), "neochord")?;
    let middle = insertions
        .iter()
        .map(|(insertion, _)| insertion.at_mm)
        .sum::<Vec3>()
        / insertions.len() as f64;
    let tip = tip(
        model,
        neochord.muscle.as_deref(),
        neochord.tip,
        middle,
        "neochord",
    )?;
    let depth_mm = match (neochord.length_mm, neochord.point_mm) {
        (Some(_), _) => None,
        (None, None) => Some(neochord.depth_mm.unwrap_or(DEPTH_MM)),
        (None, Some(_)) => {
            let message = "is missing; for a place given as a point it cannot be estimated";
            return Err(Fault::error("neochord.length_mm", message));
        }
    };
    let mut rods = Vec::new();
    let (mut length_mm, mut open_mm) = (Vec::new(), Vec::new());
    for (insertion, share) in &insertions {
        let estimate = || match (depth_mm, share) {
            (Some(depth_mm), &Some(share)) => estimated_mm(model, tip, share, depth_mm - neochord.inset_mm),
            _ => Ok(0.0),
        };
        let length = neochord.length_mm.map_or_else(estimate, Ok)?;
        length_mm.push(length);
        open_mm.push((model.rest_mm[tip.vertex as usize] - insertion.at_mm).norm());
        rods.push(rod(model, tip, insertion, length));
    }
    let doubted = length_mm.iter().position(|length| !PLAUSIBLE_MM.contains(length));
    let warnings = doubted.map(|strand| {
        let share = insertions[strand].1;
        let reaching_mm = share.and_then(|share| reaching_mm(model, tip, share, neochord.inset_mm));
        doubt(neochord, [length_mm[strand], open_mm[strand]], reaching_mm)
    });
    let name = match (neochord.site, neochord.position) {
        (Some(site), _) => format!("neochord {} {}", neochord.leaflet, site.name()),
        (None, Some(position)) => format!("neochord {} {position}", neochord.leaflet),
        (None, None) => format!("neochord {}", neochord.leaflet),
    };
    let area_mm2 = std::f64::consts::FRAC_PI_4 * DIAMETER_MM.powi(2);
    let mut repaired = model.clone();
    let name = string(
        &mut repaired,
        &name,
        ChordKind::Neochorda,
        neochord.axial_stiffness_n / area_mm2,
        rods,
    );
    Ok(Repaired {
        model: repaired,
        report: Report::Neochord(NeochordReport {
            name,
            leaflet: neochord.leaflet.clone(),
            muscle: model.papillary[tip.muscle].name.clone(),
            tip: tip.number,
            length_mm,
            open_mm,
            depth_mm,
        }),
        warnings: warnings.into_iter().collect(),
    })
}

fn number_faults(neochord: &Neochord) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut check = |holds: bool, key: &str, message: String| {
        if !holds {
            faults.push(Fault::error(format!("neochord.{key}"), message));
        }
    };
    let strands = neochord.strands;
    check(
        (1..=20).contains(&strands),
        "strands",
        format!("is {strands}, expected 1 to 20"),
    );
    let spread = neochord.spread_mm;
    check(
        (0.0..=40.0).contains(&spread),
        "spread_mm",
        format!("is {spread} mm, expected 0 to 40"),
    );
    let stiffness = neochord.axial_stiffness_n;
    check(
        stiffness > 0.0 && stiffness <= 1e5,
        "axial_stiffness_n",
        format!("is {stiffness} N, expected above 0 and at most 100000"),
    );
    if let Some(length) = neochord.length_mm {
        check(
            LENGTH_MM.contains(&length),
            "length_mm",
            format!(
                "is {length} mm, expected {} to {}",
                LENGTH_MM.start(),
                LENGTH_MM.end()
            ),
        );
        check(
            neochord.depth_mm.is_none(),
            "depth_mm",
            "is given beside `length_mm`; expected one of the two".to_owned(),
        );
    }
    if let Some(depth) = neochord.depth_mm {
        check(
            depth.abs() <= 50.0,
            "depth_mm",
            format!("is {depth} mm, expected -50 to 50"),
        );
    }
    faults
}

/// What is doubted of a strand so long, which spans so much in the open valve; with the lengths that reach, where they can be told.
fn doubt(neochord: &Neochord, [length_mm, open_mm]: [f64; 2], reaching_mm: Option<[f64; 2]>) -> Fault {
    let here = match reaching_mm {
        Some([shortest, longest]) => format!(
            "with {shortest:.1} to {longest:.1} mm from this tip the margin ends {} to {} mm below the closed annulus, as is usual, \
             by estimate",
            USUAL_DEPTHS_MM[0], USUAL_DEPTHS_MM[1]
        ),
        None => format!("in the open valve the place is {open_mm:.1} mm from this tip"),
    };
    let key = match neochord.depth_mm {
        Some(_) => "neochord.depth_mm",
        None => "neochord.length_mm",
    };
    let message = format!("a strand is {length_mm:.1} mm long, expected about 14 to 24 mm; {here}");
    Fault::warning(key, message)
}

/// The shortest and the longest strand with which the margin ends as far below the closed annulus as is usual [mm]; none for a valve
/// whose line of closure cannot be foretold.
fn reaching_mm(model: &Model, tip: Tip, share: f64, inset_mm: f64) -> Option<[f64; 2]> {
    let [higher, lower] =
        USUAL_DEPTHS_MM.map(|depth_mm| estimated_mm(model, tip, share, depth_mm - inset_mm).ok());
    let (higher, lower) = (higher?, lower?);
    Some([higher.min(lower), higher.max(lower)])
}

/// From where the tip is when the valve is closed to where the insertion is to be.
fn estimated_mm(model: &Model, tip: Tip, share: f64, depth_mm: f64) -> Result<f64, Fault> {
    let there = closing_place_mm(model, share, depth_mm, "neochord.depth_mm")?;
    Ok((there - model.target_mm(tip.vertex)).norm())
}

/// Lengths are given to the insertion; the chord pulls at the middle of its patch, as the patient's own.
fn rod(model: &Model, tip: Tip, insertion: &Insertion, length_mm: f64) -> Rod {
    let from = model.rest_mm[tip.vertex as usize];
    let pulls_at = place_mm(&insertion.vertices, &model.rest_mm);
    let nearer_mm = (insertion.at_mm - from).norm() - (pulls_at - from).norm();
    Rod {
        ends: [vec![(tip.vertex, 1.0)], insertion.vertices.clone()],
        rest_length_mm: (length_mm - nearer_mm).max(0.1 * length_mm),
        area_mm2: std::f64::consts::FRAC_PI_4 * DIAMETER_MM.powi(2),
    }
}
