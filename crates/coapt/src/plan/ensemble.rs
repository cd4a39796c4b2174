//! How far an answer depends on what is not known: the same plan on many valves that an image could not tell from the given one.

use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::Rng;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{Outcome, Refusal, Settings, Start, Watch, apply_all, closed};
use crate::Vec3;
use crate::measure::Measures;
use crate::measure::agreement::{Agreement, SMALL_MM2};
use crate::measure::statistics::percentile;
use crate::mesh::polyline;
use crate::model::Model;
use crate::scene::{Fault, Repair, Tissue};
use crate::state::State;

/// What is not known of a valve, as standard deviations of normal distributions; beyond three of them nothing is drawn.
///
/// The defaults are our choice but for their sizes: three-dimensional echo resolves 0.5 to 1 mm, and nobody measures the length of
/// a patient's chordae or his tissue.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Uncertainty {
    /// Length of each chord by itself, as a part of it [1].
    pub chord_length: f64,
    /// Length of all chordae together, as a part of it [1].
    pub chord_length_common: f64,
    /// Strain at which tissue made of springs stiffens, as a part of it [1]; membranes keep their laws.
    pub transition_strain: f64,
    /// Where the annulus stands in systole, at each of its points, in each direction [mm]; smooth along the annulus, as errors
    /// of a drawn curve are.
    pub annulus_mm: f64,
    /// Where each papillary muscle stands in systole, with all its tips, in each direction [mm].
    pub papillary_mm: f64,
    /// Pressure, as a part of it [1].
    pub pressure: f64,
}

impl Default for Uncertainty {
    fn default() -> Self {
        Self {
            chord_length: 0.03,
            chord_length_common: 0.03,
            transition_strain: 0.1,
            annulus_mm: 0.7,
            papillary_mm: 0.7,
            pressure: 0.1,
        }
    }
}

impl Uncertainty {
    /// Standard deviations that make no sense, with their keys.
    ///
    /// # Errors
    /// All of them.
    pub fn check(&self) -> Result<(), Vec<Fault>> {
        let given = [
            ("chord_length", self.chord_length, LARGEST_PART),
            ("chord_length_common", self.chord_length_common, LARGEST_PART),
            ("transition_strain", self.transition_strain, LARGEST_PART),
            ("annulus_mm", self.annulus_mm, LARGEST_MM),
            ("papillary_mm", self.papillary_mm, LARGEST_MM),
            ("pressure", self.pressure, LARGEST_PART),
        ];
        let wrong = given
            .into_iter()
            .filter(|(_, value, most)| !(0.0..=*most).contains(value));
        let told = wrong.map(|(key, value, most)| {
            Fault::error(
                format!("uncertainty.{key}"),
                format!("is {value}; expected 0 to {most}"),
            )
        });
        let faults: Vec<Fault> = told.collect();
        if faults.is_empty() { Ok(()) } else { Err(faults) }
    }
}

/// Largest standard deviation that makes sense of a part of something [1]: three of them leave a tenth.
const LARGEST_PART: f64 = 0.3;
/// The same of a place [mm]: what is not known to a centimetre is not known.
const LARGEST_MM: f64 = 10.0;
/// Harmonics of the annulus' error along its length, our choice: shifts, tilts, widths and the saddle's height are wrong, single
/// points are not.
const HARMONICS: u32 = 3;
/// Samples are closed to this residual [1], or to the valve's own where that is larger. Of 300 samples, 60 of each preset at 650 faces, no
/// orifice came out by more than 0.01 mm² otherwise than at 1e-6, no coaptation length at A2-P2 by more than 0.01 mm, no contact area by
/// more than 2.7 mm² (0.7 but for the healthy valve); a tenth of the iterations is saved.
const SAMPLE_TOLERANCE: f64 = 1e-3;
/// Valves whose orifice is below this count as sealed [mm²].
pub const SEALED_BELOW_MM2: f64 = SMALL_MM2;

/// The closed valves of an ensemble.
#[derive(Clone, Debug, PartialEq)]
pub struct Ensemble {
    /// What each sample came to, in the order of their numbers; a sample whose repairs cannot be applied says why.
    pub samples: Vec<Result<Outcome, Refusal>>,
}

/// Median and an interval that holds nine samples of ten.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// Below it lie 5 % of the certified samples.
    pub low: f64,
    /// Half of them.
    pub median: f64,
    /// 95 % of them.
    pub high: f64,
}

/// How often something came out, with the interval (Wilson's, 95 %) that so few samples leave for its probability.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Probability {
    /// Part of the certified samples [1].
    pub estimate: f64,
    /// Lower end of the interval [1].
    pub low: f64,
    /// Upper end [1].
    pub high: f64,
}

impl Ensemble {
    /// Measures of the samples that closed with a certificate: no others are counted anywhere.
    pub fn certified(&self) -> impl Iterator<Item = &Measures> {
        let outcomes = self.samples.iter().filter_map(|sample| sample.as_ref().ok());
        outcomes
            .filter(|outcome| outcome.is_certified())
            .map(|outcome| &outcome.measures)
    }

    /// Median and interval of a measure; none where no sample is certified.
    pub fn interval(&self, of: impl Fn(&Measures) -> f64) -> Option<Interval> {
        let values: Vec<f64> = self.certified().map(of).collect();
        if values.is_empty() {
            return None;
        }
        let at = |share: f64| percentile(values.clone(), share);
        Some(Interval {
            low: at(0.05),
            median: at(0.5),
            high: at(0.95),
        })
    }

    /// How many certified samples leave in doubt how much is open: margins and passage tell otherwise
    /// ([`OrificeMeasures::agreement`](crate::measure::OrificeMeasures::agreement)).
    pub fn in_doubt(&self) -> usize {
        let doubted = |measures: &&Measures| measures.orifice.agreement() != Agreement::Fair;
        self.certified().filter(doubted).count()
    }

    /// How probable it is that the valve seals: that its orifice is below [`SEALED_BELOW_MM2`]. None where no sample is certified.
    pub fn probability_sealed(&self) -> Option<Probability> {
        let sealed = self
            .certified()
            .filter(|measures| measures.orifice.area_mm2 < SEALED_BELOW_MM2);
        wilson(sealed.count(), self.certified().count())
    }
}

/// Wilson's interval (1927) at 95 %.
fn wilson(successes: usize, count: usize) -> Option<Probability> {
    const QUANTILE: f64 = 1.959_964;
    if count == 0 {
        return None;
    }
    let (count, part) = (count as f64, successes as f64 / count as f64);
    let squared = QUANTILE * QUANTILE / count;
    let middle = (part + 0.5 * squared) / (1.0 + squared);
    let half = QUANTILE / (1.0 + squared) * (part * (1.0 - part) / count + 0.25 * squared / count).sqrt();
    Some(Probability {
        estimate: part,
        low: (middle - half).max(0.0),
        high: (middle + half).min(1.0),
    })
}

/// Closes so many valves that differ as an image leaves it open, each with the same repairs. Sample `n` of a seed is the same valve for
/// every plan, so that plans are compared on the same valves; no sample depends on another, nor on the number of threads.
///
/// Each begins at `start`, the closed valve that they vary around, where one is given: that takes 0.4 to 0.9 times as long as from the
/// open valve. Where soft tissue folds in more ways than one it comes to rest in another fold then; of 60 samples of each preset (40 of `restricted`) at 650
/// faces, before and after a saddle ring of 30 mm, medians of orifice and coaptation length at A2-P2 agreed to 0.1 mm² and 0.1 mm,
/// single samples to 10 mm² and, in Barlow's valve, 3.3 mm (`docs/plans.md`).
pub fn ensemble(
    model: &Model,
    repairs: &[Repair],
    uncertainty: &Uncertainty,
    (samples, seed): (u32, u64),
    start: Option<&State>,
    watch: Watch,
) -> Ensemble {
    let settings = Settings::default();
    let sample = |number: u32| {
        let mut varied = varied(model, uncertainty, seed, number);
        let tolerance = &mut varied.settings.residual_tolerance;
        *tolerance = tolerance.max(SAMPLE_TOLERANCE);
        let applied = apply_all(&varied, repairs)?;
        let start = Start {
            closed: start,
            ..Start::default()
        };
        Ok(closed(applied, start, &settings, watch))
    };
    let numbers = (0..samples).into_par_iter().with_max_len(1);
    Ensemble {
        samples: numbers.map(sample).collect(),
    }
}

/// Sample `number` of a seed: the valve as it may be.
pub fn varied(model: &Model, uncertainty: &Uncertainty, seed: u64, number: u32) -> Model {
    let mut normal = Normal::new(seed, number);
    let mut model = model.clone();
    // The order of draws is part of what a seed means.
    model.pressure_mpa *= normal.factor(uncertainty.pressure);
    let knee = normal.factor(uncertainty.transition_strain);
    // What cuts a leaflet, or makes a coarse mesh of it, makes its springs anew of the tissue.
    for leaflet in &mut model.leaflets {
        scale_transition_strain(&mut leaflet.tissue, knee);
    }
    let springs = &mut model.springs;
    for (rest_mm, transition_mm) in springs
        .rest_length_mm
        .iter()
        .zip(&mut springs.transition_length_mm)
    {
        *transition_mm = rest_mm + (*transition_mm - rest_mm) * knee;
    }
    let common = normal.factor(uncertainty.chord_length_common);
    for length_mm in &mut model.chords.rest_length_mm {
        *length_mm *= common * normal.factor(uncertainty.chord_length);
    }
    for index in 0..model.papillary.len() {
        let shift_mm = normal.vector() * uncertainty.papillary_mm;
        for tip in model.papillary[index].tips.clone() {
            move_target(&mut model, tip, shift_mm);
        }
    }
    move_annulus(&mut model, uncertainty.annulus_mm, &mut normal);
    model
}

/// Makes springs stiffen at so many times their strain; membranes keep their laws.
fn scale_transition_strain(tissue: &mut Tissue, factor: f64) {
    match tissue {
        Tissue::BilinearSprings {
            transition_strain, ..
        } => *transition_strain *= factor,
        Tissue::AnisotropicSprings {
            circumferential,
            radial,
            ..
        } => {
            circumferential.transition_strain *= factor;
            radial.transition_strain *= factor;
        }
        Tissue::StVenantKirchhoff { .. } | Tissue::Exponential { .. } | Tissue::MayNewman { .. } => {}
    }
}

/// A sum of harmonics along the annulus, each with the same expected square, that add up to the standard deviation.
fn move_annulus(model: &mut Model, deviation_mm: f64, normal: &mut Normal) {
    let amplitude_mm = deviation_mm / f64::from(HARMONICS + 1).sqrt();
    let waves: Vec<[Vec3; 2]> = (0..=HARMONICS)
        .map(|_| [normal.vector(), normal.vector()])
        .collect();
    let annulus = model.annulus.clone();
    let curve_mm: Vec<Vec3> = annulus
        .iter()
        .map(|&vertex| model.rest_mm[vertex as usize])
        .collect();
    let along_mm = polyline::arc_lengths(&curve_mm, true);
    let length_mm = along_mm.last().copied().unwrap_or_default();
    for (&vertex, along) in annulus.iter().zip(&along_mm) {
        let angle = std::f64::consts::TAU * along / length_mm;
        let wave = |(harmonic, [cosine, sine]): (usize, &[Vec3; 2])| {
            let angle = angle * harmonic as f64;
            cosine * angle.cos() + sine * angle.sin()
        };
        let shift_mm: Vec3 = waves.iter().enumerate().map(wave).sum();
        move_target(model, vertex, shift_mm * amplitude_mm);
    }
}

fn move_target(model: &mut Model, vertex: u32, shift_mm: Vec3) {
    if let Some(target) = model.target_mut(vertex) {
        *target += shift_mm;
    }
}

/// Normal random numbers of one sample.
struct Normal(Pcg64Mcg);

/// Beyond so many standard deviations a number is drawn again.
const FARTHEST: f64 = 3.0;

impl Normal {
    fn new(seed: u64, number: u32) -> Self {
        // The lowest bit of its state is always set: it tells nothing apart.
        let mut generator = Pcg64Mcg::new((u128::from(seed) << 32 | u128::from(number)) << 1 | 1);
        // Neighbouring states begin alike.
        for _ in 0..8 {
            let _ = generator.next_u64();
        }
        Self(generator)
    }

    /// Uniform in (0, 1].
    fn uniform(&mut self) -> f64 {
        ((self.0.next_u64() >> 11) + 1) as f64 / (1_u64 << 53) as f64
    }

    /// By Box and Muller (1958).
    fn draw(&mut self) -> f64 {
        loop {
            let (radius, turn) = (self.uniform(), self.uniform());
            let value = (-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * turn).cos();
            if value.abs() <= FARTHEST {
                return value;
            }
        }
    }

    fn factor(&mut self, deviation: f64) -> f64 {
        1.0 + deviation * self.draw()
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.draw(), self.draw(), self.draw())
    }
}

#[cfg(test)]
mod tests;
