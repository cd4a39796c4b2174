//! The cards of membrane laws.

use coapt::model::Model;

use super::super::material::Material;
use super::super::{density, put};

/// The laws of [`Material`], all of which FEBio has.
pub(super) const LAWS: &str = "st-venant-kirchhoff, exponential, each with wrinkling = resolved";

pub(super) fn put_materials(text: &mut String, model: &Model, materials: &[Material]) {
    let density = density(model);
    put(text, format_args!("<Material>"));
    for (leaflet, material) in materials.iter().enumerate() {
        let name = leaflet + 1;
        let (kind, constants) = card(material);
        put(
            text,
            format_args!(
                "<material id=\"{name}\" name=\"tissue{name}\" type=\"{kind}\">\n<density>{density:?}</density>{constants}\n\
                 </material>"
            ),
        );
    }
    put(text, format_args!("</Material>"));
}

/// FEBio's name of a law, and its constants.
fn card(material: &Material) -> (&'static str, String) {
    match *material {
        // As for CalculiX: without Poisson's effect across, the plane part is that of plane stress.
        Material::StVenantKirchhoff {
            modulus_mpa: modulus,
            poisson_ratio: ratio,
        } => {
            let shear = modulus / (2.0 + 2.0 * ratio);
            (
                "orthotropic elastic",
                format!(
                    "<E1>{modulus:?}</E1><E2>{modulus:?}</E2><E3>{modulus:?}</E3>\
                     <v12>{ratio:?}</v12><v23>0</v23><v31>0</v31>\
                     <G12>{shear:?}</G12><G23>{shear:?}</G23><G31>{shear:?}</G31><mat_axis type=\"local\">1,2,3</mat_axis>"
                ),
            )
        }
        Material::Exponential {
            c0_mpa,
            c1_mpa,
            c2,
            compressibility_per_mpa,
        } => {
            let bulk = 2.0 / compressibility_per_mpa;
            (
                "uncoupled isotropic Lee-Sacks",
                format!(
                    "<c0>{c0_mpa:?}</c0><c1>{c1_mpa:?}</c1><c2>{c2:?}</c2><k>{bulk:?}</k><tangent_scale>1</tangent_scale>"
                ),
            )
        }
    }
}

pub(super) fn description(material: &Material) -> String {
    match material {
        Material::StVenantKirchhoff { .. } => {
            "st-venant-kirchhoff -> orthotropic elastic, across the membrane without \
                                               Poisson's effect: plane stress"
                .to_owned()
        }
        Material::Exponential {
            compressibility_per_mpa,
            ..
        } => format!(
            "exponential -> uncoupled isotropic Lee-Sacks with bulk modulus {:?} MPa",
            2.0 / compressibility_per_mpa
        ),
    }
}
