//! What alternatives are ranked by, and below which difference it tells nothing.

use serde::{Deserialize, Serialize};

use crate::measure::Measures;

/// Coaptation that a surgeon aims for [mm]: 8 mm or more at A2-P2, 5 to 10 mm being acceptable. It is held against the mean
/// along the line of closure, which is lower than the middle: a target on the safe side.
pub const COAPTATION_TARGET_MM: f64 = 8.0;

/// A measure that tells a better repair from a worse one.
///
/// Differences below the [noise](Criterion::noise) tell nothing. "Equal within a tolerance" is no order, since a may equal
/// b and b equal c where a is better than c; so each measure is cut into bins as wide as its noise, the first of which begins at
/// the best value there is, and bins are compared. That way whether one alternative ranks above another does not depend on the
/// others. The price: two that lie on either side of a bin's border are told apart by less than the noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Criterion {
    /// Regurgitant orifice area: the smaller the better.
    Orifice,
    /// Mean coaptation length: the less it lacks of [`COAPTATION_TARGET_MM`] the better; beyond that, more is no better.
    CoaptationLength,
    /// Largest tension of a chord: the lower the better.
    ChordForce,
    /// Strain, 95th percentile of the leaflet where it is largest: the lower the better.
    Strain,
}

impl Criterion {
    /// All, in the order that is used unless another is asked for.
    pub const ALL: [Self; 4] = [
        Self::Orifice,
        Self::CoaptationLength,
        Self::ChordForce,
        Self::Strain,
    ];

    /// As written in plans.
    pub fn name(self) -> &'static str {
        match self {
            Self::Orifice => "orifice",
            Self::CoaptationLength => "coaptation_length",
            Self::ChordForce => "chord_force",
            Self::Strain => "strain",
        }
    }

    /// Unit of value and noise.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Orifice => "mm²",
            Self::CoaptationLength => "mm",
            Self::ChordForce => "N",
            Self::Strain => "1",
        }
    }

    /// The measure [mm², mm, N, 1].
    pub fn value(self, measures: &Measures) -> f64 {
        match self {
            Self::Orifice => measures.orifice.area_mm2,
            Self::CoaptationLength => measures.coaptation.length_mean_mm,
            Self::ChordForce => measures.chords.max_force_n,
            Self::Strain => measures
                .leaflets
                .iter()
                .map(|leaflet| leaflet.strain_p95)
                .fold(0.0, f64::max),
        }
    }

    /// Differences below this are those between meshes or roads, not between repairs.
    ///
    /// The orifice's is that of README. The others are the round numbers above the largest differences of certified closures of
    /// a dilated valve after twelve rings, between meshes of 650 and 2600 faces or between a cold and a warm start: 0.79 mm,
    /// 0.11 N, 0.007.
    pub fn noise(self) -> f64 {
        match self {
            Self::Orifice => 8.0,
            Self::CoaptationLength => 1.0,
            Self::ChordForce => 0.2,
            Self::Strain => 0.01,
        }
    }

    /// How far from the best there is, at least 0, in the unit of the value.
    pub(super) fn cost(self, measures: &Measures) -> f64 {
        let value = self.value(measures);
        match self {
            Self::CoaptationLength => (COAPTATION_TARGET_MM - value).max(0.0),
            Self::Orifice | Self::ChordForce | Self::Strain => value,
        }
    }

    /// The bin of that cost, from 0.
    pub(super) fn bin(self, measures: &Measures) -> u64 {
        // Measures are finite; the conversion saturates.
        (self.cost(measures) / self.noise()).floor() as u64
    }
}
