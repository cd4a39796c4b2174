//! The cards of membrane laws.

use coapt::Vec3;
use coapt::model::Model;

use super::super::material::Material;
use super::super::{corners, density, put};
use super::number;

/// Laws that [`card`] knows.
pub(super) const LAWS: &str =
    "st-venant-kirchhoff, exponential with c1_mpa = 0 (neo-Hookean), each with wrinkling = resolved";

pub(super) fn put_materials(text: &mut String, model: &Model, materials: &[Material]) {
    let density = density(model);
    for (leaflet, material) in materials.iter().enumerate() {
        let name = leaflet + 1;
        // The caller has refused all that have no card.
        let card = card(material).unwrap_or_default();
        put(
            text,
            format_args!(
                "*MATERIAL, NAME=LEAFLET{name}\n{card}*DENSITY\n{}",
                number(density)
            ),
        );
        if !needs_axes(material) {
            put(
                text,
                format_args!("*SOLID SECTION, ELSET=LEAFLET{name}, MATERIAL=LEAFLET{name}"),
            );
        }
    }
    for face in 0..model.faces.len() {
        let leaflet = model.face_leaflet[face] as usize;
        if needs_axes(&materials[leaflet]) {
            put_section(text, face + 1, leaflet + 1, corners(model, face));
        }
    }
}

/// A section with axes of its own: the third along the normal; where the first two lie in the plane does not matter.
fn put_section(text: &mut String, element: usize, leaflet: usize, [a, b, c]: [Vec3; 3]) {
    let (first, second) = (b - a, c - a);
    let axes = [first.x, first.y, first.z, second.x, second.y, second.z]
        .map(number)
        .join(", ");
    put(
        text,
        format_args!(
            "*ORIENTATION, NAME=AXES{element}, SYSTEM=RECTANGULAR\n{axes}\n*ELSET, ELSET=FACE{element}\n{element}\n\
             *SOLID SECTION, ELSET=FACE{element}, MATERIAL=LEAFLET{leaflet}, ORIENTATION=AXES{element}"
        ),
    );
}

fn needs_axes(material: &Material) -> bool {
    matches!(material, Material::StVenantKirchhoff { .. })
}

/// The card of a law, where CalculiX has one.
pub(super) fn card(material: &Material) -> Option<String> {
    match *material {
        // Without Poisson's effect across the membrane the plane part of the law is that of plane stress, E / (1 − ν²)
        // (1 − ν, ...), exactly; the isotropic card would be the same until the membrane is stretched so far that its
        // thickness vanishes (E₁₁ + E₂₂ = (1 − ν) / 2ν), and it has no ν = 0.5.
        Material::StVenantKirchhoff {
            modulus_mpa,
            poisson_ratio,
        } => {
            let [modulus, ratio, shear] = [
                modulus_mpa,
                poisson_ratio,
                modulus_mpa / (2.0 + 2.0 * poisson_ratio),
            ]
            .map(number);
            Some(format!(
                "*ELASTIC, TYPE=ENGINEERING CONSTANTS\n{modulus}, {modulus}, {modulus}, {ratio}, 0., 0., {shear}, \
                 {shear}\n{shear}\n"
            ))
        }
        Material::Exponential {
            c0_mpa,
            c1_mpa: 0.0,
            compressibility_per_mpa,
            ..
        } => Some(format!(
            "*HYPERELASTIC, NEO HOOKE\n{}, {}\n",
            number(0.5 * c0_mpa),
            number(compressibility_per_mpa)
        )),
        _ => None,
    }
}

pub(super) fn description(material: &Material) -> String {
    match material {
        Material::StVenantKirchhoff { .. } => {
            "st-venant-kirchhoff -> *ELASTIC, TYPE=ENGINEERING CONSTANTS, across the membrane without Poisson's effect: \
             plane stress"
                .to_owned()
        }
        Material::Exponential {
            compressibility_per_mpa, ..
        } => format!("exponential with c1 = 0 -> *HYPERELASTIC, NEO HOOKE with D1 = {compressibility_per_mpa:e} / MPa"),
    }
}
