//! A patch set into a leaflet, which makes it higher.
//!
//! The leaflet is opened along a line at a fraction of its height, what lies beyond is moved away from the annulus along the
//! axis of the valve, and new faces fill the gap, widest in its middle and fading to its ends. Along each place's own meridian,
//! for all of them lean inward, what lies beyond would be crowded together by a quarter of the patch's area, and the leaflets
//! would cross. Chordae keep their lengths.
//!
//! The patch is taken for tissue of the leaflet: one of another tissue would be a leaflet of its own, which margins, sites and
//! measures of contact would take it for. Fixed pericardium is stiffer, 10 to 50 MPa, and stretches less.

use super::excision::{Reinserted, remade};
use super::incision::{Fields, Mesh, incise_along};
use super::leaflet::{LeafletMargin, leaflet_named};
use super::leaflet_chart::{Chart, chart};
use super::patch::open;
use super::resect::fixed;
use super::ring_shape::normal_of;
use super::rods::place_mm;
use super::site::position;
use crate::Vec3;
use crate::contact::surface::Surface;
use crate::contact::tangle::tangles;
use crate::energy::chord::WeightedVertices;
use crate::mesh::topology;
use crate::model::Model;
use crate::repair::{Repaired, Report};
use crate::scene::{Augment, Fault};

/// Part of the height that lies between the annulus and the patch if nobody says [1]: near the annulus, with tissue enough to sew
/// to (our choice).
const FRACTION: f64 = 0.25;

/// No patch is sewn nearer to annulus or margin than this part of the height [1] (our choice).
const LEAST_FRACTION: f64 = 0.1;

/// What lies beyond the patch may gain or lose this part of the patch's area [1] (our choice). The posterior leaflets of the
/// presets do by 0.06 at most; their anterior ones, which lean far inward when open, by three times the area of the patch.
const MOST_DISTORTION: f64 = 0.15;

/// Patches wider than this are none [mm]: twice the widest that are usual (our choice).
const MOST_WIDTH_MM: f64 = 30.0;

/// What was set in.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct AugmentReport {
    /// Name of the leaflet.
    pub leaflet: String,
    /// Share of the margin from the anterolateral commissure [1], of the patch's middle.
    pub position: f64,
    /// Width of the patch in its middle [mm].
    pub width_mm: f64,
    /// Length of the patch along the margin [mm].
    pub length_mm: f64,
    /// Part of the height between annulus and patch [1].
    pub fraction: f64,
    /// Area of the patch [mm²], unloaded.
    pub area_mm2: f64,
    /// Height of the leaflet in the patch's middle, before [mm].
    pub leaflet_height_mm: f64,
}

/// Sets a patch in.
///
/// # Errors
/// No such leaflet or site; numbers out of range; a patch that reaches a commissure, or with which the leaflets cross when open.
pub fn augment(model: &Model, deed: &Augment) -> Result<Repaired, Vec<Fault>> {
    augmented(model, deed).map_err(|fault| vec![fault])
}

fn augmented(model: &Model, deed: &Augment) -> Result<Repaired, Fault> {
    let fraction = checked(deed)?;
    let leaflet = leaflet_named(model, &deed.leaflet, "augment.leaflet")?;
    let (_, position) = position(deed.site, deed.position, "augment")?;
    let margin = LeafletMargin::new(model, leaflet, "augment.leaflet")?;
    let middle_mm = position * margin.length_mm();
    let half_mm = 0.5 * deed.length_mm;
    if middle_mm < half_mm || middle_mm + half_mm > margin.length_mm() {
        let room_mm = 2.0 * middle_mm.min(margin.length_mm() - middle_mm);
        let message = format!(
            "is {} mm, but there are {room_mm:.1} mm about the position between the commissures; expected at most that",
            deed.length_mm
        );
        return Err(Fault::of_shape("augment.length_mm", message));
    }
    let chart = chart(model, &margin);
    let leaflet_height_mm = margin
        .height_line(middle_mm, margin.tangent(middle_mm, 2.0), 0.0)
        .length_mm();
    let annulus: Vec<Vec3> = model.annulus.iter().map(|&v| model.rest_mm[v as usize]).collect();
    let stretch = Stretch {
        down: -normal_of(&annulus),
        middle: position,
        half_mm,
        margin_mm: margin.length_mm(),
        width_mm: deed.width_mm,
    };
    let (after, area_mm2) = patched(model, leaflet, &chart, &stretch, fraction)?;
    let gained_mm2 = unloaded_mm2(&after) - unloaded_mm2(model);
    if (gained_mm2 / area_mm2 - 1.0).abs() > MOST_DISTORTION {
        let message = format!(
            "is `{}`, which leans so far inward when open that moving it along the valve's axis would change its area by \
             {gained_mm2:.0} mm2 for a patch of {area_mm2:.0} mm2; expected a leaflet that hangs down",
            deed.leaflet
        );
        return Err(Fault::of_shape("augment.leaflet", message));
    }
    let tangles = tangles(&Surface::new(&after.faces, &after.rest_mm), &after.rest_mm);
    if let (true, Some(tangle)) = (after.contact.is_on(), tangles.first()) {
        let at = after.rest_mm[tangle.vertex as usize];
        let message = format!(
            "is {} mm, with which the open leaflets cross at {} places, as at ({:.1}, {:.1}, {:.1}) mm; expected less",
            deed.width_mm,
            tangles.len(),
            at.x,
            at.y,
            at.z
        );
        return Err(Fault::of_shape("augment.width_mm", message));
    }
    Ok(Repaired {
        model: after,
        report: Report::Augment(AugmentReport {
            leaflet: model.leaflets[leaflet as usize].name.clone(),
            position,
            width_mm: deed.width_mm,
            length_mm: deed.length_mm,
            fraction,
            area_mm2,
            leaflet_height_mm,
        }),
        warnings: larger_than_the_leaflet(deed, leaflet_height_mm)
            .into_iter()
            .collect(),
    })
}

/// The doubt that a patch brings which is wider than the leaflet is high where it is set in: the leaflet becomes more than twice as high,
/// which no surgeon means. How long it may be, the commissures say.
fn larger_than_the_leaflet(deed: &Augment, leaflet_height_mm: f64) -> Option<Fault> {
    let message = || {
        format!(
            "is {} mm, more than the {leaflet_height_mm:.1} mm that the leaflet is high there, and more than doubles it; 8 to 15 mm are usual",
            deed.width_mm
        )
    };
    (deed.width_mm > leaflet_height_mm).then(|| Fault::warning("augment.width_mm", message()))
}

/// The part of the height between annulus and patch.
fn checked(deed: &Augment) -> Result<f64, Fault> {
    let fraction = deed.fraction.unwrap_or(FRACTION);
    let most = 1.0 - LEAST_FRACTION;
    let told = |key: &str, message: String| Err(Fault::error(format!("augment.{key}"), message));
    if !(deed.width_mm > 0.0 && deed.width_mm <= MOST_WIDTH_MM) {
        return told(
            "width_mm",
            format!(
                "is {} mm, expected above 0 and at most {MOST_WIDTH_MM}",
                deed.width_mm
            ),
        );
    }
    if !(deed.length_mm > 0.0 && deed.length_mm.is_finite()) {
        return told("length_mm", format!("is {} mm, expected above 0", deed.length_mm));
    }
    if !(LEAST_FRACTION..=most).contains(&fraction) {
        return told(
            "fraction",
            format!("is {fraction}, expected {LEAST_FRACTION} to {most}"),
        );
    }
    Ok(fraction)
}

/// How wide a patch is along the margin.
struct Stretch {
    /// Share of the margin at its middle [1].
    middle: f64,
    half_mm: f64,
    /// Along the axis of the valve, away from the atrium, a unit vector.
    down: Vec3,
    margin_mm: f64,
    width_mm: f64,
}

impl Stretch {
    /// Distance along the margin beyond the patch's end on one side, negative before it [mm].
    fn beyond_mm(&self, share: f64, side: f64) -> f64 {
        side * (share - self.middle) * self.margin_mm - self.half_mm
    }

    /// The share of the margin so far beyond the end on the posteromedial side.
    fn share(&self, beyond_mm: f64) -> f64 {
        self.middle + (beyond_mm + self.half_mm) / self.margin_mm
    }

    /// Width at a share of the margin [mm]: full in the middle, from there to the ends as a cubic without kinks.
    fn width_at(&self, share: f64) -> f64 {
        let within_mm = -self.beyond_mm(share, -1.0).max(self.beyond_mm(share, 1.0));
        let x = (within_mm / self.half_mm).clamp(0.0, 1.0);
        self.width_mm * x * x * (3.0 - 2.0 * x)
    }
}

/// The model with the patch, and the patch's area.
fn patched(
    model: &Model,
    leaflet: u32,
    chart: &Chart,
    stretch: &Stretch,
    fraction: f64,
) -> Result<(Model, f64), Fault> {
    let mut mesh = Mesh::of(model);
    // Negative beyond the line, and within the stretch on either side.
    let of_shares = |side: f64| {
        chart
            .shares
            .iter()
            .map(|&share| stretch.beyond_mm(share, side))
            .collect()
    };
    let mut fields: Fields = vec![
        chart.heights.iter().map(|height| fraction - height).collect(),
        of_shares(-1.0),
        of_shares(1.0),
    ];
    let before = fields[0].clone();
    incise_along(&mut mesh, &mut fields, &fixed(model, leaflet), 0);
    let moved: Vec<bool> = (0..model.leaflet_vertex_count)
        .map(|v| mesh.points_mm[v] != model.rest_mm[v] || fields[0][v] == 0.0)
        .collect();
    let motion = |share: f64| match share.is_nan() {
        true => Vec3::zeros(),
        false => stretch.down * stretch.width_at(share),
    };
    let motions: Vec<Vec3> = fields[2]
        .iter()
        .map(|&beyond| motion(stretch.share(beyond)))
        .collect();
    let opened = open(&mut mesh, leaflet, &fields[0], &motions, mean_edge_mm(model));
    let area_mm2 = opened.ok_or_else(|| {
        let message = "lies where the leaflet cannot be opened along one line; expected another height, or a longer patch";
        Fault::of_shape("augment.fraction", message)
    })?;
    let place = |point: &WeightedVertices, of: &[f64]| -> f64 {
        point.iter().map(|&(v, weight)| weight * of[v as usize]).sum()
    };
    let mut reinserted = Reinserted::new();
    for (number, point) in (0..).zip(&model.chords.points) {
        let on_leaflet = point
            .iter()
            .all(|&(v, _)| before.get(v as usize).is_some_and(|field| !field.is_nan()));
        let beyond = point
            .iter()
            .filter(|&&(v, _)| before.get(v as usize).is_some_and(|&field| field < 0.0))
            .count();
        let is_cut = (beyond > 0 && beyond < point.len())
            || point.iter().any(|&(v, _)| moved.get(v as usize) == Some(&true));
        if on_leaflet && is_cut {
            let at = place_mm(point, &model.rest_mm);
            let by = if place(point, &before) < 0.0 {
                motion(place(point, &chart.shares))
            } else {
                Vec3::zeros()
            };
            reinserted.insert(number, (leaflet, at + by));
        }
    }
    let (after, _) = remade(model, &mesh, &reinserted, "augment")?;
    Ok((after, area_mm2))
}

/// Area of the leaflets, unloaded [mm²].
fn unloaded_mm2(model: &Model) -> f64 {
    let area = |face: &[u32; 3]| {
        let [a, b, c] = face.map(|v| model.rest_mm[v as usize]);
        0.5 * (b - a).cross(&(c - a)).norm()
    };
    model.faces.iter().map(area).sum()
}

/// Mean length of the edges in the open valve [mm].
fn mean_edge_mm(model: &Model) -> f64 {
    let edges = topology::edges(&model.faces).ends;
    let length = |&[a, b]: &[u32; 2]| (model.rest_mm[a as usize] - model.rest_mm[b as usize]).norm();
    edges.iter().map(length).sum::<f64>() / edges.len().max(1) as f64
}
