//! Valves as they come to the surgeon.

use serde::{Deserialize, Serialize};

use super::parameters::{AnnulusDimensions, ValveParameters};
use crate::scene::Tissue;

/// A class of valve. The recipes are our choice, within the published ranges named at each.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// Closes along its whole line.
    Healthy,
    /// Functional regurgitation: wide annulus, displaced papillary muscles, leaflets and chordae normal.
    Dilated,
    /// Fibroelastic deficiency: ruptured marginal chordae at P2.
    Flail,
    /// Barlow's disease: large, flat annulus, excess soft tissue, long chordae.
    Barlow,
    /// Rheumatic-like: stiff thick leaflets, short chordae.
    Restricted,
}

impl Preset {
    /// All presets.
    pub const ALL: [Self; 5] = [
        Self::Healthy,
        Self::Dilated,
        Self::Flail,
        Self::Barlow,
        Self::Restricted,
    ];

    /// Name as written in scenes and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Healthy => "healthy",
            Self::Dilated => "dilated",
            Self::Flail => "flail",
            Self::Barlow => "barlow",
            Self::Restricted => "restricted",
        }
    }

    /// The preset of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|preset| preset.name() == name)
    }
}

impl ValveParameters {
    /// The parameters of a preset.
    pub fn preset(preset: Preset) -> Self {
        let mut valve = Self {
            name: preset.name().into(),
            ..Self::default()
        };
        match preset {
            Preset::Healthy => {}
            Preset::Dilated => dilate(&mut valve),
            Preset::Flail => rupture(&mut valve),
            Preset::Barlow => enlarge(&mut valve),
            Preset::Restricted => restrict(&mut valve),
        }
        valve
    }
}

/// Functional regurgitation, symmetric. Annulus: 43 x 34 mm and 5.9 mm high at mid-systole (PMC7368231). The
/// leaflets are a little lower on the longer hinge, so that their area stays within 1.0 to 1.1 of the healthy
/// one.
fn dilate(valve: &mut ValveParameters) {
    valve.chordae.rest_annulus = Some(valve.annulus);
    valve.annulus = AnnulusDimensions {
        transverse_mm: 43.0,
        anteroposterior_mm: 34.0,
        anterior_fraction: 0.45,
        anterior_height_mm: 5.9,
        posterior_height_mm: 1.2,
        ..valve.annulus
    };
    valve.leaflets.height_scale *= 0.9;
    // 5 mm apical, 4 mm to the side and back: within the 3-8 mm usual for symmetric tethering.
    let sideways = 4.0 / f64::sqrt(2.0);
    valve.papillary.anterolateral_shift_mm = [sideways, sideways, -5.0];
    valve.papillary.posteromedial_shift_mm = [-sideways, sideways, -5.0];
}

/// The six marginal chordae that reach two fifths of the posterior margin, and the two intermediate ones
/// behind them: with fewer, P2 stays below the anterior leaflet. The annulus is enlarged with its saddle kept
/// (about 1300 mm² in fibroelastic deficiency, same 77 patients as below) and P2 a little higher.
fn rupture(valve: &mut ValveParameters) {
    valve.annulus = AnnulusDimensions {
        transverse_mm: 44.0,
        anteroposterior_mm: 36.0,
        anterior_fraction: 0.42,
        anterior_height_mm: 8.0,
        posterior_height_mm: 2.5,
        ..valve.annulus
    };
    valve.leaflets.posterior_heights_mm[1] *= 1.1;
    valve.chordae.ruptured_posterior_fraction = 0.4;
}

/// Annulus about 1500 mm² and flattened (77 patients, Cardiovascular Ultrasound 2016); heights x1.3-1.6, rest
/// lengths x1.1-1.4; myxomatous tissue half as stiff with a later knee.
fn enlarge(valve: &mut ValveParameters) {
    valve.annulus = AnnulusDimensions {
        transverse_mm: 46.0,
        anteroposterior_mm: 40.0,
        anterior_fraction: 0.45,
        anterior_height_mm: 4.5,
        posterior_height_mm: 0.8,
        ..valve.annulus
    };
    valve.leaflets.height_scale *= 1.4;
    valve.leaflets.thickness_mm = 1.5;
    valve.leaflets.tissue = scaled(valve.leaflets.tissue, 0.5, 1.3);
    valve.chordae.rest_length_scale = 1.25;
}

/// Three times as stiff with an early knee, twice as thick; rest lengths x0.7-0.9.
fn restrict(valve: &mut ValveParameters) {
    valve.leaflets.posterior_heights_mm = valve.leaflets.posterior_heights_mm.map(|height| 0.9 * height);
    valve.leaflets.thickness_mm = 2.0;
    valve.leaflets.tissue = scaled(valve.leaflets.tissue, 3.0, 0.4);
    valve.chordae.rest_length_scale = 0.8;
}

/// A tissue with both moduli and the transition strain multiplied.
fn scaled(tissue: Tissue, modulus: f64, transition: f64) -> Tissue {
    match tissue {
        Tissue::BilinearSprings {
            pre_transition_modulus_mpa,
            transition_strain,
            post_transition_modulus_mpa,
            compression_modulus_ratio,
        } => Tissue::BilinearSprings {
            pre_transition_modulus_mpa: pre_transition_modulus_mpa * modulus,
            transition_strain: transition_strain * transition,
            post_transition_modulus_mpa: post_transition_modulus_mpa * modulus,
            compression_modulus_ratio,
        },
    }
}
