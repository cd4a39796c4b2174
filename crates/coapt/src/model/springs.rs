//! Spring constants from the leaflets' moduli.

use super::surface::Surface;
use crate::Vec3;
use crate::energy::bilinear_spring::Springs;
use crate::mesh::topology::Edges;
use crate::scene::{Leaflet, Tissue};

/// What a face is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct FaceTissue {
    /// Thickness [mm].
    pub(crate) thickness_mm: f64,
    /// Modulus below the transition [MPa].
    pub(crate) soft_mpa: f64,
    /// Modulus above the transition [MPa].
    pub(crate) stiff_mpa: f64,
    /// Modulus in compression [MPa].
    pub(crate) compression_mpa: f64,
    /// Transition strain times the modulus below it [MPa].
    pub(crate) knee_mpa: f64,
}

/// The springs of leaflets that are each of one tissue.
pub(crate) fn springs(surface: &Surface, edges: &Edges, leaflets: &[Leaflet]) -> Springs {
    let tissues: Vec<FaceTissue> = leaflets.iter().map(of_leaflet).collect();
    let of_face = |face: usize| tissues[surface.face_leaflet[face] as usize];
    of_faces(&surface.points, &surface.faces, edges, of_face)
}

fn of_leaflet(leaflet: &Leaflet) -> FaceTissue {
    let Tissue::BilinearSprings {
        pre_transition_modulus_mpa,
        transition_strain,
        post_transition_modulus_mpa,
        compression_modulus_ratio,
        ..
    } = leaflet.tissue;
    FaceTissue {
        thickness_mm: leaflet.thickness_mm,
        soft_mpa: pre_transition_modulus_mpa,
        stiff_mpa: post_transition_modulus_mpa,
        compression_mpa: compression_modulus_ratio * pre_transition_modulus_mpa,
        knee_mpa: transition_strain * pre_transition_modulus_mpa,
    }
}

/// One spring per edge. Each face next to it adds E t A / L² (Van Gelder 1998: stiffness goes with triangle area
/// over edge length squared), in its own tissue; on equilateral triangles this is exactly a membrane of
/// modulus E and Poisson ratio 1/3 (Lloyd, Székely & Harders 2007).
///
/// The stiff branch begins at (1 + transition strain) times the rest length; where two tissues meet, at the mean
/// weighted by their soft stiffnesses.
pub(crate) fn of_faces(
    points: &[Vec3],
    faces: &[[u32; 3]],
    edges: &Edges,
    tissue: impl Fn(usize) -> FaceTissue,
) -> Springs {
    let mut springs = Springs::default();
    for edge in 0..edges.len() {
        let [a, b] = edges.ends[edge];
        let length = (points[a as usize] - points[b as usize]).norm();
        let (mut soft, mut stiff, mut compression, mut knee) = (0.0, 0.0, 0.0, 0.0);
        for &face in edges.faces_of(edge) {
            let tissue = tissue(face as usize);
            let [p, q, r] = faces[face as usize].map(|v| points[v as usize]);
            let area = 0.5 * (q - p).cross(&(r - p)).norm();
            let width = tissue.thickness_mm * area / (length * length);
            soft += tissue.soft_mpa * width;
            stiff += tissue.stiff_mpa * width;
            compression += tissue.compression_mpa * width;
            knee += tissue.knee_mpa * width;
        }
        springs.ends.push([a, b]);
        springs.rest_length_mm.push(length);
        springs.transition_length_mm.push(length * (1.0 + knee / soft));
        springs.soft_n_per_mm.push(soft);
        springs.stiff_n_per_mm.push(stiff);
        springs.compression_n_per_mm.push(compression);
    }
    springs
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::skirt;
    use super::*;
    use crate::mesh::topology;

    #[test]
    fn spring_constants_are_van_gelders() {
        // Two equilateral triangles, E t = 2 N/mm: inside sqrt(3)/2 E t, at the border half of that.
        let high = 0.75_f64.sqrt();
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.5, high], [1.5, high]];
        let surface = Surface {
            points: corners.map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec(),
            faces: vec![[0, 1, 2], [2, 1, 3]],
            face_leaflet: vec![0, 1],
            ..Surface::default()
        };
        let mut leaflets = skirt().leaflets;
        let tissue = |soft: f64, knee: f64| Tissue::BilinearSprings {
            pre_transition_modulus_mpa: soft,
            transition_strain: knee,
            post_transition_modulus_mpa: 10.0,
            compression_modulus_ratio: 0.5,
            bending_modulus_ratio: 0.0,
        };
        leaflets[0].tissue = tissue(2.0, 0.1);
        leaflets[1].tissue = tissue(6.0, 0.3);
        let edges = topology::edges(&surface.faces);
        let springs = springs(&surface, &edges, &leaflets);
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
}
