//! An indentation of the posterior margin sewn up: stitches join its two edges, from its bottom to the margin.

use super::leaflet::{LeafletMargin, leaflet_named};
use super::sutures::{STITCH_N_PER_MM, Sewn, Stitch, held_gap_mm, sew};
use crate::model::Model;
use crate::repair::{Repaired, Report};
use crate::scene::{CloseCleft, Fault};

/// The bottom is sought so far to either side of the position [mm] (our choice: half the width of a scallop).
const SEARCH_MM: f64 = 4.0;

/// Distance between stitches along the edges, at most [mm] (our choice, as of other seams).
const SPACING_MM: f64 = 2.0;

/// An indentation less deep than this is no cleft, and what is sewn up is a fold of the margin [mm] (our choice).
const SHALLOW_MM: f64 = 1.0;

/// What was sewn.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct CleftReport {
    /// Share of the posterior margin at which the bottom was found [1].
    pub position: f64,
    /// How far the bottom lies back from the straight line between the outermost stitches [mm].
    pub indentation_mm: f64,
    /// The stitches.
    #[serde(flatten)]
    pub sewn: Sewn,
}

/// Sews up an indentation.
///
/// # Errors
/// No posterior leaflet with a margin; numbers out of range; stitches beyond a commissure.
pub fn close(model: &Model, cleft: &CloseCleft) -> Result<Repaired, Vec<Fault>> {
    closed(model, cleft).map_err(|fault| vec![fault])
}

fn closed(model: &Model, cleft: &CloseCleft) -> Result<Repaired, Fault> {
    let (position, depth_mm) = (cleft.position, cleft.depth_mm);
    if !(0.0..=1.0).contains(&position) {
        return Err(Fault::error(
            "close-cleft.position",
            format!("is {position}, expected 0 to 1"),
        ));
    }
    if !(depth_mm > 0.0 && depth_mm.is_finite()) {
        return Err(Fault::error(
            "close-cleft.depth_mm",
            format!("is {depth_mm} mm, expected above 0"),
        ));
    }
    let leaflet = leaflet_named(model, "posterior", "close-cleft.position")?;
    let margin = LeafletMargin::new(model, leaflet, "close-cleft.position")?;
    let bottom_mm = bottom(&margin, position * margin.length_mm(), depth_mm);
    if bottom_mm < depth_mm || bottom_mm > margin.length_mm() - depth_mm {
        let message = format!(
            "the indentation's bottom lies {:.1} mm from a commissure; expected more than `depth_mm`, {depth_mm} mm",
            bottom_mm.min(margin.length_mm() - bottom_mm)
        );
        return Err(Fault::of_shape("close-cleft.position", message));
    }
    let steps = (depth_mm / SPACING_MM).ceil();
    let stitch = |step: u32| {
        let aside_mm = depth_mm * f64::from(step) / steps;
        let end = |arc_mm: f64| {
            margin
                .height_line(arc_mm, margin.tangent(arc_mm, SPACING_MM), 0.0)
                .at(0.0)
        };
        Stitch {
            ends: [end(bottom_mm - aside_mm), end(bottom_mm + aside_mm)],
            length_mm: held_gap_mm(model),
        }
    };
    let stitches = (1..=steps as u32).map(stitch).collect();
    let indentation_mm = indentation(&margin, bottom_mm, depth_mm);
    let mut warnings = Vec::new();
    if indentation_mm < SHALLOW_MM {
        let message = format!(
            "the margin is indented by {indentation_mm:.1} mm only; expected a cleft, what is sewn up is a fold of the margin"
        );
        warnings.push(Fault::warning("close-cleft.position", message));
    }
    let share = bottom_mm / margin.length_mm();
    let mut repaired = model.clone();
    let sewn = sew(
        &mut repaired,
        &format!("cleft {share:.2}"),
        stitches,
        STITCH_N_PER_MM,
    );
    Ok(Repaired {
        model: repaired,
        report: Report::CloseCleft(CleftReport {
            position: share,
            indentation_mm,
            sewn,
        }),
        warnings,
    })
}

/// Arc length of the deepest place near `arc_mm`: the one that lies farthest back from the line between its neighbours on
/// either side.
fn bottom(margin: &LeafletMargin, arc_mm: f64, depth_mm: f64) -> f64 {
    let steps = 40;
    let at = |i: i32| arc_mm + SEARCH_MM * f64::from(i) / f64::from(steps);
    let inside = |arc: &f64| (depth_mm..=margin.length_mm() - depth_mm).contains(arc);
    let places = (-steps..=steps).map(at).filter(inside);
    let deepest =
        places.max_by(|&a, &b| indentation(margin, a, depth_mm).total_cmp(&indentation(margin, b, depth_mm)));
    deepest.unwrap_or(arc_mm)
}

/// How far the margin lies back, toward the annulus, from the middle between the places so far to either side [mm].
fn indentation(margin: &LeafletMargin, arc_mm: f64, aside_mm: f64) -> f64 {
    let here = margin.point_mm(arc_mm);
    let middle = 0.5 * (margin.point_mm(arc_mm - aside_mm) + margin.point_mm(arc_mm + aside_mm));
    let line = margin.height_line(arc_mm, margin.tangent(arc_mm, 2.0 * aside_mm), 0.0);
    let up = margin.place_mm(&line.at(aside_mm.min(0.5 * line.length_mm()))) - here;
    (here - middle).dot(&up.normalize())
}
