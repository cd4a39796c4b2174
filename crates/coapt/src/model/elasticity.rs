//! What resists deformation of the leaflets, made from their tissues: springs, membranes, hinges.

use super::fibres::circumferential;
use super::{LeafletTissue, Model, hinges, membranes, springs};
use crate::Vec3;
use crate::energy::{bending::Hinges, bilinear_spring::Springs, membrane::Membranes};
use crate::mesh::topology::Edges;
use crate::scene::Tissue;

/// Leaflets as a mesh and what each is made of.
#[derive(Clone, Copy, Debug)]
pub struct Sheet<'a> {
    /// Unloaded positions [mm], shape `[vertex]`.
    pub rest_mm: &'a [Vec3],
    /// Triangles, shape `[face]`.
    pub faces: &'a [[u32; 3]],
    /// Which leaflet each belongs to, shape `[face]`.
    pub face_leaflet: &'a [u32],
    /// Annulus vertices in order.
    pub annulus: &'a [u32],
    /// What the leaflets are made of.
    pub leaflets: &'a [LeafletTissue],
}

/// What resists deformation.
#[derive(Clone, Debug, PartialEq)]
pub struct Elasticity {
    /// Along the edges of leaflets made of springs.
    pub springs: Springs,
    /// On the faces of the others.
    pub membranes: Membranes,
    /// Along the edges of leaflets that resist bending.
    pub hinges: Hinges,
}

impl<'a> Sheet<'a> {
    /// The leaflets of a model.
    pub fn of(model: &'a Model) -> Self {
        Self {
            rest_mm: &model.rest_mm,
            faces: &model.faces,
            face_leaflet: &model.face_leaflet,
            annulus: &model.annulus,
            leaflets: &model.leaflets,
        }
    }

    pub(super) fn leaflet(&self, face: u32) -> &LeafletTissue {
        &self.leaflets[self.face_leaflet[face as usize] as usize]
    }
}

/// Makes springs, membranes and hinges. Fibres run along the annulus; they are looked for only where a tissue has any.
pub fn elasticity(sheet: &Sheet, edges: &Edges) -> Elasticity {
    let is_fibrous = |leaflet: &LeafletTissue| {
        matches!(
            leaflet.tissue,
            Tissue::AnisotropicSprings { .. } | Tissue::MayNewman { .. }
        )
    };
    let fibres = match sheet.leaflets.iter().any(is_fibrous) {
        true => circumferential(sheet.rest_mm, sheet.faces, sheet.annulus),
        false => vec![Vec3::zeros(); sheet.faces.len()],
    };
    Elasticity {
        springs: springs::springs(sheet, edges, &fibres),
        membranes: membranes::membranes(sheet, &fibres),
        hinges: hinges::hinges(sheet, edges),
    }
}
