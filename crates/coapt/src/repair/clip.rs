//! Edge-to-edge repair with a clip: places of both leaflets that lie between the clip's arms are tied pairwise.
//!
//! On each leaflet the arms cover a rectangle, the clip's width along the margin by the grasp toward the annulus. Ties stand
//! on a lattice over it that does not depend on the mesh, and join places that are equally far from the tips of the arms. The
//! arms' own stiffness against bending is not modelled, nor is the body of the clip.

use super::leaflet::{HeightLine, LeafletMargin};
use super::site::{SiteMargins, on_both_leaflets};
use super::sutures::{Sewn, Stitch, held_gap_mm, refuse_overlap, sew};
use crate::model::Model;
use crate::repair::{Repaired, Report};
use crate::scene::{Clip, ClipModel, Fault};

/// Ties are at most this far apart [mm]; our choice, about an edge of the coarsest useful mesh. Denser ties share the same
/// force; the stiffness of the grip grows with their number.
const SPACING_MM: f64 = 2.0;

/// Arms lean no farther: beyond, they would lie along the margin [°] (our choice).
const MOST_LEAN_DEG: f64 = 45.0;

/// What a clip grips.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ClipReport {
    /// Share of the margin from the anterolateral commissure [1].
    pub position: f64,
    /// Length of the arms [mm].
    pub arm_mm: f64,
    /// Width along the margin [mm].
    pub width_mm: f64,
    /// How much of the anterior leaflet is gripped, then of the posterior one [mm].
    pub grasp_mm: [f64; 2],
    /// How high the leaflets are there, in the same order: the least over the clip's width [mm].
    pub leaflet_height_mm: [f64; 2],
    /// The ties.
    #[serde(flatten)]
    pub sewn: Sewn,
}

/// Clips the leaflets together.
///
/// # Errors
/// No such site; a clip that reaches beyond a commissure, grips more than its arms are long or the leaflet is high, or
/// overlaps with an earlier repair that joins the leaflets; numbers out of range.
pub fn clip(model: &Model, clip: &Clip) -> Result<Repaired, Vec<Fault>> {
    let grasp_mm =
        [clip.grasp_anterior_mm, clip.grasp_posterior_mm].map(|given| given.unwrap_or(clip.size.grasp_mm()));
    let stiffness_n_per_mm = clip.stiffness_n_per_mm.unwrap_or(clip.model.stiffness_n_per_mm());
    let mut faults = number_faults(clip, grasp_mm, stiffness_n_per_mm);
    let site = match on_both_leaflets(model, clip.site, clip.position, "clip") {
        Ok(site) if faults.is_empty() => site,
        Ok(_) => return Err(faults),
        Err(fault) => {
            faults.push(fault);
            return Err(faults);
        }
    };
    let width_mm = clip.size.width_mm();
    let place = if clip.site.is_some() {
        "clip.site"
    } else {
        "clip.position"
    };
    refuse_beyond_commissure(&site, width_mm, "the clip", place)?;
    refuse_overlap(model, &site, width_mm, "the clip", place).map_err(|fault| vec![fault])?;
    let lines = [0, 1].map(|side| lines(&site.margins[side], site.position, width_mm, clip.angle_deg));
    let height_mm = lines.each_ref().map(|lines| lowest_mm(lines));
    refuse_too_long_a_grasp(model, &site, grasp_mm, height_mm)?;
    let stitches = ties(
        &lines,
        [width_mm, grasp_mm[0], grasp_mm[1]],
        held_gap_mm(model),
        clip.model,
    );
    let mut model = model.clone();
    let sewn = sew(
        &mut model,
        &format!("clip {}", site.name),
        stitches,
        stiffness_n_per_mm,
    );
    Ok(Repaired {
        model,
        report: Report::Clip(ClipReport {
            position: site.position,
            arm_mm: clip.size.arm_mm(),
            width_mm,
            grasp_mm,
            leaflet_height_mm: height_mm,
            sewn,
        }),
        warnings: Vec::new(),
    })
}

fn number_faults(clip: &Clip, grasp_mm: [f64; 2], stiffness_n_per_mm: f64) -> Vec<Fault> {
    let mut faults = Vec::new();
    let arm_mm = clip.size.arm_mm();
    for (grasp, key) in grasp_mm
        .into_iter()
        .zip(["clip.grasp_anterior_mm", "clip.grasp_posterior_mm"])
    {
        if !(grasp > 0.0 && grasp <= arm_mm) {
            let message =
                format!("is {grasp} mm, expected above 0 and at most the arm's length, {arm_mm} mm");
            faults.push(Fault::error(key, message));
        }
    }
    if !(-MOST_LEAN_DEG..=MOST_LEAN_DEG).contains(&clip.angle_deg) {
        let message = format!(
            "is {}, expected -{MOST_LEAN_DEG} to {MOST_LEAN_DEG}",
            clip.angle_deg
        );
        faults.push(Fault::error("clip.angle_deg", message));
    }
    // Up to a hundred times what is usual: stiffer is no more rigid, and only ill-conditioned.
    if !(stiffness_n_per_mm > 0.0 && stiffness_n_per_mm <= 1000.0) {
        let message = format!("is {stiffness_n_per_mm} N/mm, expected above 0 and at most 1000");
        faults.push(Fault::error("clip.stiffness_n_per_mm", message));
    }
    faults
}

/// Refuses what is wider than the margin to either side of the site; `what` is how the message calls it.
///
/// # Errors
/// How far beyond which commissure it would reach.
pub fn refuse_beyond_commissure(
    site: &SiteMargins,
    width_mm: f64,
    what: &str,
    place: &str,
) -> Result<(), Vec<Fault>> {
    let least = site
        .margins
        .iter()
        .map(LeafletMargin::length_mm)
        .fold(f64::INFINITY, f64::min);
    let room = 0.5 * width_mm / least;
    if (room..=1.0 - room).contains(&site.position) {
        return Ok(());
    }
    if room > 0.5 {
        let message =
            format!("{what} is {width_mm} mm wide, the margin {least:.1} mm long; expected a shorter one");
        return Err(vec![Fault::of_shape(place, message)]);
    }
    let (beyond, side) = match site.position < 0.5 {
        true => (room - site.position, "anterolateral"),
        false => (site.position + room - 1.0, "posteromedial"),
    };
    let message = format!(
        "{what}, {width_mm} mm wide, would reach {:.1} mm beyond the {side} commissure; expected a position from {:.3} to {:.3}",
        beyond * least,
        room,
        1.0 - room
    );
    Err(vec![Fault::of_shape(place, message)])
}

/// Ways across a leaflet, evenly over a width about a position of its margin, parallel to each other.
pub fn lines(margin: &LeafletMargin, position: f64, width_mm: f64, lean_deg: f64) -> Vec<HeightLine> {
    let middle = position * margin.length_mm();
    let along = margin.tangent(middle, width_mm);
    let steps = (width_mm / SPACING_MM).ceil().max(1.0);
    let arcs = (0..=steps as u32).map(|i| middle + width_mm * (f64::from(i) / steps - 0.5));
    arcs.map(|arc_mm| margin.height_line(arc_mm, along, lean_deg.to_radians()))
        .collect()
}

fn lowest_mm(lines: &[HeightLine]) -> f64 {
    lines
        .iter()
        .map(HeightLine::length_mm)
        .fold(f64::INFINITY, f64::min)
}

fn refuse_too_long_a_grasp(
    model: &Model,
    site: &SiteMargins,
    grasp_mm: [f64; 2],
    height_mm: [f64; 2],
) -> Result<(), Vec<Fault>> {
    let mut faults = Vec::new();
    let keys = ["clip.grasp_anterior_mm", "clip.grasp_posterior_mm"];
    for side in 0..2 {
        if grasp_mm[side] >= height_mm[side] {
            let leaflet = &model.leaflets[site.margins[side].leaflet as usize].name;
            let message = format!(
                "is {} mm, but the {leaflet} leaflet is only {:.1} mm high under the clip; expected less",
                grasp_mm[side], height_mm[side]
            );
            faults.push(Fault::of_shape(keys[side], message));
        }
    }
    if faults.is_empty() { Ok(()) } else { Err(faults) }
}

/// Ties between places that are equally far from the tips of the arms, and if rigid their braces.
fn ties(
    lines: &[Vec<HeightLine>; 2],
    [width_mm, anterior_mm, posterior_mm]: [f64; 3],
    gap_mm: f64,
    clip_model: ClipModel,
) -> Vec<Stitch> {
    let grasp_mm = [anterior_mm, posterior_mm];
    let shared_mm = grasp_mm[0].min(grasp_mm[1]);
    let steps = (shared_mm / SPACING_MM).ceil().max(1.0) as usize;
    let rows = steps + 1;
    let row_mm = shared_mm / steps as f64;
    let columns = lines[0].len();
    let column_mm = width_mm / (columns - 1) as f64;
    let place =
        |side: usize, column: usize, row: usize| lines[side][column].at(grasp_mm[side] - row_mm * row as f64);
    let mut stitches = Vec::new();
    for (column, row) in (0..columns).flat_map(|column| (0..rows).map(move |row| (column, row))) {
        let mut tie = |to_column: usize, to_row: usize, apart_mm: f64| {
            stitches.push(Stitch {
                ends: [place(0, column, row), place(1, to_column, to_row)],
                length_mm: gap_mm.hypot(apart_mm),
            });
        };
        tie(column, row, 0.0);
        if clip_model == ClipModel::Rigid {
            // Toward all four neighbours: a tie only pulls, so that each direction needs its own.
            if row > 0 {
                tie(column, row - 1, row_mm);
            }
            if row + 1 < rows {
                tie(column, row + 1, row_mm);
            }
            if column > 0 {
                tie(column - 1, row, column_mm);
            }
            if column + 1 < columns {
                tie(column + 1, row, column_mm);
            }
        }
    }
    stitches
}
