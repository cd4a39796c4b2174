//! Which parts of a surface are seen, and which are in contact.

use super::ComparedSurface;
use crate::measure::atrial_view::atrial_view;
use crate::measure::indexed_surface::IndexedSurface;
use crate::measure::plane::AnnularPlane;

/// What is known of a surface's parts.
pub(super) struct Masks {
    /// Seen from the atrium.
    pub(super) visible: Option<Mask>,
    /// Tissue on tissue.
    pub(super) contact: Option<Mask>,
}

/// A part of a surface.
pub(super) struct Mask {
    /// Which points are in it, shape `[point]`.
    pub(super) points: Vec<bool>,
    /// Which faces, shape `[face]`.
    pub(super) faces: Vec<bool>,
}

/// The parts of a surface; a face is seen if its centroid is, and in contact if two of its corners are.
pub(super) fn masks(
    surface: &ComparedSurface,
    indexed: &IndexedSurface,
    plane: Option<AnnularPlane>,
    thickness_mm: f64,
) -> Masks {
    let visible = plane.map(|plane| {
        let view = atrial_view(plane, &indexed.points_mm, indexed.faces, thickness_mm);
        Mask {
            points: indexed.points_mm.iter().map(|&p| view.sees(p)).collect(),
            faces: indexed.centroids_mm.iter().map(|&p| view.sees(p)).collect(),
        }
    });
    let contact = surface.contact.as_ref().map(|points| {
        let two = |face: &[u32; 3]| face.iter().filter(|&&v| points[v as usize]).count() >= 2;
        Mask {
            points: points.clone(),
            faces: indexed.faces.iter().map(two).collect(),
        }
    });
    Masks { visible, contact }
}
