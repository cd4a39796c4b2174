//! What each repair did: for machines, and as a sentence.

use coapt::measure::{SLACK_BELOW_N, SlackNeochord};
use coapt::repair::{
    self, AlfieriReport, AugmentReport, CleftReport, ClipReport, CutReport, NeochordReport, RelocationReport,
    ResectReport, RingExtent, RingReport, TransferReport,
};
use coapt::scene::{ResectionShape, RingFamily};
use serde::{Deserialize, Serialize};

/// What one repair did.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum RepairReport {
    /// Annuloplasty.
    Ring(RingFigures),
    /// Edge-to-edge repair with a clip.
    Clip(ClipReport),
    /// Edge-to-edge repair with stitches.
    Alfieri(AlfieriReport),
    /// Artificial chordae.
    Neochord(NeochordReport),
    /// Chordae cut.
    CutChord(CutReport),
    /// A chord set elsewhere.
    TransferChord(TransferReport),
    /// Chordae torn.
    Rupture(CutReport),
    /// A papillary muscle drawn elsewhere.
    RelocatePapillary(RelocationReport),
    /// An indentation sewn up.
    CloseCleft(CleftReport),
    /// A piece of a leaflet cut out.
    Resect(ResectReport),
    /// A patch set into a leaflet.
    Augment(AugmentReport),
}

/// What a ring did to the annulus.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RingFigures {
    /// Family; none for a measured curve.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub family: Option<RingFamily>,
    /// Inner transverse diameter [mm]; none for a measured curve.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size_mm: Option<f64>,
    /// How many sutures hold it; none where it holds the annulus everywhere.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sutures: Option<u32>,
    /// Whether it takes the annulus' length only.
    #[serde(skip_serializing_if = "std::ops::Not::not", default)]
    pub flexible: bool,
    /// Whether the ring is closed.
    pub closed: bool,
    /// How large it is where it lies.
    pub laid: RingExtent,
    /// Length of the ring [mm].
    pub ring_length_mm: f64,
    /// Length of the stretch of annulus sewn to it, before [mm].
    pub annulus_length_mm: f64,
    /// Mean distance by which sewn annulus points move [mm].
    pub warp_mean_mm: f64,
    /// Largest of these distances [mm].
    pub warp_max_mm: f64,
    /// Least length of an annulus edge after over before [1].
    pub edge_stretch_min: f64,
    /// Largest of these ratios [1].
    pub edge_stretch_max: f64,
    /// Angle between the planes of ring and annulus [degree].
    pub tilt_deg: f64,
}

pub(crate) fn repair_report(report: &repair::Report) -> RepairReport {
    match report {
        repair::Report::Ring(ring) => RepairReport::Ring(ring_figures(ring)),
        repair::Report::Clip(clip) => RepairReport::Clip(clip.clone()),
        repair::Report::Alfieri(stitches) => RepairReport::Alfieri(stitches.clone()),
        repair::Report::Neochord(neochord) => RepairReport::Neochord(neochord.clone()),
        repair::Report::CutChord(cut) => RepairReport::CutChord(cut.clone()),
        repair::Report::TransferChord(transfer) => RepairReport::TransferChord(transfer.clone()),
        repair::Report::Rupture(torn) => RepairReport::Rupture(torn.clone()),
        repair::Report::RelocatePapillary(moved) => RepairReport::RelocatePapillary(moved.clone()),
        repair::Report::CloseCleft(cleft) => RepairReport::CloseCleft(cleft.clone()),
        repair::Report::Resect(piece) => RepairReport::Resect(piece.clone()),
        repair::Report::Augment(patch) => RepairReport::Augment(patch.clone()),
    }
}

fn ring_figures(ring: &RingReport) -> RingFigures {
    RingFigures {
        family: ring.family,
        size_mm: ring.size_mm,
        sutures: ring.sutures,
        flexible: ring.flexible,
        closed: ring.closed,
        laid: ring.laid,
        ring_length_mm: ring.ring_length_mm,
        annulus_length_mm: ring.annulus_length_mm,
        warp_mean_mm: ring.warp_mean_mm,
        warp_max_mm: ring.warp_max_mm,
        edge_stretch_min: ring.edge_stretch_min,
        edge_stretch_max: ring.edge_stretch_max,
        tilt_deg: ring.tilt_degrees,
    }
}

/// Whether the leaflets are held together where they touch.
pub(super) fn joins_edges(repair: &RepairReport) -> bool {
    matches!(repair, RepairReport::Clip(_) | RepairReport::Alfieri(_))
}

/// What a repair did, in a line.
pub(crate) fn repair_line(repair: &RepairReport) -> String {
    match repair {
        RepairReport::Ring(ring) => ring_line(ring),
        RepairReport::Clip(clip) => format!(
            "{}: arms {} mm long and {} mm wide, {:.1} mm of the anterior and {:.1} mm of the posterior leaflet gripped at {} \
             places, up to {:.1} mm apart when open",
            clip.sewn.name,
            clip.arm_mm,
            clip.width_mm,
            clip.grasp_mm[0],
            clip.grasp_mm[1],
            clip.sewn.sutures,
            clip.sewn.farthest_mm
        ),
        RepairReport::Alfieri(stitches) => format!(
            "{}: {} mm of the margins joined by {} stitches, up to {:.1} mm apart when open",
            stitches.sewn.name, stitches.length_mm, stitches.sewn.sutures, stitches.sewn.farthest_mm
        ),
        RepairReport::Neochord(neochord) => neochord_line(neochord),
        RepairReport::CutChord(cut) => format!("{} of {} chords or branches cut", cut.count, cut.of),
        RepairReport::TransferChord(transfer) => transfer_line(transfer),
        RepairReport::Rupture(torn) => format!("{} of {} chords torn", torn.count, torn.of),
        RepairReport::RelocatePapillary(moved) => {
            let [x, y, z] = moved.by_mm;
            format!(
                "{} papillary muscle, {} tips, drawn by {:.1} mm: ({x:.1}, {y:.1}, {z:.1}) mm",
                moved.muscle,
                moved.tips,
                x.hypot(y).hypot(z)
            )
        }
        RepairReport::CloseCleft(cleft) => format!(
            "{}: an indentation of {:.1} mm closed by {} stitches, up to {:.1} mm apart when open",
            cleft.sewn.name, cleft.indentation_mm, cleft.sewn.sutures, cleft.sewn.farthest_mm
        ),
        RepairReport::Resect(piece) => resect_line(piece),
        RepairReport::Augment(patch) => format!(
            "patch {:.1} mm wide and {:.1} mm long, {:.0} mm2, set into the {} leaflet, which is {:.1} mm high there, {:.0} % of the way \
             from the annulus",
            patch.width_mm,
            patch.length_mm,
            patch.area_mm2,
            patch.leaflet,
            patch.leaflet_height_mm,
            100.0 * patch.fraction
        ),
    }
}

fn neochord_line(neochord: &NeochordReport) -> String {
    let [shortest, longest] =
        [f64::min, f64::max].map(|pick| neochord.length_mm.iter().copied().reduce(pick));
    let depth = neochord
        .depth_mm
        .map(|depth| format!(", estimated for a margin {depth:.1} mm below the annulus"));
    format!(
        "{}: {} strands from tip {} of the {} papillary muscle, {:.1} to {:.1} mm long{}",
        neochord.name,
        neochord.length_mm.len(),
        neochord.tip,
        neochord.muscle,
        shortest.unwrap_or(0.0),
        longest.unwrap_or(0.0),
        depth.unwrap_or_default()
    )
}

/// What stands before a neochord that holds nothing back, or of which some strands do not.
pub(crate) fn slack_mark(slack: &SlackNeochord) -> &'static str {
    match slack.is_idle() {
        true => "SLACK",
        false => "partly slack",
    }
}

/// That a neochord does nothing, or half of what was meant: else a plan with it looks like a repair and is the valve as it was.
pub(crate) fn slack_line(slack: &SlackNeochord) -> String {
    let SlackNeochord {
        repair,
        name,
        strands,
        slack_strands,
    } = slack;
    match slack.is_idle() {
        true => format!(
            "repair[{repair}], {name}: no strand bears {SLACK_BELOW_N} N or more in the closed valve, which closes as without it"
        ),
        false => format!(
            "repair[{repair}], {name}: {slack_strands} of {strands} strands {} less than {SLACK_BELOW_N} N in the closed valve",
            if *slack_strands == 1 { "bears" } else { "bear" }
        ),
    }
}

fn resect_line(piece: &ResectReport) -> String {
    let shape = match piece.shape {
        ResectionShape::Triangular => "triangle",
        ResectionShape::Quadrangular => "quadrangle",
    };
    let annulus = piece
        .annulus_mm
        .map(|[before, after]| format!("; the annulus plicated from {before:.1} to {after:.1} mm"));
    format!(
        "{}: a {shape} {:.1} mm wide and {:.1} of {:.1} mm high, {:.0} mm2, cut out with {} chord branches, the gap of up to {:.1} \
         mm closed by {} stitches{}",
        piece.sewn.name,
        piece.width_mm,
        piece.height_mm,
        piece.leaflet_height_mm,
        piece.area_mm2,
        piece.chords_cut,
        piece.sewn.farthest_mm,
        piece.sewn.sutures,
        annulus.unwrap_or_default()
    )
}

fn transfer_line(transfer: &TransferReport) -> String {
    let at = |[x, y, z]: [f64; 3]| format!("({x:.1}, {y:.1}, {z:.1})");
    let muscle = transfer
        .muscle
        .as_ref()
        .map(|name| format!(" and to the {name} papillary muscle"));
    format!(
        "chord of `{}` moved from {} to {} mm{}",
        transfer.group,
        at(transfer.from_mm),
        at(transfer.to_mm),
        muscle.unwrap_or_default()
    )
}

fn ring_line(ring: &RingFigures) -> String {
    let mut kind = if ring.closed { "closed" } else { "open" }.to_owned();
    if ring.flexible {
        kind.push_str(", flexible");
    }
    if let Some(sutures) = ring.sutures {
        kind.push_str(&format!(", {sutures} sutures"));
    }
    let shape = match (ring.family.and_then(family_name), ring.size_mm) {
        (Some(name), Some(size)) => format!("ring {name}, size {size} mm"),
        _ => "measured ring".to_owned(),
    };
    format!(
        "{shape} ({kind}, {:.1} mm long; {}) on {:.1} mm of annulus, which moves {:.1} mm on average, {:.1} mm at most",
        ring.ring_length_mm,
        extent_words(&ring.laid),
        ring.annulus_length_mm,
        ring.warp_mean_mm,
        ring.warp_max_mm
    )
}

/// How large a ring is, as a surgeon knows it: the annulus' own figures do not let its size be recognised.
pub(crate) fn extent_words(laid: &RingExtent) -> String {
    let open = if laid.closed { "" } else { " were it closed" };
    format!(
        "{:.1} mm across and {:.1} mm from front to back{open}, {:.1} mm high",
        laid.width_mm, laid.depth_mm, laid.height_mm
    )
}

/// The name of a family as in plans.
fn family_name(family: RingFamily) -> Option<String> {
    Some(serde_json::to_value(family).ok()?.as_str()?.to_owned())
}
