//! What the coarse faces are made of: the mean of the fine faces that went into each.

use super::thin::NONE;
use crate::energy::bilinear_spring::Springs;
use crate::mesh::topology::Edges;
use crate::model::Model;
use crate::model::springs::FaceTissue;

/// The tissue of each fine face, read back from the springs at its sides by the rule that made them.
///
/// A spring holds the mean tissue of the faces at its edge, so that only edges within one leaflet tell about
/// it. A face that has none takes what it gets from all three.
pub(super) fn of_fine_faces(model: &Model, edges: &Edges, area_mm2: &[f64]) -> Vec<FaceTissue> {
    let mut within = vec![Sum::default(); model.faces.len()];
    let mut all = within.clone();
    for edge in 0..edges.len() {
        let faces = edges.faces_of(edge);
        let area: f64 = faces.iter().map(|&f| area_mm2[f as usize]).sum();
        let tissue = of_spring(&model.springs, edge, area);
        let leaflet = model.face_leaflet[faces[0] as usize];
        let is_within = faces.iter().all(|&f| model.face_leaflet[f as usize] == leaflet);
        for &face in faces {
            all[face as usize].add(&tissue, 1.0);
            if is_within {
                within[face as usize].add(&tissue, 1.0);
            }
        }
    }
    let mean = |face: usize| {
        let sum = if within[face].weight > 0.0 { &within } else { &all };
        sum[face].mean()
    };
    (0..model.faces.len()).map(mean).collect()
}

/// What a spring whose faces have this area is made of. It knows stiffness times thickness only: the thickness
/// is 1.
fn of_spring(springs: &Springs, index: usize, area_mm2: f64) -> FaceTissue {
    let length = springs.rest_length_mm[index];
    let per_width = length * length / area_mm2;
    let soft_mpa = springs.soft_n_per_mm[index] * per_width;
    FaceTissue {
        thickness_mm: 1.0,
        soft_mpa,
        stiff_mpa: springs.stiff_n_per_mm[index] * per_width,
        compression_mpa: springs.compression_n_per_mm[index] * per_width,
        knee_mpa: soft_mpa * (springs.transition_length_mm[index] / length - 1.0),
    }
}

/// The mean tissue of the fine faces whose heir each face is, weighted by their area.
pub(super) fn merged(fine: &[FaceTissue], area_mm2: &[f64], heir: &[u32]) -> Vec<FaceTissue> {
    let mut sums = vec![Sum::default(); fine.len()];
    for face in 0..fine.len() {
        let mut last = face as u32;
        while last != NONE && heir[last as usize] != last {
            last = heir[last as usize];
        }
        if last != NONE {
            sums[last as usize].add(&fine[face], area_mm2[face]);
        }
    }
    sums.iter().map(|sum| sum.mean()).collect()
}

/// A weighted sum of tissues of thickness 1.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    weight: f64,
    total: FaceTissue,
}

impl Sum {
    fn add(&mut self, tissue: &FaceTissue, weight: f64) {
        self.weight += weight;
        self.total.soft_mpa += weight * tissue.soft_mpa;
        self.total.stiff_mpa += weight * tissue.stiff_mpa;
        self.total.compression_mpa += weight * tissue.compression_mpa;
        self.total.knee_mpa += weight * tissue.knee_mpa;
    }

    fn mean(&self) -> FaceTissue {
        FaceTissue {
            thickness_mm: 1.0,
            soft_mpa: self.total.soft_mpa / self.weight,
            stiff_mpa: self.total.stiff_mpa / self.weight,
            compression_mpa: self.total.compression_mpa / self.weight,
            knee_mpa: self.total.knee_mpa / self.weight,
        }
    }
}
