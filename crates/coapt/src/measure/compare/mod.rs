//! How far apart two surfaces lie, under every definition that closed valves have been validated with.
//!
//! The published figures are not interchangeable: papers differ in which points they measure from, to what, in what
//! counts, and whether the shapes were aligned before. Here they all stand side by side, of plain surfaces, since a
//! segmented image or a finite-element result has no [`crate::model::Model`].

mod align;
mod annular;
mod checks;
mod kabsch;
mod regions;
mod rows;
#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};

use crate::Vec3;
use crate::scene::{Contact, Fault};

pub use align::{Alignment, AlignmentMethod};
pub use rows::{Definitions, Regions};

use super::{indexed_surface::IndexedSurface, side};

/// A surface that is compared: plain triangles, with what is known of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ComparedSurface {
    /// Name in faults, such as the file.
    pub name: String,
    /// Points [mm], shape `[point]`. Those that no face uses do not count.
    pub points_mm: Vec<Vec3>,
    /// Triangles as point numbers, shape `[face]`, looking to the atrium.
    pub faces: Vec<[u32; 3]>,
    /// The cell that each triangle is a part of, ascending, shape `[face]`: halves of one quadrilateral share it.
    /// Empty: each is its own.
    pub face_cell: Vec<u32>,
    /// Whether tissue touches tissue at each point, shape `[point]`; none where that is not known.
    pub contact: Option<Vec<bool>>,
    /// Whether each point lies on the annulus, shape `[point]`; none where that is not known.
    pub annulus: Option<Vec<bool>>,
}

/// What a comparison leaves to the caller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompareSettings {
    /// Towards the atrium, of any length; none: from the annulus of each surface.
    pub atrial_direction: Option<Vec3>,
    /// Distance of mid-surfaces in contact [mm], which tells slits from gaps; by default that of scenes.
    pub contact_thickness_mm: f64,
}

impl Default for CompareSettings {
    fn default() -> Self {
        Self {
            atrial_direction: None,
            contact_thickness_mm: Contact::default().thickness_mm,
        }
    }
}

/// The distance between two surfaces.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// Size of both surfaces, and what is known of them.
    pub result: SurfaceSummary,
    /// The same of the reference.
    pub reference: SurfaceSummary,
    /// Whether both are the same mesh: as many points, the same cells.
    pub nodes_correspond: bool,
    /// Where both stand as given.
    pub as_given: Regions,
    /// After the result was moved rigidly on the reference.
    pub aligned: Regions,
    /// That motion.
    pub alignment: Alignment,
    /// The error at each point of the result, as given.
    #[serde(skip)]
    pub map: ErrorMap,
    /// What may make the figures mean less than they seem to.
    #[serde(skip)]
    pub warnings: Vec<Fault>,
}

/// Size of a surface, and what is known of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SurfaceSummary {
    /// Points that faces use.
    pub points: usize,
    /// Triangles.
    pub faces: usize,
    /// Area [mm²].
    pub area_mm2: f64,
    /// Mean length of the edges of its triangles [mm]; an edge counts once for each.
    pub mean_edge_mm: f64,
    /// Unit vector to the atrium; none where it could not be told.
    pub atrial_direction: Option<[f64; 3]>,
    /// Share of the area that is seen from the atrium [1].
    pub visible_share: Option<f64>,
    /// Share of the area that is in contact [1].
    pub contact_share: Option<f64>,
}

/// The error at each point of the result, shape `[point]` throughout.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ErrorMap {
    /// Distance to the reference where both stand as given [mm].
    pub distance_mm: Vec<f64>,
    /// Distance to the reference after rigid alignment [mm].
    pub aligned_distance_mm: Vec<f64>,
    /// `distance_mm`, negative on the ventricular side of the reference; none where its faces do not wind alike.
    pub signed_distance_mm: Option<Vec<f64>>,
    /// Seen from the atrium.
    pub visible: Option<Vec<bool>>,
    /// In contact, as the result says.
    pub contact: Option<Vec<bool>>,
}

/// Compares a result with a reference, both in one frame.
///
/// # Errors
/// A surface without points, faces or area; numbers that are not finite or beyond a kilometre; faces of points that do
/// not exist; arrays of the wrong shape; a contact thickness that is not positive; a direction without length.
pub fn compare(
    result: &ComparedSurface,
    reference: &ComparedSurface,
    settings: &CompareSettings,
) -> Result<Comparison, Vec<Fault>> {
    checks::check(result, reference, settings)?;
    let mut warnings = Vec::new();
    let here = IndexedSurface::new(&result.faces, result.points_mm.clone());
    let there = IndexedSurface::new(&reference.faces, reference.points_mm.clone());
    warnings.extend(checks::apart(result, &here, reference, &there));
    let planes = annular::planes([(result, &here), (reference, &there)], settings, &mut warnings);
    let seen_here = regions::masks(result, &here, planes[0], settings.contact_thickness_mm);
    let seen_there = regions::masks(reference, &there, planes[1], settings.contact_thickness_mm);
    let to_atrium = planes.map(|plane| plane.map(|plane| plane.normal));
    let nodes_correspond = checks::same_mesh(result, &here, reference, &there);
    let alignment = match nodes_correspond {
        true => align::on_nodes(&here, &there),
        false => align::on_surface(&here, &there),
    };
    let moved = result.points_mm.iter().map(|&p| alignment.moved(p)).collect();
    let moved = IndexedSurface::new(&result.faces, moved);
    let sides = [&seen_here, &seen_there];
    let (as_given, feet) = rows::regions([&here, &there], sides, nodes_correspond);
    let (aligned, aligned_feet) = rows::regions([&moved, &there], sides, nodes_correspond);
    Ok(Comparison {
        result: summary(&here, &seen_here, to_atrium[0]),
        reference: summary(&there, &seen_there, to_atrium[1]),
        nodes_correspond,
        as_given,
        aligned,
        alignment,
        map: ErrorMap {
            signed_distance_mm: side::signed(&there, to_atrium[1], &here.points_mm, &feet),
            distance_mm: feet.iter().map(|foot| foot.distance_mm).collect(),
            aligned_distance_mm: aligned_feet.iter().map(|foot| foot.distance_mm).collect(),
            visible: seen_here.visible.map(|mask| mask.points),
            contact: seen_here.contact.map(|mask| mask.points),
        },
        warnings,
    })
}

fn summary(surface: &IndexedSurface, masks: &regions::Masks, normal: Option<Vec3>) -> SurfaceSummary {
    let area_mm2: f64 = surface.face_area_mm2.iter().sum();
    let share = |mask: &regions::Mask| {
        let inside = surface
            .face_area_mm2
            .iter()
            .zip(&mask.faces)
            .filter(|part| *part.1);
        inside.map(|part| part.0).sum::<f64>() / area_mm2
    };
    SurfaceSummary {
        points: surface.used.iter().filter(|&&used| used).count(),
        faces: surface.faces.len(),
        area_mm2,
        mean_edge_mm: surface.mean_edge_mm(),
        atrial_direction: normal.map(Into::into),
        visible_share: masks.visible.as_ref().map(share),
        contact_share: masks.contact.as_ref().map(share),
    }
}
