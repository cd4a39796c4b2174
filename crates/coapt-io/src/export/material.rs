//! What leaflets and chordae are made of, in the words that other engines have for it.

use coapt::energy::chord_law::response;
use coapt::model::Model;
use coapt::scene::{ChordLaw, Fault, Tissue, Wrinkling};

/// A membrane law that other engines have too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Material {
    /// Linear in Green's strain.
    StVenantKirchhoff {
        /// Young's modulus [MPa].
        modulus_mpa: f64,
        /// Poisson's ratio [1].
        poisson_ratio: f64,
    },
    /// C₀/2 (I₁ − 3) + C₁/2 (exp(C₂ (I₁ − 3)²) − 1) + (J − 1)² / D.
    Exponential {
        /// C₀ [MPa].
        c0_mpa: f64,
        /// C₁ [MPa]; 0: neo-Hookean.
        c1_mpa: f64,
        /// C₂ [1].
        c2: f64,
        /// D [1/MPa], never 0.
        compressibility_per_mpa: f64,
    },
}

/// Bulk modulus over shear modulus of tissue that is incompressible here [1]: other engines need a finite one. A hundred
/// leaves half a per cent of the displacements of a valve, three hundred a fifth; at a thousand CalculiX fails.
const INCOMPRESSIBLE_RATIO: f64 = 300.0;

/// The material of each leaflet, shape `[leaflet]`.
///
/// # Errors
/// Each leaflet whose law `engine` does not have.
pub(super) fn materials(
    model: &Model,
    engine: &str,
    laws: &str,
    has: impl Fn(&Material) -> bool,
) -> Result<Vec<Material>, Vec<Fault>> {
    let mut faults = Vec::new();
    let mut found = Vec::new();
    for (number, leaflet) in model.leaflets.iter().enumerate() {
        match material(&leaflet.tissue) {
            Ok(material) if has(&material) => found.push(material),
            answer => {
                let law = answer.err().unwrap_or("exponential with c1_mpa above 0");
                faults.push(Fault::error(
                    format!("leaflets[{number}].tissue"),
                    format!(
                        "leaflet `{}` is made of {law}, which has no equal in {engine}; expected one of {laws}",
                        leaflet.name
                    ),
                ));
            }
        }
    }
    if faults.is_empty() { Ok(found) } else { Err(faults) }
}

/// What a tissue is elsewhere, or its name where nobody else has it.
fn material(tissue: &Tissue) -> Result<Material, &'static str> {
    match *tissue {
        Tissue::StVenantKirchhoff {
            wrinkling: Wrinkling::TensionField,
            ..
        }
        | Tissue::Exponential {
            wrinkling: Wrinkling::TensionField,
            ..
        } => Err("a membrane with wrinkling = tension-field"),
        Tissue::StVenantKirchhoff {
            modulus_mpa,
            poisson_ratio,
            ..
        } => Ok(Material::StVenantKirchhoff {
            modulus_mpa,
            poisson_ratio,
        }),
        Tissue::Exponential {
            c0_mpa,
            c1_mpa,
            c2,
            compressibility_per_mpa,
            ..
        } => Ok(Material::Exponential {
            c0_mpa,
            c1_mpa,
            c2,
            compressibility_per_mpa: match compressibility_per_mpa {
                0.0 => 2.0 / (INCOMPRESSIBLE_RATIO * c0_mpa),
                given => given,
            },
        }),
        Tissue::BilinearSprings { .. } => Err("bilinear-springs"),
        Tissue::AnisotropicSprings { .. } => Err("anisotropic-springs"),
        Tissue::MayNewman { .. } => Err("may-newman"),
    }
}

/// Largest strain of a chord that a table goes to [mm/mm]: no chord gets there.
const LARGEST_STRAIN: f64 = 10.0;

/// Straight pieces in place of a curved law. The steepest bend by e^(15 / 300) each, which leaves 3e-4 of the force.
const PIECES: u32 = 300;

/// Force [N] over elongation from the open valve on [mm], ascending: pairs of elongation and force, straight between.
/// Exact for laws of straight pieces.
pub(super) fn chord_curve(model: &Model, segment: usize) -> Vec<[f64; 2]> {
    let chords = &model.chords;
    let [from, to] = chords.ends[segment].map(|point| chords.point_mm(point, &model.rest_mm));
    let open_mm = (to - from).norm();
    let rest_mm = chords.rest_length_mm[segment];
    let law = &chords.laws[chords.group[segment] as usize];
    let mut curve = vec![[-open_mm, 0.0], [rest_mm - open_mm, 0.0]];
    curve.extend(knots(law).into_iter().map(|strain| {
        let force_n = chords.area_mm2[segment] * response(law, strain).stress_mpa;
        [rest_mm * (1.0 + strain) - open_mm, force_n]
    }));
    curve
}

/// Strains above 0 between which a law is straight, or nearly, ascending.
fn knots(law: &ChordLaw) -> Vec<f64> {
    let curved = |until: f64| (1..=PIECES).map(move |piece| until * f64::from(piece) / f64::from(PIECES));
    let mut strains: Vec<f64> = match law {
        ChordLaw::Linear { .. } => Vec::new(),
        ChordLaw::PiecewiseLinear {
            transition_strain, ..
        } => vec![*transition_strain],
        // The law itself goes on straight from an exponent of 15.
        ChordLaw::Exponential { exponent, .. } => curved(15.0 / exponent).collect(),
        ChordLaw::Collagen {
            exponent,
            full_recruitment_strain,
            ..
        } => curved(full_recruitment_strain.min(15.0 / exponent))
            .chain([*full_recruitment_strain])
            .collect(),
        ChordLaw::Table { strain, .. } => strain.clone(),
    };
    strains.retain(|&strain| strain > 0.0 && strain < LARGEST_STRAIN);
    strains.dedup();
    strains.push(LARGEST_STRAIN);
    strains
}
