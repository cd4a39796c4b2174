//! What is known of a frame in numbers: a message of JSON beside each frame, for curves over time.

use coapt::film::Frame;
use coapt::measure::measure;
use coapt::model::Model;
use coapt::relax::Status;
use coapt::relax::load::elastic_energy_mj;
use coapt::scene::MMHG_MPA;
use serde::{Deserialize, Serialize};

/// Figures of a frame. What is not finite is none: JSON has no word for it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// Number of the frame, from 0.
    pub frame: usize,
    /// Whether the frame is a balance: converged, stable, nothing crosses.
    pub certified: bool,
    /// Why the solver stopped.
    pub status: Status,
    /// Transvalvular pressure [mmHg].
    pub pressure_mmhg: Option<f64>,
    /// Largest force left on a free vertex over [`reference_force_n`](coapt::relax::load::reference_force_n) [1].
    pub residual: Option<f64>,
    /// Energy that leaflets and chordae store [mJ]. Neither contact, a penalty of the method, nor pressure, which has no energy at a
    /// free margin, is part of it: it is no energy of the whole, and need not be least in a balance.
    pub elastic_energy_mj: Option<f64>,
    /// Contact area of the leaflets [mm²].
    pub coaptation_area_mm2: Option<f64>,
    /// Anatomic orifice [mm²], as it is measured in closed valves.
    pub orifice_area_mm2: Option<f64>,
    /// How far mid-surfaces in contact are nearer than the contact distance, at most [mm].
    pub max_penetration_mm: Option<f64>,
}

impl Figures {
    pub(super) fn new(model: &Model, frame: &Frame, number: usize) -> Self {
        let equilibrium = &frame.equilibrium;
        let positions_mm = &equilibrium.state.positions_mm;
        let measures = measure(model, positions_mm, &equilibrium.reactions_n);
        let finite = |value: f64| value.is_finite().then_some(value);
        Self {
            frame: number,
            certified: frame.is_certified(),
            status: equilibrium.status,
            pressure_mmhg: finite(frame.pressure_mpa / MMHG_MPA),
            residual: finite(equilibrium.certificate.residual),
            elastic_energy_mj: finite(elastic_energy_mj(model, positions_mm)),
            coaptation_area_mm2: finite(measures.coaptation.area_mm2),
            orifice_area_mm2: finite(measures.orifice.area_mm2),
            max_penetration_mm: finite(equilibrium.certificate.max_penetration_mm),
        }
    }

    /// The numbers with their names, which end in their units.
    pub fn numbers(&self) -> [(&'static str, Option<f64>); 6] {
        [
            ("pressure_mmhg", self.pressure_mmhg),
            ("residual", self.residual),
            ("elastic_energy_mj", self.elastic_energy_mj),
            ("coaptation_area_mm2", self.coaptation_area_mm2),
            ("orifice_area_mm2", self.orifice_area_mm2),
            ("max_penetration_mm", self.max_penetration_mm),
        ]
    }
}
