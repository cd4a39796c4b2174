//! What alternatives are ranked by, and below which difference it tells nothing.

use serde::{Deserialize, Serialize};

use super::Diastole;
use crate::measure::Measures;

/// Coaptation that a surgeon aims for [mm]: 8 mm or more at A2-P2, 5 to 10 mm being acceptable. Held against the mean along the
/// line of closure, which is lower than the middle, it is a target on the safe side.
pub const COAPTATION_TARGET_MM: f64 = 8.0;

/// Orifice of the open valve beyond which more is no better [mm²], and from which halvings are counted; no limit below which anything
/// would be wrong: the 4 cm² from which clips leave no high gradient (discharge
/// gradients of 3.3 against 3.9 mmHg below it, PMC12813607).
pub const DIASTOLIC_TARGET_MM2: f64 = 400.0;

/// A measure that tells a better repair from a worse one.
///
/// Differences below the [noise](Criterion::noise) tell nothing. "Equal within a tolerance" is no order, since a may equal
/// b and b equal c where a is better than c; so each measure is cut into [bins](Criterion::bin_width), the first of which begins at
/// the best value there is, and bins are compared. That way whether one alternative ranks above another does not depend on the
/// others. The price: two that lie on either side of a bin's border are told apart by less than the noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Criterion {
    /// Regurgitant orifice area: the smaller the better.
    Orifice,
    /// Coaptation length at A2-P2: the less it lacks of [`COAPTATION_TARGET_MM`] the better; beyond that, more is no better.
    #[serde(rename = "coaptation_length_a2p2")]
    CoaptationLengthA2P2,
    /// Mean coaptation length along the line of closure, held against the same target.
    CoaptationLength,
    /// Largest tension of a chord: the lower the better.
    ChordForce,
    /// Strain, 95th percentile of the leaflet where it is largest: the lower the better.
    Strain,
    /// Orifice of the valve without pressure: the less often it must be doubled to reach [`DIASTOLIC_TARGET_MM2`] the better;
    /// beyond that, more is no better. Half the orifice is four times the gradient; less of a difference tells nothing, since the
    /// figure is no mitral valve area. Where it is not known, the alternative stands behind all others of that criterion.
    DiastolicOrifice,
}

impl Criterion {
    /// All.
    pub const ALL: [Self; 6] = [
        Self::Orifice,
        Self::CoaptationLengthA2P2,
        Self::CoaptationLength,
        Self::ChordForce,
        Self::Strain,
        Self::DiastolicOrifice,
    ];

    /// Those that rank unless others are asked for, in their order. The length at A2-P2 is what the target of 8 mm was said of, and
    /// differs less between meshes than the mean. Which order is our choice, as a surgeon would ask: does it seal, does it still
    /// open, how surely will it seal tomorrow, what must chordae and tissue bear.
    pub const DEFAULT: [Self; 4] = [
        Self::Orifice,
        Self::CoaptationLengthA2P2,
        Self::ChordForce,
        Self::Strain,
    ];

    /// The default, with the orifice of the open valve second where that is computed.
    pub fn default_with(diastole: bool) -> Vec<Self> {
        let [first, rest @ ..] = Self::DEFAULT;
        let second = diastole.then_some(Self::DiastolicOrifice);
        [first].into_iter().chain(second).chain(rest).collect()
    }

    /// As written in plans.
    pub fn name(self) -> &'static str {
        match self {
            Self::Orifice => "orifice",
            Self::CoaptationLengthA2P2 => "coaptation_length_a2p2",
            Self::CoaptationLength => "coaptation_length",
            Self::ChordForce => "chord_force",
            Self::Strain => "strain",
            Self::DiastolicOrifice => "diastolic_orifice",
        }
    }

    /// Unit of value and noise.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Orifice | Self::DiastolicOrifice => "mm²",
            Self::CoaptationLengthA2P2 | Self::CoaptationLength => "mm",
            Self::ChordForce => "N",
            Self::Strain => "1",
        }
    }

    /// The measure [mm², mm, mm, N, 1, mm²]; none of the open valve where that was not computed, or not with a certificate.
    pub fn value(self, measures: &Measures, diastole: Option<&Diastole>) -> Option<f64> {
        Some(match self {
            Self::Orifice => measures.orifice.area_mm2,
            Self::CoaptationLengthA2P2 => measures.coaptation.length_a2p2_mm,
            Self::CoaptationLength => measures.coaptation.length_mean_mm,
            Self::ChordForce => measures.chords.max_force_n,
            Self::Strain => largest_strain(measures),
            Self::DiastolicOrifice => return Some(diastole?.orifice.as_ref()?.area_mm2),
        })
    }

    /// Differences below this are those between meshes or roads, not between repairs.
    ///
    /// The orifice's is that of README. The others are the round numbers above the largest differences of certified closures of
    /// a dilated valve after twelve rings, between meshes of 650 and 2600 faces or between a cold and a warm start: 0.37 mm at
    /// A2-P2 and 1.29 mm in the mean (after a posterior band; 0.79 mm after closed rings), 0.11 N, 0.007; of the open valve 11.7 mm².
    pub fn noise(self) -> f64 {
        match self {
            Self::Orifice => 8.0,
            Self::CoaptationLengthA2P2 => 0.5,
            Self::CoaptationLength => 1.5,
            Self::ChordForce => 0.2,
            Self::Strain => 0.01,
            Self::DiastolicOrifice => 15.0,
        }
    }

    /// How wide the bins are in which values are compared, and in what: of the open valve in halvings, else as wide as the noise.
    pub fn bin_width(self) -> (f64, &'static str) {
        match self {
            Self::DiastolicOrifice => (1.0, "halvings"),
            _ => (self.noise(), self.unit()),
        }
    }

    /// How far from the best there is, at least 0, in what bins are counted in; infinite where that is not known.
    pub(super) fn cost(self, measures: &Measures, diastole: Option<&Diastole>) -> f64 {
        let Some(value) = self.value(measures, diastole) else {
            return f64::INFINITY;
        };
        match self {
            Self::CoaptationLengthA2P2 | Self::CoaptationLength => (COAPTATION_TARGET_MM - value).max(0.0),
            // What does not open at all stands behind whatever does.
            Self::DiastolicOrifice if value <= 0.0 => f64::INFINITY,
            Self::DiastolicOrifice => (DIASTOLIC_TARGET_MM2 / value).log2().max(0.0),
            Self::Orifice | Self::ChordForce | Self::Strain => value,
        }
    }

    /// The bin of that cost, from 0.
    pub(super) fn bin(self, measures: &Measures, diastole: Option<&Diastole>) -> u64 {
        // Measures are finite; the conversion saturates.
        (self.cost(measures, diastole) / self.bin_width().0).floor() as u64
    }
}

/// Strain, 95th percentile, in the leaflet where it is largest [1].
pub fn largest_strain(measures: &Measures) -> f64 {
    let strains = measures.leaflets.iter().map(|leaflet| leaflet.strain_p95);
    strains.fold(0.0, f64::max)
}
