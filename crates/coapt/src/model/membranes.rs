//! Membranes from the leaflets' tissues.

use super::LeafletTissue;
use super::elasticity::Sheet;
use crate::Vec3;
use crate::energy::membrane::{self, Law, Membranes, exponential, may_newman, st_venant_kirchhoff};
use crate::scene::{Tissue, Wrinkling};

/// A triangle of membrane for each face whose leaflet is one; `fibres` hold the fibre direction of each face.
pub(super) fn membranes(sheet: &Sheet, fibres: &[Vec3]) -> Membranes {
    let of_leaflet: Vec<Option<membrane::Tissue>> = sheet.leaflets.iter().map(tissue).collect();
    let is_membrane = |leaflet: usize| u32::from(of_leaflet[leaflet].is_some());
    let number = |leaflet: usize| (0..leaflet).map(is_membrane).sum();
    let mut membranes = Membranes {
        tissues: of_leaflet.iter().flatten().copied().collect(),
        ..Membranes::default()
    };
    for (face, &corners) in sheet.faces.iter().enumerate() {
        let leaflet = sheet.face_leaflet[face] as usize;
        if of_leaflet[leaflet].is_some() {
            let thickness_mm = sheet.leaflets[leaflet].thickness_mm;
            membranes.push(
                corners,
                number(leaflet),
                thickness_mm,
                sheet.rest_mm,
                fibres[face],
            );
        }
    }
    membranes
}

/// What a leaflet is as a membrane; nothing where it is a network of springs.
pub(super) fn tissue(leaflet: &LeafletTissue) -> Option<membrane::Tissue> {
    let (law, wrinkling) = match leaflet.tissue {
        Tissue::BilinearSprings { .. } | Tissue::AnisotropicSprings { .. } => return None,
        Tissue::StVenantKirchhoff {
            modulus_mpa,
            poisson_ratio,
            wrinkling,
            ..
        } => (
            Law::StVenantKirchhoff(st_venant_kirchhoff::Constants {
                modulus_mpa,
                poisson_ratio,
            }),
            wrinkling,
        ),
        Tissue::Exponential {
            c0_mpa,
            c1_mpa,
            c2,
            compressibility_per_mpa,
            wrinkling,
            ..
        } => (
            Law::Exponential(exponential::Constants {
                c0_mpa,
                c1_mpa,
                c2,
                compressibility_per_mpa,
            }),
            wrinkling,
        ),
        Tissue::MayNewman {
            c0_mpa,
            c1,
            c2,
            wrinkling,
            ..
        } => (
            Law::MayNewman(may_newman::Constants { c0_mpa, c1, c2 }),
            wrinkling,
        ),
    };
    Some(membrane::Tissue {
        law,
        wrinkles: wrinkling == Wrinkling::TensionField,
    })
}
