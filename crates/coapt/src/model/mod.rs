//! Everything that stays constant while the valve relaxes.

mod annulus;
mod annulus_checks;
mod attachment;
mod build;
mod chord_checks;
mod chordae;
mod cleaning;
mod doubts;
pub mod elasticity;
mod facing;
mod faults;
mod fibres;
#[cfg(test)]
pub(crate) mod fixtures;
mod hinges;
mod insertion;
mod membranes;
pub mod mesh_quality;
mod names;
mod near_points;
pub mod size;
mod springs;
mod strands;
mod surface;
mod untangle;
mod validate;
mod validate_numbers;
mod validate_tissue;

pub use build::Built;
pub use chordae::LeftOut;
pub use doubts::doubts;
pub(crate) use insertion::{Insertion, insertion_near};
pub use untangle::Untangled;
pub(crate) use validate_tissue::tissue_faults;

use crate::Vec3;
use crate::energy::{
    bending::Hinges, bilinear_spring::Springs, chord::Chords, dead_load::DeadLoads, membrane::Membranes,
};
pub use crate::mesh::landmarks::AnnulusLandmarks;
use crate::scene::{Contact, Settings, Tissue};

/// A valve ready to be closed. Vertices: leaflets first, then chord nodes, then papillary tips.
#[derive(Clone, Debug)]
pub struct Model {
    /// Name of the case.
    pub name: String,
    /// Open, unloaded positions [mm], shape `[vertex]`. Rest lengths and areas come from these.
    pub rest_mm: Vec<Vec3>,
    /// The first so many vertices belong to leaflets.
    pub leaflet_vertex_count: usize,
    /// Triangles, normals to the atrium, shape `[face]`.
    pub faces: Vec<[u32; 3]>,
    /// Which leaflet each face belongs to, shape `[face]`.
    pub face_leaflet: Vec<u32>,
    /// The leaflets.
    pub leaflets: Vec<LeafletTissue>,
    /// Springs along the edges of leaflets made of them.
    pub springs: Springs,
    /// Triangles of leaflets made of membrane.
    pub membranes: Membranes,
    /// Edges about which the leaflets resist bending.
    pub hinges: Hinges,
    /// Chordae.
    pub chords: Chords,
    /// What the chords of each group are, shape `[chord group]`; their laws stand in `chords`.
    pub chord_groups: Vec<ChordGroup>,
    /// Transvalvular pressure [MPa].
    pub pressure_mpa: f64,
    /// Forces on vertices besides [N]; a scene gives none.
    pub dead_loads_n: DeadLoads,
    /// How leaflets touch.
    pub contact: Contact,
    /// Annulus vertices in order around the orifice, counter-clockwise seen from the atrium. For a single patch that
    /// is held on part of its border only: those vertices, in that order.
    pub annulus: Vec<u32>,
    /// Free margins: every other boundary loop or open boundary chain, in order.
    pub margins: Vec<Margin>,
    /// Papillary muscles.
    pub papillary: Vec<Papillary>,
    /// Where the landmarks lie on the annulus.
    pub landmarks: AnnulusLandmarks,
    /// Vertices that do not move freely and where they end up, in ascending order of vertex.
    pub prescribed: Vec<Prescribed>,
    /// How the equilibrium is sought.
    pub settings: Settings,
}

/// Chords of one name and kind.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChordGroup {
    /// Name in reports.
    pub name: String,
    /// What they are.
    pub kind: ChordKind,
}

impl ChordGroup {
    /// The patient's own chordae of this name.
    pub fn chordae(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            kind: ChordKind::Chorda,
        }
    }
}

/// What carries tension along a straight line. All follow the same laws, but they are reported and fitted apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChordKind {
    /// A chord of the patient's own.
    Chorda,
    /// A chord that a surgeon strung from a papillary tip to a leaflet.
    Neochorda,
    /// A thread, or the grip of a clip, that holds two places of the leaflets together.
    Suture,
}

impl Model {
    /// Where a vertex is when the valve is closed, if it is held, else when it is open [mm].
    pub fn target_mm(&self, vertex: u32) -> Vec3 {
        let held = self.prescribed.binary_search_by_key(&vertex, |held| held.vertex);
        held.map_or(self.rest_mm[vertex as usize], |found| {
            self.prescribed[found].target_mm
        })
    }

    /// Where a held vertex is when the valve is closed [mm]; none for a free one.
    pub fn target_mut(&mut self, vertex: u32) -> Option<&mut Vec3> {
        let held = self.prescribed.binary_search_by_key(&vertex, |held| held.vertex);
        held.ok().map(|found| &mut self.prescribed[found].target_mm)
    }
}

/// What a leaflet is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct LeafletTissue {
    /// Name.
    pub name: String,
    /// Thickness [mm].
    pub thickness_mm: f64,
    /// Its law. Springs, membranes and hinges are made of it, here and on coarser meshes.
    pub tissue: Tissue,
}

/// A boundary of the leaflets that is not annulus.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Margin {
    /// Vertices in order.
    pub vertices: Vec<u32>,
    /// Whether the last vertex joins the first.
    pub closed: bool,
}

/// A papillary muscle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Papillary {
    /// Name.
    pub name: String,
    /// Its tips, as vertices.
    pub tips: Vec<u32>,
}

/// A Dirichlet vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prescribed {
    /// The vertex.
    pub vertex: u32,
    /// Where it stands when the valve is closed [mm].
    pub target_mm: Vec3,
}
