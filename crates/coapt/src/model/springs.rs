//! Spring constants from the leaflets' moduli.

use super::surface::Surface;
use crate::energy::bilinear_spring::Springs;
use crate::mesh::topology::Edges;
use crate::scene::{Leaflet, Tissue};

/// One spring per edge. Each face next to it adds E t A / L² (Van Gelder 1998: stiffness goes with triangle area
/// over edge length squared), in its own leaflet's tissue; on equilateral triangles this is exactly a membrane of
/// modulus E and Poisson ratio 1/3 (Lloyd, Székely & Harders 2007).
///
/// The stiff branch begins at (1 + transition strain) times the rest length; where two tissues meet, at the mean
/// weighted by their soft stiffnesses.
pub(crate) fn springs(surface: &Surface, edges: &Edges, leaflets: &[Leaflet]) -> Springs {
    let mut springs = Springs::default();
    for edge in 0..edges.len() {
        let [a, b] = edges.ends[edge];
        let length = (surface.points[a as usize] - surface.points[b as usize]).norm();
        let (mut soft, mut stiff, mut compression, mut knee) = (0.0, 0.0, 0.0, 0.0);
        for &face in edges.faces_of(edge) {
            let leaflet = &leaflets[surface.face_leaflet[face as usize] as usize];
            let Tissue::BilinearSprings {
                pre_transition_modulus_mpa,
                transition_strain,
                post_transition_modulus_mpa,
                compression_modulus_ratio,
            } = leaflet.tissue;
            let [p, q, r] = surface.corners(face as usize);
            let area = 0.5 * (q - p).cross(&(r - p)).norm();
            let width = leaflet.thickness_mm * area / (length * length);
            soft += pre_transition_modulus_mpa * width;
            stiff += post_transition_modulus_mpa * width;
            compression += compression_modulus_ratio * pre_transition_modulus_mpa * width;
            knee += transition_strain * pre_transition_modulus_mpa * width;
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
