//! What a surgeon does to the valve: one file per deed. A repair makes a new model and leaves the old one as it is.

pub mod alfieri;
pub mod augment;
mod chord_choice;
mod chord_ends;
pub mod clip;
pub mod close_cleft;
mod closure_line;
pub mod cut_chord;
mod excision;
mod incision;
pub mod leaflet;
mod leaflet_chart;
pub mod neochord;
mod patch;
pub mod placement;
mod plication;
pub mod relocate_papillary;
pub mod resect;
mod resect_chords;
pub mod ring;
pub mod ring_attachment;
mod ring_candidates;
mod ring_faults;
mod ring_flexible;
mod ring_laying;
pub mod ring_shape;
mod ring_sutures;
mod rods;
pub mod rupture;
mod seam;
pub mod site;
pub mod sutures;
pub mod transfer_chord;

pub use alfieri::AlfieriReport;
pub use augment::AugmentReport;
pub use clip::ClipReport;
pub use close_cleft::CleftReport;
pub use cut_chord::CutReport;
pub use neochord::NeochordReport;
pub use relocate_papillary::RelocationReport;
pub use resect::ResectReport;
pub use ring::{RingExtent, RingReport};
pub use ring_shape::parse_ring_spec;
pub use transfer_chord::TransferReport;

use crate::model::Model;
use crate::scene::{Fault, Repair};

/// A model after a repair.
#[derive(Clone, Debug)]
pub struct Repaired {
    /// The new model.
    pub model: Model,
    /// What was done, in figures.
    pub report: Report,
    /// Guesses and doubts.
    pub warnings: Vec<Fault>,
}

/// What was done, by kind of repair.
#[derive(Clone, Debug, PartialEq)]
pub enum Report {
    /// Annuloplasty.
    Ring(RingReport),
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

/// Applies one repair.
///
/// # Errors
/// Every fault that keeps the repair from being carried out, with the key in the repair.
pub fn apply(model: &Model, repair: &Repair) -> Result<Repaired, Vec<Fault>> {
    match repair {
        Repair::Ring(ring) => ring::implant(model, ring),
        Repair::Clip(clip) => clip::clip(model, clip),
        Repair::Alfieri(stitches) => alfieri::stitch(model, stitches),
        Repair::Neochord(neochord) => neochord::string_neochord(model, neochord),
        Repair::CutChord(cut) => cut_chord::cut(model, cut),
        Repair::TransferChord(transfer) => transfer_chord::transfer(model, transfer),
        Repair::Rupture(rupture) => rupture::rupture(model, rupture),
        Repair::RelocatePapillary(relocation) => relocate_papillary::relocate(model, relocation),
        Repair::CloseCleft(cleft) => close_cleft::close(model, cleft),
        Repair::Resect(piece) => resect::resect(model, piece),
        Repair::Augment(patch) => augment::augment(model, patch),
    }
}
