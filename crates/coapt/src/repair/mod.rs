//! What a surgeon does to the valve: one file per deed. A repair makes a new model and leaves the old one as it is.

pub mod alfieri;
pub mod clip;
pub mod leaflet;
pub mod placement;
pub mod ring;
pub mod ring_attachment;
mod ring_candidates;
mod ring_laying;
pub mod ring_shape;
pub mod site;
pub mod sutures;

pub use alfieri::AlfieriReport;
pub use clip::ClipReport;
pub use ring::RingReport;
pub use ring_shape::parse_ring_spec;

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
    }
}

/// A fault of the plan's repair of that number, from 0: `clip.site` becomes `repair[0].site`.
pub fn in_plan(number: usize, fault: &Fault) -> Fault {
    let key = fault.place.find(['.', ' ']).map_or("", |at| &fault.place[at..]);
    Fault {
        place: format!("repair[{number}]{key}"),
        ..fault.clone()
    }
}
