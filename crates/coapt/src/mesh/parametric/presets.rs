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
/// leaflets are a little lower on the longer hinge: 1.1 times the healthy area, where ventricular dysfunction has 1.0
/// to 1.35 (35 ± 20 % more, Chaput 2008), on an annulus 1.35 times as large.
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
    valve.leaflets.height_scale *= 0.89;
    // 4.4 mm in all, at the lower end of the 3-8 mm usual for symmetric tethering: enough for a tenting volume of 5.3 mL
    // (5.2 ± 1.8 mL in the same patients) and an orifice of 20 mm².
    valve.papillary.anterolateral_shift_mm = [2.5, 3.0, -2.0];
    valve.papillary.posteromedial_shift_mm = [-2.5, 3.0, -2.0];
}

/// The six marginal chordae that reach two fifths of the posterior margin, which is all of P2 (28 % of the hinge) and
/// its borders, and the two intermediate ones behind them: with fewer, P2 stays below the anterior leaflet. The annulus is enlarged with its saddle kept
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
    valve.leaflets.height_scale *= 0.96;
    valve.leaflets.posterior_heights_mm[1] *= 1.1;
    valve.chordae.ruptured_posterior_fraction = 0.4;
}

/// Annulus about 1500 mm² and flattened (77 patients, Cardiovascular Ultrasound 2016); heights x1.3-1.6: P2 is higher
/// than 20 mm; rest lengths x1.1-1.4, counting the tips, which lie 6 mm lower and 4 mm wider in the larger ventricle
/// (our choice: the open margins keep clear of them); myxomatous tissue half as stiff with a later knee.
fn enlarge(valve: &mut ValveParameters) {
    valve.annulus = AnnulusDimensions {
        transverse_mm: 46.0,
        anteroposterior_mm: 40.0,
        anterior_fraction: 0.45,
        anterior_height_mm: 4.5,
        posterior_height_mm: 0.8,
        ..valve.annulus
    };
    valve.leaflets.height_scale *= 1.28;
    valve.leaflets.thickness_mm = 1.5;
    valve.leaflets.tissue = scaled(valve.leaflets.tissue, 0.5, 1.3);
    valve.papillary.anterolateral_mm = [16.0, 5.0, -26.0];
    valve.papillary.posteromedial_mm = [-16.0, 6.0, -27.0];
    valve.chordae.rest_length_scale = 1.2;
}

/// Three times as stiff with an early knee, twice as thick, posterior leaflet lower; rest lengths x0.87, of the
/// x0.7-0.9 usual for rheumatic valves, which makes an orifice of 20-40 mm². The heights are unloaded ones: tissue
/// that hardly stretches needs 10 % more of them to be imaged at the usual size under pressure (our choice).
fn restrict(valve: &mut ValveParameters) {
    valve.leaflets.posterior_heights_mm = valve.leaflets.posterior_heights_mm.map(|height| 0.9 * height);
    valve.leaflets.height_scale *= 1.055;
    valve.leaflets.thickness_mm = 2.0;
    valve.leaflets.tissue = scaled(valve.leaflets.tissue, 3.0, 0.4);
    valve.chordae.rest_length_scale = 0.87;
}

/// Springs with both moduli and the transition strain multiplied; presets are made of springs.
fn scaled(mut tissue: Tissue, modulus: f64, transition: f64) -> Tissue {
    if let Tissue::BilinearSprings {
        pre_transition_modulus_mpa,
        transition_strain,
        post_transition_modulus_mpa,
        ..
    } = &mut tissue
    {
        *pre_transition_modulus_mpa *= modulus;
        *transition_strain *= transition;
        *post_transition_modulus_mpa *= modulus;
    }
    tissue
}
