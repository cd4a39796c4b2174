//! Everything that changes while the valve relaxes.

use crate::Vec3;
use crate::model::Model;

/// The positions of all vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Positions [mm], shape `[vertex]`.
    pub positions_mm: Vec<Vec3>,
}

impl State {
    /// The open valve.
    pub fn open(model: &Model) -> Self {
        Self {
            positions_mm: model.rest_mm.clone(),
        }
    }
}
