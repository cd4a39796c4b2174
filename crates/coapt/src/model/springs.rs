//! Spring constants from the leaflets' moduli.

use super::LeafletTissue;
use super::elasticity::Sheet;
use crate::Vec3;
use crate::energy::bilinear_spring::Springs;
use crate::mesh::topology::Edges;
use crate::scene::{SpringBranches, Tissue};

/// The tissue of a spring in one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Branches {
    /// Below the transition strain and above it.
    tension: SpringBranches,
    /// Modulus in compression [MPa].
    compression_mpa: f64,
}

/// One spring per edge of a leaflet made of them. Each face next to it adds E t A / L² (Van Gelder 1998: stiffness goes with
/// triangle area over edge length squared), in its own tissue; on equilateral triangles this is exactly a membrane of
/// modulus E and Poisson ratio 1/3 (Lloyd, Székely & Harders 2007).
///
/// The stiff branch begins at (1 + transition strain) times the rest length; where two tissues meet, at the mean
/// weighted by their soft stiffnesses. `fibres` hold the circumferential direction of each face.
pub(super) fn springs(sheet: &Sheet, edges: &Edges, fibres: &[Vec3]) -> Springs {
    let mut springs = Springs::default();
    for (edge, &[a, b]) in edges.ends.iter().enumerate() {
        let along = sheet.rest_mm[b as usize] - sheet.rest_mm[a as usize];
        let length = along.norm();
        let (mut soft, mut stiff, mut compression, mut knee) = (0.0, 0.0, 0.0, 0.0);
        for &face in edges.faces_of(edge) {
            let leaflet = sheet.leaflet(face);
            let Some(Branches {
                tension,
                compression_mpa,
            }) = branches(leaflet, along, fibres[face as usize])
            else {
                continue;
            };
            let [p, q, r] = sheet.faces[face as usize].map(|v| sheet.rest_mm[v as usize]);
            let area = 0.5 * (q - p).cross(&(r - p)).norm();
            let width = leaflet.thickness_mm * area / (length * length);
            soft += tension.pre_transition_modulus_mpa * width;
            stiff += tension.post_transition_modulus_mpa * width;
            compression += compression_mpa * width;
            knee += tension.transition_strain * tension.pre_transition_modulus_mpa * width;
        }
        if soft > 0.0 {
            springs.ends.push([a, b]);
            springs.rest_length_mm.push(length);
            springs.transition_length_mm.push(length * (1.0 + knee / soft));
            springs.soft_n_per_mm.push(soft);
            springs.stiff_n_per_mm.push(stiff);
            springs.compression_n_per_mm.push(compression);
        }
    }
    springs
}

/// The tissue along a direction; nothing where the leaflet is a membrane.
fn branches(leaflet: &LeafletTissue, along: Vec3, fibre: Vec3) -> Option<Branches> {
    let (tension, compression_modulus_ratio) = match leaflet.tissue {
        Tissue::BilinearSprings {
            pre_transition_modulus_mpa,
            transition_strain,
            post_transition_modulus_mpa,
            compression_modulus_ratio,
            ..
        } => (
            SpringBranches {
                pre_transition_modulus_mpa,
                transition_strain,
                post_transition_modulus_mpa,
            },
            compression_modulus_ratio,
        ),
        Tissue::AnisotropicSprings {
            circumferential,
            radial,
            compression_modulus_ratio,
            ..
        } => (
            between(&circumferential, &radial, along, fibre),
            compression_modulus_ratio,
        ),
        Tissue::StVenantKirchhoff { .. } | Tissue::Exponential { .. } | Tissue::MayNewman { .. } => {
            return None;
        }
    };
    Some(Branches {
        tension,
        compression_mpa: compression_modulus_ratio * tension.pre_transition_modulus_mpa,
    })
}

/// The branches along an edge; without fibres, as along them.
fn between(
    circumferential: &SpringBranches,
    radial: &SpringBranches,
    along: Vec3,
    fibre: Vec3,
) -> SpringBranches {
    let lengths_squared = along.norm_squared() * fibre.norm_squared();
    let cosine_squared = match lengths_squared > 0.0 {
        true => (along.dot(&fibre).powi(2) / lengths_squared).min(1.0),
        false => 1.0,
    };
    SpringBranches::between(circumferential, radial, cosine_squared)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::topology;

    fn leaflet(tissue: Tissue) -> LeafletTissue {
        LeafletTissue {
            name: String::new(),
            thickness_mm: 1.0,
            tissue,
        }
    }

    #[test]
    fn spring_constants_are_van_gelders() {
        // Two equilateral triangles, E t = 2 N/mm: inside sqrt(3)/2 E t, at the border half of that.
        let high = 0.75_f64.sqrt();
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.5, high], [1.5, high]];
        let points = corners.map(|[x, y]| Vec3::new(x, y, 0.0));
        let faces = [[0, 1, 2], [2, 1, 3]];
        let tissue = |soft: f64, knee: f64| Tissue::BilinearSprings {
            pre_transition_modulus_mpa: soft,
            transition_strain: knee,
            post_transition_modulus_mpa: 10.0,
            compression_modulus_ratio: 0.5,
            bending_modulus_ratio: 0.0,
        };
        let sheet = Sheet {
            rest_mm: &points,
            faces: &faces,
            face_leaflet: &[0, 1],
            annulus: &[],
            leaflets: &[leaflet(tissue(2.0, 0.1)), leaflet(tissue(6.0, 0.3))],
        };
        let springs = springs(&sheet, &topology::edges(&faces), &[Vec3::zeros(); 2]);
        let root = 3.0_f64.sqrt() / 4.0;
        let inner = springs.ends.iter().position(|&e| e == [1, 2]).unwrap();
        // Rounding only: a dozen operations on numbers near 1.
        let close = |a: f64, b: f64| (a - b).abs() < 1e-14 * 16.0;
        assert!(close(springs.soft_n_per_mm[inner], root * 8.0));
        assert!(close(springs.stiff_n_per_mm[inner], root * 20.0));
        assert!(close(springs.compression_n_per_mm[inner], root * 4.0));
        assert!(close(
            springs.transition_length_mm[inner],
            1.0 + (2.0 * 0.1 + 6.0 * 0.3) / 8.0
        ));
        assert!(close(springs.soft_n_per_mm[0], root * 2.0));
        assert!(close(springs.transition_length_mm[0], 1.1));
    }

    /// Along the fibres, across them and in between (√X₀ cos²φ + √X₉₀ sin²φ)².
    #[test]
    fn springs_take_the_tissue_of_their_direction() {
        let branches = |soft: f64, knee: f64| SpringBranches {
            pre_transition_modulus_mpa: soft,
            transition_strain: knee,
            post_transition_modulus_mpa: 16.0 * soft,
        };
        let (around, outward) = (branches(1.0, 0.09), branches(4.0, 0.36));
        let fibre = Vec3::new(0.0, -2.0, 0.0);
        let blended = |along: Vec3| between(&around, &outward, along, fibre);
        assert_eq!(blended(Vec3::y()), around);
        assert_eq!(blended(Vec3::x()), outward);
        let diagonal = blended(Vec3::new(3.0, 3.0, 0.0));
        assert!((diagonal.pre_transition_modulus_mpa - 2.25).abs() < 1e-14);
        assert!((diagonal.transition_strain - 0.2025).abs() < 1e-14);
        assert!((diagonal.post_transition_modulus_mpa - 36.0).abs() < 1e-13);
    }
}
