//! The repaired valve as it opens.

use std::ops::ControlFlow;

use crate::Vec3;
use crate::measure::flow::{Filling, mean_diastolic_gradient_mmhg};
use crate::measure::{DiastolicOrifice, diastolic_orifice};
use crate::model::Model;
use crate::relax::{Certificate, Moment, Status, relax_watched};
use crate::state::State;

/// A valve that no pressure closes, nor any flow opens.
#[derive(Clone, Debug, PartialEq)]
pub struct Diastole {
    /// Why the solver stopped.
    pub status: Status,
    /// How far the result can be trusted.
    pub certificate: Certificate,
    /// Solver iterations.
    pub iterations: usize,
    /// What is left to be flowed through; none without a certificate.
    pub orifice: Option<DiastolicOrifice>,
    /// Mean gradient over that orifice of a heart at rest ([`Filling`]'s default) [mmHg]; none without a certificate, nor where the valve
    /// [hardly opens](crate::measure::flow::HARDLY_OPENS_MM2).
    pub mean_gradient_mmhg: Option<f64>,
    /// Where the vertices hang [mm], shape `[vertex]`; empty unless asked for ([`keep_positions`](super::Settings)).
    pub positions_mm: Vec<Vec3>,
}

impl Diastole {
    /// Whether the result may be used.
    pub fn is_certified(&self) -> bool {
        self.certificate.is_certified(self.status)
    }
}

/// Relaxes a valve without pressure, annulus and papillary tips where they are in systole.
///
/// In a living heart the flow pushes the leaflets apart and the annulus is wider: the orifice found here is less than the one that
/// blood passes, the gradient more. They compare repairs of one valve; limits for a patient's mitral valve area are not meant
/// for them.
pub(super) fn diastole(
    model: &Model,
    start: &State,
    watch: impl FnMut(&Moment) -> ControlFlow<()>,
) -> Diastole {
    let open = Model {
        pressure_mpa: 0.0,
        ..model.clone()
    };
    let found = relax_watched(&open, start, watch);
    let is_certified = found.certificate.is_certified(found.status);
    let orifice = is_certified.then(|| diastolic_orifice(&open, &found.state.positions_mm));
    let area_mm2 = orifice.as_ref().map(|orifice| orifice.area_mm2);
    Diastole {
        mean_gradient_mmhg: area_mm2.and_then(|area| mean_diastolic_gradient_mmhg(area, &Filling::default())),
        status: found.status,
        certificate: found.certificate,
        iterations: found.history.len(),
        orifice,
        positions_mm: found.state.positions_mm,
    }
}
